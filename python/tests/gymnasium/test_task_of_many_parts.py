"""Tasks with named observations, discrete actions and their own truncation."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.spaces import Box, Dict, Discrete, MultiBinary, MultiDiscrete, Tuple
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray
from tasks_of_tests import CART

import clench
from clench.gymnasium import BatchEnv, SingleEnv

Array = NDArray[Any]


class Pushed(BatchEnv):
    """A cart that is pushed left, right or not at all, with named observations. Leaving a range truncates episodes."""

    model = CART
    frame_skip = 2
    single_action_space = Discrete(3, start=-1)

    def observe(self) -> dict[str, Array]:
        speed = np.clip(100 * np.abs(self.batch.qvel), 0, 255).astype(np.uint8)
        return {"state": np.concatenate([self.batch.qpos, self.batch.qvel], axis=1), "speed": speed}

    def control(self, action: Array) -> Array:
        assert action.dtype == np.int64
        return np.column_stack([3.0 * action, np.zeros(self.num_envs)])

    def reward(self, action: Array) -> Array:
        return np.abs(action).astype(np.float64)

    def truncated(self) -> Array:
        left: Array = np.abs(self.batch.qpos[:, 0]) > 0.05
        return left

    def info(self) -> dict[str, Array]:
        return {"elapsed": self.elapsed}

    def initial_states(self, envs: NDArray[np.intp]) -> tuple[Array, Array]:
        places = np.array([self.generator(env).uniform(-0.01, 0.01) for env in envs])
        return self.init_qpos + places[:, np.newaxis] * [1, 0], self.init_qvel


class PushedEnv(SingleEnv):
    task = Pushed


def test_observations_have_names() -> None:
    envs = Pushed(3)
    space = envs.single_observation_space
    state, speed = Box(-np.inf, np.inf, (4,), np.float64), Box(0, 255, (2,), np.uint8)
    assert space == Dict({"state": state, "speed": speed})
    observations, _ = envs.reset(seed=3)
    assert envs.observation_space.contains(observations) and observations["state"].shape == (3, 4)
    kept = observations["state"].copy()
    envs.step(np.array([1, 0, -1]))
    np.testing.assert_array_equal(observations["state"], kept)


def test_episodes_start_all_at_once() -> None:
    envs, others = Pushed(4), Pushed(2)
    observations, _ = envs.reset(seed=5)
    assert len(set(observations["state"][:, 0])) == 4
    np.testing.assert_array_equal(others.reset(seed=5)[0]["state"], observations["state"][:2])
    before = observations["state"]
    after = envs.reset(options={"reset_mask": np.array([False, True, False, True])})[0]["state"]
    np.testing.assert_array_equal(after[[0, 2]], before[[0, 2]])
    assert (after[[1, 3], 0] != before[[1, 3], 0]).all()

    class Wrong(Pushed):
        def initial_states(self, envs: NDArray[np.intp]) -> tuple[Array, Array]:
            return np.zeros((3, 7)), self.init_qvel

    with pytest.raises(ValueError, match=r"qpos of initial_states\(\) is an array of shape \(3, 7\), expected \(2, 2\) or \(2,\)"):
        Wrong(2).reset()


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_a_task_cuts_its_episodes_short(mode: AutoresetMode) -> None:
    envs = Pushed(2, autoreset_mode=mode)
    envs.reset(seed=1)
    for step in range(1, 100):
        observations, rewards, terminations, truncations, infos = envs.step(np.array([1, 0]))
        np.testing.assert_array_equal(rewards, [1, 0])
        assert not terminations.any() and not truncations[1]
        if truncations[0]:
            break
        np.testing.assert_array_equal(infos["elapsed"], [step, step])
    assert truncations[0]
    if mode is AutoresetMode.SAME_STEP:
        last = infos["final_obs"][0]
        assert last["state"][0] > 0.05 > abs(observations["state"][0, 0])
        assert infos["final_info"]["elapsed"][0] == step and infos["final_obs"][1] is None
    else:
        assert observations["state"][0, 0] > 0.05


@pytest.mark.parametrize(
    ("action", "message"),
    [
        ([0, 2], "not in MultiDiscrete"),
        ([0.0, 1.0], "expected integers"),
        ([[0], [1]], r"shape \(2, 1\), expected \(2,\)"),
    ],
)
def test_actions_among_some_are_checked(action: list[Any], message: str) -> None:
    envs = Pushed(2)
    envs.reset(seed=0)
    with pytest.raises(ValueError, match=f"Pushed: an action .*{message}"):
        envs.step(np.array(action))


@pytest.mark.parametrize("space", [MultiBinary(3), MultiDiscrete([2, 4, 3]), Box(-1, 1, (3, 2))], ids=str)
def test_spaces_of_actions(space: Any) -> None:
    class Task(Pushed):
        single_action_space = space

        def control(self, action: Array) -> Array:
            assert action.shape == (2, *space.shape)
            return np.zeros((2, 2))

        def reward(self, action: Array) -> Array:
            return np.zeros(2)

    envs = Task(2)
    envs.reset(seed=0)
    envs.step(envs.action_space.sample())
    wrong = type("Wrong", (Pushed,), {"single_action_space": Tuple([space])})
    with pytest.raises(TypeError, match="Wrong: single_action_space must be a Box, .* not Tuple"):
        wrong(2)


def test_a_single_one_is_a_gymnasium_environment() -> None:
    env = PushedEnv()
    check_env(env, skip_render_check=True)
    gymnasium.wrappers.FlattenObservation(env).reset(seed=0)


def test_a_single_one_can_be_put_elsewhere_and_asked() -> None:
    env = PushedEnv(outputs=("xpos",))
    env.reset(seed=0)
    assert env.model.nq == 2
    env.set_state([0.02, 0.3], np.zeros(2))
    sim = env.sim
    np.testing.assert_array_equal(sim.qpos, [0.02, 0.3])
    np.testing.assert_array_equal(sim.body("cart").xpos, env.vector.batch.xpos[0, 1])
    sim.step(10)
    observation, *_ = env.step(np.int64(0))
    assert abs(observation["state"][0] - 0.02) < 0.01
    with pytest.raises(ValueError, match=r"qvel is an array of shape \(3,\), expected \(2,\)"):
        env.set_state([0.0, 0.0], np.zeros(3))
    assert env.vector.batch.qpos[0, 1] != 0
    with pytest.raises(clench.SimulationError, match="cannot continue from this state"):
        env.set_state([np.nan, 0.0], np.zeros(2))
