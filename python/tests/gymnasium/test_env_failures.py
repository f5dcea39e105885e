"""Failures while stepping: failed simulations, invalid actions, calls in the wrong order."""

from __future__ import annotations

from typing import Any

import clench.gymnasium  # noqa: F401, for the tasks it registers
import gymnasium
import numpy as np
import pytest
from gymnasium.error import ClosedEnvironmentError, ResetNeeded
from gymnasium.vector import AutoresetMode
from tasks_of_tests import Cart, CartEnv

from clench import SimulationError

ENVS = 6
BROKEN = 3


def absurd() -> Any:
    """Returns controls with which one environment fails."""
    actions = np.zeros((ENVS, 2))
    actions[BROKEN, 1] = 1e307
    return actions


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_failed(mode: AutoresetMode) -> None:
    """A failure ends the episode with its own reward and a reason, without effect on others, and can be reset."""
    envs, calm = Cart(ENVS, autoreset_mode=mode), Cart(ENVS, autoreset_mode=mode)
    envs.reset(seed=1), calm.reset(seed=1)
    before = envs.batch.qpos[BROKEN].copy()
    observations, rewards, terminations, truncations, infos = envs.step(absurd())
    theirs = calm.step(np.zeros((ENVS, 2)))

    others = np.arange(ENVS) != BROKEN
    np.testing.assert_array_equal(observations[others], theirs[0][others])
    np.testing.assert_array_equal(rewards[others], theirs[1][others])
    assert rewards[BROKEN] == -5.0
    np.testing.assert_array_equal(terminations, ~others)
    assert not truncations.any()
    assert np.isfinite(observations).all()

    last, about = observations[BROKEN], infos
    if mode is AutoresetMode.SAME_STEP:
        last, about = infos["final_obs"][BROKEN], infos["final_info"]
        assert "failed" not in infos
    np.testing.assert_array_equal(about["failed"], ~others)
    np.testing.assert_array_equal(about["_failed"], ~others)
    assert isinstance(about["fault"][BROKEN], str) and about["fault"][BROKEN]
    assert all(about["fault"][row] is None for row in np.flatnonzero(others))
    np.testing.assert_array_equal(last[:2], before)

    if mode is AutoresetMode.DISABLED:
        with pytest.raises(ResetNeeded):
            envs.step(np.zeros((ENVS, 2)))
        observations, infos = envs.reset(options={"reset_mask": terminations})
    if mode is AutoresetMode.NEXT_STEP:
        observations, rewards, terminations, _, infos = envs.step(absurd())
        assert rewards[BROKEN] == 0.0
        assert not terminations.any()
        assert "failed" not in infos
    assert not np.array_equal(observations[BROKEN], last)
    np.testing.assert_array_equal(observations[BROKEN, 2:], 0.0)
    assert envs.batch.running.all()
    assert not envs.step(np.zeros((ENVS, 2)))[2].any()


def test_failed_single() -> None:
    env = CartEnv()
    env.reset(seed=1)
    for _ in range(2):
        observation, reward, terminated, truncated, info = env.step(np.array([0.0, 1e307]))
        assert (reward, terminated, truncated) == (-5.0, True, False)
        assert np.isfinite(observation).all()
        assert info["failed"] and info["fault"]
    env.reset()
    assert "failed" not in env.step(np.zeros(2))[4]


def test_initial_state_that_cannot_be() -> None:
    class Lost(Cart):
        def initial_state(self, rng: np.random.Generator) -> Any:
            return np.array([np.nan, 0.0]), self.init_qvel

    for outputs in ((), ("xpos",)):
        with pytest.raises(SimulationError, match="Lost: environment 0 cannot start"):
            Lost(2, outputs=outputs).reset(seed=0)


@pytest.mark.parametrize(
    ("actions", "message"),
    [
        (np.zeros((ENVS, 3)), r"shape \(6, 3\), expected \(6, 2\)"),
        (np.zeros((ENVS - 1, 2)), r"shape \(5, 2\)"),
        (np.zeros(2), r"shape \(2,\)"),
        (0.0, r"shape \(\)"),
        (None, "dtype object"),
        ("left", "dtype <U4"),
        (np.zeros((ENVS, 2), dtype=complex), "dtype complex128"),
        (np.zeros((ENVS, 2), dtype=bool), "dtype bool"),
        ([[0.0, 1.0], [0.0]], "not an array"),
        (np.where(np.arange(12).reshape(6, 2) == 9, np.nan, 0.0), "not finite: nan for actuator 1 of environment 4"),
        (np.where(np.arange(12).reshape(6, 2) == 2, -np.inf, 0.0), "not finite: -inf for actuator 0 of environment 1"),
    ],
)
def test_bad_actions(actions: Any, message: str) -> None:
    """Errors about actions name the task and change nothing."""
    envs, calm = Cart(ENVS), Cart(ENVS)
    envs.reset(seed=1), calm.reset(seed=1)
    with pytest.raises(ValueError, match=f"Cart: .*{message}"):
        envs.step(actions)
    np.testing.assert_array_equal(envs.step(np.zeros((ENVS, 2)))[0], calm.step(np.zeros((ENVS, 2)))[0])


@pytest.mark.parametrize("action", [np.zeros((1, 2)), np.zeros(3), "left", np.array([0.0, np.nan])])
def test_bad_single_actions(action: Any) -> None:
    env = CartEnv()
    env.reset()
    with pytest.raises(ValueError, match="CartEnv"):
        env.step(action)


def test_action_dtypes() -> None:
    """Actions may be integers, float32 and lists."""
    envs = Cart(2)
    rows = []
    for actions in ([[1, 0], [0, 1]], np.eye(2, dtype=np.float32), np.eye(2, dtype=np.int8), np.eye(2, order="F")):
        envs.reset(seed=1)
        rows.append(envs.step(actions)[0])
    for row in rows[1:]:
        np.testing.assert_array_equal(row, rows[0])


def test_actions_are_not_clipped() -> None:
    """The simulator clamps controls; the reward sees the original action."""
    seen = []

    class Curious(Cart):
        def reward(self, action: Any) -> Any:
            seen.append(action.copy())
            return super().reward(action)

    envs = Curious(2)
    envs.reset(seed=1)
    far = envs.step(np.array([[50.0, 0.0], [-50.0, 0.0]]))[0]
    envs.reset(seed=1)
    edge = envs.step(np.array([[3.0, 0.0], [-3.0, 0.0]]))[0]
    np.testing.assert_array_equal(far, edge)
    assert seen[0][0, 0] == 50.0


@pytest.mark.parametrize("make", [lambda: Cart(2), lambda: CartEnv()])
def test_out_of_turn(make: Any) -> None:
    env = make()
    action = env.action_space.sample()
    with pytest.raises(ResetNeeded, match=r"reset\(\) before step\(\)"):
        env.step(action)
    env.reset()
    env.close()
    env.close()
    batch = (lambda: env.sim, lambda: env.model) if isinstance(env, CartEnv) else (lambda: env.batch,)
    for call in (lambda: env.step(action), env.reset, *batch):
        with pytest.raises(ClosedEnvironmentError, match="closed"):
            call()


def test_no_window_is_opened() -> None:
    makers: list[Any] = [lambda **kwargs: gymnasium.make_vec("clench/Ant-v5", 2, **kwargs), Cart, CartEnv]
    for make in makers:
        with pytest.raises(ValueError, match="render_mode"):
            make(render_mode="human")
