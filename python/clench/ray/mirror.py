"""Arrays of the state that exist here and in the workers: local changes are sent before the next call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import NDArray

Array = NDArray[Any]


class Mirror:
    """The fields of the state of all environments that were requested.

    Parameters
    ----------
    parts : sequence of slice
        The environments of each worker.
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
        """Returns the array of a field, the same object during the life of the batch; None if it was not requested
        yet."""
        return self._arrays.get(name)

    def add(self, name: str, rows: Array) -> Array:
        """Mirrors a field from now on; `rows` are the values of the workers."""
        self._arrays[name], self._known[name] = rows, rows.copy()
        return rows

    def written(self, part: int) -> dict[str, Array]:
        """Returns copies of the rows of whole fields that were written here since the last exchange with a worker."""
        rows = self._parts[part]
        changed = {}
        for name, array in self._arrays.items():
            own, known = array[rows], self._known[name][rows]
            # Compare bits, since NaN is a value that can be written.
            if own.tobytes() != known.tobytes():
                known[...] = own
                changed[name] = own.copy()
        return changed

    def update(self, part: int, fields: Mapping[str, Array]) -> None:
        """Stores the current values of a worker."""
        rows = self._parts[part]
        for name, values in fields.items():
            self._arrays[name][rows] = values
            self._known[name][rows] = values
