"""Arrays of an environment that are views of its batch's memory, in copies and pickles of the environment.

A task may store such views, as ``self._tip = self.batch.site_xpos[:, 0]``. NumPy copies them as arrays of their own,
which later steps would not change. So a copy stores where a view lies, and makes it again in its own batch's memory.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clench import Batch
from clench._core import _STATE_FIELDS

Array = NDArray[Any]


@dataclass(frozen=True)
class View:
    """A view of an array of a batch.

    Attributes
    ----------
    name : str
        The name of the array.
    offset : int
        Bytes from its first element.
    shape, strides : tuple of int
        As NumPy's.
    dtype : numpy.dtype
        The type of its elements.
    """

    name: str
    offset: int
    shape: tuple[int, ...]
    strides: tuple[int, ...]
    dtype: np.dtype[Any]


def detached(value: Any, batch: Batch) -> Any:
    """Returns a value with a `View` in place of each view of the batch's memory, also in dictionaries, lists and tuples."""
    names = ("time", *(name for name, *_ in _STATE_FIELDS), *batch.outputs)
    arrays = {name: getattr(batch, name) for name in names}
    return _replaced(value, lambda part: _view(part, arrays))


def attached(value: Any, batch: Batch) -> Any:
    """Returns a value with a view of the batch's memory in place of each `View`."""

    def made(part: Any) -> Any:
        if not isinstance(part, View):
            return part
        return np.ndarray(part.shape, part.dtype, getattr(batch, part.name), part.offset, part.strides)

    return _replaced(value, made)


def _replaced(value: Any, replace: Callable[[Any], Any]) -> Any:
    """Returns a value with the replacements of its parts."""
    if type(value) is dict:
        return {key: _replaced(part, replace) for key, part in value.items()}
    if type(value) in (list, tuple):
        return type(value)(_replaced(part, replace) for part in value)
    return replace(value)


def _view(value: Any, arrays: dict[str, Array]) -> Any:
    """Returns the view that an array is of one of others, or else the value."""
    if type(value) is not np.ndarray or value.size == 0:
        return value
    address = value.ctypes.data
    for name, array in arrays.items():
        offset = address - array.ctypes.data
        if 0 <= offset < array.nbytes and array.flags.c_contiguous:
            return View(name, offset, value.shape, value.strides, value.dtype)
    return value
