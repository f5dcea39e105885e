"""Whether an environment runs."""

from __future__ import annotations

from enum import IntEnum

__all__ = ["EnvStatus"]


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
