"""Randomization: boxes of different friction and mass slide over a floor.

Each environment of a batch can have its own parameters. Here a box starts at 3 m/s in each. The distance that it slides
follows from Coulomb's law, v²/(2 μ g), for any mass::

    python python/examples/randomization.py
    python python/examples/randomization.py --plot randomization.png
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import plots

import clench

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SLIDING_BOX = """
<mujoco model="sliding box">
  <option timestep="0.002" cone="elliptic"/>
  <worldbody>
    <geom name="floor" type="plane" size="20 1 0.1" friction="0 0 0"/>
    <body name="box" pos="0 0 0.05">
      <freejoint/>
      <geom name="box" type="box" size="0.2 0.2 0.05" mass="1"/>
    </body>
  </worldbody>
</mujoco>
"""


def main() -> None:
    """Run the example."""
    options = plots.parser(__doc__).parse_args()
    n, seconds, speed = (32 if options.quick else 512), 3.5, 3.0

    model = clench.Model.from_xml(SLIDING_BOX)
    batch = clench.Batch(model, n)
    rng = np.random.default_rng(0)
    box = model.body("box").id

    # A parameter has the whole field for each environment: geom_friction is (ngeom, 3) in a model, so (n, ngeom, 3).
    friction = batch.param("geom_friction")
    friction[:, model.geom("box").id, 0] = rng.uniform(0.2, 1.0, n)
    batch.randomize("geom_friction", friction)

    mass, inertia = batch.param("body_mass"), batch.param("body_inertia")
    scale = rng.uniform(0.2, 5.0, n)
    mass[:, box] *= scale
    inertia[:, box] *= scale[:, np.newaxis]
    batch.randomize("body_mass", mass)
    batch.randomize("body_inertia", inertia)

    batch.qvel[:, 0] = speed
    failed = batch.step(round(seconds / model.timestep))
    print(f"{n} boxes, {failed} of them failed")

    coefficient, distance = friction[:, model.geom("box").id, 0], batch.qpos[:, 0]
    expected = speed**2 / (2.0 * coefficient * -model.gravity[2])
    error = distance / expected - 1.0
    print(f"they slid {distance.min():.2f} to {distance.max():.2f} m")
    print(f"against v²/(2 μ g): off by {np.abs(error).mean():.2%} on average, {np.abs(error).max():.2%} at most")
    print(f"correlation of that with mass: {np.corrcoef(error, mass[:, box])[0, 1]:+.2f}")

    def draw(axes: Axes) -> None:
        line = np.linspace(0.2, 1.0, 100)
        axes.plot(line, speed**2 / (2.0 * line * -model.gravity[2]), color="black", label="v²/(2 μ g)")
        points = axes.scatter(coefficient, distance, c=mass[:, box], s=12)
        axes.figure.colorbar(points, ax=axes, label="mass, kg")
        axes.set(xlabel="friction coefficient μ", ylabel="distance, m", title="Boxes slide to rest")
        axes.legend()

    plots.finish(options, draw)


if __name__ == "__main__":
    main()
