"""TorchRL's wrapper of Gymnasium's environments accepts ours, single and vector ones. Skipped without it."""

from __future__ import annotations

from typing import Any

import gymnasium
import pytest
from test_task_of_many_parts import Pushed

from clench.gymnasium.tasks.hopper import HopperVectorEnv

pytest.importorskip("torchrl")

from gymnasium.spaces import Discrete  # noqa: E402
from torchrl.envs import Compose, GymWrapper, RewardSum, StepCounter, TransformedEnv  # noqa: E402  Of use only where it is.
from torchrl.envs.utils import check_env_specs  # noqa: E402


class Chosen(Pushed):
    single_action_space = Discrete(3)

    def control(self, action: Any) -> Any:
        return super().control(action - 1)


@pytest.mark.parametrize(("task", "mode"), [(HopperVectorEnv, "Disabled"), (HopperVectorEnv, "SameStep"), (Chosen, "Disabled")])
def test_it_takes_vector_environments(task: Any, mode: str) -> None:
    env = TransformedEnv(GymWrapper(task(3, autoreset_mode=mode, max_episode_steps=4)), Compose(StepCounter(), RewardSum()))
    check_env_specs(env)
    run = env.rollout(10, break_when_any_done=False)
    assert run["next", "reward"].shape == (3, 10, 1)
    assert run["next", "done"][:, 3].all() and run["next", "done"].sum() == 6


def test_it_takes_single_environments() -> None:
    env = GymWrapper(gymnasium.make("clench/Hopper-v5"))
    check_env_specs(env)
    assert env.rollout(5)["next", "reward"].shape[-1] == 1
