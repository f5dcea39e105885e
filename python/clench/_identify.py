"""System identification: the parameters of a model that explain recorded motion."""

from __future__ import annotations

import operator
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from clench._core import Model, RigidOptions, Sim
from clench._recorded import Recorded
from clench._tangent import Floats
from clench.errors import SimulationError

__all__ = ["Identification", "identify"]


@dataclass(frozen=True, eq=False)
class Identification:
    """The result of `identify`.

    Parameters
    ----------
    parameters : dict of str to numpy.ndarray
        All numbers of each field, with the estimates in place, for `Sim.set_param`.
    estimates : numpy.ndarray
        (n,) The estimated numbers, in the order of `parameters` and of the indices of each field.
    covariance : numpy.ndarray
        (n, n) Covariance of the estimates, σ² (Jᵀ J)⁻¹. Infinite if the recordings do not determine all of them.
    residual : float
        σ, the root of the sum of squared residuals over their number minus n. It is near 1 if the model fits and
        `scale` holds the standard deviations of the noise.
    result : scipy.optimize.OptimizeResult
        SciPy's result: cost, Jacobian, residuals, number of evaluations, termination status.
    """

    parameters: dict[str, NDArray[np.float64]]
    estimates: NDArray[np.float64]
    covariance: NDArray[np.float64]
    residual: float
    result: Any


def identify(
    model: Model,
    recordings: Sequence[Mapping[str, Any]],
    parameters: Sequence[str] | Mapping[str, Sequence[int]],
    *,
    scale: Mapping[str, ArrayLike] | None = None,
    bounds: Mapping[str, tuple[ArrayLike, ArrayLike]] | None = None,
    options: RigidOptions | None = None,
    **settings: Any,
) -> Identification:
    """Estimates parameters from recorded motion by nonlinear least squares.

    SciPy's `least_squares <https://docs.scipy.org/doc/scipy/reference/generated/scipy.optimize.least_squares.html>`_
    (``pip install scipy``) minimizes the squared differences between simulated and recorded motion. It starts from the
    values of the model. Its Jacobian is exact: `Sim.linearize` gives it step by step.

    Parameters
    ----------
    model : Model
        The model.
    recordings : sequence of mappings
        Each has some of ``"qpos"`` (T, nq), ``"qvel"`` (T, nv) and ``"sensordata"`` (T, nsensordata), in the layout of
        `Batch.rollout`: a row after each step, with sensors of that step's start. Numbers that are NaN were not
        measured. ``"ctrl"`` (T, nu) has the controls of each step. ``"initial"`` is a `State`, or a row with time,
        positions, velocities and activations; by default the initial state of the model.
    parameters : sequence of str, or mapping of str to sequence of int
        Fields to estimate (see `clench.PARAMETERS`): all their numbers, or those at the given indices of the flattened
        field.
    scale : mapping of str to array_like, optional
        Standard deviations of the noise of ``"qpos"`` (along the nv dofs), ``"qvel"`` and ``"sensordata"``. By default
        they are 1.
    bounds : mapping of str to (array_like, array_like), optional
        Least and greatest values of the numbers of a field. By default those that a simulation accepts.
    options : RigidOptions, optional
        Options that take precedence over those of the model.
    **settings
        Further arguments of ``least_squares``, such as ``loss="huber"`` or ``verbose=2``.

    Returns
    -------
    Identification
        Estimates and their covariance.

    Raises
    ------
    ModuleNotFoundError
        If SciPy is not installed.
    ValueError
        If a name or shape is wrong, a scale is not positive, or nothing was recorded.
    TypeError
        If `recordings` is a single mapping, or `parameters` a single name.
    IndexError
        If an index is outside its field.
    SimulationError
        If a simulation with the values of the model fails.

    Examples
    --------
    >>> sim = clench.Sim(clench.Model.from_file("models/pendulum.xml"))
    >>> sim.qpos = [-1.5]
    >>> recording = {"initial": sim.state, "qpos": []}
    >>> sim.set_param("dof_damping", [0.05])
    >>> for _ in range(300):
    ...     sim.step()
    ...     recording["qpos"].append(sim.qpos.copy())
    >>> found = clench.identify(sim.model, [recording], ["dof_damping"])  # doctest: +SKIP
    >>> found.parameters["dof_damping"].round(6)  # doctest: +SKIP
    array([0.05])
    """
    try:
        from scipy.optimize import least_squares
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError("identify needs the package scipy: pip install scipy", name="scipy") from error
    if isinstance(recordings, Mapping):
        raise TypeError("recordings is a sequence of mappings: give one recording as [recording]")
    if isinstance(parameters, str):
        raise TypeError(f'parameters is a sequence of names, such as ["{parameters}"], not a str')
    sim = Sim(model, options)
    chosen = _Chosen(sim, parameters)
    problems = [Recorded(model, recording, scale or {}) for recording in recordings]
    if not sum(len(problem) for problem in problems):
        raise ValueError("the recordings have no measured numbers")

    def residuals(x: Floats) -> Floats:
        chosen.write(sim, x)
        return np.concatenate([problem.residuals(sim) for problem in problems])

    def tried(x: Floats) -> Floats:
        # SciPy shortens a trial step whose residuals are not finite.
        try:
            return residuals(x)
        except (SimulationError, ValueError):
            return np.full(first.shape, np.inf)

    def jacobian(x: Floats) -> Floats:
        chosen.write(sim, x)
        return np.vstack([problem.jacobian(sim, chosen.indices) for problem in problems])

    first = residuals(chosen.start)
    limits = chosen.bounds(bounds or {})
    result = least_squares(tried, chosen.start, jacobian, limits, **{"x_scale": "jac", **settings})
    sigma = float(np.sqrt(2.0 * result.cost / max(first.size - result.x.size, 1)))
    fields = chosen.write(sim, result.x)
    return Identification(fields, result.x, _covariance(result.jac, sigma), sigma, result)


