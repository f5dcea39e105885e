"""The common part of element views of a simulation or a batch: the element, its name and its index."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, SupportsIndex, TypeVar

from clench._core import Sim

if TYPE_CHECKING:
    from clench._core import Batch, Element


def is_alone(owner: Any) -> bool:
    """Returns true if the owner is a `Sim`, which has no axis of environments."""
    return isinstance(owner, Sim)


_Value = TypeVar("_Value")


def computed_once(function: Callable[[Any], _Value]) -> _Value:
    """Makes a property of a view that is computed when it is first read, as `functools.cached_property` does for
    classes without slots."""
    name = function.__name__

    def read(view: ElementView) -> _Value:
        if name not in view._computed:
            view._computed[name] = function(view)
        value: _Value = view._computed[name]
        return value

    return property(read)  # type: ignore[return-value]


class ElementView:
    """An element of a simulation or batch, with its quantities as attributes.

    Parts of the state are live views of the same memory; write into them or assign. Outputs are those of the last step,
    or of the current state if it was written since; in a batch they must be recorded. Parameters belong to this
    simulation only: they are read as read-only copies, and assignments are validated. In a batch all have the
    environments as their first axis.

    Parameters
    ----------
    owner : Sim or Batch
        The owner of the element.
    which : str or int
        Its name or index.
    """

    __slots__ = ("_alone", "_computed", "_element", "_owner", "_row")
    _kind = ""

    def __init__(self, owner: Sim | Batch, which: str | SupportsIndex) -> None:
        self._element: Element = getattr(owner.model, self._kind)(which)
        self._owner = owner
        self._row: int = self._element.id
        self._alone = is_alone(owner)
        self._computed: dict[str, Any] = {}

    def __reduce__(self) -> tuple[Any, ...]:
        """Returns what a copy or pickle is made of: the owner, which is copied too, and the index."""
        return type(self), (self._owner, self._row)

    @property
    def element(self) -> Element:
        """The element of the model, with its structure."""
        return self._element

    @property
    def id(self) -> int:
        """Its index among the elements of its kind."""
        return self._row

    @property
    def name(self) -> str:
        """Its name, possibly empty."""
        return self.element.name

    def __repr__(self) -> str:
        what = f'"{self.name}"' if self.name else "without a name"
        return f"<clench.{type(self).__name__}: {self._kind} {self._row}, {what}>"
