"""A hopper learns to leap: gradients through contacts beside an evolution strategy, for the same processor time.

The policy has 42 numbers: joint targets from the state, the phase of a clock and an offset. The gradient of a rollout is a
product of the exact derivatives of its steps, the last one first. The evolution strategy compares rollouts of a batch::

    python python/examples/leap.py
    python python/examples/leap.py --plot leap.png
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import plots
from numpy.typing import NDArray

import clench

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Floats = NDArray[np.float64]

HOPPER = """
<mujoco model="hopper">
  <option timestep="0.01"/>
  <default>
    <joint damping="1" armature="0.02" limited="true"/>
    <geom type="capsule" contype="0" conaffinity="0"/>
    <position kp="60" kv="2" forcerange="-120 120"/>
  </default>
  <worldbody>
    <geom type="plane" size="20 5 .1" contype="1" conaffinity="1" solref="0.04 1"/>
    <body name="torso" pos="0 0 1">
      <joint name="x" type="slide" axis="1 0 0" damping="0" armature="0" limited="false"/>
      <joint name="z" type="slide" axis="0 0 1" damping="0" armature="0" limited="false"/>
      <joint name="pitch" axis="0 1 0" damping="0" armature="0" limited="false"/>
      <geom fromto="0 0 0 0 0 0.3" size=".06"/>
      <body name="thigh">
        <joint name="hip" axis="0 1 0" range="-60 60"/>
        <geom fromto="0 0 0 0 0 -0.4" size=".045"/>
        <body name="shin" pos="0 0 -0.4">
          <joint name="knee" axis="0 1 0" range="0 120"/>
          <geom fromto="0 0 0 0 0 -0.45" size=".04"/>
          <body name="foot" pos="0 0 -0.45">
            <joint name="ankle" axis="0 1 0" range="-60 60"/>
            <geom fromto="-0.12 0 -0.06 0.2 0 -0.06" size=".05" contype="1" conaffinity="1" solref="0.04 1"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator><position joint="hip"/><position joint="knee"/><position joint="ankle"/></actuator>
