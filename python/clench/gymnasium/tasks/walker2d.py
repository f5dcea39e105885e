"""Walker2d: a planar runner on two legs."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from clench.gymnasium.single_env import SingleEnv
from clench.gymnasium.tasks.planar import UprightRunner
from clench.gymnasium.tasks.task import between


class Walker2dVectorEnv(UprightRunner):
    """Gymnasium's Walker2d-v5 over one batch.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    xml_file, frame_skip, forward_reward_weight, ctrl_cost_weight, healthy_reward, terminate_when_unhealthy, \
healthy_z_range, healthy_angle_range, reset_noise_scale, exclude_current_positions_from_observation
        As in gymnasium.
    **kwargs
        Arguments of :class:`clench.gymnasium.BatchEnv`.
    """

    def __init__(
        self,
        num_envs: int = 1,
        *,
        xml_file: str = "walker2d_v5.xml",
        frame_skip: int = 4,
        forward_reward_weight: float = 1.0,
        ctrl_cost_weight: float = 1e-3,
        healthy_reward: float = 1.0,
        terminate_when_unhealthy: bool = True,
        healthy_z_range: tuple[float, float] = (0.8, 2.0),
        healthy_angle_range: tuple[float, float] = (-1.0, 1.0),
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
        self.healthy_z_range = healthy_z_range
        self.healthy_angle_range = healthy_angle_range

    def healthy(self) -> NDArray[Any]:
        """Returns true if height and angle are within their ranges."""
        qpos = self.batch.qpos
        healthy: NDArray[Any] = between(qpos[:, 1], self.healthy_z_range)
        return healthy & between(qpos[:, 2], self.healthy_angle_range)


class Walker2dEnv(SingleEnv):
    """A single Walker2d environment."""

    task = Walker2dVectorEnv
