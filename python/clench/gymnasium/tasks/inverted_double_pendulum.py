"""InvertedDoublePendulum: a cart keeps two poles upright, one on the other."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clench.gymnasium.single_env import SingleEnv
from clench.gymnasium.tasks.task import Task

Array = NDArray[Any]


class InvertedDoublePendulumVectorEnv(Task):
    """Gymnasium's InvertedDoublePendulum-v5 over one batch.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    xml_file, frame_skip, healthy_reward, reset_noise_scale
        As in gymnasium.
    **kwargs
        Arguments of :class:`clench.gymnasium.BatchEnv`.
    """

    normal_velocity_noise = True

    def __init__(
        self,
        num_envs: int = 1,
        *,
        xml_file: str = "inverted_double_pendulum.xml",
        frame_skip: int = 5,
        healthy_reward: float = 10.0,
        reset_noise_scale: float = 0.1,
        **kwargs: Any,
    ) -> None:
        super().__init__(
            num_envs,
            xml_file=xml_file,
            frame_skip=frame_skip,
            reset_noise_scale=reset_noise_scale,
            outputs=("site_xpos", "qfrc_constraint"),
            **kwargs,
        )
        self.healthy_reward = healthy_reward
        self._tip = self.batch.site_xpos[:, 0]

    def observe(self) -> Array:
        """Returns the cart's position, sines and cosines of the poles' angles, velocities, and the constraint force on
        the cart."""
        cart, angles = self.batch.qpos[:, :1], self.batch.qpos[:, 1:]
        velocities = np.clip(self.batch.qvel, -10.0, 10.0)
        force = np.clip(self.batch.qfrc_constraint[:, :1], -10.0, 10.0)
        return np.concatenate([cart, np.sin(angles), np.cos(angles), velocities, force], axis=1)

    def terminated(self) -> Array:
        """Returns true for environments whose tip is not above 1 m."""
        low: Array = self._tip[:, 2] <= 1.0
        return low

    def reward(self, action: Array) -> Array:
        """Rewards an upright posture, less the costs of the tip's distance from its target and of the poles' speeds."""
        x, y = self._tip[:, 0], self._tip[:, 2]
        first, second = self.batch.qvel[:, 1], self.batch.qvel[:, 2]
        self._survive = self.healthy_reward * ~self.terminated()
        self._distance = -(0.01 * x**2 + (y - 2.0) ** 2)
        self._speed = -(1e-3 * first**2 + 5e-3 * second**2)
        total: Array = self._survive + self._distance + self._speed
        return total

    def info(self) -> Mapping[str, Array]:
        """Returns the terms of the reward."""
        return {"reward_survive": self._survive, "distance_penalty": self._distance, "velocity_penalty": self._speed}


class InvertedDoublePendulumEnv(SingleEnv):
    """A single InvertedDoublePendulum environment."""

    task = InvertedDoublePendulumVectorEnv
