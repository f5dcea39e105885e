"""The task: an arm of six joints pushes a box over a table onto a mark."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from clench.gymnasium import BatchEnv, SingleEnv
from numpy.typing import NDArray

Array = NDArray[Any]

JOINTS = 6
OBJECTS = 5  # Numbers of `environment_state`.
# The parts of an observation by type, under LeRobot's names.
OBS_TYPES = {
    "pixels_agent_pos": ("pixels", "agent_pos"),
    "pixels": ("pixels",),
    "environment_state_agent_pos": ("environment_state", "agent_pos"),
}
_NEAR = 0.03  # m, the distance of box and mark at which the task is done.
_TOUCH = 0.06  # m, the distance of fingertip and box within which approaching earns nothing more.


def check_obs_type(obs_type: str) -> tuple[str, ...]:
    """Returns the parts of an observation.

    Raises
    ------
    ValueError
        If no type has the name.
    """
    if obs_type not in OBS_TYPES:
        raise ValueError(f"obs_type must be one of {', '.join(OBS_TYPES)}, not {obs_type!r}")
    return OBS_TYPES[obs_type]


class PushBoxVectorEnv(BatchEnv):
    """Many arms in one batch; LeRobot uses single ones, `PushBoxEnv`.

    An action is the target of each joint's servo, rad. The reward is the negative distance, m, of box and mark,
    and a fifth of that of the fingertip from the box, and one when the box is on the mark. Then the episode ends, and
    ``is_success`` of ``info`` is True.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    obs_type : {"pixels_agent_pos", "pixels", "environment_state_agent_pos"}
        Parts of the observation: ``pixels`` (height, width, 3), uint8; ``agent_pos`` (6,), the joints' positions, rad;
        ``environment_state`` (5,), positions of box and mark on the table, m, and the box's turn about the vertical,
        rad.
    observation_size : tuple of int
        Width and height of ``pixels``.
    **kwargs
        Other arguments of `clench.gymnasium.BatchEnv`.
    """

    model = Path(__file__).with_name("push_box.xml")
    frame_skip = 20
    max_episode_steps = 200
    outputs = ("site_xpos",)
    render_camera = "front"

    def __init__(
        self,
        num_envs: int = 1,
        *,
        obs_type: str = "pixels_agent_pos",
        observation_size: tuple[int, int] = (128, 128),
        **kwargs: Any,
    ) -> None:
        self._parts = check_obs_type(obs_type)
        if len(observation_size) != 2 or min(observation_size) < 1:
            raise ValueError(f"observation_size must be a width and a height in pixels, not {observation_size!r}")
        self.observation_size = observation_size
        super().__init__(num_envs, **kwargs)

    @property
    def _box(self) -> Array:
        return self.batch.qpos[:, JOINTS : JOINTS + 2]

    @property
    def _mark(self) -> Array:
        return self.batch.mocap_pos[:, 0, :2]

    def observe(self) -> dict[str, Array]:
        made = {"pixels": self._pixels, "agent_pos": self._agent_pos, "environment_state": self._objects}
        return {part: made[part]() for part in self._parts}

    def _pixels(self) -> Array:
        width, height = self.observation_size
        return np.stack([self.batch.render(env, width, height, camera="front") for env in range(self.num_envs)])

    def _agent_pos(self) -> Array:
        return self.batch.qpos[:, :JOINTS].astype(np.float32)

    def _objects(self) -> Array:
        w, x, y, z = self.batch.qpos[:, JOINTS + 3 : JOINTS + 7].T
        turn = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
        return np.column_stack([self._box, self._mark, turn]).astype(np.float32)

    def _distance(self) -> Array:
        distance: Array = np.linalg.norm(self._box - self._mark, axis=1)
        return distance

    def reward(self, action: Array) -> Array:
        gap = np.linalg.norm(self.batch.site_xpos[:, 0, :2] - self._box, axis=1)
        reward: Array = self.terminated() - self._distance() - 0.2 * np.maximum(gap - _TOUCH, 0)
        return reward

    def terminated(self) -> Array:
        return self._distance() < _NEAR

    def info(self) -> Mapping[str, Array]:
        return {"is_success": self.terminated()}

    def reset_info(self) -> Mapping[str, Array]:
        return self.info()

    def initial_state(self, rng: np.random.Generator) -> tuple[Array, Array]:
        qpos = self.init_qpos.copy()
        qpos[JOINTS : JOINTS + 2] = rng.uniform([0.48, -0.05], [0.52, 0.05])
        return qpos, self.init_qvel

    def on_reset(self, mask: Array) -> None:
        for env in np.flatnonzero(mask).tolist():
            distance, angle = self.generator(env).uniform([0.06, -0.5], [0.12, 0.5])
            self._mark[env] = self._box[env] + distance * np.array([np.cos(angle), np.sin(angle)])


class PushBoxEnv(SingleEnv):
    """One arm, as ``gymnasium.make`` and LeRobot make it.

    Parameters
    ----------
    **kwargs
        Arguments of `PushBoxVectorEnv`.
    """

    task = PushBoxVectorEnv
    task_description = "Push the box onto the red mark."

    def __init__(self, **kwargs: Any) -> None:
        # The limit is that of `gymnasium.make`, which the caller sets.
        super().__init__(max_episode_steps=-1, **kwargs)
