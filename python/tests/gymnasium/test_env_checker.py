"""Gymnasium's own checks, registration, and wrappers with our environments."""

from __future__ import annotations

import subprocess
import sys
import warnings
from typing import Any

import clench.gymnasium
import gymnasium
import numpy as np
import pytest
import reference
from gymnasium.utils.env_checker import check_env
from gymnasium.wrappers import vector as wrappers
from tasks_of_tests import CartEnv

# Warnings of check_env about unbounded observations and controls beyond one; gymnasium's own tasks get them too.
EXPECTED = ("A Box observation space m", "For Box action spaces, we recommend", "A Box action space m")


@pytest.mark.parametrize("task", [*reference.TASKS, "Cart"])
def test_check_env(task: str) -> None:
    """check_env finds no fault in seeds, determinism, spaces and aliasing."""
    env = CartEnv() if task == "Cart" else gymnasium.make(f"clench/{task}-v5").unwrapped
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        check_env(env)
    unexpected = [str(w.message) for w in caught if not any(text in str(w.message) for text in EXPECTED)]
    if task == "Cart":
        unexpected = [text for text in unexpected if "not having a spec" not in text]
    assert not unexpected


@pytest.mark.parametrize("task", reference.TASKS)
def test_passive_checker(task: str) -> None:
    """The checkers that gymnasium.make adds do not warn."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = gymnasium.make(f"clench/{task}-v5", max_episode_steps=20)
        env.action_space.seed(0)
        env.reset(seed=0)
        for _ in range(25):
            _, _, terminated, truncated, _ = env.step(env.action_space.sample())
            if terminated or truncated:
                env.reset()


@pytest.mark.parametrize("task", reference.TASKS)
@pytest.mark.parametrize("mode", ["NextStep", "SameStep"])
def test_vector_protocol(task: str, mode: str) -> None:
    """Spaces contain the results of steps, and results never share memory."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        envs = gymnasium.make_vec(f"clench/{task}-v5", num_envs=3, autoreset_mode=mode, max_episode_steps=5)
    envs.action_space.seed(0)
    observations, infos = envs.reset(seed=0)
    kept: list[Any] = []
    for _ in range(12):
        assert observations in envs.observation_space
        assert all(row in envs.single_observation_space for row in observations)
        for key, value in infos.items():
            assert key.startswith("_") or f"_{key}" in infos
            assert isinstance(value, dict) or len(value) == 3
        observations, rewards, terminations, truncations, infos = envs.step(envs.action_space.sample())
        for array, dtype in ((rewards, np.float64), (terminations, np.bool_), (truncations, np.bool_)):
            assert (array.dtype, array.shape) == (dtype, (3,))
        arrays = [observations, rewards, terminations, truncations]
        arrays += [value for value in infos.values() if isinstance(value, np.ndarray)]
        assert not any(np.shares_memory(new, old) for new in arrays for old in kept)
        kept = arrays
    envs.close()
    envs.close()


def test_vector_wrappers() -> None:
    """Gymnasium's vector wrappers work on top."""
    envs: Any = gymnasium.make_vec("clench/Hopper-v5", num_envs=4, max_episode_steps=6)
    envs = wrappers.RecordEpisodeStatistics(envs)
    envs = wrappers.NormalizeObservation(envs)
    envs = wrappers.ClipAction(envs)
    envs = wrappers.DictInfoToList(envs)
    envs.reset(seed=0)
    lengths = []
    for _ in range(13):
        *_, infos = envs.step(np.full((4, 3), 5.0, dtype=np.float32))
        lengths += [info["episode"]["l"] for info in infos if "episode" in info]
    assert lengths == [6] * 8


def test_sync_over_singles() -> None:
    """Gymnasium can vectorize our single environments, in its own process or in others."""
    envs = gymnasium.make_vec("clench/Reacher-v5", num_envs=2)
    for mode in ("sync", "async"):
        theirs = gymnasium.make_vec("clench/Reacher-v5", num_envs=2, vectorization_mode=mode)
        np.testing.assert_array_equal(theirs.reset(seed=1)[0], envs.reset(seed=1)[0])
        theirs.close()


def test_names() -> None:
    ours = {name for name in gymnasium.registry if name.startswith("clench/")}
    assert ours == {f"clench/{task}-v5" for task in reference.TASKS}
    clench.gymnasium.register_tasks()
    for name in ours:
        gymnasium.spec(name).to_json()


def test_import_is_light() -> None:
    """Importing only registers names: it imports no MuJoCo, no task, and no gymnasium unless requested."""
    program = (
        "import sys, clench; assert 'gymnasium' not in sys.modules\n"
        "import clench.gymnasium; assert not [m for m in sys.modules if m.startswith('clench.gymnasium.tasks')]\n"
        "import gymnasium; gymnasium.make_vec('clench/Humanoid-v5', num_envs=2).reset(seed=0)\n"
        "assert 'mujoco' not in sys.modules and 'gymnasium.envs.mujoco' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", program], check=True)


def test_without_import() -> None:
    """Gymnasium imports the module itself if the name contains it."""
    program = "import gymnasium; gymnasium.make_vec('clench.gymnasium:clench/Humanoid-v5', num_envs=2).reset(seed=0)"
    subprocess.run([sys.executable, "-c", program], check=True)


def test_model_files() -> None:
    with pytest.raises(FileNotFoundError, match="no model file .*assets.*ants.xml"):
        gymnasium.make_vec("clench/Ant-v5", 2, xml_file="ants.xml")
    with pytest.raises(FileNotFoundError, match="no model file ants.xml"):
        gymnasium.make_vec("clench/Ant-v5", 2, xml_file="./ants.xml")
    with pytest.raises(TypeError, match="healthy_z"):
        gymnasium.make_vec("clench/Ant-v5", 2, healthy_z=1.0)


def test_drawing_arguments() -> None:
    """Arguments for drawing are accepted as in gymnasium."""
    gymnasium.make("clench/Ant-v5", default_camera_config={"distance": 2.0}, width=100, camera_id=0)
