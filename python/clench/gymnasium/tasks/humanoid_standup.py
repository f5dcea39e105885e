"""HumanoidStandup: gets up from the floor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clench.gymnasium.single_env import SingleEnv
from clench.gymnasium.tasks.person import Person
from clench.gymnasium.tasks.task import row_squares

Array = NDArray[Any]


class HumanoidStandupVectorEnv(Person):
    """Gymnasium's HumanoidStandup-v5 over one batch.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    xml_file, frame_skip, uph_cost_weight, ctrl_cost_weight, impact_cost_weight, impact_cost_range, reset_noise_scale, \
exclude_current_positions_from_observation, include_cinert_in_observation, include_cvel_in_observation, \
include_qfrc_actuator_in_observation, include_cfrc_ext_in_observation
        As in gymnasium, where ``uph_cost_weight`` has no effect.
    **kwargs
        Arguments of :class:`clench.gymnasium.BatchEnv`.
    """

    def __init__(
        self,
        num_envs: int = 1,
        *,
        xml_file: str = "humanoidstandup.xml",
        frame_skip: int = 5,
        uph_cost_weight: float = 1.0,
        ctrl_cost_weight: float = 0.1,
        impact_cost_weight: float = 5e-7,
        impact_cost_range: tuple[float, float] = (-np.inf, 10.0),
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
            **kwargs,
        )
        self.uph_cost_weight = uph_cost_weight
        self.ctrl_cost_weight = ctrl_cost_weight
        self.impact_cost_weight = impact_cost_weight
        self.impact_cost_range = impact_cost_range

    def reward(self, action: Array) -> Array:
        """Rewards height divided by the duration of a simulation step, less the costs of controls and impacts, plus
        one."""
        self._up = self.batch.qpos[:, 2] / self.timestep
        self._ctrl = -self.ctrl_cost_weight * row_squares(action)
        self._impact = -np.clip(self.impact_cost_weight * row_squares(self._forces), *self.impact_cost_range)
        total: Array = self._up + self._ctrl + self._impact + 1.0
        return total

    def info(self) -> Mapping[str, Array]:
        """Returns the position, and the terms of the reward."""
        return {
            **self.reset_info(),
            "reward_linup": self._up,
            "reward_quadctrl": self._ctrl,
            "reward_impact": self._impact,
        }

    def reset_info(self) -> Mapping[str, Array]:
        """Returns the position, and the lengths and velocities of the tendons."""
        qpos = self.batch.qpos
        return {
            "x_position": qpos[:, 0],
            "y_position": qpos[:, 1],
            "z_distance_from_origin": qpos[:, 2] - self.init_qpos[2],
            **self.tendon_info(),
        }


class HumanoidStandupEnv(SingleEnv):
    """A single HumanoidStandup environment."""

    task = HumanoidStandupVectorEnv
