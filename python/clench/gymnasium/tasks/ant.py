"""Ant: a torso on four legs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clench.gymnasium.single_env import SingleEnv
from clench.gymnasium.tasks.task import Task, row_norms, row_squares

Array = NDArray[Any]


class AntVectorEnv(Task):
    """Gymnasium's Ant-v5 over one batch.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    xml_file, frame_skip, forward_reward_weight, ctrl_cost_weight, contact_cost_weight, healthy_reward, main_body, \
terminate_when_unhealthy, healthy_z_range, contact_force_range, reset_noise_scale, \
exclude_current_positions_from_observation, include_cfrc_ext_in_observation
        As in gymnasium.
    **kwargs
        Arguments of :class:`clench.gymnasium.BatchEnv`.
    """

    normal_velocity_noise = True

    def __init__(
        self,
        num_envs: int = 1,
        *,
        xml_file: str = "ant.xml",
        frame_skip: int = 5,
        forward_reward_weight: float = 1.0,
        ctrl_cost_weight: float = 0.5,
        contact_cost_weight: float = 5e-4,
        healthy_reward: float = 1.0,
        main_body: int | str = 1,
        terminate_when_unhealthy: bool = True,
        healthy_z_range: tuple[float, float] = (0.2, 1.0),
        contact_force_range: tuple[float, float] = (-1.0, 1.0),
        reset_noise_scale: float = 0.1,
        exclude_current_positions_from_observation: bool = True,
        include_cfrc_ext_in_observation: bool = True,
        **kwargs: Any,
    ) -> None:
        super().__init__(
            num_envs,
            xml_file=xml_file,
            frame_skip=frame_skip,
            reset_noise_scale=reset_noise_scale,
            outputs=("xpos", "cfrc_ext"),
            **kwargs,
        )
        self.forward_reward_weight = forward_reward_weight
        self.ctrl_cost_weight = ctrl_cost_weight
        self.contact_cost_weight = contact_cost_weight
        self.healthy_reward = healthy_reward
        self.terminate_when_unhealthy = terminate_when_unhealthy
        self.healthy_z_range = healthy_z_range
        self.contact_force_range = contact_force_range
        self.skipped = 2 if exclude_current_positions_from_observation else 0
        self.include_cfrc_ext_in_observation = include_cfrc_ext_in_observation
        self._torso_xy = self.batch.xpos[:, self.batch.model.body(main_body).id, :2]
        self._forces = self.batch.cfrc_ext[:, 1:].reshape(num_envs, -1)

    def before_step(self) -> None:
        """Stores the position of the torso, to compute the step's mean velocity."""
        self._xy_before = self._torso_xy.copy()

    def observe(self) -> Array:
        """Returns positions, by default without x and y, velocities, and clipped external forces, which are zero before
        a step."""
        parts = [self.batch.qpos[:, self.skipped :], self.batch.qvel]
        if not self.include_cfrc_ext_in_observation:
            return np.concatenate(parts, axis=1)
        observation = np.concatenate([*parts, self._forces], axis=1)
        forces = observation[:, -self._forces.shape[1] :]
        forces[self.fresh] = 0.0
        np.clip(forces, *self.contact_force_range, out=forces)
        return observation

    def reward(self, action: Array) -> Array:
        """Rewards speed along x and an upright posture, less the costs of controls and contact forces."""
        z, (low, high) = self.batch.qpos[:, 2], self.healthy_z_range
        self._healthy = (low <= z) & (z <= high)
        self._velocity = (self._torso_xy - self._xy_before) / self.dt
        self._forward = self.forward_reward_weight * self._velocity[:, 0]
        self._survive = self.healthy_reward * self._healthy
        self._ctrl = -self.ctrl_cost_weight * row_squares(action)
        self._contact = -self.contact_cost_weight * row_squares(np.clip(self._forces, *self.contact_force_range))
        total: Array = self._forward + self._survive + (self._ctrl + self._contact)
        return total

    def terminated(self) -> Array:
        """Returns true for environments whose torso is not upright."""
        return ~self._healthy if self.terminate_when_unhealthy else super().terminated()

    def info(self) -> Mapping[str, Array]:
        """Returns the position, the velocity, and the terms of the reward."""
        return {
            **self.reset_info(),
            "x_velocity": self._velocity[:, 0],
            "y_velocity": self._velocity[:, 1],
            "reward_forward": self._forward,
            "reward_ctrl": self._ctrl,
            "reward_contact": self._contact,
            "reward_survive": self._survive,
        }

    def reset_info(self) -> Mapping[str, Array]:
        """Returns the position."""
        xy = self.batch.qpos[:, :2]
        return {"x_position": xy[:, 0], "y_position": xy[:, 1], "distance_from_origin": row_norms(xy)}


class AntEnv(SingleEnv):
    """A single Ant environment."""

    task = AntVectorEnv
