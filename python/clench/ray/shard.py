"""The code that a worker runs: a batch of its own environments, controlled by calls."""

from __future__ import annotations

import os
import pickle
import socket
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

import clench
from clench.ray.results import IkResult, RayHits

Array = NDArray[Any]


class Shard:
    """A part of the environments.

    Every change is a call of :meth:`run`. The same calls in the same order give the same bits; the replacement of a
    lost worker relies on that.
    """

    _batch: clench.Batch
    _resets: NDArray[np.int64] | int = 0

    def run(
        self, method: str, arguments: tuple[Any, ...], chosen: dict[str, Any], watched: Sequence[str]
    ) -> tuple[Any, dict[str, Array]]:
        """Executes a call.

        Parameters
        ----------
        method : str
            A method of this class, or else of the batch.
        arguments : tuple
            Its positional arguments.
        chosen : dict
            Its keyword arguments.
        watched : sequence of str
            Fields of the state to return after the call.

        Returns
        -------
        object
            The result of the call, or the exception that it raised.
        dict of str to ndarray
            Copies of the fields.
        """
        try:
            own = getattr(self, f"_{method}", None)
            result = (own or getattr(self._batch, method))(*arguments, **chosen)
        except Exception as error:  # It is reported to the caller on another machine.
            return error, {}
        return result, {name: getattr(self._batch, name).copy() for name in watched}

    def _start(self, packed: bytes) -> None:
        model, n_envs, precision, threads, options, record = pickle.loads(packed)
        self._batch = clench.Batch(model, n_envs, precision, threads, options=options, record=record)

    def _snapshot(self) -> bytes | None:
        """Returns the data for :meth:`_restore`; None while an environment has failed, since pickles of a batch do not
        store that."""
        if not self._batch.running.all():
            return None
        return pickle.dumps((self._batch, self._all_resets()))

    def _restore(self, packed: bytes) -> None:
        self._batch, self._resets = pickle.loads(packed)

    def _write(self, fields: dict[str, Array]) -> None:
        for name, values in fields.items():
            getattr(self._batch, name)[...] = values

    def _read(self) -> None:
        """Does nothing: it only returns the watched fields."""

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

    def _jacobian_at(self, point: Array, **chosen: Any) -> Array:
        return self._batch.jacobian(point=point, **chosen)

    def _jacobian_rate_at(self, point: Array, **chosen: Any) -> Array:
        return self._batch.jacobian_rate(point=point, **chosen)

    def _ik(self, targets: Sequence[Any], start: Array | None, **search: Any) -> IkResult:
        return IkResult.of(self._batch.ik(targets, start=start, **search))

    def _where(self) -> tuple[str, int]:
        return socket.gethostname(), os.getpid()
