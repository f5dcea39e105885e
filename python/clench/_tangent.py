"""Maps between position coordinates, whose quaternions have four numbers, and motions along the dofs."""

from __future__ import annotations

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
        self._shape = (model.nq, model.nv)
        # The first coordinate of each quaternion, and the first dof of its rotation.
        self._quats = (np.asarray(model.jnt_qposadr) + offset)[rotates]
        self._rotations = (np.asarray(model.jnt_dofadr) + offset)[rotates]
        coordinates, dofs = np.ones(model.nq, bool), np.ones(model.nv, bool)
        for q, v in zip(self._quats, self._rotations):
            coordinates[q : q + 4] = dofs[v : v + 3] = False
        self._constant = np.zeros(self._shape)
        self._constant[np.flatnonzero(coordinates), np.flatnonzero(dofs)] = 1.0

    def basis(self, qpos: Floats) -> Floats:
        """Returns the derivatives of coordinates (..., nq) by their motion, (..., nq, nv)."""
        matrix = np.broadcast_to(self._constant, (*qpos.shape[:-1], *self._shape)).copy()
        for q, v in zip(self._quats, self._rotations):
            w, x, y, z = np.moveaxis(0.5 * qpos[..., q : q + 4], -1, 0)
            block = np.stack([-x, -y, -z, w, -z, y, z, w, -x, -y, x, w], axis=-1)
            matrix[..., q : q + 4, v : v + 3] = block.reshape(*x.shape, 4, 3)
        return matrix

    def inverse(self, qpos: Floats) -> Floats:
        """Returns the derivatives of a motion by coordinates (..., nq), zero along a quaternion's length, (..., nv, nq)."""
        matrix = np.swapaxes(self.basis(qpos), -1, -2)
        for q, v in zip(self._quats, self._rotations):
            squares = np.square(qpos[..., q : q + 4]).sum(axis=-1)
            matrix[..., v : v + 3, :] *= 4.0 / squares[..., None, None]
        return matrix

    def nearest(self, qpos: Floats, others: Floats) -> Floats:
        """Returns `others` (nq) with those quaternions negated that are then nearer to those of `qpos` (nq)."""
        others = others.copy()
        for q in self._quats:
            if others[q : q + 4] @ qpos[q : q + 4] < 0.0:
                others[q : q + 4] *= -1.0
        return others


def state_size(sim: Sim | Batch) -> int:
    """Returns the length of x in ``sim.linearize(memory=True)``."""
    memory = (sim.plastic, sim.history, sim.stick_references, sim.stick_friction)
    envs = sim.n_envs if isinstance(sim, Batch) else 1
    return 2 * sim.model.nv + sim.model.na + sum(field.size for field in memory) // max(envs, 1)
