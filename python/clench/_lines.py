"""Descriptors for the tables in `_named.py`: they read and set the quantities of an element, depending on their
source."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from clench._element_view import ElementView, is_alone

if TYPE_CHECKING:
    from typing_extensions import Self


class Line:
    """A quantity of an element: its rows of an array."""

    def __init__(self, array: str, doc: str, rows: str = "_row") -> None:
        self._array = array
        self._rows = rows
        self.__doc__ = doc

    def _part(self, view: ElementView, array: NDArray[Any]) -> Any:
        """Returns the rows of this element, after the axis of environments if there is one."""
        rows = getattr(view, self._rows)
        return array[rows] if view._alone else array[:, rows]

    @overload
    def __get__(self, view: None, of: type[Any]) -> Self: ...
    @overload
    def __get__(self, view: ElementView, of: type[Any]) -> Any: ...
    def __get__(self, view: ElementView | None, of: type[Any]) -> Any:
        if view is None:
            return self
        return self._read(view)

    def _read(self, view: ElementView) -> Any:
        raise NotImplementedError

    def __set__(self, view: ElementView, values: ArrayLike) -> None:
        raise AttributeError(f"{self._array} is computed from the state and cannot be set")


class StateLine(Line):
    """A part of the state, as a live view."""

    def _read(self, view: ElementView) -> Any:
        return self._part(view, getattr(view._owner, self._array))

    def __set__(self, view: ElementView, values: ArrayLike) -> None:
        array = getattr(view._owner, self._array)
        rows = getattr(view, self._rows)
        # This also works if the part is a single number, which is not a view.
        array[rows if view._alone else (slice(None), rows)] = values


class OutputLine(Line):
    """An output of the last step or forward pass, or of the current state, as in `Sim.output` and `Batch.output`."""

    def _read(self, view: ElementView) -> Any:
        return self._part(view, view._owner.output(self._array))


class ParameterLine(Line):
    """A parameter of this simulation, as a read-only copy. Assignments are validated as in `set_param`."""

    def _read(self, view: ElementView) -> Any:
        part = self._part(view, view._owner.param(self._array))
        if isinstance(part, np.ndarray):
            part.setflags(write=False)
        return part

    def __set__(self, view: ElementView, values: ArrayLike) -> None:
        array = view._owner.param(self._array)
        rows = getattr(view, self._rows)
        array[rows if view._alone else (slice(None), rows)] = values
        set_parameter(view._owner, self._array, array)


def set_parameter(owner: Any, field: str, values: ArrayLike) -> None:
    if is_alone(owner):
        owner.set_param(field, values)
    else:
        owner.randomize(field, values)
