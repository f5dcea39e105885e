"""Hopper: a planar runner on one leg."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from clench.gymnasium.single_env import SingleEnv
from clench.gymnasium.tasks.planar import UprightRunner
from clench.gymnasium.tasks.task import between


class HopperVectorEnv(UprightRunner):
    """Gymnasium's Hopper-v5 over one batch.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    xml_file, frame_skip, forward_reward_weight, ctrl_cost_weight, healthy_reward, terminate_when_unhealthy, \
healthy_state_range, healthy_z_range, healthy_angle_range, reset_noise_scale, exclude_current_positions_from_observation
        As in gymnasium.
    **kwargs
        Arguments of :class:`clench.gymnasium.BatchEnv`.
    """

    def __init__(
        self,
        num_envs: int = 1,
        *,
        xml_file: str = "hopper.xml",
        frame_skip: int = 4,
        forward_reward_weight: float = 1.0,
        ctrl_cost_weight: float = 1e-3,
        healthy_reward: float = 1.0,
        terminate_when_unhealthy: bool = True,
        healthy_state_range: tuple[float, float] = (-100.0, 100.0),
        healthy_z_range: tuple[float, float] = (0.7, float("inf")),
        healthy_angle_range: tuple[float, float] = (-0.2, 0.2),
        reset_noise_scale: float = 5e-3,
        exclude_current_positions_from_observation: bool = True,
        **kwargs: Any,
    ) -> None:
        super().__init__(
            num_envs,
            xml_file=xml_file,
            frame_skip=frame_skip,
            forward_reward_weight=forward_reward_weight,
            ctrl_cost_weight=ctrl_cost_weight,
            healthy_reward=healthy_reward,
            terminate_when_unhealthy=terminate_when_unhealthy,
            reset_noise_scale=reset_noise_scale,
            exclude_current_positions_from_observation=exclude_current_positions_from_observation,
            **kwargs,
        )
        self.healthy_state_range = healthy_state_range
        self.healthy_z_range = healthy_z_range
        self.healthy_angle_range = healthy_angle_range

    def healthy(self) -> NDArray[Any]:
        """Returns true if height, angle and all state variables except x and z are within their ranges."""
        qpos, qvel = self.batch.qpos, self.batch.qvel
        states = between(qpos[:, 2:], self.healthy_state_range).all(axis=1)
        states &= between(qvel, self.healthy_state_range).all(axis=1)
        healthy: NDArray[Any] = (
            states & between(qpos[:, 1], self.healthy_z_range) & between(qpos[:, 2], self.healthy_angle_range)
        )
        return healthy


class HopperEnv(SingleEnv):
    """A single Hopper environment."""

    task = HopperVectorEnv
