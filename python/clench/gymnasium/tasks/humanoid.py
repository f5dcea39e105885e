"""Humanoid: walks on two legs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clench.gymnasium.single_env import SingleEnv
from clench.gymnasium.tasks.person import Person
from clench.gymnasium.tasks.task import between, row_norms, row_squares

Array = NDArray[Any]


class HumanoidVectorEnv(Person):
    """Gymnasium's Humanoid-v5 over one batch.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    xml_file, frame_skip, forward_reward_weight, ctrl_cost_weight, contact_cost_weight, contact_cost_range, \
healthy_reward, terminate_when_unhealthy, healthy_z_range, reset_noise_scale, \
exclude_current_positions_from_observation, include_cinert_in_observation, include_cvel_in_observation, \
include_qfrc_actuator_in_observation, include_cfrc_ext_in_observation
        As in gymnasium.
    **kwargs
        Arguments of :class:`clench.gymnasium.BatchEnv`.
    """

    def __init__(
        self,
        num_envs: int = 1,
        *,
        xml_file: str = "humanoid.xml",
        frame_skip: int = 5,
        forward_reward_weight: float = 1.25,
        ctrl_cost_weight: float = 0.1,
        contact_cost_weight: float = 5e-7,
        contact_cost_range: tuple[float, float] = (-np.inf, 10.0),
        healthy_reward: float = 5.0,
        terminate_when_unhealthy: bool = True,
        healthy_z_range: tuple[float, float] = (1.0, 2.0),
        reset_noise_scale: float = 1e-2,
        exclude_current_positions_from_observation: bool = True,
        include_cinert_in_observation: bool = True,
        include_cvel_in_observation: bool = True,
        include_qfrc_actuator_in_observation: bool = True,
        include_cfrc_ext_in_observation: bool = True,
        **kwargs: Any,
    ) -> None:
        super().__init__(
            num_envs,
            xml_file=xml_file,
            frame_skip=frame_skip,
            reset_noise_scale=reset_noise_scale,
            exclude_current_positions_from_observation=exclude_current_positions_from_observation,
            include_cinert_in_observation=include_cinert_in_observation,
            include_cvel_in_observation=include_cvel_in_observation,
            include_qfrc_actuator_in_observation=include_qfrc_actuator_in_observation,
            include_cfrc_ext_in_observation=include_cfrc_ext_in_observation,
            outputs=("subtree_com",),
            **kwargs,
        )
        self.forward_reward_weight = forward_reward_weight
        self.ctrl_cost_weight = ctrl_cost_weight
        self.contact_cost_weight = contact_cost_weight
        self.contact_cost_range = contact_cost_range
        self.healthy_reward = healthy_reward
        self.terminate_when_unhealthy = terminate_when_unhealthy
        self.healthy_z_range = healthy_z_range
        self._com_xy = self.batch.subtree_com[:, 0, :2]

    def before_step(self) -> None:
        """Stores the position of the centre of mass, to compute the step's mean velocity."""
        self._xy_before = self._com_xy.copy()

    def reward(self, action: Array) -> Array:
        """Rewards speed along x and an upright posture, less the costs of controls and contact forces."""
        self._healthy = between(self.batch.qpos[:, 2], self.healthy_z_range)
        self._velocity = (self._com_xy - self._xy_before) / self.dt
        self._forward = self.forward_reward_weight * self._velocity[:, 0]
        self._survive = self.healthy_reward * self._healthy
        self._ctrl = -self.ctrl_cost_weight * row_squares(action)
        self._contact = -np.clip(self.contact_cost_weight * row_squares(self._forces), *self.contact_cost_range)
        total: Array = self._forward + self._survive + (self._ctrl + self._contact)
        return total

    def terminated(self) -> Array:
        """Returns true for environments whose torso is too low or too high."""
        return ~self._healthy if self.terminate_when_unhealthy else super().terminated()

    def info(self) -> Mapping[str, Array]:
        """Returns the position, the velocity, and the terms of the reward."""
        return {
            **self.reset_info(),
            "x_velocity": self._velocity[:, 0],
            "y_velocity": self._velocity[:, 1],
            "reward_survive": self._survive,
            "reward_forward": self._forward,
            "reward_ctrl": self._ctrl,
            "reward_contact": self._contact,
        }

    def reset_info(self) -> Mapping[str, Array]:
        """Returns the position, and the lengths and velocities of the tendons."""
        xy = self.batch.qpos[:, :2]
        return {
            "x_position": xy[:, 0],
            "y_position": xy[:, 1],
            "distance_from_origin": row_norms(xy),
            **self.tendon_info(),
        }


class HumanoidEnv(SingleEnv):
    """A single Humanoid environment."""

    task = HumanoidVectorEnv
