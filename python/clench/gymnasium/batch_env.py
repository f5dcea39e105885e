"""The base class of tasks: a vector environment over one batch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from gymnasium.error import ClosedEnvironmentError, ResetNeeded
from gymnasium.spaces import Space
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import ArrayLike, NDArray

from clench import Batch, FreeCamera, RigidOptions, SimulationError, State
from clench.gymnasium import infos as vector_infos
from clench.gymnasium import observations
from clench.gymnasium.checks import check_action_space, checked_action, checked_mask, checked_seeds, one_each, one_or_all, rows
from clench.gymnasium.drawn import Drawn
from clench.gymnasium.models import Source, action_space, loaded
from clench.gymnasium.task_methods import TaskMethods
from clench.gymnasium.views import attached, detached

Array = NDArray[Any]


class BatchEnv(TaskMethods, Drawn, VectorEnv[Any, Array, Array]):  # type: ignore[misc]  # One random generator per environment.
    """Many environments of one model or of several, stepped together.

    A task derives from this class, names a model, and defines over all environments at once the observation
    (:meth:`observe`), the reward (:meth:`reward`) and the end of an episode (:meth:`terminated`, :meth:`truncated`),
    from the arrays of :attr:`batch`. The results of these methods are copied: they may be views.

    Each parameter can also be an attribute of the derived class; an argument takes precedence.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    model : clench.Model or str or os.PathLike, or a sequence of these
        The model, the path of its file, or the text of an MJCF file. Several models are those of :class:`clench.Batch`;
        environment ``i`` starts with model ``i % len(model)``, and :meth:`choose_models` can give it another.
    frame_skip : int
        Number of simulation steps per environment step.
    max_episode_steps : int, optional
        Number of steps after which an episode is truncated; None or -1 for no limit.
    outputs : sequence of str
        Derived quantities that the task reads from :attr:`batch`, such as ``"xpos"``; see ``clench.OUTPUTS``.
    precision : {"64", "32"}, optional
        Bits of the simulator's numbers; by default "64" on the CPU and "32" on a GPU.
    device : str
        The device that steps: "cpu", "gpu", or "gpu:" and a part of a name that ``clench.devices()`` lists. The device
        must be able to compute all of :attr:`outputs`.
    threads : int, optional
        Number of threads of the simulation; by default that of the machine.
    options : clench.RigidOptions or dict, optional
        Options that take precedence over those of the model's file, or their names and values, as in
        ``{"contact_model": "coulomb", "stiction": True}``.
    autoreset_mode : gymnasium.vector.AutoresetMode or str
        The time of resets after the end of an episode: with the next step, in the same step, or only by :meth:`reset`.
    render_mode : {None, "rgb_array"}
        The result of :meth:`render`: pictures, drawn without a window.
    render_size : tuple of int
        Width and height of pictures, pixels.
    render_camera : str or int or clench.FreeCamera, optional
        The camera of the pictures; by default the model's camera ``track``, as in Gymnasium, or, if it has none, a view
        of everything that moves.

    Attributes
    ----------
    batch : clench.Batch
        The environments. States are live, ``batch.qpos`` is (n, nq); outputs are those of the last forward pass, that
        is of the start of the last simulation step (with RK4 its last stage), or of the reset.
    render_appearance : dict of str to ndarray or None
        Colours and lights of the pictures of each environment, see ``Model.appearance``; None for those of the model.
    fresh : ndarray
        Booleans (n,): True for environments that have not been stepped since their reset.
    elapsed : ndarray
        Integers (n,): the number of steps since each environment's reset; in `reward` and later methods the current
        step is included.
    timestep, dt : float
        Duration of a simulation step, and of an environment step, s.
    init_qpos, init_qvel : ndarray
        The initial state of the model, (nq,) and (nv,); of several models, that of the first.
    failure_reward : float
        The reward of a step in which the simulation of an environment fails.

    Notes
    -----
    An environment whose simulation fails, for example by an overflow or an extreme control, ends its episode: it is
    ``terminated``, its observation is that of the last good state, and ``info`` has ``failed`` (True) and ``fault``
    (the reason).

    Every environment has its own random generator, seeded as in ``gymnasium.vector.SyncVectorEnv``. Environments are
    therefore independent of each other.
    """

    model: Source | Sequence[Source]
    frame_skip: int = 1
    max_episode_steps: int | None = None
    outputs: Sequence[str] = ()
    precision: Literal["64", "32"] | None = None
    device: str = "cpu"
    threads: int | None = None
    options: RigidOptions | Mapping[str, Any] | None = None
    autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP
    failure_reward: float = 0.0

    def __init__(
        self,
        num_envs: int = 1,
        *,
        model: Source | Sequence[Source] | None = None,
        frame_skip: int | None = None,
        max_episode_steps: int | None = None,
        outputs: Sequence[str] | None = None,
        precision: Literal["64", "32"] | None = None,
        device: str | None = None,
        threads: int | None = None,
        options: RigidOptions | Mapping[str, Any] | None = None,
        autoreset_mode: AutoresetMode | str | None = None,
        render_mode: str | None = None,
        render_size: tuple[int, int] | None = None,
        render_camera: str | int | FreeCamera | None = None,
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f'{self._name}: render_mode must be "rgb_array" or None, not {render_mode!r}')
        given = {
            "model": model,
            "frame_skip": frame_skip,
            "max_episode_steps": max_episode_steps,
            "outputs": outputs,
            "precision": precision,
            "device": device,
            "threads": threads,
            "options": options,
            "autoreset_mode": autoreset_mode,
            "render_size": render_size,
            "render_camera": render_camera,
        }
        for name, value in given.items():
            if value is not None:
                setattr(self, name, value)
        if not hasattr(self, "model"):
            raise TypeError(f"{type(self).__name__} needs a model: an argument or an attribute of the class")
        if num_envs < 1:
            raise ValueError(f"num_envs must be at least 1, not {num_envs}")
        if self.frame_skip < 1:
            raise ValueError(f"frame_skip must be at least 1, not {self.frame_skip}")
        if self.max_episode_steps is not None and self.max_episode_steps < 1 and self.max_episode_steps != -1:
            raise ValueError(f"max_episode_steps must be at least 1, or -1 for no limit, not {self.max_episode_steps}")
        self.autoreset_mode = self._mode = AutoresetMode(self.autoreset_mode)
        self.render_mode = render_mode

        self.num_envs = num_envs
        rigid = self.options
        self.batch = Batch(
            loaded(self.model),
            num_envs,
            self.precision,
            self.threads,
            options=RigidOptions(**rigid) if isinstance(rigid, Mapping) else rigid,
            record=self.outputs,
            device=self.device,
        )
        self.timestep = float(self.batch.model.timestep)
        self.dt = self.timestep * self.frame_skip
        self.metadata = {**self.metadata, "render_fps": round(1 / self.dt), "autoreset_mode": self._mode}
        self.init_qpos = self.batch.qpos[0].copy()
        self.init_qvel = self.batch.qvel[0].copy()
        if getattr(self, "single_action_space", None) is None:
            self.single_action_space = action_space(self.batch.model)
        check_action_space(self.single_action_space, self._name)
        self.action_space = batch_space(self.single_action_space, num_envs)

        self.fresh = np.zeros(num_envs, dtype=np.bool_)
        self.started = False
        self._all = np.ones(num_envs, dtype=np.bool_)
        self._done = np.zeros(num_envs, dtype=np.bool_)
        self.elapsed = np.zeros(num_envs, dtype=np.int64)
        self._generators: list[np.random.Generator | None] = [None] * num_envs
        self._seeds: list[int | None] = [None] * num_envs

    if not TYPE_CHECKING:  # Type checkers would accept any name.

        def __getattr__(self, name: str) -> Any:
            """Raises the error of an attribute that does not exist, such as the batch of a closed environment."""
            if name == "batch" and self.closed:
                raise ClosedEnvironmentError(f"{self._name} is closed")
            return object.__getattribute__(self, name)

    def __getstate__(self) -> dict[str, Any]:
        """Returns the attributes of a copy or pickle, without views of the batch's memory."""
        state = dict(self.__dict__)
        return detached(state, self.batch) if "batch" in state else state

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Sets the attributes of a copy, with views of its own batch's memory."""
        self.__dict__.update(attached(state, state["batch"]) if "batch" in state else state)

    # The API of gymnasium.

    @property
    def single_observation_space(self) -> Space[Any]:
        """The space of one observation: it has the shape and dtype of the result of :meth:`observe`, without bounds
        except for bytes; a ``Dict`` if that is a mapping."""
        if self._single_observation_space is None:
            if not self.started and self.batch.outputs:
                self.batch.forward()
            self._single_observation_space = observations.space(self.observation())
        return self._single_observation_space

    @single_observation_space.setter
    def single_observation_space(self, space: Space[Any]) -> None:
        self._single_observation_space = space

    @property
    def observation_space(self) -> Space[Any]:
        """The space of the observations of all environments."""
        if self._observation_space is None:
            self._observation_space = batch_space(self.single_observation_space, self.num_envs)
        return self._observation_space

    @observation_space.setter
    def observation_space(self, space: Space[Any]) -> None:
        self._observation_space = space

    # Computed on demand, since a task may set attributes that observe() needs after this class is initialised.
    _single_observation_space: Space[Any] | None = None
    _observation_space: Space[Any] | None = None

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Starts episodes.

        Parameters
        ----------
        seed : int or sequence of int, optional
            Environment ``i`` is seeded with ``seed + i`` or ``seed[i]``. Without a seed, generators continue; those
            that were never seeded are seeded by the system.
        options : dict, optional
            ``reset_mask``: booleans (n,), True for the environments to reset; by default all.

        Returns
        -------
        observations : ndarray or dict of str to ndarray
            The observations of all environments, (n, ...).
        infos : dict
            The infos of the environments that were reset.

        Raises
        ------
        clench.SimulationError
            If an initial state cannot be simulated.
        """
        mask = checked_mask(options, self.num_envs)
        if not self.started and not mask.all():
            raise ResetNeeded(f"{self._name}: the first reset must be of all environments")
        seeds = checked_seeds(seed, self.num_envs)
        for env in np.flatnonzero(mask).tolist():
            seed = seeds[env]
            if seed is not None:
                self._seed(env, seed)
        infos: dict[str, Any] = {}
        vector_infos.add(infos, self._restart(mask), mask)
        self.started = True
        return self.observation(), infos

    def step(self, actions: ArrayLike) -> tuple[Any, Array, Array, Array, dict[str, Any]]:
        """Steps every environment.

        Parameters
        ----------
        actions : array_like
            Actions (n, ...), by default controls (n, nu); a task can change that (:meth:`control`). Controls are
            clamped only as the model specifies.

        Returns
        -------
        observations : ndarray or dict of str to ndarray
            (n, ...)
        rewards : ndarray
            (n,) float64.
        terminations, truncations : ndarray
            (n,) bool.
        infos : dict
            As in every vector environment of gymnasium, with ``failed`` and ``fault`` if a simulation failed.

        Raises
        ------
        ValueError
            If the actions have another shape or dtype, are not finite, or are not in the space.
        gymnasium.error.ResetNeeded
            Before the first reset; without autoreset, also if the episode of an environment has ended.
        """
        self._check_ready()
        action = checked_action(actions, self.action_space, self._name)
        over = self._done
        if self._mode is AutoresetMode.DISABLED and over.any():
            first = int(np.flatnonzero(over)[0])
            raise ResetNeeded(f"{self._name}: the episode of environment {first} is over, and autoreset is disabled")

        rewards, terminations, truncations, about = self.advance(action)
        infos: dict[str, Any] = {}
        if self._mode is AutoresetMode.NEXT_STEP and over.any():
            rewards[over], terminations[over], truncations[over] = 0.0, False, False
            for values, mask in about:
                vector_infos.add(infos, values, mask & ~over)
            vector_infos.add(infos, self._restart(over), over)
            self._done = terminations | truncations
            return self.observation(), rewards, terminations, truncations, infos

        done = terminations | truncations
        if self._mode is AutoresetMode.SAME_STEP and done.any():
            vector_infos.add_final(infos, self.observation(), about, done)
            for values, mask in about:
                vector_infos.add(infos, values, mask & ~done)
            vector_infos.add(infos, self._restart(done), done)
        else:
            for values, mask in about:
                vector_infos.add(infos, values, mask)
            self._done = done
        return self.observation(), rewards, terminations, truncations, infos

    def close_extras(self, **kwargs: Any) -> None:
        """Releases the batch, its threads and its memory. If the constructor failed, there is no batch."""
        self.__dict__.pop("batch", None)

    # Implementation.

    @property
    def _name(self) -> str:
        return type(self).__name__ if self.spec is None else self.spec.id

    def _check_ready(self) -> None:
        if not self.started:
            raise ResetNeeded(f"{self._name}: call reset() before step()")

    def _restart(self, mask: Array) -> Mapping[str, Array]:
        """Starts an episode of the environments in ``mask``; returns the reset's infos over all environments."""
        batch, qpos, qvel = self.batch, self.batch.qpos, self.batch.qvel
        envs = np.flatnonzero(mask)
        batch.reset(mask, env_model=self.choose_models(envs))
        start = self.initial_states(envs)
        if isinstance(start, State):
            batch.set_state(start, envs)
            start = qpos[envs], qvel[envs]
        for name, rows_of, values in zip(("qpos", "qvel"), (qpos, qvel), start, strict=True):
            shape = (len(envs), rows_of.shape[1])
            rows_of[envs] = one_or_all(values, shape, self, f"{name} of initial_states()")
        self.elapsed[mask] = 0
        self.on_reset(mask)
        if batch.outputs and batch.forward(mask):
            env = int(np.flatnonzero(mask & ~batch.running)[0])
            raise SimulationError(f"{self._name}: environment {env} cannot start: {batch.fault(env)}")
        for name, values in (("qpos", qpos[envs]), ("qvel", qvel[envs])):
            if not np.isfinite(values).all():
                env = int(envs[np.argwhere(~np.isfinite(values))[0, 0]])
                raise SimulationError(f"{self._name}: environment {env} cannot start: its {name} is not finite")
        self.fresh |= mask
        self._done = self._done & ~mask
        return self._checked_info(self.reset_info())

    def advance(self, action: Array) -> tuple[Array, Array, Array, list[vector_infos.Group]]:
        """Steps every environment, without resets: returns rewards, terminations, truncations, and infos."""
        batch, n = self.batch, self.num_envs
        batch.ctrl[...] = self.control(action)
        self.before_step()
        batch.step(self.frame_skip)
        self.elapsed += 1
        self.fresh[:] = False

        rewards = one_each(self.reward(action), n, np.float64, self, "reward()")
        terminations = one_each(self.terminated(), n, np.bool_, self, "terminated()")
        limit = self.max_episode_steps
        truncations = one_each(self.truncated(), n, np.bool_, self, "truncated()")
        if limit is not None and limit != -1:
            truncations |= self.elapsed >= limit
        about: list[vector_infos.Group] = [(self._checked_info(self.info()), self._all)]

        running = batch.running
        if not running.all():
            failed = ~running
            rewards[failed], terminations[failed] = self.failure_reward, True
            faults = np.full(n, None, dtype=np.object_)
            for env in np.flatnonzero(failed).tolist():
                faults[env] = batch.fault(env)
            about.append(({"failed": failed, "fault": faults}, failed))
        return rewards, terminations, truncations, about

    def observation(self) -> Any:
        """Returns the observation, in separate arrays."""
        return observations.checked(self.observe(), self.num_envs, self, "observe()")

    def _checked_info(self, info: Mapping[str, Array]) -> Mapping[str, Array]:
        return {key: rows(value, self.num_envs, self, f"info `{key}`") for key, value in info.items()}
