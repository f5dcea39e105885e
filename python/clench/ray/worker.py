"""The driver's representation of a worker: it forwards calls, and replaces a worker that dies.

The state of a worker is its last snapshot and the journal of later calls; the driver stores both. A lost worker is
therefore restored on any machine with free capacity: the new one loads the snapshot, and repeats the journal.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from clench.errors import ClenchError
from clench.ray.shard import Array, Shard

# The number of consecutive deaths of workers in one call after which the call is considered the cause.
_TRIES = 3


def ray_module() -> Any:
    """Imports Ray.

    Raises
    ------
    ImportError
        If Ray is not installed.
    """
    try:
        return importlib.import_module("ray")
    except ImportError as error:
        raise ImportError("clench.ray needs Ray: pip install 'clench[ray]'") from error


@dataclass
class Call:
    """A call of a worker."""

    method: str
    arguments: tuple[Any, ...]
    chosen: Mapping[str, Any]
    watched: Sequence[str]
    answer: Any = None
    """Ray's reference to the result until it is received; it is replaced if the call is repeated."""


class Worker:
    """One part of the environments, on some machine.

    Parameters
    ----------
    packed : bytes
        The arguments of the part; see `Shard`.
    threads : int
        CPUs that Ray reserves for it.
    snapshot_every : int
        Time steps between snapshots.

    Attributes
    ----------
    journal : list of Call
        The calls since the last snapshot that change the part, the snapshot itself first.
    replaced : int
        The number of replacements.
    """

    def __init__(self, packed: bytes, threads: int, snapshot_every: int) -> None:
        self._ray = ray_module()
        self._threads = threads
        self._every = snapshot_every
        self._steps = 0
        self.journal: list[Call] = []
        self._snapshot: tuple[Any, Call] | None = None
        self.replaced = 0
        self._actor = self._new_actor()
        self.receive(self.send("start", packed, changes=True))

    def send(
        self,
        method: str,
        *arguments: Any,
        chosen: Mapping[str, Any] = MappingProxyType({}),
        changes: bool = False,
        watched: Sequence[str] = (),
    ) -> Call:
        """Starts a call, without waiting for it.

        Parameters
        ----------
        method : str
            As for `Shard.run`.
        *arguments
            The positional arguments.
        chosen : mapping
            The keyword arguments.
        changes : bool
            True if the call changes the part, so that it must be repeated after a death.
        watched : sequence of str
            As for `Shard.run`.
        """
        call = Call(method, arguments, chosen, watched)
        if changes:
            self.journal.append(call)
        call.answer = self._submit(call)
        return call

    def send_steps(self, steps: int, method: str, *arguments: Any, watched: Sequence[str] = ()) -> Call:
        """Starts a number of time steps, with a snapshot before them if one is due.

        Snapshots are taken only here, since steps recompute all recorded outputs, which snapshots do not store.
        """
        before = None
        if self._steps >= self._every:
            before = self.send("snapshot").answer
            self._steps = 0
        self._steps += steps
        call = self.send(method, *arguments, changes=True, watched=watched)
        if before is not None:
            self._snapshot = before, call
        return call

    def receive(self, call: Call) -> tuple[Any, dict[str, Array]]:
        """Waits for a call.

        Returns
        -------
        object
            The result, or an exception that the worker raised.
        dict of str to ndarray
            The watched fields.

        Raises
        ------
        ClenchError
            If one worker after the other died during the call.
        """
        for _ in range(_TRIES):
            try:
                answer: tuple[Any, dict[str, Array]] = self._ray.get(call.answer)
                # Ray keeps a result in memory as long as there is a reference to it, and the journal keeps the call.
                call.answer = None
                self._take_snapshot(call)
                return answer
            except self._deaths() as error:
                death = error
                self._replace(call)
        raise ClenchError(f"{_TRIES} workers died one after the other in the call `{call.method}`") from death

    def close(self) -> None:
        """Terminates the worker."""
        self._ray.kill(self._actor)

    def _take_snapshot(self, call: Call) -> None:
        """Stores the snapshot that preceded a call, and discards the earlier calls."""
        if self._snapshot is None or self._snapshot[1] is not call:
            return
        answer, self._snapshot = self._snapshot[0], None
        packed, _ = self._ray.get(answer)
        if isinstance(packed, bytes):
            since = next(place for place, other in enumerate(self.journal) if other is call)
            self.journal[:since] = [Call("restore", (packed,), {}, ())]

    def _replace(self, call: Call) -> None:
        """Replaces a worker that died."""
        self._ray.kill(self._actor)
        self._actor = self._new_actor()
        self.replaced += 1
        self._snapshot = None
        # A call in the journal is its last: each is received before the next is sent.
        repeated = self.journal if self.journal[-1] is call else [*self.journal, call]
        for earlier in repeated:
            call.answer = self._submit(earlier)

    def _new_actor(self) -> Any:
        # Ray must not retry a lost task: the calls after the snapshot must be repeated in order.
        remote = self._ray.remote(num_cpus=self._threads, max_restarts=0, scheduling_strategy="SPREAD")(Shard)
        return remote.remote()

    def _submit(self, call: Call) -> Any:
        return self._actor.run.remote(call.method, call.arguments, dict(call.chosen), tuple(call.watched))

    def _deaths(self) -> tuple[type[BaseException], ...]:
        """Returns the exceptions that Ray raises if a worker, or the machine with its results, is lost."""
        errors = self._ray.exceptions
        return errors.RayActorError, errors.ObjectLostError, errors.WorkerCrashedError
