"""Maps between position coordinates, whose quaternions have four numbers, and motions along the dofs."""

from __future__ import annotations

import functools

import numpy as np
from numpy.typing import NDArray

from clench._core import Batch, Model, Sim

Floats = NDArray[np.float64]

_FREE, _BALL = 0, 1


class Tangent:
    """The position coordinates of a model and their motions along its dofs.

    A small motion v changes the coordinates by `basis` (qpos) v. A rotation is about the axes of the child, so a
    quaternion q changes by ½ q (0, v).
    """

    def __init__(self, model: Model) -> None:
        kinds = np.asarray(model.jnt_type)
        offset = np.where(kinds == _FREE, 3, 0)
        rotates = (kinds == _FREE) | (kinds == _BALL)
        self._nq, self._nv = model.nq, model.nv
        # The first coordinate of each quaternion, and the first dof of its rotation.
        self._quats = ((np.asarray(model.jnt_qposadr) + offset)[rotates]).tolist()
        self._rotations = ((np.asarray(model.jnt_dofadr) + offset)[rotates]).tolist()
        coordinates, dofs = np.ones(model.nq, bool), np.ones(model.nv, bool)
        for q, v in zip(self._quats, self._rotations):
            coordinates[q : q + 4] = dofs[v : v + 3] = False
        # All others, in order.
        self._coordinates, self._dofs = np.flatnonzero(coordinates), np.flatnonzero(dofs)

    def by_motion(self, qpos: Floats, gradient: Floats) -> Floats:
        """Returns the gradient by a motion (..., nv) from that by the coordinates (..., nq)."""
        result = np.empty((*np.broadcast_shapes(qpos.shape[:-1], gradient.shape[:-1]), self._nv))
        result[..., self._dofs] = gradient[..., self._coordinates]
        for q, v in zip(self._quats, self._rotations):
            w, x, y, z = np.moveaxis(0.5 * qpos[..., q : q + 4], -1, 0)
            a, b, c, d = np.moveaxis(gradient[..., q : q + 4], -1, 0)
            result[..., v] = w * b + z * c - x * a - y * d
            result[..., v + 1] = w * c + x * d - y * a - z * b
            result[..., v + 2] = w * d + y * b - z * a - x * c
        return result

    def by_coordinates(self, qpos: Floats, gradient: Floats) -> Floats:
        """Returns the gradient by the coordinates (..., nq), zero along a quaternion's length, from that by a motion
        (..., nv)."""
        result = np.empty((*np.broadcast_shapes(qpos.shape[:-1], gradient.shape[:-1]), self._nq))
        result[..., self._coordinates] = gradient[..., self._dofs]
        for q, v in zip(self._quats, self._rotations):
            quat = qpos[..., q : q + 4]
            scale = 2.0 / np.square(quat).sum(axis=-1, keepdims=True)
            w, x, y, z = np.moveaxis(scale * quat, -1, 0)
            a, b, c = np.moveaxis(gradient[..., v : v + 3], -1, 0)
            result[..., q] = -x * a - y * b - z * c
            result[..., q + 1] = w * a - z * b + y * c
            result[..., q + 2] = z * a + w * b - x * c
            result[..., q + 3] = x * b - y * a + w * c
        return result

    def basis(self, qpos: Floats) -> Floats:
        """Returns the derivatives of coordinates (..., nq) by their motion, (..., nq, nv)."""
        return self.by_motion(qpos[..., None, :], np.eye(self._nq))

    def inverse(self, qpos: Floats) -> Floats:
        """Returns the derivatives of a motion by coordinates (..., nq), zero along a quaternion's length, (..., nv, nq)."""
        return self.by_coordinates(qpos[..., None, :], np.eye(self._nv))

    def nearest(self, qpos: Floats, others: Floats) -> Floats:
        """Returns `others` (nq) with those quaternions negated that are then nearer to those of `qpos` (nq)."""
        others = others.copy()
        for q in self._quats:
            if others[q : q + 4] @ qpos[q : q + 4] < 0.0:
                others[q : q + 4] *= -1.0
        return others


_last = functools.lru_cache(maxsize=1)(Tangent)


def tangent_of(model: Model) -> Tangent:
    """Returns the tangent of a model; that of the last model is stored."""
    return _last(model)


def state_size(sim: Sim | Batch) -> int:
    """Returns the length of x in ``sim.linearize(memory=True)``."""
    memory = (sim.plastic, sim.history, sim.stick_references, sim.stick_friction)
    envs = sim.n_envs if isinstance(sim, Batch) else 1
    return 2 * sim.model.nv + sim.model.na + sum(field.size for field in memory) // max(envs, 1)
