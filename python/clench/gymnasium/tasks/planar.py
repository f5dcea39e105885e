"""Runners in a plane: along x, on legs that swing about y."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clench.gymnasium.tasks.task import Task, row_squares

Array = NDArray[Any]


class PlanarRunner(Task):
    """Rewarded for speed along x, charged for controls.

    Parameters
    ----------
    num_envs : int
        How many environments.
    forward_reward_weight : float
        Weight of the speed.
    ctrl_cost_weight : float
        Weight of the sum of squared controls.
    exclude_current_positions_from_observation : bool
        Whether x is left out of what is observed.
    **kwargs
        What :class:`Task` takes.
    """

    def __init__(
        self,
        num_envs: int,
        *,
        forward_reward_weight: float,
        ctrl_cost_weight: float,
        exclude_current_positions_from_observation: bool,
        **kwargs: Any,
    ) -> None:
        super().__init__(num_envs, **kwargs)
        self.forward_reward_weight = forward_reward_weight
        self.ctrl_cost_weight = ctrl_cost_weight
        self.skipped = 1 if exclude_current_positions_from_observation else 0

    def before_step(self) -> None:
        """Keeps x, of which the step's mean speed is worked out."""
        self._x_before = self.batch.qpos[:, 0].copy()

    def observe(self) -> Array:
        """Positions, without x unless asked for, and velocities."""
        return np.concatenate([self.batch.qpos[:, self.skipped :], self.batch.qvel], axis=1)

    def reward(self, action: Array) -> Array:
        """Speed less controls."""
        self._x_velocity = (self.batch.qpos[:, 0] - self._x_before) / self.dt
        self._forward = self.forward_reward_weight * self._x_velocity
        self._ctrl = -self.ctrl_cost_weight * row_squares(action)
        total: Array = self._forward + self._ctrl
        return total

    def info(self) -> Mapping[str, Array]:
        """Where it is, how fast, and the terms of the reward."""
        return {
            **self.reset_info(),
            "x_velocity": self._x_velocity,
            "reward_forward": self._forward,
            "reward_ctrl": self._ctrl,
        }

    def reset_info(self) -> Mapping[str, Array]:
        """Where it is."""
        return {"x_position": self.batch.qpos[:, 0]}


class UprightRunner(PlanarRunner):
    """A runner that is over when it falls.

    Parameters
    ----------
    num_envs : int
        How many environments.
    healthy_reward : float
        What being upright is worth.
    terminate_when_unhealthy : bool
        Whether falling ends the episode.
    **kwargs
        What :class:`PlanarRunner` takes.
    """

    def __init__(
        self, num_envs: int, *, healthy_reward: float, terminate_when_unhealthy: bool, **kwargs: Any
    ) -> None:
        super().__init__(num_envs, **kwargs)
        self.healthy_reward = healthy_reward
        self.terminate_when_unhealthy = terminate_when_unhealthy

    def healthy(self) -> Array:
        """Who is upright, (n,) booleans."""
        raise NotImplementedError

    def observe(self) -> Array:
        """Positions, without x unless asked for, and velocities clipped to 10."""
        observation = super().observe()
        velocities = observation[:, -self.init_qvel.size :]
        np.clip(velocities, -10.0, 10.0, out=velocities)
        return observation

    def reward(self, action: Array) -> Array:
        """Speed and being upright, less controls."""
        self._healthy = self.healthy()
        self._survive = self.healthy_reward * self._healthy
        total: Array = super().reward(action) + self._survive
        return total

    def terminated(self) -> Array:
        """Who fell."""
        return ~self._healthy if self.terminate_when_unhealthy else super().terminated()

    def info(self) -> Mapping[str, Array]:
        """Where it is, how fast, and the terms of the reward."""
        return {**super().info(), "reward_survive": self._survive}

    def reset_info(self) -> Mapping[str, Array]:
        """Where it is."""
        return {**super().reset_info(), "z_distance_from_origin": self.batch.qpos[:, 1] - self.init_qpos[1]}
