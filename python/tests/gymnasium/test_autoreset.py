"""Compares ends of episodes with gymnasium's SyncVectorEnv over its own environments, in all three autoreset modes."""

from __future__ import annotations

from typing import Any

import clench.gymnasium  # noqa: F401, for the tasks it registers
import gymnasium
import numpy as np
import pytest
import reference
from gymnasium.error import ResetNeeded
from gymnasium.vector import AutoresetMode, SyncVectorEnv

ENVS = 5
STEPS = 90

# Tasks and lengths of episodes. Some fall earlier, some never; some infos have arrays, some resets have no infos.
CASES = (("Hopper", 25), ("InvertedPendulum", 12), ("Humanoid", 30), ("Reacher", 7), ("Ant", 1))


def pair(task: str, length: int, mode: AutoresetMode) -> tuple[Any, Any]:
    theirs: Any = SyncVectorEnv(
        [lambda: reference.gymnasium_env(task, max_episode_steps=length) for _ in range(ENVS)], autoreset_mode=mode
    )
    ours = gymnasium.make_vec(f"clench/{task}-v5", ENVS, max_episode_steps=length, autoreset_mode=mode)
    assert ours.metadata["autoreset_mode"] is mode
    ours.action_space.seed(2)
    return theirs, ours


def assert_same_step(ours: tuple[Any, ...], theirs: tuple[Any, ...]) -> None:
    """Compares observations, rewards, terminations, truncations and infos; of a reset, observations and infos."""
    names = ("observation", "reward", "terminated", "truncated")
    for mine, yours, what in zip(ours[:-1], theirs[:-1], names, strict=False):
        assert (mine.dtype, mine.shape) == (yours.dtype, yours.shape)
        reference.assert_close(mine, yours, what)
    reference.assert_same_infos(ours[-1], theirs[-1])


@pytest.mark.parametrize(("task", "length"), CASES)
@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_autoreset(task: str, length: int, mode: AutoresetMode) -> None:
    theirs, ours = pair(task, length, mode)
    assert_same_step(ours.reset(seed=3), theirs.reset(seed=3))
    ended = 0
    for _ in range(STEPS):
        actions = ours.action_space.sample()
        result = ours.step(actions)
        assert_same_step(result, theirs.step(actions))
        ended += int((result[2] | result[3]).sum())
    assert ended > ENVS


@pytest.mark.parametrize(("task", "length"), CASES)
def test_disabled(task: str, length: int) -> None:
    """Ended episodes are reset by hand, and sometimes others."""
    theirs, ours = pair(task, length, AutoresetMode.DISABLED)
    assert_same_step(ours.reset(seed=3), theirs.reset(seed=3))
    rng = np.random.default_rng(0)
    for step in range(STEPS):
        actions = ours.action_space.sample()
        result = ours.step(actions)
        assert_same_step(result, theirs.step(actions))
        mask = result[2] | result[3] | (rng.random(ENVS) < 0.05)
        if mask.any():
            seed = 100 + step if step % 2 else None
            again = ours.reset(seed=seed, options={"reset_mask": mask})
            assert_same_step(again, theirs.reset(seed=seed, options={"reset_mask": mask}))


def test_disabled_refuses_to_go_on() -> None:
    _, ours = pair("Reacher", 3, AutoresetMode.DISABLED)
    ours.reset(seed=0)
    for _ in range(3):
        ours.step(ours.action_space.sample())
    with pytest.raises(ResetNeeded, match="clench/Reacher-v5: the episode of environment 0 is over"):
        ours.step(ours.action_space.sample())


def test_modes_by_name() -> None:
    """The mode may be gymnasium's name; any other name is an error."""
    assert gymnasium.make_vec("clench/Reacher-v5", 2, autoreset_mode="SameStep").metadata["autoreset_mode"] is (
        AutoresetMode.SAME_STEP
    )
    with pytest.raises(ValueError, match="sometimes"):
        gymnasium.make_vec("clench/Reacher-v5", 2, autoreset_mode="sometimes")


@pytest.mark.parametrize(
    ("mask", "error"),
    [
        ([True, False], TypeError),
        (np.array([1, 0]), TypeError),
        (np.array([True, False, True]), ValueError),
        (np.array([False, False]), ValueError),
    ],
)
def test_bad_masks(mask: Any, error: type[Exception]) -> None:
    envs = gymnasium.make_vec("clench/Reacher-v5", 2)
    envs.reset(seed=0)
    with pytest.raises(error, match="reset_mask"):
        envs.reset(options={"reset_mask": mask})


def test_reset_options() -> None:
    """An unknown option is an error; the caller's dictionary is not changed."""
    envs = gymnasium.make_vec("clench/Reacher-v5", 2)
    with pytest.raises(ResetNeeded, match="first reset must be of all"):
        envs.reset(options={"reset_mask": np.array([True, False])})
    envs.reset(seed=0, options={})
    with pytest.raises(ValueError, match="no reset option `mask`"):
        envs.reset(options={"mask": np.array([True, False])})
    options = {"reset_mask": np.array([True, False])}
    envs.reset(options=options)
    assert list(options) == ["reset_mask"]
    with pytest.raises(ValueError, match="no reset option `reset_mask`"):
        gymnasium.make("clench/Reacher-v5").reset(options=options)
