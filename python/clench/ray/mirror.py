"""Arrays of the state that live here as well as with the workers: what is written here goes there before the next call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import NDArray

Array = NDArray[Any]


class Mirror:
    """Fields of the state of all environments, those that were asked for.

    Parameters
    ----------
    parts : sequence of slice
        Which environments each worker has.
    """

    def __init__(self, parts: Sequence[slice]) -> None:
        self._parts = parts
        self._arrays: dict[str, Array] = {}
        self._known: dict[str, Array] = {}

    @property
    def names(self) -> tuple[str, ...]:
        """The fields."""
        return tuple(self._arrays)

    def get(self, name: str) -> Array | None:
        """The array of a field, the same object as long as the batch lives; None where it was not asked for yet."""
        return self._arrays.get(name)

    def add(self, name: str, rows: Array) -> Array:
        """Keeps a field from now on; what the workers have is `rows`."""
        self._arrays[name], self._known[name] = rows, rows.copy()
        return rows

    def written(self, part: int) -> dict[str, Array]:
        """What was written here since a worker knew of it: copies of the rows of whole fields."""
        rows = self._parts[part]
        changed = {}
        for name, array in self._arrays.items():
            own, known = array[rows], self._known[name][rows]
            # Bits, for NaN is a number that one can write.
            if own.tobytes() != known.tobytes():
                known[...] = own
                changed[name] = own.copy()
        return changed

    def update(self, part: int, fields: Mapping[str, Array]) -> None:
        """Takes over what a worker has now."""
        rows = self._parts[part]
        for name, values in fields.items():
            self._arrays[name][rows] = values
            self._known[name][rows] = values
