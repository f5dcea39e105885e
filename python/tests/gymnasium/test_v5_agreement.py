"""Compares the eleven tasks with gymnasium's own, step by step from the same states and actions."""

from __future__ import annotations

import inspect
from typing import Any

import clench.gymnasium  # noqa: F401, for the tasks it registers
import gymnasium
import numpy as np
import pytest
import reference
from gymnasium.envs.registration import load_env_creator

ENVS = 4
STEPS = 300
EPISODE = 120

CASES = [pytest.param(task, {}, id=task) for task in reference.TASKS] + [
    pytest.param(task, kwargs, id=f"{task}-other") for task, kwargs in reference.OTHER_ARGUMENTS.items()
]


def pair(task: str, kwargs: dict[str, Any], count: int) -> tuple[list[Any], Any]:
    """Returns gymnasium's environments and ours, reset with the same seeds and compared."""
    theirs = [reference.gymnasium_env(task, max_episode_steps=EPISODE, **kwargs) for _ in range(count)]
    ours = gymnasium.make_vec(
        f"clench/{task}-v5", count, max_episode_steps=EPISODE, autoreset_mode="Disabled", **kwargs
    )
    observations, infos = ours.reset(seed=11)
    for row, env in enumerate(theirs):
        observation, info = env.reset(seed=11 + row)
        compare(ours, row, observations, infos, observation, info)
    return theirs, ours


def compare(ours: Any, row: int, observations: Any, infos: Any, observation: Any, info: Any) -> None:
    reference.assert_close(observations[row], observation, "observation")
    assert observations.dtype == observation.dtype
    reference.assert_same_infos(reference.row_of_infos(infos, row), info)


def actions_of(ours: Any, step: int) -> Any:
    """Returns random actions, every third time outside the ranges: clamped actions must have the same cost."""
    actions = ours.action_space.sample()
    return actions * np.float32(1.7) if step % 3 == 0 else actions


@pytest.mark.parametrize(("task", "kwargs"), CASES)
def test_steps(task: str, kwargs: dict[str, Any]) -> None:
    theirs, ours = pair(task, kwargs, ENVS)
    ours.action_space.seed(5)
    resets = 0
    for step in range(STEPS):
        actions = actions_of(ours, step)
        for row, env in enumerate(theirs):
            reference.copy_state(env, ours.unwrapped.batch, row)
        observations, rewards, terminations, truncations, infos = ours.step(actions)
        for row, env in enumerate(theirs):
            observation, reward, terminated, truncated, info = env.step(actions[row])
            compare(ours, row, observations, infos, observation, info)
            reference.assert_close(rewards[row], reward, "reward")
            assert terminations[row] == terminated
            assert truncations[row] == truncated
        done = terminations | truncations
        if done.any():
            resets += int(done.sum())
            observations, infos = ours.reset(options={"reset_mask": done})
            for row in np.flatnonzero(done).tolist():
                observation, info = theirs[row].reset()
                compare(ours, row, observations, infos, observation, info)
    assert resets >= ENVS * (STEPS // EPISODE)


@pytest.mark.parametrize("task", reference.TASKS)
def test_free_running(task: str) -> None:
    """Without copying states, steps after the same reset agree for as long as the motion is not chaotic."""
    theirs, ours = pair(task, {}, 1)
    ours.action_space.seed(6)
    for step in range(30):
        actions = ours.action_space.sample()
        observations, rewards, terminations, truncations, infos = ours.step(actions)
        observation, reward, terminated, truncated, info = theirs[0].step(actions[0])
        compare(ours, 0, observations, infos, observation, info)
        reference.assert_close(rewards[0], reward, "reward")
        assert (terminations[0], truncations[0]) == (terminated, truncated)
        if terminated or truncated:
            break


@pytest.mark.parametrize("task", reference.TASKS)
def test_spaces(task: str) -> None:
    theirs: Any = reference.gymnasium_env(task)
    ours: Any = gymnasium.make(f"clench/{task}-v5")
    assert ours.observation_space == theirs.observation_space
    assert ours.action_space == theirs.action_space
    assert ours.spec.reward_threshold == theirs.spec.reward_threshold
    assert ours.spec.max_episode_steps == theirs.spec.max_episode_steps
    assert ours.unwrapped.dt == pytest.approx(theirs.unwrapped.dt, rel=1e-15)


@pytest.mark.parametrize("task", reference.TASKS)
def test_every_argument(task: str) -> None:
    """The arguments and defaults are those of gymnasium's class."""
    names = gymnasium.spec(f"{task}-v5").entry_point, gymnasium.spec(f"clench/{task}-v5").vector_entry_point
    theirs, ours = (inspect.signature(load_env_creator(str(name))).parameters for name in names)
    for name, parameter in theirs.items():
        if name in ("default_camera_config", "kwargs"):
            continue
        assert ours[name].default == parameter.default, name
