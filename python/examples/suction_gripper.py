"""A suction gripper picks a box up, carries it, and lets it go.

The object is selected at run time: a weld is added between the cup and the body that the cup touches, and later
removed. This is one simulation; `Batch.add_weld` does the same in chosen environments::

    python python/examples/suction_gripper.py
    python python/examples/suction_gripper.py --plot suction_gripper.png
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import plots

import clench

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def go(sim: clench.Sim, x: float, z: float, seconds: float) -> list[tuple[float, float]]:
    """Drive the gantry to a position and wait; return the positions of the box."""
    sim.actuator("x").ctrl = x
    sim.actuator("z").ctrl = z
    return rest(sim, seconds)


def rest(sim: clench.Sim, seconds: float) -> list[tuple[float, float]]:
    """Simulate some time; return the positions of the box."""
    path = []
    for _ in range(round(seconds / (10 * sim.model.timestep))):
        sim.step(10)
        path.append((sim.time, float(sim.body("box").xpos[2])))
    return path


def touched(sim: clench.Sim) -> int | None:
    """Return the body that the cup touches."""
    for contact in sim.contacts.of_geom("cup"):
        (other,) = set(contact.body) - {sim.body("cup").id}
        return other
    return None


def main() -> None:
    """Run the example."""
    options = plots.parser(__doc__).parse_args()
    sim = clench.Sim(clench.Model.from_file(plots.MODELS / "suction_gripper.xml"))
    box = sim.body("box")

    path = go(sim, 0.3, -0.475, 1.5)
    found = touched(sim)
    if found is None:
        raise SystemExit("the cup touches nothing")
    grip = sim.add_weld("cup", found)
    print(f"gripped {sim.body(found).name} at z = {box.xpos[2]:.3f} m")
    path += go(sim, 0.3, 0.0, 1.5)
    print(f"lifted it to z = {box.xpos[2]:.3f} m")
    path += go(sim, -0.3, 0.0, 2.0)
    print(f"carried it to x = {box.xpos[0]:.3f} m")
    sim.remove(grip)
    path += rest(sim, 1.0 if options.quick else 2.0)
    print(f"released: it lies at x = {box.xpos[0]:.3f} m, z = {box.xpos[2]:.3f} m")

    def draw(axes: Axes) -> None:
        axes.plot(*zip(*path))
        axes.set(xlabel="time, s", ylabel="height of the box, m", title="A box is picked up and released")

    plots.finish(options, draw)


if __name__ == "__main__":
    main()