class _Chosen:
    """The numbers to estimate: fields, and indices in their flattened arrays."""

    def __init__(self, sim: Sim, parameters: Sequence[str] | Mapping[str, Sequence[int]]) -> None:
        if isinstance(parameters, Mapping):
            self.indices = {name: [operator.index(index) for index in indices] for name, indices in parameters.items()}
        else:
            self.indices = {name: list(range(np.size(sim.param(name)))) for name in parameters}
        sim.linearize(parameters=self.indices)  # Checks the names and indices.
        self._fields = {name: np.array(sim.param(name), np.float64) for name in self.indices}
        chosen = [self._fields[name].ravel()[indices] for name, indices in self.indices.items()]
        self.start: Floats = np.concatenate(chosen) if chosen else np.empty(0)
        if not self.start.size:
            raise ValueError("there are no parameters to estimate")

    def write(self, sim: Sim, x: Floats) -> dict[str, NDArray[np.float64]]:
        """Sets the numbers in a simulation, and returns the fields."""
        written, begin = {}, 0
        for name, indices in self.indices.items():
            values = self._fields[name].copy()
            values.ravel()[indices] = x[begin : begin + len(indices)]
            sim.set_param(name, values)
            written[name] = values
            begin += len(indices)
        return written

    def bounds(self, bounds: Mapping[str, tuple[ArrayLike, ArrayLike]]) -> tuple[Floats, Floats]:
        """Returns the least and greatest value of each number."""
        if unknown := set(bounds) - set(self.indices):
            raise ValueError(f"bounds of {', '.join(sorted(unknown))}, which are not estimated")
        pairs = [
            np.broadcast_arrays(*bounds.get(name, (-np.inf, np.inf)), np.empty(len(indices)))[:2]
            for name, indices in self.indices.items()
        ]
        low, high = (np.concatenate(side).astype(np.float64) for side in zip(*pairs))
        return low, high


def _covariance(jacobian: Floats, sigma: float) -> Floats:
    """Returns σ² (Jᵀ J)⁻¹, infinite if J lacks full rank."""
    lengths = np.linalg.norm(jacobian, axis=0)
    if not lengths.all() or np.linalg.matrix_rank(jacobian / lengths) < lengths.size:
        return np.full((lengths.size, lengths.size), np.inf)
    unit = jacobian / lengths
    covariance: Floats = sigma**2 * np.linalg.inv(unit.T @ unit) / np.outer(lengths, lengths)
    return covariance
