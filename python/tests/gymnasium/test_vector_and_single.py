"""A vector environment of n is bitwise equal to n single environments; seeds determine everything."""

from __future__ import annotations

from typing import Any

import clench.gymnasium  # noqa: F401, for the tasks it registers
import gymnasium
import numpy as np
import pytest
import reference

ENVS = 11
EPISODE = 17


def assert_same(ours: Any, theirs: Any) -> None:
    np.testing.assert_array_equal(ours, theirs, strict=True)


@pytest.mark.parametrize("task", reference.TASKS)
@pytest.mark.parametrize("precision", ["64", "32"])
def test_vector_of_singles(task: str, precision: str) -> None:
    envs = gymnasium.make_vec(f"clench/{task}-v5", ENVS, max_episode_steps=EPISODE, precision=precision, threads=2)
    singles: list[Any] = [
        gymnasium.make(f"clench/{task}-v5", max_episode_steps=EPISODE, precision=precision) for _ in range(ENVS)
    ]
    envs.action_space.seed(1)
    observations, infos = envs.reset(seed=40)
    for row, env in enumerate(singles):
        observation, info = env.reset(seed=40 + row)
        assert_same(observations[row], observation)
        assert_same_info(reference.row_of_infos(infos, row), info)
    over = np.zeros(ENVS, dtype=bool)
    for _ in range(40):
        actions = envs.action_space.sample()
        observations, rewards, terminations, truncations, infos = envs.step(actions)
        for row, env in enumerate(singles):
            if over[row]:
                observation, info = env.reset()
                reward, terminated, truncated = 0.0, False, False
            else:
                observation, reward, terminated, truncated, info = env.step(actions[row])
            assert_same(observations[row], observation)
            assert_same_info(reference.row_of_infos(infos, row), info)
            assert (rewards[row], terminations[row], truncations[row]) == (reward, terminated, truncated)
            over[row] = terminated or truncated
    assert observations.dtype == (np.float64 if precision == "64" else np.float32)


def assert_same_info(ours: dict[str, Any], theirs: dict[str, Any]) -> None:
    assert ours.keys() == theirs.keys()
    for key, value in theirs.items():
        assert_same(ours[key], value)


def episode(envs: Any, seed: Any) -> Any:
    """Returns the observations of a reset and ten steps."""
    envs.action_space.seed(9)
    return [envs.reset(seed=seed)[0], *(envs.step(envs.action_space.sample())[0] for _ in range(10))]


def test_options_by_name() -> None:
    """Options are given by name, also in the text of a spec, or as an object."""
    named: dict[str, Any] = {"contact_model": "coulomb", "stiction": True}
    by_name: Any = gymnasium.make_vec("clench/Hopper-v5", 2, options=named)
    as_object: Any = gymnasium.make_vec("clench/Hopper-v5", 2, options=clench.RigidOptions(**named))
    first = episode(by_name, 5)
    assert_same(first, episode(as_object, 5))
    assert by_name.unwrapped.batch.options.contact_model == "coulomb"
    single: Any = gymnasium.make("clench/Hopper-v5", options=named)
    again: Any = gymnasium.make(gymnasium.envs.registration.EnvSpec.from_json(single.spec.to_json()))
    for env in (single, again):
        assert (env.unwrapped.sim.options.contact_model, env.unwrapped.sim.options.stiction) == ("coulomb", True)
    with pytest.raises(TypeError, match="contact"):
        gymnasium.make_vec("clench/Hopper-v5", 2, options={"contact": "coulomb"})


def test_seeds() -> None:
    envs: Any = gymnasium.make_vec("clench/Hopper-v5", 4, max_episode_steps=4)
    again: Any = gymnasium.make_vec("clench/Hopper-v5", 4, max_episode_steps=4)
    first = episode(envs, 5)
    assert_same(first, episode(again, 5))
    assert_same(first, episode(envs, [5, 6, 7, 8]))
    assert envs.np_random_seed == (5, 6, 7, 8)
    assert not np.array_equal(first, episode(envs, 6))
    assert not np.array_equal(first[0], envs.reset()[0])
    assert len({row.tobytes() for row in first[0]}) == 4


def test_seeds_of_some() -> None:
    """A seed of None continues a generator; environments outside the mask keep theirs."""
    envs: Any = gymnasium.make_vec("clench/Hopper-v5", 3)
    start = envs.reset(seed=5)[0]
    later = envs.reset(seed=[None, 6, None])[0]
    assert_same(later[1], start[1])
    assert not np.array_equal(later[0], start[0])
    only = envs.reset(seed=5, options={"reset_mask": np.array([True, False, False])})[0]
    assert_same(only[0], start[0])
    assert_same(only[1:], later[1:])


def test_unseeded() -> None:
    """Without a seed the system provides one, which can be read and reused."""
    envs: Any = gymnasium.make_vec("clench/Hopper-v5", 3)
    first = envs.reset()[0]
    assert_same(envs.reset(seed=envs.np_random_seed)[0], first)
    assert not np.array_equal(gymnasium.make_vec("clench/Hopper-v5", 3).reset()[0], first)


@pytest.mark.parametrize("seed", [[1, 2], "abc", -1, 0.5])
def test_bad_seeds(seed: Any) -> None:
    with pytest.raises((ValueError, TypeError, gymnasium.error.Error)):
        gymnasium.make_vec("clench/Hopper-v5", 3).reset(seed=seed)
