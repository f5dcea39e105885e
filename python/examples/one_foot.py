"""A humanoid balances on one foot: a linear-quadratic regulator from the exact derivatives of one step.

Inverse kinematics finds a posture whose centre of mass is above the left foot, inverse dynamics the torques that hold
it. The regulator corrects the targets of the servos by the linear model of a step at this posture (``pip install scipy``)::

    python python/examples/one_foot.py
    python python/examples/one_foot.py --plot one_foot.png
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import plots
from numpy.typing import NDArray
from scipy.linalg import solve_discrete_are

import clench

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Floats = NDArray[np.float64]

# From the frame of a foot to the middle of its sole, m.
SOLE = np.array([0.04, 0.0, 0.0])
# Weights of the distance of the centre of mass from the foot (1/m²), of joints (1/rad²) and of drift.
BALANCE, POSTURE, DRIFT = 1000.0, 0.3, 0.01
PUSH, PUSHED = 30.0, (1.0, 1.2)  # N, s


def stand(sim: clench.Sim) -> None:
    """Stand on the left foot at rest, with the servos' targets that hold the posture."""
    model = sim.model
    sim.reset("standing")
    posture, hinge = sim.qpos.copy(), dict(zip(model.names("joint"), model.jnt_qposadr))
    for name, angle in (("right_knee", 1.2), ("right_hip_y", 0.6), ("right_shoulder_x", 0.6), ("left_shoulder_x", 0.6)):
        posture[hinge[name]] = angle
    foot = sim.body("left_foot").xpos.copy()
    sole = clench.FrameTarget(body="left_foot", position=foot, quat=[1, 0, 0, 0])
    balance = clench.ComTarget(foot + SOLE, cost=[1, 1, 0])
    sim.qpos = sim.ik([sole, balance, clench.PostureTarget(posture, cost=0.03)], start=posture).qpos
    height = float(sim.qpos[2])
    # The foot sinks in until the floor carries the weight.
    low, high = height - 0.01, height + 0.01
    for _ in range(40):
        sim.qpos[2] = 0.5 * (low + high)
        if sim.inverse(np.zeros(model.nv))[2] > 0.0:
            high = sim.qpos[2]
        else:
            low = sim.qpos[2]
    stiffness = np.asarray(model.actuator_gainprm)[:, 0]
    sim.ctrl = sim.qpos[7:] + sim.inverse(np.zeros(model.nv))[6:] / stiffness


def regulator(sim: clench.Sim) -> Floats:
    """Return the gains (nu, 2 nv) about the present state: the targets change by -gains @ (motion, velocity)."""
    nv, nu = sim.model.nv, sim.model.nu
    sway = sim.subtree_jacobian("torso") - sim.jacobian(body="left_foot")[0]
    weights = DRIFT * np.eye(2 * nv)
    weights[:nv, :nv] += BALANCE * sway.T @ sway
    weights[6:nv, 6:nv] += POSTURE * np.eye(nv - 6)
    linear = sim.linearize()
    value = solve_discrete_are(linear.A, linear.B, weights, np.eye(nu))
    gains: Floats = np.linalg.solve(np.eye(nu) + linear.B.T @ value @ linear.B, linear.B.T @ value @ linear.A)
    return gains


def simulate(sim: clench.Sim, gains: Floats, steps: int) -> Floats:
    """Return the height of the head over time, with a push against the torso from the side."""
    start, posture, targets = sim.state, sim.qpos.copy(), sim.ctrl.copy()
    heights = np.empty(steps)
    for k in range(steps):
        motion = sim.model.differentiate_pos(posture, sim.qpos)
        sim.ctrl = targets - gains @ np.concatenate([motion, sim.qvel])
        sim.xfrc_applied[1, 1] = PUSH if PUSHED[0] <= sim.time < PUSHED[1] else 0.0
        sim.step()
        heights[k] = sim.geom("head").xpos[2]
    sim.state = start
    return heights


def main() -> None:
    """Run the example."""
    options = plots.parser(__doc__).parse_args()
    sim = clench.Sim(clench.Model.from_file(plots.MODELS / "humanoid.xml"))
    steps = 1500 if options.quick else 5000
    stand(sim)
    gains = regulator(sim)
    runs = {"feedback": gains, "servos alone": np.zeros_like(gains)}
    heights = {name: simulate(sim, own, steps) for name, own in runs.items()}
    for name, height in heights.items():
        print(f"{name}: the head is {height[0]:.2f} m high, after {steps * float(sim.model.timestep):.0f} s {height[-1]:.2f}")

    def draw(axes: Axes) -> None:
        times = np.arange(steps) * float(sim.model.timestep)
        for name, height in heights.items():
            axes.plot(times, height, label=name)
        axes.axvspan(*PUSHED, alpha=0.2)
        axes.set(xlabel="time, s", ylabel="height of the head, m", title="A humanoid on one foot is pushed")
        axes.legend()

    plots.finish(options, draw)


if __name__ == "__main__":
    main()
