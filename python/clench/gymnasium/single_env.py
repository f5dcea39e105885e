"""Single environments of a task, as ``gymnasium.make`` returns them."""

from __future__ import annotations

from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.vector import AutoresetMode
from numpy.typing import ArrayLike, NDArray

from clench import Model, Sim, SimulationError
from clench.gymnasium.batch_env import BatchEnv
from clench.gymnasium.checks import check_options, checked_action
from clench.gymnasium.observations import of_one

Array = NDArray[Any]


class SingleEnv(gymnasium.Env[Any, Array]):
    """A single environment, implemented by a vector environment of one.

    A derived class only has to define the :attr:`task`.

    Parameters
    ----------
    **kwargs
        The arguments of the task. ``threads`` is 1 by default.

    Attributes
    ----------
    task : type of BatchEnv
        The task.
    vector : BatchEnv
        The underlying vector environment, with ``num_envs`` 1.
    dt : float
        Duration of a step, s.
    """

    task: ClassVar[type[BatchEnv]]
    metadata: dict[str, Any] = {"render_modes": ["rgb_array"]}

    def __init__(self, **kwargs: Any) -> None:
        kwargs.setdefault("threads", 1)
        self.vector = self.task(1, autoreset_mode=AutoresetMode.DISABLED, **kwargs)
        self.action_space = self.vector.single_action_space
        self.observation_space = self.vector.single_observation_space
        self.dt = self.vector.dt
        self.render_mode = self.vector.render_mode
        self.metadata = {**self.metadata, "render_fps": self.vector.metadata["render_fps"]}

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Starts an episode.

        Parameters
        ----------
        seed : int, optional
            The seed of the random generator; without one, the generator continues.
        options : dict, optional
            No option is supported.

        Returns
        -------
        observation : ndarray or dict of str to ndarray
        info : dict
        """
        check_options(options, ())
        super().reset(seed=seed)
        self.vector.np_random = (self.np_random,)
        observation, infos = self.vector.reset()
        return of_one(observation, 0), {key: value[0] for key, value in infos.items() if f"_{key}" in infos}

    def step(self, action: ArrayLike) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Steps the environment.

        Parameters
        ----------
        action : array_like
            An action, by default controls (nu,); a task can change that. Controls are clamped only as the model
            specifies.

        Returns
        -------
        observation : ndarray or dict of str to ndarray
        reward : float
        terminated, truncated : bool
        info : dict
            With ``failed`` and ``fault`` if the simulation failed.

        Raises
        ------
        ValueError
            If the action has another shape or dtype, is not finite, or is not in the space.
        gymnasium.error.ResetNeeded
            Before the first reset.
        """
        if not self.vector.started:
            raise ResetNeeded(f"{self}: call reset() before step()")
        row = checked_action(action, self.action_space, str(self))
        rewards, terminations, truncations, about = self.vector.advance(row[np.newaxis])
        info = {key: value.copy()[0] for values, mask in about if mask[0] for key, value in values.items()}
        return of_one(self.vector.observation(), 0), float(rewards[0]), bool(terminations[0]), bool(truncations[0]), info

    @property
    def model(self) -> Model:
        """The model."""
        return self.vector.batch.model

    @property
    def sim(self) -> Sim:
        """A separate simulation in the current state, which can be queried and stepped without changing the
        environment."""
        return self.vector.batch.sim(0)

    def set_state(self, qpos: ArrayLike, qvel: ArrayLike) -> None:
        """Sets positions and velocities, like gymnasium's ``MujocoEnv.set_state``; the episode continues from there.

        Parameters
        ----------
        qpos : array_like
            Positions (nq,).
        qvel : array_like
            Velocities (nv,).

        Raises
        ------
        ValueError
            If a shape is wrong.
        clench.SimulationError
            If the state cannot be simulated.
        """
        batch = self.vector.batch
        given = np.asarray(qpos), np.asarray(qvel)
        for name, row, values in zip(("qpos", "qvel"), (batch.qpos[0], batch.qvel[0]), given, strict=True):
            if values.shape != row.shape:
                raise ValueError(f"{self}: {name} is an array of shape {values.shape}, expected {row.shape}")
        batch.qpos[0], batch.qvel[0] = given
        batch.revive()
        if batch.outputs and batch.forward():
            raise SimulationError(f"{self}: cannot continue from this state: {batch.fault(0)}")

    def render(self) -> Array | None:
        """Renders the environment.

        Returns
        -------
        ndarray or None
            Its picture (height, width, 3), uint8; None if ``render_mode`` is None.
        """
        pictures = self.vector.render()
        return None if pictures is None else pictures[0]

    def close(self) -> None:
        """Releases the batch."""
        self.vector.close()
