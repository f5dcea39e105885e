"""A box slides over a floor, by MuJoCo's model of contacts and by Coulomb's law.

In MuJoCo's model sliding adds to the normal force, so the box lifts off; by Coulomb's law it stays on the floor and
stops after v² / (2 μ g)::

    python python/examples/sliding_box.py
    python python/examples/sliding_box.py --plot sliding_box.png
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import plots

import clench

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

SPEED, FRICTION, GRAVITY = 6.0, 1.0, 9.81
SCENE = f"""
<mujoco model="sliding box">
  <default><geom friction="{FRICTION} 0 0"/></default>
  <worldbody>
    <geom type="plane" size="0 0 1"/>
    <body pos="0 0 0.02"><freejoint/><geom type="box" size="0.05 0.05 0.02" mass="1"/></body>
  </worldbody>
</mujoco>
"""


def slide(model: clench.Model, seconds: float, **options: Any) -> NDArray[np.float64]:
    """Return the distance and the rise (m) of the box after each step, (steps, 2)."""
    sim = clench.Sim(model, clench.RigidOptions(**options))
    sim.step(500)
    start = sim.qpos[[0, 2]].copy()
    sim.qvel[0] = SPEED
    path = np.empty((round(seconds / model.timestep), 2))
    for row in path:
        sim.step()
        row[:] = sim.qpos[[0, 2]] - start
    return path


def main() -> None:
    """Run the example."""
    options = plots.parser(__doc__).parse_args()
    model = clench.Model.from_xml(SCENE)
    seconds = 0.7 if options.quick else 1.5
    laws: dict[str, dict[str, Any]] = {
        "convex, pyramids": {},
        "convex, elliptic cones": {"friction_cone": "elliptic"},
        "Coulomb's law": {"contact_model": "coulomb"},
    }
    paths = {name: slide(model, seconds, **law) for name, law in laws.items()}
    print(f"Coulomb's law stops the box after {SPEED**2 / (2 * FRICTION * GRAVITY):.3f} m")
    for name, path in paths.items():
        print(f"{name:22} slides {path[-1, 0]:.3f} m and rises {1000 * path[:, 1].max():7.3f} mm")

    def draw(axes: Axes) -> None:
        for name, path in paths.items():
            axes.plot(path[:, 0], 1000 * path[:, 1], label=name)
        axes.set(xlabel="distance (m)", ylabel="height above its rest (mm)", title=f"A box thrown at {SPEED:g} m/s")
        axes.legend()

    plots.finish(options, draw)


if __name__ == "__main__":
    main()
