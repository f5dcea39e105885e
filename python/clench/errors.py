"""The exceptions of clench.

Errors of arguments are Python's: a wrong shape or value raises a :class:`ValueError`, a wrong type or dtype a
:class:`TypeError`, a nonexistent element an :class:`IndexError`, insufficient memory a :class:`MemoryError`. Errors of
the simulator are a :class:`ClenchError`.
"""

from __future__ import annotations

__all__ = ["BusyError", "ClenchError", "LoadError", "SimulationError"]


class ClenchError(Exception):
    """The base class of this package's exceptions."""


class LoadError(ClenchError, ValueError):
    """An error in a model file, with its location.

    As text it reads ``robot.xml:12: joint "knee": ...``.

    Parameters
    ----------
    message : str
        The problem.
    file : str
        The file as it was named, or as an include found it; empty if the model is not from a file.
    line : int or None
        Line number, from one; None for the whole file.
    element : str or None
        The element, such as ``joint "knee"``; None for the whole file.
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
        location = f"{self.file}:" if self.file else ""
        if self.line is not None:
            location += f"{self.line}:" if self.file else f"line {self.line}:"
        return " ".join(part for part in (location, f"{self.element}:" if self.element else "", self.message) if part)


class SimulationError(ClenchError, RuntimeError):
    """The state cannot be stepped, or the step failed; the last good state is retained."""


class BusyError(ClenchError, RuntimeError):
    """Another thread is using the simulation or batch."""
