"""What a task says of its environments: the methods that it defines, each over all of them at once."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clench import State
from clench.gymnasium.generators import Generators
from clench.gymnasium.observed import Observation

Array = NDArray[Any]


class TaskMethods(Generators):
    """What a task defines, and what holds where it does not."""

    init_qpos: Array
    init_qvel: Array

    def observe(self) -> Observation:
        """What is observed, as a function of the arrays of :attr:`batch` alone: an array (n, ...), or arrays (n, ...) by name.

        Numbers that are not of single precision, nor bytes (uint8, as in pictures), are made float64.
        """
        raise NotImplementedError(f"{type(self).__name__} must define observe()")

    def reward(self, action: Array) -> Array:
        """What the step was worth, (n,).

        Called once a step, when the simulator is done, before :meth:`terminated` and :meth:`info`: they may use what
        was worked out here.

        Parameters
        ----------
        action : ndarray
            The actions (n, ...), as :meth:`control` gets them. Not to be written to.
        """
        raise NotImplementedError(f"{type(self).__name__} must define reward(action)")

    def control(self, action: Array) -> Array:
        """The controls that actions mean, (n, nu). The actions themselves unless defined.

        A task whose actions are others also has the attribute ``single_action_space``, of the class or set before the constructor
        of this class: a ``Box`` of any shape, a ``Discrete``, ``MultiDiscrete`` or ``MultiBinary``.

        Parameters
        ----------
        action : ndarray
            The actions (n, ...): float64 of a ``Box``, else int64. Not to be written to.
        """
        return action

    def terminated(self) -> Array:
        """Whose episode is over, (n,) booleans. Nobody's unless defined."""
        return np.zeros(self.num_envs, dtype=np.bool_)

    def truncated(self) -> Array:
        """Whose episode is cut short, (n,) booleans, besides those that reach ``max_episode_steps``. Nobody's unless defined.

        Called after :meth:`terminated`.
        """
        return np.zeros(self.num_envs, dtype=np.bool_)

    def info(self) -> Mapping[str, Array]:
        """More about the step: arrays (n, ...) by name. Nothing unless defined."""
        return {}

    def reset_info(self) -> Mapping[str, Array]:
        """The same about the states that resets lead to."""
        return {}

    def before_step(self) -> None:
        """Called with the controls set, before the simulator steps: the place to keep what the step will change."""

    def initial_state(self, rng: np.random.Generator) -> tuple[Array, Array] | State:
        """Where an episode of one environment starts. The initial state of the model unless defined.

        Not asked where :meth:`initial_states` is defined.

        Parameters
        ----------
        rng : numpy.random.Generator
            The generator of the environment that is reset.

        Returns
        -------
        qpos, qvel : ndarray
            Positions (nq,) and velocities (nv,); or a `State`, such as ``sim.state``, of which everything counts.
        """
        return self.init_qpos, self.init_qvel

    def initial_states(self, envs: NDArray[np.intp]) -> tuple[Array, Array] | State:
        """Where episodes start, of all environments that are reset at once. What :meth:`initial_state` says of each unless defined.

        Parameters
        ----------
        envs : ndarray
            Integers (k,): which environments. Random numbers of environment ``i`` come from ``generator(i)``.

        Returns
        -------
        qpos, qvel : ndarray
            Positions (k, nq) and velocities (k, nv); or (nq,) and (nv,), where all start from the same; or a `State`, of one or of k
            environments.
        """
        starts = [self.initial_state(self.generator(env)) for env in envs.tolist()]
        states = [start for start in starts if isinstance(start, State)]
        if states:
            return State.stack(states)
        pairs = [start for start in starts if not isinstance(start, State)]
        return np.array([qpos for qpos, _ in pairs]), np.array([qvel for _, qvel in pairs])

    def on_reset(self, mask: Array) -> None:
        """Called when environments start an episode, with their states set and before anything is observed.

        The place for goals, parameters of environments (``batch.randomize``), welds (``batch.add_weld``), poses of mocap bodies, or
        states of many environments at once: what it writes to the arrays of :attr:`batch` is where they start.

        Parameters
        ----------
        mask : ndarray
            Booleans (n,): which environments; ``numpy.flatnonzero(mask)`` are their indices. Random numbers of environment ``i`` come
            from ``generator(i)``.
        """
