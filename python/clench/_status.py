"""Status codes of environments and of inverse kinematics."""

from __future__ import annotations

from enum import IntEnum

__all__ = ["EnvStatus", "IkStatus"]


class EnvStatus(IntEnum):
    """The status of an environment of a `Batch`: the codes in `Batch.status`."""

    RUNNING = 0
    """The environment takes part in steps."""
    NOT_FINITE = 1
    """The state had an infinite or NaN value."""
    SINGULAR = 2
    """The mass matrix was not positive definite."""
    DIVERGED = 3
    """The motion diverged: positions, velocities or accelerations exceeded 1e10 or were not finite."""
    CONTACT_OVERFLOW = 4
    """There were more contacts than `max_contacts` allows."""
    OVER_BUDGET = 5
    """The step exceeded the budget that the model was loaded with."""
    UNFINISHED = 6
    """The GPU terminated its step early, as Mesa's software device does for very long ones."""


class IkStatus(IntEnum):
    """The outcome of inverse kinematics: the codes in `IkResult.status`."""

    REACHED = 0
    """All goals except postures are within the tolerance."""
    STATIONARY = 1
    """A local minimum was found: no nearby positions reduce the total error."""
    ITERATION_LIMIT = 2
    """The iteration limit was reached."""
    NON_FINITE = 3
    """A number became infinite or NaN."""
