"""Quick start: load a model, step it, read and write its state.

A humanoid falls while its servos hold it stiff. The example shows a model with named elements, a simulation with live
arrays, contacts with their forces, and a state that is saved and restored::

    python python/examples/quick_start.py
    python python/examples/quick_start.py --plot quick_start.png
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

    model = clench.Model.from_file(plots.MODELS / "humanoid.xml")
    torso, knee = model.body("torso"), model.joint("left_knee")
    print(f"{model.name}: {model.nq} position coordinates, {model.nv} degrees of freedom, {model.nu} actuators")
    print(f"the torso weighs {torso.mass:.1f} kg; the knee bends from {knee.range[0]:.2f} to {knee.range[1]:.2f} rad")

    # State arrays are the simulation's own memory: the next step starts from the values written there.
    sim = clench.Sim(model)
    sim.reset("standing")
    sim.qvel[0] = 1.5  # A push forward, m/s.
    start = sim.state

    # All other data have MuJoCo's names.
    steps = 200 if options.quick else 1000
    times, heights = np.empty(steps), np.empty(steps)
    for k in range(steps):
        sim.step()
        times[k], heights[k] = sim.time, sim.xpos[torso.id, 2]
    print(f"after {sim.time:.1f} s the torso is at {heights[-1]:.2f} m")
    for (first, second), force in zip(sim.contacts.geom_names, sim.contacts.force):
        print(f"  {first} and {second}: {force[0]:.0f} N")
    print(f"the last solve: {sim.solver_stats.status} after {sim.solver_stats.iterations} iterations")

    # A state is converted to bytes and back, and the steps from it are bitwise the same.
    end = sim.qpos.copy()
    sim.state = clench.State.from_bytes(start.to_bytes())
    sim.step(steps)
    print(f"from the same state again: {'the same to the bit' if np.array_equal(sim.qpos, end) else 'something else'}")

    def draw(axes: Axes) -> None:
        axes.plot(times, heights)
        axes.set(xlabel="time, s", ylabel="height of the torso, m", title="A humanoid falls")

    plots.finish(options, draw)


if __name__ == "__main__":
    main()
