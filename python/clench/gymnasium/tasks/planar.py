"""Runners in a plane: along x, on legs that swing about y."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clench.gymnasium.tasks.task import Task, row_squares

Array = NDArray[Any]


class PlanarRunner(Task):
    """A runner that is rewarded for speed along x, less the cost of controls.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    forward_reward_weight : float
        Weight of the speed.
    ctrl_cost_weight : float
        Weight of the sum of squared controls.
    exclude_current_positions_from_observation : bool
        True to omit x from the observation.
    **kwargs
        Arguments of :class:`Task`.
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
        """Stores x, to compute the step's mean speed."""
        self._x_before = self.batch.qpos[:, 0].copy()

    def observe(self) -> Array:
        """Returns positions, by default without x, and velocities."""
        return np.concatenate([self.batch.qpos[:, self.skipped :], self.batch.qvel], axis=1)

    def reward(self, action: Array) -> Array:
        """Rewards speed, less the cost of controls."""
        self._x_velocity = (self.batch.qpos[:, 0] - self._x_before) / self.dt
        self._forward = self.forward_reward_weight * self._x_velocity
        self._ctrl = -self.ctrl_cost_weight * row_squares(action)
        total: Array = self._forward + self._ctrl
        return total

    def info(self) -> Mapping[str, Array]:
        """Returns the position, the velocity, and the terms of the reward."""
        return {
            **self.reset_info(),
            "x_velocity": self._x_velocity,
            "reward_forward": self._forward,
            "reward_ctrl": self._ctrl,
        }

    def reset_info(self) -> Mapping[str, Array]:
        """Returns the position."""
        return {"x_position": self.batch.qpos[:, 0]}


class UprightRunner(PlanarRunner):
    """A runner whose episode ends when it falls.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    healthy_reward : float
        Reward of an upright posture.
    terminate_when_unhealthy : bool
        True if a fall ends the episode.
    **kwargs
        Arguments of :class:`PlanarRunner`.
    """

    def __init__(
        self, num_envs: int, *, healthy_reward: float, terminate_when_unhealthy: bool, **kwargs: Any
    ) -> None:
        super().__init__(num_envs, **kwargs)
        self.healthy_reward = healthy_reward
        self.terminate_when_unhealthy = terminate_when_unhealthy

    def healthy(self) -> Array:
        """Returns booleans (n,): True if the runner is upright."""
        raise NotImplementedError

    def observe(self) -> Array:
        """Returns positions, by default without x, and velocities clipped to 10."""
        observation = super().observe()
        velocities = observation[:, -self.init_qvel.size :]
        np.clip(velocities, -10.0, 10.0, out=velocities)
        return observation

    def reward(self, action: Array) -> Array:
        """Rewards speed and an upright posture, less the cost of controls."""
        self._healthy = self.healthy()
        self._survive = self.healthy_reward * self._healthy
        total: Array = super().reward(action) + self._survive
        return total

    def terminated(self) -> Array:
        """Returns true for environments whose runner fell."""
        return ~self._healthy if self.terminate_when_unhealthy else super().terminated()

    def info(self) -> Mapping[str, Array]:
        """Returns the position, the velocity, and the terms of the reward."""
        return {**super().info(), "reward_survive": self._survive}

    def reset_info(self) -> Mapping[str, Array]:
        """Returns the position."""
        return {**super().reset_info(), "z_distance_from_origin": self.batch.qpos[:, 1] - self.init_qpos[1]}
