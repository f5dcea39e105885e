"""InvertedPendulum: a cart keeps a pole upright."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clench.gymnasium.single_env import SingleEnv
from clench.gymnasium.tasks.task import Task

Array = NDArray[Any]


class InvertedPendulumVectorEnv(Task):
    """Gymnasium's InvertedPendulum-v5 over one batch.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    xml_file, frame_skip, reset_noise_scale
        As in gymnasium.
    **kwargs
        Arguments of :class:`clench.gymnasium.BatchEnv`.
    """

    def __init__(
        self,
        num_envs: int = 1,
        *,
        xml_file: str = "inverted_pendulum.xml",
        frame_skip: int = 2,
        reset_noise_scale: float = 0.01,
        **kwargs: Any,
    ) -> None:
        super().__init__(
            num_envs, xml_file=xml_file, frame_skip=frame_skip, reset_noise_scale=reset_noise_scale, **kwargs
        )

    def observe(self) -> Array:
        """Returns positions and velocities."""
        return np.concatenate([self.batch.qpos, self.batch.qvel], axis=1)

    def terminated(self) -> Array:
        """Returns true for environments whose pole leans by more than 0.2 rad."""
        leans: Array = np.abs(self.batch.qpos[:, 1]) > 0.2
        return leans

    def reward(self, action: Array) -> Array:
        """Returns 1 while the pole is upright."""
        self._upright = ~self.terminated()
        return self._upright

    def info(self) -> Mapping[str, Array]:
        """Returns the reward."""
        return {"reward_survive": self._upright.astype(int)}


class InvertedPendulumEnv(SingleEnv):
    """A single InvertedPendulum environment."""

    task = InvertedPendulumVectorEnv
