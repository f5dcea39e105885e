"""The methods that a task defines, each over all environments at once."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from clench import Batch, State
from clench.gymnasium.generators import Generators
from clench.gymnasium.observations import Observation

Array = NDArray[Any]


class TaskMethods(Generators):
    """The methods that a task defines, with their defaults."""

    batch: Batch
    init_qpos: Array
    init_qvel: Array

    def observe(self) -> Observation:
        """Returns the observation, a function of only the arrays of :attr:`batch`: an array (n, ...), or arrays (n,
        ...) by name.

        Values that are neither single precision nor bytes (uint8, as in pictures) are converted to float64.
        """
        raise NotImplementedError(f"{type(self).__name__} must define observe()")

    def reward(self, action: Array) -> Array:
        """Returns the rewards of the step, (n,).

        It is called once per step, after the simulation and before :meth:`terminated` and :meth:`info`: they may use
        its intermediate results.

        Parameters
        ----------
        action : ndarray
            The actions (n, ...), as passed to :meth:`control`. Read-only.
        """
        raise NotImplementedError(f"{type(self).__name__} must define reward(action)")

    def control(self, action: Array) -> Array:
        """Converts actions to controls (n, nu). By default they are the same.

        A task with other actions also has the attribute ``single_action_space``, of the class or set before the
        constructor of this class: a ``Box`` of any shape, a ``Discrete``, ``MultiDiscrete`` or ``MultiBinary``.

        Parameters
        ----------
        action : ndarray
            The actions (n, ...): float64 for a ``Box``, else int64. Read-only.
        """
        return action

    def terminated(self) -> Array:
        """Returns booleans (n,): True if the episode has terminated. By default none has."""
        return np.zeros(self.num_envs, dtype=np.bool_)

    def truncated(self) -> Array:
        """Returns booleans (n,): True if the episode is truncated, in addition to those that reach
        ``max_episode_steps``. By default none is.

        It is called after :meth:`terminated`.
        """
        return np.zeros(self.num_envs, dtype=np.bool_)

    def info(self) -> Mapping[str, Array]:
        """Returns more data about the step: arrays (n, ...) by name. By default there are none."""
        return {}

    def reset_info(self) -> Mapping[str, Array]:
        """Returns more data about the states after a reset."""
        return {}

    def before_step(self) -> None:
        """Called with the controls set, before the simulator steps. Override it to store values that the step will
        change."""

    def choose_models(self, envs: NDArray[np.intp]) -> ArrayLike | None:
        """Returns the model of each environment that is reset, for its next episode. By default it keeps its model.

        Parameters
        ----------
        envs : ndarray
            Integers (k,): the environments. Random numbers of environment ``i`` come from ``generator(i)``.

        Returns
        -------
        array_like of int or None
            Indices (k,) of ``batch.models``, or None to keep all. Parameters of an environment that gets another model
            become those of the model.
        """
        return None

    def initial_state(self, rng: np.random.Generator) -> tuple[Array, Array] | State:
        """Returns the initial state of an episode of one environment. By default it is the initial state of the model.

        It is not called if :meth:`initial_states` is defined.

        Parameters
        ----------
        rng : numpy.random.Generator
            The generator of the environment that is reset.

        Returns
        -------
        qpos, qvel : ndarray
            Positions (nq,) and velocities (nv,); or a complete `State`, such as ``sim.state``.
        """
        return self.init_qpos, self.init_qvel

    def initial_states(self, envs: NDArray[np.intp]) -> tuple[Array, Array] | State:
        """Returns the initial states of all environments that are reset at once. By default it calls
        :meth:`initial_state` for each.

        Parameters
        ----------
        envs : ndarray
            Integers (k,): the environments. Random numbers of environment ``i`` come from ``generator(i)``.

        Returns
        -------
        qpos, qvel : ndarray
            Positions (k, nq) and velocities (k, nv); or (nq,) and (nv,), if all start from the same; or a `State`, of
            one or of k environments.
        """
        if len(self.batch.models) > 1 and type(self).initial_state is TaskMethods.initial_state:
            # The batch was reset: each environment is in the initial state of its own model.
            return self.batch.qpos[envs], self.batch.qvel[envs]
        starts = [self.initial_state(self.generator(env)) for env in envs.tolist()]
        states = [start for start in starts if isinstance(start, State)]
        if states:
            return State.stack(states)
        pairs = [start for start in starts if not isinstance(start, State)]
        return np.array([qpos for qpos, _ in pairs]), np.array([qvel for _, qvel in pairs])

    def on_reset(self, mask: Array) -> None:
        """Called when environments start an episode, with their states set and before the first observation.

        Override it to set goals, parameters of environments (``batch.randomize``), welds (``batch.add_weld``), poses of
        mocap bodies, or states of many environments at once: they start from the values that it writes to the arrays of
        :attr:`batch`.

        Parameters
        ----------
        mask : ndarray
            Booleans (n,): True for the environments that start; ``numpy.flatnonzero(mask)`` are their indices. Random
            numbers of environment ``i`` come from ``generator(i)``.
        """
