"""Recorded motion, compared with the motion of a simulation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from clench._core import Model, Sim
from clench._state import State
from clench._tangent import Floats, Tangent, state_size

_MEASURED = ("qpos", "qvel", "sensordata")


class Recorded:
    """The measured numbers of one motion, compared with those of a simulation."""

    def __init__(self, model: Model, recording: Mapping[str, Any], scale: Mapping[str, ArrayLike]) -> None:
        if unknown := set(recording) - {*_MEASURED, "ctrl", "initial"}:
            raise ValueError(f"recordings do not contain {', '.join(sorted(unknown))}")
        if unknown := set(scale) - {*_MEASURED}:
            raise ValueError(f"scale does not contain {', '.join(sorted(unknown))}")
        sizes = {"qpos": model.nq, "qvel": model.nv, "sensordata": model.nsensordata, "ctrl": model.nu}
        arrays = {name: np.asarray(recording[name], np.float64) for name in sizes if name in recording}
        self._steps = max((len(array) for array in arrays.values()), default=0)
        for name, array in arrays.items():
            if array.shape != (self._steps, sizes[name]):
                raise ValueError(f"{name} of a recording has shape {array.shape}, not {(self._steps, sizes[name])}")
        self._ctrl, self._initial = arrays.pop("ctrl", None), recording.get("initial")
        row = 1 + model.nq + model.nv + model.na
        if not isinstance(self._initial, (State, type(None))) and np.shape(self._initial) != (row,):
            raise ValueError(f"initial of a recording has shape {np.shape(self._initial)}, not {(row,)}")
        self._measured, self._tangent = arrays, Tangent(model)
        sizes["qpos"] = model.nv
        weights = [1.0 / _scale_of(name, scale.get(name, 1.0), sizes[name]) for name in arrays]
        known = [~np.isnan(array) for array in arrays.values()]
        if "qpos" in arrays:
            # A rotation was measured if all four numbers of its quaternion were.
            uses = self._tangent.basis(np.ones(model.nq)) != 0.0
            known[0] = ~(np.isnan(arrays["qpos"]) @ uses)
        self._known = np.hstack(known).ravel() if known else np.empty(0, bool)
        self._weights: Floats = np.tile(np.concatenate([np.empty(0), *weights]), self._steps)[self._known]

    def __len__(self) -> int:
        """Returns the number of residuals."""
        return int(self._known.sum())

    def residuals(self, sim: Sim) -> Floats:
        """Simulates the motion and returns the weighted differences, step after step."""
        rows = []
        for k in self._each_step(sim):
            sim.step()
            for name, measured in self._measured.items():
                if name == "qpos":
                    inverse, qpos, recorded = self._positions(sim, k)
                    rows.append(inverse @ (qpos - recorded))
                else:
                    rows.append(sim.output(name) - measured[k])
        differences: Floats = self._weights * np.concatenate([np.empty(0), *rows])[self._known]
        return differences

    def jacobian(self, sim: Sim, parameters: Mapping[str, Sequence[int]]) -> Floats:
        """Returns the derivatives of the residuals by the parameters.

        Those of the state obey S⁺ = A S + E, those of the sensors are C S + F.
        """
        nv, rows, n = sim.model.nv, [], sum(map(len, parameters.values()))
        state = np.zeros((state_size(sim), n))
        sensors = not self._measured.keys() <= {"qpos", "qvel"}
        for k in self._each_step(sim):
            linear = sim.linearize(parameters=parameters, memory=True, sensors=sensors)
            readings = linear.C @ state + np.hstack([*linear.output_parameters.values()])
            state = linear.A @ state + np.hstack([*linear.parameters.values()])
            sim.step()
            for name in self._measured:
                if name == "qpos":
                    inverse, qpos, _ = self._positions(sim, k)
                    rows.append(inverse @ self._tangent.basis(qpos) @ state[:nv])
                else:
                    rows.append(state[nv : 2 * nv] if name == "qvel" else readings)
        every = np.vstack([np.empty((0, n)), *rows])
        derivatives: Floats = self._weights[:, np.newaxis] * every[self._known]
        return derivatives

    def _each_step(self, sim: Sim) -> Iterator[int]:
        """Sets the initial state, then the controls of each step."""
        if isinstance(self._initial, State):
            sim.state = self._initial
        else:
            sim.reset()
            if self._initial is not None:
                sizes = np.cumsum([1, sim.model.nq, sim.model.nv])
                time, sim.qpos, sim.qvel, sim.act = np.split(np.asarray(self._initial, np.float64), sizes)
                sim.time = time[0]
        for k in range(self._steps):
            if self._ctrl is not None:
                sim.ctrl = self._ctrl[k]
            yield k

    def _positions(self, sim: Sim, k: int) -> tuple[Floats, Floats, Floats]:
        """Returns the map from coordinates to motions, and the simulated and measured coordinates of a step."""
        measured = self._measured["qpos"][k]
        measured = np.where(np.isnan(measured), sim.qpos, measured)
        return self._tangent.inverse(measured), self._tangent.nearest(measured, sim.qpos), measured


def _scale_of(name: str, given: ArrayLike, size: int) -> Floats:
    """Returns the standard deviation of each of the numbers with a name."""
    scale = np.asarray(given, np.float64)
    if scale.shape not in ((), (1,), (size,)):
        raise ValueError(f"scale of {name} has shape {scale.shape}, not () or {(size,)}")
    if not (scale > 0.0).all():
        raise ValueError(f"scale of {name} has a number that is not positive")
    return np.broadcast_to(scale, size)
