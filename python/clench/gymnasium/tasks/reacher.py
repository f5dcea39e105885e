"""Reacher: an arm of two links brings its fingertip to a target, in a plane."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clench.gymnasium.single_env import SingleEnv
from clench.gymnasium.tasks.task import Task, row_norms, row_squares

Array = NDArray[Any]


class ReacherVectorEnv(Task):
    """Gymnasium's Reacher-v5 over one batch.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    xml_file, frame_skip, reward_dist_weight, reward_control_weight
        As in gymnasium.
    **kwargs
        Arguments of :class:`clench.gymnasium.BatchEnv`.
    """

    def __init__(
        self,
        num_envs: int = 1,
        *,
        xml_file: str = "reacher.xml",
        frame_skip: int = 2,
        reward_dist_weight: float = 1.0,
        reward_control_weight: float = 1.0,
        **kwargs: Any,
    ) -> None:
        super().__init__(num_envs, xml_file=xml_file, frame_skip=frame_skip, outputs=("xpos",), **kwargs)
        self.reward_dist_weight = reward_dist_weight
        self.reward_control_weight = reward_control_weight
        self._fingertip, self._target = (
            self.batch.xpos[:, self.batch.model.body(name).id] for name in ("fingertip", "target")
        )

    def observe(self) -> Array:
        """Returns cosines and sines of the arm's angles, the target, the arm's velocities, and the vector from target
        to fingertip."""
        qpos, angles = self.batch.qpos, self.batch.qpos[:, :2]
        away = (self._fingertip - self._target)[:, :2]
        return np.concatenate([np.cos(angles), np.sin(angles), qpos[:, 2:], self.batch.qvel[:, :2], away], axis=1)

    def reward(self, action: Array) -> Array:
        """Returns minus the costs of the distance and of controls."""
        self._dist = -self.reward_dist_weight * row_norms(self._fingertip - self._target)
        self._ctrl = -self.reward_control_weight * row_squares(action)
        total: Array = self._dist + self._ctrl
        return total

    def info(self) -> Mapping[str, Array]:
        """Returns the terms of the reward."""
        return {"reward_dist": self._dist, "reward_ctrl": self._ctrl}

    def initial_state(self, rng: np.random.Generator) -> tuple[Array, Array]:
        """Returns a state with the arm nearly straight and at rest, and the target anywhere in a disc."""
        qpos = self.init_qpos + rng.uniform(-0.1, 0.1, self.init_qpos.size)
        goal = rng.uniform(-0.2, 0.2, 2)
        while np.linalg.norm(goal) >= 0.2:
            goal = rng.uniform(-0.2, 0.2, 2)
        qpos[-2:] = goal
        qvel = self.init_qvel + rng.uniform(-0.005, 0.005, self.init_qvel.size)
        qvel[-2:] = 0.0
        return qpos, qvel


class ReacherEnv(SingleEnv):
    """A single Reacher environment."""

    task = ReacherVectorEnv
