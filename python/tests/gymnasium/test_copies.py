"""Copies and pickles of environments go on as the originals do."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import clench.gymnasium
import gymnasium
import numpy as np
import pytest

NAMES = [name for name in gymnasium.registry if name.startswith("clench/")]
WAYS = {"deep": copy.deepcopy, "pickle": lambda env: pickle.loads(pickle.dumps(env))}


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)
@pytest.mark.parametrize("name", NAMES)
def test_a_copy_of_an_environment_goes_on_like_it(name: str, way: Any) -> None:
    env = gymnasium.make(name)
    env.reset(seed=3)
    env.action_space.seed(0)
    for _ in range(5):
        env.step(env.action_space.sample())
    other = way(env)
    for _ in range(3):
        action = env.action_space.sample()
        same(env.step(action), other.step(action))
    same(env.reset(), other.reset())


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)
@pytest.mark.parametrize("name", ["clench/Ant-v5", "clench/Humanoid-v5", "clench/Reacher-v5"])
def test_a_copy_of_many_goes_on_like_them(name: str, way: Any) -> None:
    envs = gymnasium.make_vec(name, num_envs=3)
    envs.reset(seed=3)
    envs.action_space.seed(0)
    for _ in range(5):
        envs.step(envs.action_space.sample())
    others = way(envs)
    for _ in range(3):
        actions = envs.action_space.sample()
        same(envs.step(actions), others.step(actions))


def same(one: Any, other: Any) -> None:
    """Checks that two results of a step or reset are equal."""
    if isinstance(one, dict):
        assert one.keys() == other.keys()
        one, other = one.values(), other.values()
    if isinstance(one, np.ndarray):
        np.testing.assert_array_equal(one, other)
    elif hasattr(one, "__iter__") and not isinstance(one, str):
        for part, of_other in zip(one, other, strict=True):
            same(part, of_other)
    else:
        assert one == other
