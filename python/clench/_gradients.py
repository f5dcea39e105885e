"""Parts of the gradients of steps that PyTorch and JAX share."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from clench._core import Batch, Sim
from clench.errors import SimulationError

Floats = NDArray[np.float64]


def rows(vectors: Floats, matrices: Floats) -> Floats:
    """Returns the products of row vectors (..., n) and matrices (..., n, m)."""
    product: Floats = (vectors[..., None, :] @ matrices)[..., 0, :]
    return product


def advance_all(sim: Sim | Batch) -> None:
    """Steps once. Raises a `SimulationError` if an environment of a batch fails."""
    sim.step()
    if isinstance(sim, Batch) and not sim.running.all():
        env = int(np.argmin(sim.running))
        raise SimulationError(f"environment {env}: {sim.fault(env)}")
