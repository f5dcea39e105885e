"""Swimmer: three links that push themselves through a viscous fluid, in a plane."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clench.gymnasium.single_env import SingleEnv
from clench.gymnasium.tasks.task import Task, row_norms, row_squares

Array = NDArray[Any]


class SwimmerVectorEnv(Task):
    """Gymnasium's Swimmer-v5 over one batch.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    xml_file, frame_skip, forward_reward_weight, ctrl_cost_weight, reset_noise_scale, \
exclude_current_positions_from_observation
        As in gymnasium.
    **kwargs
        Arguments of :class:`clench.gymnasium.BatchEnv`.
    """

    def __init__(
        self,
        num_envs: int = 1,
        *,
        xml_file: str = "swimmer.xml",
        frame_skip: int = 4,
        forward_reward_weight: float = 1.0,
        ctrl_cost_weight: float = 1e-4,
        reset_noise_scale: float = 0.1,
        exclude_current_positions_from_observation: bool = True,
        **kwargs: Any,
    ) -> None:
        super().__init__(
            num_envs, xml_file=xml_file, frame_skip=frame_skip, reset_noise_scale=reset_noise_scale, **kwargs
        )
        self.forward_reward_weight = forward_reward_weight
        self.ctrl_cost_weight = ctrl_cost_weight
        self.skipped = 2 if exclude_current_positions_from_observation else 0

    def before_step(self) -> None:
        """Stores x and y, to compute the step's mean velocity."""
        self._xy_before = self.batch.qpos[:, :2].copy()

    def observe(self) -> Array:
        """Returns positions, by default without x and y, and velocities."""
        return np.concatenate([self.batch.qpos[:, self.skipped :], self.batch.qvel], axis=1)

    def reward(self, action: Array) -> Array:
        """Rewards speed along x, less the cost of controls."""
        self._velocity = (self.batch.qpos[:, :2] - self._xy_before) / self.dt
        self._forward = self.forward_reward_weight * self._velocity[:, 0]
        self._ctrl = -self.ctrl_cost_weight * row_squares(action)
        total: Array = self._forward + self._ctrl
        return total

    def info(self) -> Mapping[str, Array]:
        """Returns the position, the velocity, and the terms of the reward."""
        return {
            **self.reset_info(),
            "x_velocity": self._velocity[:, 0],
            "y_velocity": self._velocity[:, 1],
            "reward_forward": self._forward,
            "reward_ctrl": self._ctrl,
        }

    def reset_info(self) -> Mapping[str, Array]:
        """Returns the position."""
        xy = self.batch.qpos[:, :2]
        return {"x_position": xy[:, 0], "y_position": xy[:, 1], "distance_from_origin": row_norms(xy)}


class SwimmerEnv(SingleEnv):
    """A single Swimmer environment."""

    task = SwimmerVectorEnv
