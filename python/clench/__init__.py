"""MuJoCo's constraint model, fast: one robot or thousands at once."""

from clench._core import Model, RigidOptions, SolverStats, __version__
from clench.errors import BusyError, ClenchError, LoadError, SimulationError

__all__ = [
    "BusyError",
    "ClenchError",
    "LoadError",
    "Model",
    "RigidOptions",
    "SimulationError",
    "SolverStats",
    "__version__",
]
