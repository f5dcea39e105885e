"""Whether an environment runs, and how inverse kinematics ended."""

from __future__ import annotations

from enum import IntEnum

__all__ = ["EnvStatus", "IkStatus"]


class EnvStatus(IntEnum):
    """Whether an environment of a `Batch` runs, and if not why: the codes in `Batch.status`."""

    RUNNING = 0
    """It takes part in steps."""
    NOT_FINITE = 1
    """Its state held a number that is infinite or none."""
    SINGULAR = 2
    """Its mass matrix was not positive definite."""
    DIVERGED = 3
    """Its motion left all bounds: positions, velocities or accelerations beyond 1e10 or not finite."""
    CONTACT_OVERFLOW = 4
    """It had more contacts than `max_contacts` allows."""
    OVER_BUDGET = 5
    """Its step asked for more than the budget that the model was loaded with."""
    UNFINISHED = 6
    """The graphics device ended its step before the end, as Mesa's software device does with very long ones."""


class IkStatus(IntEnum):
    """How inverse kinematics ended: the codes in `IkResult.status`."""

    REACHED = 0
    """Every goal but postures is within the tolerance."""
    STATIONARY = 1
    """Nothing near brings the targets closer to their goals together."""
    ITERATION_LIMIT = 2
    """The iteration limit came first."""
    NON_FINITE = 3
    """A number became infinite or none."""