</mujoco>
"""

START = np.array([0.0, -0.03, 0.0, -0.4, 0.8, -0.4])
NV, NU, NF = 6, 3, 14
STEPS, STEP, PERIOD, SWING = 100, 0.01, 0.5, 0.8
PAIRS, SPREAD, RATE = 16, 0.05, 0.03


def features(qpos: Floats, qvel: Floats, step: int) -> Floats:
    """Return the inputs of the policy (..., NF)."""
    phase = 2.0 * np.pi * step * STEP / PERIOD
    clock = np.broadcast_to([np.sin(phase), np.cos(phase), 1.0], (*qpos.shape[:-1], 3))
    return np.concatenate([qpos[..., 1:] - START[1:], 0.1 * qvel, clock], axis=-1)


def cost(qpos: Floats, qvel: Floats) -> Floats:
    """Return the cost of a state: minus the distance of a step, and penalties for falling and turning."""
    low = np.maximum(0.0, -0.25 - qpos[..., 1])
    total: Floats = STEP * (20.0 * low**2 + 2.0 * qpos[..., 2] ** 2 - qvel[..., 0])
    return total


def gradient(sim: clench.Sim, policy: Floats) -> Floats:
    """Return the gradient of the cost of a rollout (NU, NF)."""
    by_state = np.zeros((NF, 2 * NV))  # The derivatives of the features.
    by_state[: NV - 1, 1:NV] = np.eye(NV - 1)
    by_state[NV - 1 : 2 * NV - 1, NV:] = 0.1 * np.eye(NV)
    sim.reset()
    sim.qpos = START
    tape = []
    for k in range(STEPS):
        inputs = features(sim.qpos, sim.qvel, k)
        targets = np.tanh(policy @ inputs)
        sim.ctrl = START[NV - NU :] + SWING * targets
        linear = sim.linearize()
        sim.step()
        slope = np.zeros(2 * NV)
        slope[[1, 2, NV]] = -40.0 * max(0.0, -0.25 - sim.qpos[1]), 4.0 * sim.qpos[2], -1.0
        tape.append((inputs, SWING * (1.0 - targets**2), linear.A, linear.B, STEP * slope))
    total, adjoint = np.zeros_like(policy), np.zeros(2 * NV)
    for inputs, rise, a, b, slope in reversed(tape):
        adjoint += slope
        by_output = (adjoint @ b) * rise
        total += np.outer(by_output, inputs)
        adjoint = adjoint @ a + by_output @ policy @ by_state
    return total


def evaluate(batch: clench.Batch, policies: Floats) -> Floats:
    """Return the costs of rollouts of policies (n, NU, NF)."""
    batch.reset()
    batch.qpos[:] = START
    total = np.zeros(len(policies))
    for k in range(STEPS):
        inputs = features(batch.qpos, batch.qvel, k)
        batch.ctrl[:] = START[NV - NU :] + SWING * np.tanh(np.einsum("nij,nj->ni", policies, inputs))
        batch.step()
        total += cost(batch.qpos, batch.qvel)
    return total


def estimate(batch: clench.Batch, policy: Floats, rng: np.random.Generator) -> Floats:
    """Return the gradient as an evolution strategy estimates it, from pairs of opposite changes."""
    changes = SPREAD * rng.normal(size=(PAIRS, NU, NF))
    costs = evaluate(batch, np.concatenate([policy + changes, policy - changes]))
    slopes: Floats = np.einsum("n,nij->ij", costs[:PAIRS] - costs[PAIRS:], changes) / (2.0 * PAIRS * SPREAD**2)
    return slopes


def learn(slope: Callable[[Floats], Floats], iterations: int, seconds: float) -> list[tuple[float, Floats]]:
    """Return the processor time and the policy after each iteration of Adam, until a limit is reached."""
    policy = 0.05 * np.random.default_rng(0).normal(size=(NU, NF))
    mean, square, curve, begin = np.zeros_like(policy), np.zeros_like(policy), [(0.0, policy)], time.process_time()
    for k in range(1, iterations + 1):
        found = slope(policy)
        found = found / max(1.0, float(np.linalg.norm(found)))
        mean, square = 0.9 * mean + 0.1 * found, 0.99 * square + 0.01 * found**2
        policy = policy - RATE * 0.99**k * (mean / (1.0 - 0.9**k)) / (np.sqrt(square / (1.0 - 0.99**k)) + 1e-8)
        curve.append((time.process_time() - begin, policy))
        if curve[-1][0] > seconds:
            break
    return curve


def main() -> None:
    """Run the example."""
    options = plots.parser(__doc__).parse_args()
    model = clench.Model.from_xml(HOPPER)
    sim, batch, rng = clench.Sim(model), clench.Batch(model, 2 * PAIRS, threads=1), np.random.default_rng(1)
    by_gradient = learn(lambda policy: gradient(sim, policy), 100 if options.quick else 200, np.inf)
    by_evolution = learn(lambda policy: estimate(batch, policy, rng), 100_000, by_gradient[-1][0])

    curves = {}
    for name, curve in (("gradients", by_gradient), ("evolution", by_evolution)):
        parts = [curve[k : k + 2 * PAIRS] for k in range(0, len(curve), 2 * PAIRS)]
        costs = []
        for part in parts:
            policies = np.array([policy for _, policy in part])
            missing = np.repeat(policies[-1:], 2 * PAIRS - len(policies), axis=0)
            costs.append(evaluate(batch, np.concatenate([policies, missing]))[: len(policies)])
        curves[name] = [seconds for seconds, _ in curve], np.minimum.accumulate(np.concatenate(costs))
        print(f"{name}: cost {curves[name][1][-1]:.2f} after {len(curve) - 1} iterations, {curve[-1][0]:.1f} s")

    def draw(axes: Axes) -> None:
        for name, (seconds, costs) in curves.items():
            axes.plot(seconds, costs, label=name)
        axes.set(xlabel="processor time, s", ylabel="cost of the best policy", title="A hopper leaps as far as it can in a second")
        axes.legend()

    plots.finish(options, draw)


if __name__ == "__main__":
    main()
