"""Pusher: an arm pushes a cylinder to a goal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clench.gymnasium.single_env import SingleEnv
from clench.gymnasium.tasks.task import Task, row_norms, row_squares

Array = NDArray[Any]


class PusherVectorEnv(Task):
    """Gymnasium's Pusher-v5 over one batch.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    xml_file, frame_skip, reward_near_weight, reward_dist_weight, reward_control_weight
        As in gymnasium.
    **kwargs
        Arguments of :class:`clench.gymnasium.BatchEnv`.
    """

    def __init__(
        self,
        num_envs: int = 1,
        *,
        xml_file: str = "pusher_v5.xml",
        frame_skip: int = 5,
        reward_near_weight: float = 0.5,
        reward_dist_weight: float = 1.0,
        reward_control_weight: float = 0.1,
        **kwargs: Any,
    ) -> None:
        super().__init__(num_envs, xml_file=xml_file, frame_skip=frame_skip, outputs=("xpos",), **kwargs)
        self.reward_near_weight = reward_near_weight
        self.reward_dist_weight = reward_dist_weight
        self.reward_control_weight = reward_control_weight
        self._tip, self._object, self._goal = (
            self.batch.xpos[:, self.batch.model.body(name).id] for name in ("tips_arm", "object", "goal")
        )

    def observe(self) -> Array:
        """Returns angles and velocities of the arm, and the positions of its tip, the cylinder and the goal."""
        arm = [self.batch.qpos[:, :7], self.batch.qvel[:, :7]]
        return np.concatenate([*arm, self._tip, self._object, self._goal], axis=1)

    def reward(self, action: Array) -> Array:
        """Returns minus the costs of the distances from cylinder to tip and to goal, and of controls."""
        self._near = -self.reward_near_weight * row_norms(self._object - self._tip)
        self._dist = -self.reward_dist_weight * row_norms(self._object - self._goal)
        self._ctrl = -self.reward_control_weight * row_squares(action)
        total: Array = self._dist + self._ctrl + self._near
        return total

    def info(self) -> Mapping[str, Array]:
        """Returns the terms of the reward."""
        return {"reward_dist": self._dist, "reward_ctrl": self._ctrl, "reward_near": self._near}

    def initial_state(self, rng: np.random.Generator) -> tuple[Array, Array]:
        """Returns a state with the arm nearly at rest and the cylinder at a distance from the goal."""

        def place() -> Array:
            return np.array([rng.uniform(-0.3, 0.0), rng.uniform(-0.2, 0.2)])

        cylinder = place()
        while np.linalg.norm(cylinder) <= 0.17:
            cylinder = place()
        qpos = self.init_qpos.copy()
        qpos[-4:-2], qpos[-2:] = cylinder, 0.0
        qvel = self.init_qvel + rng.uniform(-0.005, 0.005, self.init_qvel.size)
        qvel[-4:] = 0.0
        return qpos, qvel


class PusherEnv(SingleEnv):
    """A single Pusher environment."""

    task = PusherVectorEnv
