"""The exceptions of clench.

What is wrong with an argument is said as Python says it: a wrong shape or value is a :class:`ValueError`, a wrong type or
dtype a :class:`TypeError`, an element that is not there an :class:`IndexError`, memory that is not there a
:class:`MemoryError`. What only a simulator can say is a :class:`ClenchError`.
"""

from __future__ import annotations

__all__ = ["BusyError", "ClenchError", "LoadError", "SimulationError"]


class ClenchError(Exception):
    """What the exceptions of this package have in common."""


class LoadError(ClenchError, ValueError):
    """A model file that cannot be loaded, and where.

    As text it reads ``robot.xml:12: joint "knee": ...``.

    Parameters
    ----------
    message : str
        What is wrong.
    file : str
        The file as it was named, or as an include found it; empty where the model came from no file.
    line : int or None
        Line, counted from one; None where the whole file is meant.
    element : str or None
        The element, such as ``joint "knee"``; None where the whole file is meant.
    """

    message: str
    file: str
    line: int | None
    element: str | None

    def __init__(self, message: str, file: str = "", line: int | None = None, element: str | None = None) -> None:
        super().__init__(message, file, line, element)
        self.message = message
        self.file = file
        self.line = line
        self.element = element

    def __str__(self) -> str:
        place = f"{self.file}:" if self.file else ""
        place += "" if self.line is None else f"{self.line}:"
        return " ".join(part for part in (place, f"{self.element}:" if self.element else "", self.message) if part)


class SimulationError(ClenchError, RuntimeError):
    """A state that cannot be stepped from, or a step that led nowhere; the state stays at the last good one."""


class BusyError(ClenchError, RuntimeError):
    """Another thread is using the simulation or batch."""
