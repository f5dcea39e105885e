"""Trajectory optimization: iLQR swings up a pole on a cart, with exact derivatives of each step.

Each iteration linearizes the steps along the motion, solves a linear-quadratic problem backward in time, and simulates
the motion under the new controls and their feedback::

    python python/examples/swing_up.py
    python python/examples/swing_up.py --plot swing_up.png
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import plots
from numpy.typing import NDArray

import clench

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Floats = NDArray[np.float64]

CART = """
<mujoco model="cart">
  <option timestep="0.02" integrator="implicitfast"/>
  <worldbody>
    <body name="cart" pos="0 0 1">
      <joint name="slide" type="slide" axis="1 0 0" range="-2 2" damping="0.5"/>
      <geom type="box" size="0.1 0.05 0.04" mass="1"/>
      <body name="pole">
        <joint name="hinge" axis="0 1 0" damping="0.01"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.6" size="0.02" mass="0.2" contype="0" conaffinity="0"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor name="push" joint="slide" gear="10"/></actuator>
</mujoco>
"""

# The state is position and angle, then their velocities. The pole hangs at the angle 0.
GOAL = np.array([0.0, np.pi, 0.0, 0.0])
AT_END = np.diag([100.0, 500.0, 20.0, 20.0])
ON_THE_WAY = np.diag([0.02, 0.02, 0.002, 0.002])
EFFORT = np.array([[0.2]])
LIMIT = 3.0


def cost(states: Floats, controls: Floats) -> float:
    """Return the cost of a motion: of errors at its end and on the way, and of effort."""
    error = states - GOAL
    running = np.einsum("ki,ij,kj", error[:-1], ON_THE_WAY, error[:-1])
    return 0.5 * float(running + np.einsum("ki,ij,kj", controls, EFFORT, controls) + error[-1] @ AT_END @ error[-1])


def simulate(sim: clench.Sim, plan: Floats, gains: Floats, states: Floats) -> tuple[Floats, Floats]:
    """Return the states (T + 1, 4) and controls (T, 1) of a plan with feedback on the difference from `states`."""
    sim.reset()
    found, controls = np.zeros_like(states), np.empty_like(plan)
    for k in range(len(plan)):
        controls[k] = np.clip(plan[k] + gains[k] @ (found[k] - states[k]), -LIMIT, LIMIT)
        sim.ctrl = controls[k]
        sim.step()
        found[k + 1] = np.concatenate([sim.qpos, sim.qvel])
    return found, controls


def linearize(sim: clench.Sim, controls: Floats) -> list[clench.Linearization]:
    """Return the linear model of each step under these controls."""
    sim.reset()
    models = []
    for sim.ctrl in controls:
        models.append(sim.linearize())
        sim.step()
    return models


def improve(
    models: list[clench.Linearization], states: Floats, controls: Floats, damping: float
) -> tuple[Floats, Floats]:
    """Return the changes of the controls (T, 1) and the gains (T, 1, 4) that minimize the linear-quadratic model."""
    changes, gains = np.empty_like(controls), np.empty((*controls.shape, 4))
    slope, curvature = AT_END @ (states[-1] - GOAL), AT_END
    for k in reversed(range(len(controls))):
        a, b = models[k].A, models[k].B
        by_control = EFFORT @ controls[k] + b.T @ slope
        weight = EFFORT + b.T @ (curvature + damping * np.eye(4)) @ b
        changes[k] = -np.linalg.solve(weight, by_control)
        gains[k] = -np.linalg.solve(weight, b.T @ curvature @ a)
        # The value before the step, under these controls.
        closed = a + b @ gains[k]
        slope = ON_THE_WAY @ (states[k] - GOAL) + closed.T @ slope + gains[k].T @ EFFORT @ controls[k]
        slope += (closed.T @ curvature @ b + gains[k].T @ EFFORT) @ changes[k]
        curvature = ON_THE_WAY + closed.T @ curvature @ closed + gains[k].T @ EFFORT @ gains[k]
    return changes, gains


def main() -> None:
    """Run the example."""
    options = plots.parser(__doc__).parse_args()
    steps, iterations = 75, 20 if options.quick else 100

    sim = clench.Sim(clench.Model.from_xml(CART))
    controls, damping = np.ones((steps, 1)), 1.0
    states, controls = simulate(sim, controls, np.zeros((steps, 1, 4)), np.zeros((steps + 1, 4)))
    costs = [cost(states, controls)]
    while len(costs) <= iterations:
        changes, gains = improve(linearize(sim, controls), states, controls, damping)
        for fraction in 0.5 ** np.arange(8):
            new = simulate(sim, controls + fraction * changes, gains, states)
            if cost(*new) < costs[-1]:
                break
        else:
            if damping > 1e8:
                break
            damping *= 10.0
            continue
        states, controls = new
        damping = max(damping / 5.0, 1e-6)
        costs.append(cost(states, controls))
        print(f"iteration {len(costs) - 1:3}: cost {costs[-1]:.4f}")
        if costs[-2] - costs[-1] < 1e-5 * costs[-1]:
            break
    angle = np.degrees(np.abs(states[-1, 1] - np.pi))
    print(f"after {sim.time:.1f} s the pole is {angle:.2f} degrees from upright and turns at {states[-1, 3]:.3f} rad/s")

    def draw(axes: Axes) -> None:
        axes.plot(np.arange(steps + 1) * float(sim.model.timestep), states[:, :2], label=["cart, m", "pole, rad"])
        axes.set(xlabel="time, s", title="A pole is swung up")
        axes.legend()

    plots.finish(options, draw)


if __name__ == "__main__":
    main()
