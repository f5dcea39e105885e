"""Contact forces: how hard the feet of a quadruped press on the floor when it lands.

A simulation gives the force of each contact, a batch the sum on each body::

    python python/examples/contact_forces.py
    python python/examples/contact_forces.py --plot contact_forces.png
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import plots

import clench

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def main() -> None:
    """Run the example."""
    options = plots.parser(__doc__).parse_args()
    steps = 1000 if options.quick else 4000

    model = clench.Model.from_file(plots.MODELS / "quadruped.xml")
    feet = [name for name in model.names("geom") if name.endswith("foot")]
    weight = model.body("trunk").subtreemass * -model.gravity[2]

    # The wrench of a contact is in world axes, and acts on the second of its two geoms: force first, then torque.
    sim = clench.Sim(model)
    sim.reset("dropped")
    times, pressing = np.empty(steps), np.zeros((steps, len(feet)))
    for k in range(steps):
        sim.step()
        times[k] = sim.time
        for (_, geom), wrench in zip(sim.contacts.geom_names, sim.contacts.wrench):
            if geom in feet:
                pressing[k, feet.index(geom)] += wrench[2]

    peak = np.unravel_index(pressing.argmax(), pressing.shape)
    print(f"the first foot to touch: {feet[int((pressing > 0.0).argmax(axis=0).argmin())]}")
    print(f"the largest impact: {pressing.max():.0f} N on {feet[int(peak[1])]} at {times[peak[0]]:.2f} s")
    print(f"after {sim.time:.0f} s the feet carry {pressing[-1].sum():.1f} N; the weight is {weight:.1f} N")

    # Constraint rows contain the same in terms of the solver: each with its force, impedance and Jacobian.
    rows = sim.constraints
    generalized = rows.J.T @ rows.force
    print(f"{len(sim.contacts)} contacts are {len(rows)} rows, with forces along dofs up to {np.abs(generalized).max():.1f}")

    # In a batch: forces on every body, in every environment, of the last step.
    batch = clench.Batch(model, 16, record=["contact_force"])
    batch.reset(keyframe="dropped")
    batch.qpos[:, 2] += np.linspace(0.0, 0.5, 16)
    worst = np.zeros(16)
    for _ in range(400):
        batch.step()
        worst = np.maximum(worst, -batch.contact_force[:, 0, 2])  # The load on the world, body 0.
    print(f"dropped from 0 to 0.5 m higher, it strikes the floor with {worst[0]:.0f} to {worst[-1]:.0f} N")

    def draw(axes: Axes) -> None:
        for name, force in zip(feet, pressing.T):
            axes.plot(times, force, label=name.replace("_", " "))
        axes.axhline(weight / 4.0, color="black", linewidth=0.8, linestyle="--", label="a quarter of the weight")
        axes.set(xlabel="time, s", ylabel="vertical force, N", title="A quadruped lands")
        axes.legend()

    plots.finish(options, draw)


if __name__ == "__main__":
    main()
