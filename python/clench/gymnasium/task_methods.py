"""What a task says of its environments: the methods that it defines, each over all of them at once."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


class TaskMethods:
    """What a task defines, and what holds where it does not."""

    num_envs: int
    init_qpos: Array
    init_qvel: Array

    def observe(self) -> Array:
        """What is observed, (n, ...), as a function of the arrays of :attr:`batch` alone."""
        raise NotImplementedError(f"{type(self).__name__} must define observe()")

    def reward(self, action: Array) -> Array:
        """What the step was worth, (n,).

        Called once a step, when the simulator is done, before :meth:`terminated` and :meth:`info`: they may use what
        was worked out here.

        Parameters
        ----------
        action : ndarray
            The actions as float64, (n, ...). Not to be written to.
        """
        raise NotImplementedError(f"{type(self).__name__} must define reward(action)")

    def control(self, action: Array) -> Array:
        """The controls that actions mean, (n, nu). The actions themselves unless defined.

        A task whose actions have another shape also has the attribute ``single_action_space``, a ``Box`` of that shape.

        Parameters
        ----------
        action : ndarray
            The actions as float64, (n, ...). Not to be written to.
        """
        return action

    def terminated(self) -> Array:
        """Whose episode is over, (n,) booleans. Nobody's unless defined."""
        return np.zeros(self.num_envs, dtype=np.bool_)

    def info(self) -> Mapping[str, Array]:
        """More about the step: arrays (n, ...) by name. Nothing unless defined."""
        return {}

    def reset_info(self) -> Mapping[str, Array]:
        """The same about the states that resets lead to."""
        return {}

    def before_step(self) -> None:
        """Called with the controls set, before the simulator steps: the place to keep what the step will change."""

    def initial_state(self, rng: np.random.Generator) -> tuple[Array, Array]:
        """Where an episode starts. The initial state of the model unless defined.

        Parameters
        ----------
        rng : numpy.random.Generator
            The generator of the environment that is reset.

        Returns
        -------
        qpos, qvel : ndarray
            Positions (nq,) and velocities (nv,).
        """
        return self.init_qpos, self.init_qvel

    def on_reset(self, mask: Array) -> None:
        """Called when environments start an episode, with their states set and before anything is observed.

        The place for goals, parameters of environments (``batch.randomize``), welds (``batch.add_weld``), poses of mocap bodies, or
        states of many environments at once: what it writes to the arrays of :attr:`batch` is where they start.

        Parameters
        ----------
        mask : ndarray
            Booleans (n,): which environments; ``numpy.flatnonzero(mask)`` are their indices. Random numbers of environment ``i`` come
            from ``np_random[i]``.
        """
