"""HalfCheetah: a planar runner on two legs that cannot fall."""

from __future__ import annotations

from typing import Any

from clench.gymnasium.single_env import SingleEnv
from clench.gymnasium.tasks.planar import PlanarRunner


class HalfCheetahVectorEnv(PlanarRunner):
    """Gymnasium's HalfCheetah-v5 over one batch.

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

    normal_velocity_noise = True

    def __init__(
        self,
        num_envs: int = 1,
        *,
        xml_file: str = "half_cheetah.xml",
        frame_skip: int = 5,
        forward_reward_weight: float = 1.0,
        ctrl_cost_weight: float = 0.1,
        reset_noise_scale: float = 0.1,
        exclude_current_positions_from_observation: bool = True,
        **kwargs: Any,
    ) -> None:
        super().__init__(
            num_envs,
            xml_file=xml_file,
            frame_skip=frame_skip,
            forward_reward_weight=forward_reward_weight,
            ctrl_cost_weight=ctrl_cost_weight,
            reset_noise_scale=reset_noise_scale,
            exclude_current_positions_from_observation=exclude_current_positions_from_observation,
            **kwargs,
        )


class HalfCheetahEnv(SingleEnv):
    """A single HalfCheetah environment."""

    task = HalfCheetahVectorEnv
