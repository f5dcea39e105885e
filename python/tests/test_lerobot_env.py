"""The environment for LeRobot, in `python/lerobot_env_clench`: its spaces and motion, and LeRobot's own functions."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import clench
import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from scenes import ROOT

PLUGIN = ROOT / "python/lerobot_env_clench"
sys.path.insert(0, str(PLUGIN))
plugin: Any = pytest.importorskip("lerobot_env_clench")
SMALL: dict[str, Any] = {"observation_size": (32, 24)}
OBS_TYPES = ("pixels_agent_pos", "pixels", "environment_state_agent_pos")


@pytest.mark.parametrize("obs_type", OBS_TYPES)
def test_gymnasium_accepts_it(obs_type: str) -> None:
    env = gymnasium.make(plugin.ID, obs_type=obs_type, render_mode="rgb_array", **SMALL)
    check_env(env.unwrapped)
    observation, info = env.reset(seed=1)
    assert not info["is_success"]
    shapes = {"pixels": (24, 32, 3), "agent_pos": (6,), "environment_state": (5,)}
    assert {key: value.shape for key, value in observation.items()} == {key: shapes[key] for key in observation}
    if "pixels" in observation:
        assert observation["pixels"].dtype == np.uint8 and observation["pixels"].std() > 10
    picture = env.render()
    assert isinstance(picture, np.ndarray) and picture.shape == (480, 480, 3)
    assert env.metadata["render_fps"] == 25


def test_the_same_seed_gives_the_same_episode() -> None:
    env = gymnasium.make(plugin.ID, obs_type="environment_state_agent_pos")
    runs = []
    for seed in (3, 3, 4):
        observation, _ = env.reset(seed=seed)
        for _ in range(5):
            observation, *_ = env.step(np.full(6, 0.1))
        runs.append(np.concatenate(list(observation.values())))
    assert (runs[0] == runs[1]).all() and not (runs[0] == runs[2]).all()


def test_a_vector_of_them_moves_as_single_ones() -> None:
    arguments: dict[str, Any] = {"obs_type": "environment_state_agent_pos"}
    many = gymnasium.make_vec(plugin.ID, num_envs=3, **arguments)
    first, _ = many.reset(seed=5)
    observations, rewards, *_ = many.step(np.full((3, 6), 0.2))
    single = gymnasium.make(plugin.ID, **arguments)
    for env in range(3):
        alone, _ = single.reset(seed=5 + env)
        assert all((alone[key] == first[key][env]).all() for key in alone)
        alone, reward, *_ = single.step(np.full(6, 0.2))
        assert all((alone[key] == observations[key][env]).all() for key in alone) and reward == rewards[env]


def pushed(env: Any, seed: int) -> tuple[bool, list[float]]:
    """Plays an episode: the finger goes behind the box, as seen from the mark, and follows the box to the mark."""
    env.reset(seed=seed)
    inner, rewards = env.unwrapped, []
    while True:
        sim = inner.sim
        box, mark = sim.body("box").xpos[:2], sim.body("mark").xpos[:2]
        along = (mark - box) / np.linalg.norm(mark - box)
        tip = sim.site("tip").xpos[:2]
        behind = box - 0.08 * along
        beside = abs((tip - box) @ [along[1], -along[0]])
        goal = mark - 0.055 * along if beside < 0.012 else behind
        ahead = tip + np.clip(goal - tip, -0.03, 0.03)
        place = clench.FrameTarget(site="tip", position=[*ahead, 0.05], orientation_cost=0.0)
        posture = clench.PostureTarget(sim.model.qpos0, cost=0.01)
        found = sim.ik([place, posture], dofs=np.arange(sim.model.nv) < 6)
        _, reward, terminated, truncated, info = env.step(found.qpos[:6])
        rewards.append(reward)
        if terminated or truncated:
            return bool(info["is_success"]), rewards


def test_a_plain_controller_succeeds() -> None:
    env = gymnasium.make(plugin.ID, obs_type="environment_state_agent_pos")
    runs = [pushed(env, seed) for seed in range(4)]
    assert all(success for success, _ in runs), runs
    assert all(rewards[-1] > 0.9 and len(rewards) < 150 for _, rewards in runs)


def test_bad_arguments() -> None:
    with pytest.raises(ValueError, match="obs_type must be one of pixels_agent_pos"):
        gymnasium.make(plugin.ID, obs_type="state")
    with pytest.raises(ValueError, match="observation_size"):
        gymnasium.make(plugin.ID, observation_size=(0, 24))


# LeRobot's own functions.


@pytest.fixture(name="lerobot_envs")
def _lerobot_envs() -> Any:
    return pytest.importorskip("lerobot.envs", reason="LeRobot is not installed")


@pytest.mark.parametrize("obs_type", OBS_TYPES)
def test_lerobot_makes_it(lerobot_envs: Any, obs_type: str) -> None:
    torch = pytest.importorskip("torch")
    config = lerobot_envs.make_env_config(
        "clench", obs_type=obs_type, observation_height=24, observation_width=32, episode_length=3
    )
    made = lerobot_envs.make_env(config, n_envs=2)
    envs = made["clench"][0]
    assert envs.call("_max_episode_steps") == (3, 3)
    assert set(envs.call("task_description")) == {"Push the box onto the red mark."}
    lerobot_envs.check_env_attributes_and_types(envs)
    observation, _ = envs.reset(seed=[0, 1])
    policy = lerobot_envs.preprocess_observation(observation)
    features = lerobot_envs.env_to_policy_features(config)
    assert set(features) == {*policy, "action"}
    for key, values in policy.items():
        assert tuple(values.shape) == (2, *features[key].shape) and values.dtype == torch.float32, key
    for _ in range(3):
        *_, truncated, info = envs.step(np.zeros((2, 6), dtype=np.float32))
    assert truncated.all() and not info["final_info"]["is_success"].any()
    assert envs.envs[0].render().shape == (480, 640, 3)
    envs.close()


def test_lerobot_steps_it_in_processes(lerobot_envs: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", ":".join([str(PLUGIN), *(path for path in sys.path if Path(path).is_dir())]))
    config = lerobot_envs.make_env_config("clench", obs_type="environment_state_agent_pos")
    envs = lerobot_envs.make_env(config, n_envs=2, use_async_envs=True)["clench"][0]
    observation, _ = envs.reset(seed=[0, 1])
    assert observation["agent_pos"].shape == (2, 6)
    envs.close()


def test_lerobots_command_line_knows_it(lerobot_envs: Any) -> None:
    draccus = pytest.importorskip("draccus")
    choices = lerobot_envs.EnvConfig.get_known_choices()
    config = draccus.parse(choices["clench"], args=["--obs_type=pixels", "--fps=25"])
    assert (config.obs_type, config.gym_id) == ("pixels", plugin.ID)
    with pytest.raises(ValueError, match="obs_type"):
        choices["clench"](obs_type="state")
