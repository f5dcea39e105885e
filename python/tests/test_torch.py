"""Gradients of steps and rollouts in PyTorch."""

from __future__ import annotations

from typing import Any

import clench
import numpy as np
import pytest
from scenes import ball, example

torch = pytest.importorskip("torch")
gradients: Any = pytest.importorskip("clench.torch")

EXACT = clench.RigidOptions(tolerance=0, iterations=200, ls_iterations=200, ls_tolerance=1e-10)

# A box in contact, a ball joint and an activation: quaternions and all parts of a state.
SCENE = """
<mujoco>
  <option timestep="0.01"/>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body pos="0 0 0.095">
      <freejoint/>
      <geom type="box" size="0.1 0.08 0.1"/>
      <body pos="0 0 0.1">
        <joint type="ball" damping="0.1"/>
        <geom type="capsule" fromto="0 0 0 0.2 0 0.1" size="0.02"/>
        <site name="s"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor site="s" gear="0 0 0 1 2 3"/>
    <general site="s" gear="0 0 0 1 0 1" dyntype="filter" dynprm="0.1"/>
  </actuator>
</mujoco>
"""


def prepared() -> tuple[clench.Sim, list[Any], Any]:
    sim = clench.Sim(clench.Model.from_xml(SCENE), EXACT)
    sim.step(20)
    assert len(sim.contacts) == 4
    ctrl = torch.tensor(0.1 * np.random.default_rng(0).normal(size=(5, sim.model.nu)), requires_grad=True)
    return sim, [part.requires_grad_() for part in gradients.state(sim)], ctrl


def test_gradients_of_a_step() -> None:
    sim, state, ctrl = prepared()

    def step(*inputs: Any) -> Any:
        return gradients.step(sim, inputs[:3], inputs[3])

    assert torch.autograd.gradcheck(step, (*state, ctrl[0].detach().requires_grad_()), atol=1e-5, rtol=1e-4)


def test_gradients_of_a_rollout() -> None:
    sim, state, ctrl = prepared()

    def rollout(*inputs: Any) -> Any:
        return gradients.rollout(sim, inputs[:3], inputs[3])

    assert torch.autograd.gradcheck(rollout, (*state, ctrl), atol=1e-4, rtol=1e-3)


def test_a_rollout_is_its_steps() -> None:
    sim, state, ctrl = prepared()
    start = sim.state
    rows = gradients.rollout(sim, state, ctrl)
    after = sim.state
    whole = torch.autograd.grad(sum(row[-1].square().sum() for row in rows), (*state, ctrl))
    assert sim.state == after  # The backward pass leaves no trace.
    sim.state, following = start, tuple(state)
    for controls in ctrl:
        following = gradients.step(sim, following, controls)
    parts = torch.autograd.grad(sum(part.square().sum() for part in following), (*state, ctrl))
    for row, part in zip(rows, following):
        assert torch.equal(row[-1], part)
    for one, other in zip(whole, parts):
        torch.testing.assert_close(one, other, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("precision", ["64", "32"])
def test_environments_of_a_batch_have_the_gradients_of_simulations(precision: Any) -> None:
    sim, _, _ = prepared()
    batch = clench.Batch(sim.model, 3, precision, options=EXACT, threads=2)
    for env in range(3):
        sim.step()
        batch.set_state(sim.state, [env])
    start = batch.state
    ctrl = torch.tensor(0.1 * np.random.default_rng(0).normal(size=(5, *batch.ctrl.shape)), requires_grad=True)
    state, ctrl = gradients.state(batch), ctrl.to(gradients.state(batch)[0].dtype)
    inputs = [part.detach().requires_grad_() for part in (*state, ctrl)]
    rows = gradients.rollout(batch, inputs[:3], inputs[3])
    after = batch.state
    whole = torch.autograd.grad(sum(row.square().sum() for row in rows), inputs)
    assert batch.state == after
    batch.state = start
    for env in range(3):
        own = batch.sim(env)
        alone = [part[..., env, :].detach().requires_grad_() for part in inputs]
        parts = gradients.rollout(own, alone[:3], alone[3])
        for row, part in zip(rows, parts):
            assert torch.equal(row[:, env], part)
        for one, other in zip(whole, torch.autograd.grad(sum(part.square().sum() for part in parts), alone)):
            torch.testing.assert_close(one[..., env, :], other, rtol=1e-9, atol=1e-12)


def test_an_environment_that_fails_raises_an_error() -> None:
    batch = clench.Batch(ball(), 2)
    state = gradients.state(batch)
    state[1][1, 0] = torch.nan
    with pytest.raises(clench.SimulationError, match="environment 1"):
        gradients.step(batch, state, torch.zeros(2, 0, dtype=torch.float64))


def test_gradients_pass_through_delays() -> None:
    text = (
        "<mujoco><option timestep='0.01'/><worldbody><body><joint name='x' type='slide'/><geom size='0.1' mass='2'/>"
        "</body></worldbody><actuator><motor joint='x' nsample='3' delay='0.02'/></actuator></mujoco>"
    )
    sim = clench.Sim(clench.Model.from_xml(text))
    ctrl = torch.zeros(5, 1, dtype=torch.float64, requires_grad=True)
    _, qvel, _ = gradients.rollout(sim, gradients.state(sim), ctrl)
    qvel[-1].sum().backward()
    # Each control acts two steps later, and changes the velocity by h / m.
    assert ctrl.grad.ravel().tolist() == pytest.approx([0.005, 0.005, 0.005, 0.0, 0.0])


def test_a_plan_improves() -> None:
    sim = clench.Sim(example("pendulum"))
    start = gradients.state(sim)
    ctrl = torch.full((200, 1), 1.5, dtype=torch.float64, requires_grad=True)
    losses = []
    for _ in range(8):
        sim.reset()
        qpos, _, _ = gradients.rollout(sim, start, ctrl)
        loss = (qpos[-1] - 0.5).square().sum()
        losses.append(float(loss.detach()))
        (slope,) = torch.autograd.grad(loss, ctrl)
        with torch.no_grad():
            ctrl -= 0.5 * loss / slope.square().sum() * slope
    assert losses[-1] < 0.1 * losses[0]


def test_refusals() -> None:
    sim, state, ctrl = prepared()
    qpos, qvel, act = state
    with pytest.raises(TypeError, match="float64"):
        gradients.step(sim, (qpos.float(), qvel, act), ctrl[0])
    with pytest.raises(ValueError, match="controls"):
        gradients.step(sim, state, ctrl[0, :1])
    with pytest.raises(ValueError, match="qpos|shape"):
        gradients.step(sim, (qpos[1:], qvel, act), ctrl[0])
    # One row of a batch is no state of a simulation, though NumPy would broadcast it.
    with pytest.raises(ValueError, match=r"qvel of the state has shape \(1, "):
        gradients.step(sim, (qpos, qvel[None], act), ctrl[0])
    single = clench.Sim(ball(), precision="32")
    with pytest.raises(TypeError, match="float32"):
        gradients.step(single, gradients.state(single), torch.zeros(0, dtype=torch.float64))
    loss = gradients.step(sim, state, ctrl[0])[0].square().sum()
    (slope,) = torch.autograd.grad(loss, ctrl, create_graph=True)
    with pytest.raises(RuntimeError, match="once_differentiable"):
        slope.sum().backward()
