"""Randomization at resets, and forces and velocity kicks between them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from unisim.dr._host import interval_payload_to_host
from unisim.dr.types import (
    RESET_TERM_SPECS,
    DomainRandomizationCapabilities,
    IntervalTermOp,
    TensorIntervalPayload,
    TensorResetRandomizationPayload,
    _validate_reset_term,
    require_op_body_ids,
)

from clench.unisim.model_queries import Array, ModelQueries

# Reset terms that are parameters of the same name.
_PARAMETERS = (
    "gravity",
    "body_iquat",
    "body_inertia",
    "body_ipos",
    "body_mass",
    "dof_armature",
    "dof_damping",
    "dof_frictionloss",
    "geom_friction",
    "geom_size",
    "geom_solref",
    "geom_solimp",
)
# Gains of position servos: the columns of parameters that hold them, and their signs there.
_GAINS = {
    "kp": (("actuator_gainprm", 0, 1.0), ("actuator_biasprm", 1, -1.0)),
    "kd": (("actuator_biasprm", 2, -1.0),),
}
# Differences from the base body's row: the parameters that they change.
_DELTAS = {"base_mass_delta": "body_mass", "base_com_offset": "body_ipos"}
RESET_TERMS = frozenset(spec.name for spec in RESET_TERM_SPECS) & {*_PARAMETERS, *_GAINS, *_DELTAS}
_NOT_NEGATIVE = {
    "body_mass",
    "body_inertia",
    "dof_armature",
    "dof_damping",
    "dof_frictionloss",
    "geom_size",
    "geom_friction",
}


class Randomization(ModelQueries):
    """The part of the contract that changes parameters, forces and velocities."""

    _base_body: int  # -1 if there is none.
    _push_body: int  # -1 if there is none.
    _wrench: NDArray[np.float64]  # (n, nbody, 6) External forces of the next step.

    def get_dr_capabilities(self) -> Any:
        interval = {"body_force", "body_torque"}
        if self._push_body >= 0:
            interval.add("push")
        if self._base_body >= 0 and self._base_layout() is not None:
            interval |= {"body_linear_velocity_delta", "body_angular_velocity_delta"}
        terms = RESET_TERMS if self._base_body >= 0 else RESET_TERMS - set(_DELTAS)
        return DomainRandomizationCapabilities(
            supported_reset_terms=frozenset(terms),
            supported_device_reset_terms=frozenset(terms),
            supported_interval_terms=frozenset(interval),
            supported_device_interval_terms=frozenset(interval),
        )

    def get_reset_term_default(self, term: str) -> Array:
        _validate_reset_term(term)
        if not self.get_dr_capabilities().supports_reset_term(term):
            raise NotImplementedError(f"clench does not support the reset term {term!r}")
        if term in _DELTAS:
            values = np.zeros((3,) if term == "base_com_offset" else ())
        elif term in _GAINS:
            field, column, sign = _GAINS[term][0]
            values = sign * self.batch.param(field)[:, :, column].astype(np.float64)
        else:
            values = self.batch.param(term).astype(np.float64)
        values.setflags(write=False)
        return values

    # Parameters.

    def _prepared(self, payload: Any, envs: Array) -> dict[str, Array]:
        """Returns the checked fields that a payload changes, in full for each of the environments."""
        if payload is None:
            return {}
        if not isinstance(payload, TensorResetRandomizationPayload):
            raise TypeError("randomization must be a TensorResetRandomizationPayload or None")
        supported = self.get_dr_capabilities().supported_reset_terms
        given = {term: interval_payload_to_host(getattr(payload, term)) for term in sorted(payload.requested_terms())}
        unsupported = sorted(set(given) - supported)
        if unsupported:
            raise NotImplementedError(f"clench does not support the reset terms {unsupported}")
        fields: dict[str, Array] = {}

        def field_of(name: str) -> Array:
            return fields.setdefault(name, self.batch.param(name)[envs].astype(np.float64))

        for term in _PARAMETERS:
            if term in given:
                fields[term] = checked(term, given[term], (envs.size, *np.shape(getattr(self._model, term))))
        for term, columns in _GAINS.items():
            if term in given:
                values = checked(term, given[term], (envs.size, self._model.nactuator))
                for name, column, sign in columns:
                    field_of(name)[:, :, column] = sign * values
        for term, name in _DELTAS.items():
            if term in given:
                if name not in fields:
                    # A difference is from the model's value, however often an environment is reset.
                    shape = np.shape(getattr(self._model, name))
                    fields[name] = np.broadcast_to(getattr(self._model, name), (envs.size, *shape)).copy()
                row = fields[name][:, self._base_body]
                row += checked(term, given[term], row.shape)
        for name, values in fields.items():
            if name in _NOT_NEGATIVE and (values < 0).any():
                raise ValueError(f"{name} must not be negative")
        return fields

    def _write_parameters(self, fields: Mapping[str, Array], envs: Array) -> None:
        """Writes fields and the constants that follow from them; an error changes nothing."""
        before = {name: self.batch.param(name)[envs] for name in fields}
        try:
            self._randomize(fields, envs)
        except ValueError:
            self._randomize(before, envs)
            raise

    def _randomize(self, fields: Mapping[str, Array], envs: Array) -> None:
        for index, (name, values) in enumerate(fields.items(), start=1):
            self.batch.randomize(name, values, envs, consistent=index == len(fields))

    # Between resets.

    def apply_interval_randomization(self, plan: Any) -> None:
        if plan.is_empty():
            return
        self._reject_wrench_write_inside_pre_step_control("apply_interval_randomization")
        self._wrench[:] = 0
        super().apply_interval_randomization(plan)

    def _interval_term_handlers(self) -> dict[str, Callable[[IntervalTermOp], None]]:
        def with_bodies(apply: Callable[[Array, Array], None]) -> Callable[[IntervalTermOp], None]:
            return lambda op: apply(
                interval_payload_to_host(require_op_body_ids(op)), interval_payload_to_host(op.payload)
            )

        return {
            "push": lambda op: self._push(op.payload),
            "body_force": with_bodies(self.apply_body_force),
            "body_torque": with_bodies(self._apply_torque),
            "body_linear_velocity_delta": with_bodies(self._kick_linear),
            "body_angular_velocity_delta": with_bodies(self._kick_angular),
        }

    def _push(self, payload: Any) -> None:
        if self._push_body < 0:
            raise NotImplementedError("the term 'push' needs push_body_name")
        force = payload.push_force if isinstance(payload, TensorIntervalPayload) else payload
        self._wrench[:] = 0
        self._wrench[:, self._push_body, :3] = checked("push", interval_payload_to_host(force), (self._num_envs, 3))

    def apply_body_force(self, body_ids: Array, force: Array, torque: Array | None = None) -> None:
        """Adds forces, N, and torques, N m, in world axes, that act in the next step on centres of mass.

        Parameters
        ----------
        body_ids : ndarray of int
            (k,) The bodies.
        force : ndarray
            (n, k, 3) Forces.
        torque : ndarray, optional
            (n, k, 3) Torques.
        """
        self._reject_wrench_write_inside_pre_step_control("apply_body_force")
        bodies = self._body_indices(body_ids)
        shape = (self._num_envs, bodies.size, 3)
        checked_torque = None if torque is None else checked("body torque", torque, shape)
        add_wrench(self._wrench, bodies, checked("body force", force, shape), checked_torque)

    def _apply_torque(self, body_ids: Array, torque: Array) -> None:
        self.apply_body_force(body_ids, np.zeros(np.shape(torque)), torque)

    def _body_indices(self, body_ids: Array) -> Array:
        bodies = np.asarray(body_ids).reshape(-1)
        if bodies.dtype.kind not in "iu":
            raise TypeError(f"body_ids must be integers, not {bodies.dtype}")
        if ((bodies < 0) | (bodies >= self._model.nbody)).any():
            raise ValueError(f"body_ids must be in [0, {self._model.nbody}), not {bodies.tolist()}")
        return bodies

    def _base_layout(self) -> Any:
        try:
            return self.get_root_state_layout(self._model.names("body")[self._base_body])
        except (NotImplementedError, ValueError):
            return None

    def _kick_linear(self, body_ids: Array, delta: Array) -> None:
        self._kick(body_ids, delta, angular=False)

    def _kick_angular(self, body_ids: Array, delta: Array) -> None:
        self._kick(body_ids, delta, angular=True)

    def _kick(self, body_ids: Array, delta: Array, *, angular: bool) -> None:
        """Adds to the velocity of the free base, in world axes."""
        layout = self._base_layout() if self._base_body >= 0 else None
        if layout is None or self._body_indices(body_ids).tolist() != [self._base_body]:
            raise NotImplementedError(
                "velocity deltas apply to the body of base_name alone, which must have a free joint"
            )
        change = checked("velocity delta", delta, (self._num_envs, 1, 3))[:, 0]
        envs = np.flatnonzero((change != 0).any(axis=1))
        if not envs.size:
            return
        change = change[envs]
        if angular:
            # Angular velocities of free joints are in the body's frame.
            change = _rotated_back(self.batch.qpos[envs][:, list(layout.qpos_indices[3:])], change)
        columns = np.array(layout.qvel_indices[3:] if angular else layout.qvel_indices[:3])
        self.batch.qvel[np.ix_(envs, columns)] += change
        self.batch.qacc_warmstart[envs] = 0
        self._refresh(envs)


def add_wrench(wrench: Array, bodies: Array, force: Array | None, torque: Array | None) -> None:
    """Adds forces and torques (n, k, 3) to the rows of k bodies; a body that is named twice gets both."""
    for columns, part in ((slice(0, 3), force), (slice(3, 6), torque)):
        if part is not None:
            for place, body in enumerate(bodies):
                wrench[:, body, columns] += part[:, place]


def checked(name: str, values: Any, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Returns finite numbers of a shape; tables may be flat after the axis of environments."""
    array = np.asarray(values)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} must be numbers, not of dtype {array.dtype}")
    flat = (shape[0], int(np.prod(shape[1:], dtype=np.int64)))
    if array.shape not in (shape, flat):
        raise ValueError(f"{name} must have shape {shape}, not {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite")
    return array.reshape(shape).astype(np.float64)


def _rotated_back(quat: Array, vector: Array) -> Array:
    """Rotates vectors (k, 3) by the inverses of unit quaternions (k, 4)."""
    w, xyz = quat[:, :1], -quat[:, 1:]
    cross = 2 * np.cross(xyz, vector)
    rotated: Array = vector + w * cross + np.cross(xyz, cross)
    return rotated
