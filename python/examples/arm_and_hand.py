"""A hand is attached to an arm, given sensors, saved, and moved in MuJoCo.

The arm is MJCF, the hand URDF. Attached elements are edited by their prefixed names, and one self-contained document is
written::

    python python/examples/arm_and_hand.py
    python python/examples/arm_and_hand.py --save arm_and_hand.xml --plot arm_and_hand.png
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import plots

import clench

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def main() -> None:
    """Run the example."""
    parser = plots.parser(__doc__)
    parser.add_argument("--save", metavar="FILE", help="write the arm with its hand to FILE")
    options = parser.parse_args()

    arm = clench.ModelSpec.from_file(plots.MODELS / "arm_and_box.xml")
    hand = clench.ModelSpec.from_file(plots.MODELS / "gripper/gripper.urdf")
    arm.keyframe("pushing").remove()
    arm.body("hand").remove()
    arm.body("wrist").add_frame(pos=[0.08, 0, 0], euler=[0, np.pi / 2, 0]).attach(hand, prefix="g_", body="forearm")
    arm.joint("g_shoulder")["damping"] = 2
    arm.body("g_left_finger").add_site(name="pad", pos=[0.05, 0, 0], size=0.02)
    arm.add_sensor("touch", name="pad", site="pad")
    arm.add_sensor("framepos", name="fingertip", objtype="site", objname="pad")
    arm.add_actuator("position", name="grip", joint="g_left", kp=50, ctrlrange=[0, 0.04])
    model = arm.build()
    print(f"{model.name}: {', '.join(model.names('body')[1:])}")

    text = arm.to_xml()
    if options.save is not None:
        Path(options.save).write_text(text)
        print(f"saved in {options.save}")

    sim, steps = clench.Sim(model), 100 if options.quick else 200
    ctrl = np.linspace(0.0, 0.3, steps)[:, np.newaxis] * np.ones(model.nu)
    path = np.empty((steps, 3))
    for k, sim.ctrl in enumerate(ctrl):
        sim.step()
        path[k] = sim.sensor("fingertip")
    print(f"the fingertip goes from {path[0].round(3)} to {path[-1].round(3)}")
    try:
        import mujoco  # type: ignore[import-untyped]
    except ImportError:
        print("MuJoCo is not installed: there is no comparison")
    else:
        oracle = mujoco.MjModel.from_xml_string(text)
        data = mujoco.MjData(oracle)
        for data.ctrl in ctrl:
            mujoco.mj_step(oracle, data)
        print(f"MuJoCo's positions differ by {np.abs(data.qpos - sim.qpos).max():.1e}")

    def draw(axes: Axes) -> None:
        axes.plot(np.arange(steps) * float(model.timestep), path, label=["x", "y", "z"])
        axes.set(xlabel="time, s", ylabel="fingertip, m", title="An arm with a hand")
        axes.legend()

    plots.finish(options, draw)


if __name__ == "__main__":
    main()
