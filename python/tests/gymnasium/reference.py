"""Gymnasium's own tasks, made comparable: MuJoCo's Newton solver, and rows of several environments."""

from __future__ import annotations

from typing import Any

import gymnasium
import mujoco  # type: ignore[import-untyped]
import numpy as np

TASKS = (
    "Ant",
    "HalfCheetah",
    "Hopper",
    "Humanoid",
    "HumanoidStandup",
    "InvertedDoublePendulum",
    "InvertedPendulum",
    "Pusher",
    "Reacher",
    "Swimmer",
    "Walker2d",
)

# Keyword arguments that differ from gymnasium's defaults; each task has all that it accepts.
OTHER_ARGUMENTS: dict[str, dict[str, Any]] = {
    "Ant": {
        "frame_skip": 3,
        "forward_reward_weight": 2.0,
        "ctrl_cost_weight": 0.25,
        "contact_cost_weight": 3e-3,
        "healthy_reward": 0.5,
        "main_body": "front_left_leg",
        "terminate_when_unhealthy": False,
        "healthy_z_range": (0.3, 0.8),
        "contact_force_range": (-20.0, 30.0),
        "reset_noise_scale": 0.3,
        "exclude_current_positions_from_observation": False,
    },
    "HalfCheetah": {
        "frame_skip": 2,
        "forward_reward_weight": 0.7,
        "ctrl_cost_weight": 0.3,
        "reset_noise_scale": 0.4,
        "exclude_current_positions_from_observation": False,
    },
    "Hopper": {
        "frame_skip": 7,
        "forward_reward_weight": 0.7,
        "ctrl_cost_weight": 0.3,
        "healthy_reward": 2.5,
        "terminate_when_unhealthy": False,
        "healthy_state_range": (-3.0, 3.0),
        "healthy_z_range": (0.9, 1.4),
        "healthy_angle_range": (-0.1, 0.3),
        "reset_noise_scale": 0.05,
        "exclude_current_positions_from_observation": False,
    },
    "Humanoid": {
        "frame_skip": 2,
        "forward_reward_weight": 0.5,
        "ctrl_cost_weight": 1.5,
        "contact_cost_weight": 1e-4,
        "contact_cost_range": (2.0, 25.0),
        "healthy_reward": 1.5,
        "terminate_when_unhealthy": False,
        "healthy_z_range": (0.9, 1.3),
        "reset_noise_scale": 0.1,
        "exclude_current_positions_from_observation": False,
        "include_cinert_in_observation": False,
        "include_qfrc_actuator_in_observation": False,
    },
    "HumanoidStandup": {
        "frame_skip": 3,
        "uph_cost_weight": 2.0,
        "ctrl_cost_weight": 0.3,
        "impact_cost_weight": 1e-4,
        "impact_cost_range": (1.0, 20.0),
        "reset_noise_scale": 0.1,
        "exclude_current_positions_from_observation": False,
        "include_cvel_in_observation": False,
        "include_cfrc_ext_in_observation": False,
    },
    "InvertedDoublePendulum": {"frame_skip": 2, "healthy_reward": 3.0, "reset_noise_scale": 0.2},
    "InvertedPendulum": {"frame_skip": 3, "reset_noise_scale": 0.1},
    "Pusher": {"frame_skip": 2, "reward_near_weight": 2.0, "reward_dist_weight": 0.3, "reward_control_weight": 0.7},
    "Reacher": {"frame_skip": 3, "reward_dist_weight": 3.0, "reward_control_weight": 0.2},
    "Swimmer": {
        "frame_skip": 2,
        "forward_reward_weight": 3.0,
        "ctrl_cost_weight": 0.1,
        "reset_noise_scale": 0.5,
        "exclude_current_positions_from_observation": False,
    },
    "Walker2d": {
        "frame_skip": 7,
        "forward_reward_weight": 0.7,
        "ctrl_cost_weight": 0.3,
        "healthy_reward": 2.5,
        "terminate_when_unhealthy": False,
        "healthy_z_range": (0.9, 1.4),
        "healthy_angle_range": (-0.1, 0.3),
        "reset_noise_scale": 0.05,
        "exclude_current_positions_from_observation": False,
    },
}


def gymnasium_env(task: str, **kwargs: Any) -> Any:
    """Returns gymnasium's own environment. If its file selects PGS, it uses Newton, whose minimum is the same.

    Newton then has a tiny tolerance: at the default tolerance MuJoCo's contact forces on the humanoids have a relative
    error of up to 6e-6, ours of 5e-12.
    """
    env: Any = gymnasium.make(f"{task}-v5", **kwargs)
    options = env.unwrapped.model.opt
    if options.solver == mujoco.mjtSolver.mjSOL_PGS:
        options.solver = mujoco.mjtSolver.mjSOL_NEWTON
        options.tolerance = 1e-15
    return env


def copy_state(env: Any, batch: Any, row: int) -> None:
    """Copies MuJoCo's current state into a row of a batch."""
    data = env.unwrapped.data
    batch.qpos[row], batch.qvel[row], batch.qacc_warmstart[row] = data.qpos, data.qvel, data.qacc_warmstart


def assert_close(ours: Any, theirs: Any, what: str) -> None:
    """Checks agreement to 1e-6, absolute, and relative for large numbers."""
    np.testing.assert_allclose(ours, theirs, rtol=1e-6, atol=1e-6, err_msg=what)


def assert_same_infos(ours: dict[str, Any], theirs: dict[str, Any], what: str = "info") -> None:
    """Checks for equal keys, shapes and masks, and numbers that agree to 1e-6."""
    assert ours.keys() == theirs.keys(), what
    for key, value in theirs.items():
        mine, name = ours[key], f"{what}[{key!r}]"
        if isinstance(value, dict):
            assert_same_infos(mine, value, name)
            continue
        assert np.shape(mine) == np.shape(value), name
        if np.asarray(value).dtype == np.object_:
            for row, (left, right) in enumerate(zip(mine, value, strict=True)):
                assert (left is None) == (right is None), f"{name}[{row}]"
                if right is not None:
                    assert left.dtype == right.dtype, f"{name}[{row}]"
                    assert_close(left, right, f"{name}[{row}]")
        else:
            assert np.asarray(mine).dtype.kind == np.asarray(value).dtype.kind, name
            assert_close(mine, value, name)


def row_of_infos(infos: dict[str, Any], row: int) -> dict[str, Any]:
    """Returns the info of one environment of a vector environment."""
    return {key: value[row] for key, value in infos.items() if f"_{key}" in infos and infos[f"_{key}"][row]}
