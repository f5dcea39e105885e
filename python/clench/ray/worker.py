"""A worker as the driver sees it: calls go there, and where it dies another takes its place.

The state of a worker is its last snapshot and what was asked of it since, the journal; both are kept here. So a worker that is lost is
made anew on whatever machine has room: the new one takes the snapshot, and does the journal again.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from clench.errors import ClenchError
from clench.ray.shard import Array, Shard

# How many workers may die in a row over one call before that call is taken to be what kills them.
_TRIES = 3


def ray_module() -> Any:
    """Ray.

    Raises
    ------
    ImportError
        It is not installed.
    """
    try:
        return importlib.import_module("ray")
    except ImportError as error:
        raise ImportError("clench.ray needs Ray: pip install 'clench[ray]'") from error


@dataclass
class Call:
    """Something that was asked of a worker."""

    method: str
    arguments: tuple[Any, ...]
    chosen: Mapping[str, Any]
    watched: Sequence[str]
    answer: Any = None
    """Where Ray puts what it returns; another place when it is done again."""


class Worker:
    """One part of the environments, on some machine.

    Parameters
    ----------
    packed : bytes
        What the part is made of, see `Shard`.
    threads : int
        Processors that Ray keeps for it.
    snapshot_every : int
        Time steps between snapshots.

    Attributes
    ----------
    journal : list of Call
        What was asked since the last snapshot that changes something, the snapshot itself first.
    replaced : int
        How often another took its place.
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
        """Asks for something, without waiting for it.

        Parameters
        ----------
        method : str
            See `Shard.run`.
        *arguments
            What it takes.
        chosen : mapping
            The keywords that it takes.
        changes : bool
            Whether it leaves the part different, so that it must be done again after a death.
        watched : sequence of str
            See `Shard.run`.
        """
        call = Call(method, arguments, chosen, watched)
        if changes:
            self.journal.append(call)
        call.answer = self._submit(call)
        return call

    def send_steps(self, steps: int, method: str, *arguments: Any, watched: Sequence[str] = ()) -> Call:
        """Asks for so many time steps, with a snapshot before them where one is due.

        Snapshots are taken there and nowhere else, since steps compute all recorded outputs anew, which snapshots do not hold.
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
        """Waits for what was asked.

        Returns
        -------
        object
            The result, or an exception that the worker raised.
        dict of str to ndarray
            What was watched.

        Raises
        ------
        ClenchError
            One worker after the other died over it.
        """
        for _ in range(_TRIES):
            try:
                answer: tuple[Any, dict[str, Array]] = self._ray.get(call.answer)
                self._take_snapshot(call)
                return answer
            except self._deaths() as error:
                death = error
                self._replace(call)
        raise ClenchError(f"{_TRIES} workers died one after the other over the call `{call.method}`") from death

    def close(self) -> None:
        """Ends it."""
        self._ray.kill(self._actor)

    def _take_snapshot(self, call: Call) -> None:
        """With the snapshot that came before a call, what was asked earlier need not be known any longer."""
        if self._snapshot is None or self._snapshot[1] is not call:
            return
        answer, self._snapshot = self._snapshot[0], None
        packed, _ = self._ray.get(answer)
        if isinstance(packed, bytes):
            since = next(place for place, other in enumerate(self.journal) if other is call)
            self.journal[:since] = [Call("restore", (packed,), {}, ())]

    def _replace(self, call: Call) -> None:
        """Puts another in the place of one that died."""
        self._ray.kill(self._actor)
        self._actor = self._new_actor()
        self.replaced += 1
        self._snapshot = None
        for earlier in self.journal:
            earlier.answer = self._submit(earlier)
        if all(call is not earlier for earlier in self.journal):
            call.answer = self._submit(call)

    def _new_actor(self) -> Any:
        # A task that is lost is not tried again by Ray: what comes after the snapshot must be done in order.
        remote = self._ray.remote(num_cpus=self._threads, max_restarts=0, scheduling_strategy="SPREAD")(Shard)
        return remote.remote()

    def _submit(self, call: Call) -> Any:
        return self._actor.run.remote(call.method, call.arguments, dict(call.chosen), tuple(call.watched))

    def _deaths(self) -> tuple[type[BaseException], ...]:
        """What Ray raises where a worker, or the machine with its results, is no more."""
        errors = self._ray.exceptions
        return errors.RayActorError, errors.ObjectLostError, errors.WorkerCrashedError
