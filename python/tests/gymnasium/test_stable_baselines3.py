"""Stable-Baselines3 trains on our environments, single and all in one batch, through its own wrappers. Skipped without it."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.spaces import Box, Discrete
from tasks_of_tests import Cart
from test_task_of_many_parts import Pushed

import clench.gymnasium

sb3 = pytest.importorskip("stable_baselines3")

from stable_baselines3.common import env_checker, env_util, vec_env  # noqa: E402  Of use only where it is.

from clench.gymnasium.sb3 import BatchVecEnv  # noqa: E402

LITTLE = {"n_steps": 32, "batch_size": 32, "n_epochs": 1, "device": "cpu"}


class Bounded(Cart):
    single_action_space = Box(-1, 1, (2,))


class Chosen(Pushed):
    single_action_space = Discrete(3)

    def control(self, action: Any) -> Any:
        return super().control(action - 1)


def test_it_takes_single_environments() -> None:
    env_checker.check_env(gymnasium.make("clench/Hopper-v5"))
    sb3.PPO("MlpPolicy", env_util.make_vec_env("clench/Hopper-v5", n_envs=2), **LITTLE).learn(64)


def test_it_trains_on_a_batch() -> None:
    envs = Bounded(4, autoreset_mode="SameStep", max_episode_steps=20)
    model = sb3.PPO("MlpPolicy", vec_env.VecNormalize(vec_env.VecMonitor(BatchVecEnv(envs))), **LITTLE).learn(256)
    lengths = [episode["l"] for episode in model.ep_info_buffer]
    assert lengths and max(lengths) <= 20


def test_it_trains_on_observations_by_name_and_chosen_actions() -> None:
    envs = vec_env.VecMonitor(BatchVecEnv(Chosen(4, autoreset_mode="SameStep", max_episode_steps=15)))
    assert len(sb3.PPO("MultiInputPolicy", envs, **LITTLE).learn(256).ep_info_buffer) > 0


def test_episodes_end_as_it_expects() -> None:
    own = Chosen(2, autoreset_mode="SameStep")
    envs = BatchVecEnv(own)
    envs.seed(3)
    first = envs.reset()
    np.testing.assert_array_equal(first["state"], Chosen(2).reset(seed=3)[0]["state"])
    for _ in range(100):
        observations, rewards, dones, infos = envs.step(np.array([2, 1]))
        assert rewards.dtype == np.float32
        if dones[0]:
            break
        assert "elapsed" in infos[0] and "terminal_observation" not in infos[0]
    assert dones.tolist() == [True, False] and infos[0]["TimeLimit.truncated"] is True
    assert infos[0]["terminal_observation"]["state"][0] > 0.05 > observations["state"][0, 0]


def test_what_it_cannot_use_is_refused() -> None:
    with pytest.raises(ValueError, match='autoreset_mode="SameStep", not "NextStep"'):
        BatchVecEnv(Bounded(2))
    with pytest.raises(ValueError, match="counts discrete actions from 0"):
        BatchVecEnv(Pushed(2, autoreset_mode="SameStep"))
    envs = BatchVecEnv(Bounded(2, autoreset_mode="SameStep"))
    with pytest.raises(ValueError, match="share their attributes"):
        envs.set_attr("failure_reward", 1.0, indices=[0])
    with pytest.raises(NotImplementedError, match=r"call `envs\.observe`"):
        envs.env_method("observe")
    assert envs.get_attr("dt") == [0.02, 0.02]
