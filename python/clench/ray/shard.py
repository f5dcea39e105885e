"""What a worker runs: a batch of its own environments, which does what it is told, call by call."""

from __future__ import annotations

import os
import pickle
import socket
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

import clench
from clench.ray.answers import IkResult, RayHits

Array = NDArray[Any]


class Shard:
    """A part of the environments.

    Everything that happens to it is a call of :meth:`run`. The same calls in the same order lead to the same bits, which is what the
    replacement of a lost worker relies on.
    """

    _batch: clench.Batch
    _resets: NDArray[np.int64] | int = 0

    def run(
        self, method: str, arguments: tuple[Any, ...], chosen: dict[str, Any], watched: Sequence[str]
    ) -> tuple[Any, dict[str, Array]]:
        """Does a call.

        Parameters
        ----------
        method : str
            One of this class, or else of the batch.
        arguments : tuple
            What it takes.
        chosen : dict
            The keywords that it takes.
        watched : sequence of str
            Fields of the state that are wanted as they are afterwards.

        Returns
        -------
        object
            What the call returned, or the exception that it raised.
        dict of str to ndarray
            Copies of the fields.
        """
        try:
            own = getattr(self, f"_{method}", None)
            result = (own or getattr(self._batch, method))(*arguments, **chosen)
        except Exception as error:  # It belongs to whoever asked, on another machine.
            return error, {}
        return result, {name: getattr(self._batch, name).copy() for name in watched}

    def _start(self, packed: bytes) -> None:
        model, n_envs, precision, threads, options, record = pickle.loads(packed)
        self._batch = clench.Batch(model, n_envs, precision, threads, options=options, record=record)

    def _snapshot(self) -> bytes | None:
        """What :meth:`_restore` begins with; None while an environment stands still, which no pickle of a batch remembers."""
        if not self._batch.running.all():
            return None
        return pickle.dumps((self._batch, self._all_resets()))

    def _restore(self, packed: bytes) -> None:
        self._batch, self._resets = pickle.loads(packed)

    def _write(self, fields: dict[str, Array]) -> None:
        for name, values in fields.items():
            getattr(self._batch, name)[...] = values

    def _read(self) -> None:
        """Nothing but what is watched is wanted."""

    def _get_state(self) -> clench.State:
        return self._batch.state

    def _set_state(self, state: clench.State, envs: list[int]) -> None:
        self._batch.set_state(state, envs)

    def _set_options(self, options: clench.RigidOptions) -> None:
        self._batch.options = options

    def _copied_output(self, name: str) -> Array:
        return self._batch.output(name).copy()

    def _all_status(self) -> NDArray[np.int8]:
        return self._batch.status

    def _all_resets(self) -> NDArray[np.int64]:
        resets: NDArray[np.int64] = self._batch.resets + self._resets
        return resets

    def _rays(self, *arguments: Any, **chosen: Any) -> RayHits:
        return RayHits.of(self._batch.rays(*arguments, **chosen))

    def _ik(self, targets: Sequence[Any], start: Array | None, **search: Any) -> IkResult:
        return IkResult.of(self._batch.ik(targets, start=start, **search))

    def _where(self) -> tuple[str, int]:
        return socket.gethostname(), os.getpid()
