"""Gradients of steps in JAX."""

from __future__ import annotations

from typing import Any

import clench
import numpy as np
import pytest
from scenes import ball, example

jax: Any = pytest.importorskip("jax")
gradients: Any = pytest.importorskip("clench.jax")

EXACT = clench.RigidOptions(tolerance=0, iterations=200, ls_iterations=200, ls_tolerance=1e-10)


@pytest.fixture(autouse=True)
def _double_precision() -> Any:
    with jax.enable_x64(True):
        yield


def test_gradients_of_a_rollout() -> None:
    sim = clench.Sim(example("quadruped"), EXACT)
    sim.reset("crouching")
    sim.step(100)
    assert len(sim.contacts) > 2
    step, state = gradients.step(sim), gradients.state(sim)
    ctrl = 0.1 * np.random.default_rng(0).normal(size=(4, sim.model.nu))

    def height(state: Any, ctrl: Any) -> Any:
        (qpos, qvel, _), _ = jax.lax.scan(lambda state, u: (step(state, u), None), state, ctrl)
        return qpos[2] + 0.01 * qvel[5]

    by_state, by_ctrl = jax.jit(jax.grad(height, (0, 1)))(state, ctrl)
    for k, u in ((0, 0), (2, 5)):
        change = np.zeros_like(ctrl)
        change[k, u] = 1e-5
        difference = (height(state, ctrl + change) - height(state, ctrl - change)) / 2e-5
        np.testing.assert_allclose(by_ctrl[k, u], difference, rtol=1e-6, atol=1e-10)
    for dof in (0, 4, 8):
        change = np.zeros(sim.model.nv)
        # Contacts switch within 1e-5 rad.
        change[dof] = 1e-6
        ahead, behind = (sim.model.integrate_pos(np.asarray(state[0]), sign * change) for sign in (1.0, -1.0))
        difference = (height((ahead, *state[1:]), ctrl) - height((behind, *state[1:]), ctrl)) / 2e-6
        np.testing.assert_allclose(by_state[0] @ (ahead - behind) / 2e-6, difference, rtol=1e-6, atol=1e-9)


def test_steps_are_those_of_the_simulation_and_pure() -> None:
    sim = clench.Sim(ball())
    step, state = gradients.step(sim), gradients.state(sim)
    ctrl = np.zeros(sim.model.nu)
    first, again = step(state, ctrl), step(state, ctrl)
    other = clench.Sim(ball())
    other.step()
    for one, two, expected in zip(first, again, (other.qpos, other.qvel, other.act)):
        np.testing.assert_array_equal(one, two)
        np.testing.assert_array_equal(one, expected)


@pytest.mark.parametrize("precision", ["64", "32"])
def test_environments_of_a_batch_have_the_gradients_of_simulations(precision: Any) -> None:
    batch = clench.Batch(example("quadruped"), 3, precision, options=EXACT)
    batch.qvel[:] = 0.1 * np.random.default_rng(0).normal(size=batch.qvel.shape)
    step, state, ctrl = gradients.step(batch), gradients.state(batch), jax.numpy.array(batch.ctrl)
    simulations = [batch.sim(env) for env in range(3)]

    def size(step: Any) -> Any:
        return jax.grad(lambda state, ctrl: sum((part**2).sum() for part in step(state, ctrl)), (0, 1))

    by_state, by_ctrl = size(step)(state, ctrl)
    for env, sim in enumerate(simulations):
        alone, by_own = size(gradients.step(sim))(gradients.state(sim), ctrl[env])
        for one, other in zip((*by_state, by_ctrl), (*alone, by_own)):
            np.testing.assert_allclose(one[env], other, rtol=1e-5 if precision == "32" else 1e-12, atol=1e-12)


def test_double_precision_is_refused_without_x64() -> None:
    with jax.enable_x64(False), pytest.raises(ValueError, match="jax_enable_x64"):
        gradients.step(clench.Sim(ball()))


def test_wrong_shapes_are_refused() -> None:
    sim = clench.Sim(example("pendulum"))
    step, (qpos, qvel, act) = gradients.step(sim), gradients.state(sim)
    with pytest.raises(ValueError, match=r"ctrl has shape \(1, 1\), not \(1,\)"):
        step((qpos, qvel, act), np.zeros((1, 1)))
    with pytest.raises(ValueError, match=r"qvel has shape \(\), not \(1,\)"):
        jax.jit(step)((qpos, 0.0, act), np.zeros(1))
