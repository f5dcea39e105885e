"""The task of ``walk.py``, stepped by MuJoCo's Python package on all processor cores; ``walk.py --mujoco`` uses it.

Everything but the simulator is the same: observations, rewards, resets and the learner.
"""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from typing import Any, cast

import numpy as np
import plots
from numpy.typing import NDArray
from walk import Walk

import clench

try:
    import mujoco  # type: ignore[import-untyped]
except ImportError as error:
    raise SystemExit("--mujoco needs MuJoCo: pip install mujoco") from error

Array = NDArray[Any]


class MujocoBatch:
    """The part of the API of `clench.Batch` that the task uses, over one `mujoco.MjData` per environment."""

    outputs = ("geom_xpos",)

    def __init__(self, model: clench.Model, n: int) -> None:
        self.model = model
        self.simulated = mujoco.MjModel.from_xml_path(str(plots.MODELS / "quadruped.xml"))
        self.simulated.opt.timestep = float(model.timestep)
        self.datas = [mujoco.MjData(self.simulated) for _ in range(n)]
        self.qpos, self.qvel = np.tile(self.simulated.qpos0, (n, 1)), np.zeros((n, model.nv))
        self.ctrl, self.geom_xpos = np.zeros((n, model.nu)), np.zeros((n, model.ngeom, 3))
        self.running = np.ones(n, dtype=np.bool_)
        self.pool = ThreadPoolExecutor(os.cpu_count())

    def _each(self, mask: Array, function: Any, *arguments: int) -> None:
        """Call a function of MuJoCo for environments, which runs without Python's lock, and exchange the state."""

        def some(envs: Array) -> None:
            for env in envs.tolist():
                data = self.datas[env]
                data.qpos, data.qvel, data.ctrl = self.qpos[env], self.qvel[env], self.ctrl[env]
                function(self.simulated, data, *arguments)
                self.qpos[env], self.qvel[env], self.geom_xpos[env] = data.qpos, data.qvel, data.geom_xpos

        # Several times as many parts as threads, for the parts differ in how long they take.
        list(self.pool.map(some, np.array_split(np.flatnonzero(mask), 8 * (os.cpu_count() or 1))))

    def step(self, n: int) -> None:
        """Step all environments ``n`` times."""
        self._each(self.running, mujoco.mj_step, n)

    def forward(self, mask: Array | None = None) -> bool:
        """Compute what follows from the state; return false, for none fails."""
        self._each(self.running if mask is None else mask, mujoco.mj_forward)
        return False

    def reset(self, mask: Array, env_model: object = None) -> None:
        """Reset environments, which have one model."""
        for env in np.flatnonzero(mask).tolist():
            mujoco.mj_resetData(self.simulated, self.datas[env])
            self.qpos[env], self.qvel[env], self.ctrl[env] = self.simulated.qpos0, 0.0, 0.0


class MujocoWalk(Walk):
    """The same task in MuJoCo."""

    def __init__(self, num_envs: int, **kwargs: Any) -> None:
        super().__init__(num_envs, **kwargs)
        self.batch = cast(clench.Batch, MujocoBatch(self.batch.model, num_envs))
