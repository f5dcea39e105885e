"""A gripper lifts a box, shakes it and holds it, with and without memory of where contacts stuck.

Friction in MuJoCo's model is a damper, so the load slides out of the hand. Elliptic cones with a large ``impratio``
slow it down, noslip iterations remove most of the motion after each solve, and ``stiction`` adds a spring, which
carries the load at rest::

    python python/examples/grasp.py
    python python/examples/grasp.py --plot grasp.png
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import plots

import clench

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

GRAVITY, GRIP, HEIGHT, FREQUENCY = 9.81, 0.05, 0.2, 3.0
LIFTED = 2.0
"""The time from which the hand shakes, s."""
HOLD = 1.0
"""The time for which it holds still in the end, s."""


def height(time: float, shaking: float) -> float:
    """Return the target height (m) of the hand, which shakes with accelerations of up to that of gravity."""
    if time < LIFTED:
        return HEIGHT * float(np.clip(time - 0.5, 0, 1))
    omega = 2 * np.pi * FREQUENCY
    return HEIGHT + GRAVITY / omega**2 * float(1 - np.cos(omega * min(time - LIFTED, shaking)))


def grasp(model: clench.Model, shaking: float, **options: Any) -> NDArray[np.float64]:
    """Return how far (mm) the load has slid down in the hand after each step since it was lifted."""
    sim = clench.Sim(model, clench.RigidOptions(**options))
    sim.actuator("left").ctrl = sim.actuator("right").ctrl = GRIP
    above = np.empty(round((LIFTED + shaking + HOLD) / model.timestep))
    for i in range(len(above)):
        sim.actuator("lift").ctrl = height(sim.time, shaking)
        sim.step()
        above[i] = 1000 * (sim.body("hand").xpos[2] - sim.body("load").xpos[2])
    lifted = round(LIFTED / model.timestep) - 1
    above -= above[lifted]
    return above[lifted:]


def main() -> None:
    """Run the example."""
    options = plots.parser(__doc__).parse_args()
    model = clench.Model.from_file(plots.MODELS / "grasp.xml")
    shaking = 2.0 if options.quick else 20.0
    laws: dict[str, dict[str, Any]] = {
        "MuJoCo's model, pyramids": {},
        "elliptic cones, impratio 10": {"friction_cone": "elliptic", "impratio": 10},
        "stiction": {"stiction": True},
        "10 noslip iterations": {"noslip_iterations": 10},
    }
    paths = {name: grasp(model, shaking, **law) for name, law in laws.items()}
    for name, path in paths.items():
        print(f"{name:28} slid {path[-1]:10.5f} mm after {shaking:g} s of shaking, at most {path.max():8.3f} mm")

    def draw(axes: Axes) -> None:
        for name, path in paths.items():
            axes.plot(model.timestep * np.arange(len(path)), path, label=name)
        axes.set(xlabel="time since it was lifted (s)", ylabel="slip of the load (mm)", ylim=(10, -1))
        axes.set_title(f"A grasp shaken at {FREQUENCY:g} Hz for {shaking:g} s")
        axes.legend(loc="lower right")

    plots.finish(options, draw)


if __name__ == "__main__":
    main()
