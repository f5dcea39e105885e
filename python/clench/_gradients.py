"""The step that PyTorch and JAX share."""

from __future__ import annotations

import numpy as np

from clench._core import Batch, Sim
from clench.errors import SimulationError


def advance_all(sim: Sim | Batch) -> None:
    """Steps once. Raises a `SimulationError` if an environment of a batch fails."""
    sim.step()
    if isinstance(sim, Batch) and not sim.running.all():
        env = int(np.argmin(sim.running))
        raise SimulationError(f"environment {env}: {sim.fault(env)}")
