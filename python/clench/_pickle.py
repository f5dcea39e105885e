"""Pickling of models, simulations, batches, cameras and targets of inverse kinematics, to copy them and send them to
other processes.

A pickle of a model stores how it was loaded: the text and the files in memory, or the path of its file, which must then
exist; a checksum detects changes of the file. A pickle of a simulation or batch stores its model, its options, the
parameters that it changed, and its state: the copy continues identically, to the bit. A batch on the processor also has
the recorded outputs of its last step. Failed environments of a batch are set running again.
"""

from __future__ import annotations

import copyreg
import zlib
from typing import Any

import numpy as np

from clench._core import PARAMETERS, Batch, ComTarget, FrameTarget, FreeCamera, Model, PostureTarget, RigidOptions, Sim
from clench._state import State

# Parameters that change when others are set.
_FOLLOWERS = {
    "body_mass": ("body_subtreemass",),
    "geom_size": ("geom_rbound",),
    "site_pos": ("eq_anchor1", "eq_anchor2"),
    "site_quat": ("eq_quat1", "eq_quat2"),
}

Target = FrameTarget | ComTarget | PostureTarget

# The arguments of the targets of inverse kinematics.
_OBJECTS = ("body", "body_com", "geom", "site", "camera")
_TARGETS: dict[Any, tuple[str, ...]] = {
    FrameTarget: (*_OBJECTS, "position", "quat", "position_cost", "orientation_cost"),
    ComTarget: ("position", "body", "cost"),
    PostureTarget: ("qpos", "cost"),
}


def _checksum(model: Model) -> int:
    """Computes a checksum of all parameters."""
    checksum = 0
    for name in PARAMETERS:
        checksum = zlib.crc32(np.asarray(getattr(model, name)).tobytes(), checksum)
    return checksum


def reduce_model(model: Model, method: str, arguments: dict[str, Any]) -> tuple[Any, ...]:
    """Implements `Model.__reduce__`."""
    return _model, (method, arguments, _checksum(model))


def _model(method: str, arguments: dict[str, Any], checksum: int) -> Model:
    rest = dict(arguments)
    source = rest.pop("path" if method == "from_file" else "text")
    model: Model = getattr(Model, method)(source, **rest)
    if _checksum(model) != checksum:
        raise ValueError(f"{source if method == 'from_file' else 'the text'} differs from the pickled model: it has changed")
    return model


def _changed(own: Sim | Batch) -> dict[str, Any]:
    """Returns the parameters that differ from the model's, and those that setting these changes, last."""
    changed = {}
    plain = None
    if isinstance(own, Batch) and len(own.models) > 1:
        plain = Batch(own.models, own.n_envs, own.precision, 1, env_model=own.env_model)
    for name in PARAMETERS:
        values = own.param(name)
        unchanged = np.asarray(getattr(own.model, name)) if plain is None else plain.param(name)
        if not (values == unchanged.astype(values.dtype)).all():
            changed[name] = values
    for leader in [name for name in _FOLLOWERS if name in changed]:
        for name in _FOLLOWERS[leader]:
            changed.pop(name, None)
            changed[name] = own.param(name)
    return changed


def _reduce_sim(sim: Sim) -> tuple[Any, ...]:
    how = {"precision": sim.precision, "threads": sim.threads}
    return _sim, (sim.model, sim.options, how, _changed(sim), sim.state, sim._last_serial)


def _sim(model: Model, options: RigidOptions, how: dict[str, Any], changed: dict[str, Any], state: State, last_serial: int) -> Sim:
    sim = Sim(model, options, **how)
    for name, values in changed.items():
        sim._restore_param(name, values)
    sim.state = state
    sim._last_serial = last_serial
    return sim


def _reduce_batch(batch: Batch) -> tuple[Any, ...]:
    how = (batch.n_envs, batch.precision, batch.threads, batch.options, batch.outputs, batch.device, batch.env_model)
    outputs = {name: batch.output(name) for name in batch.outputs} if batch.device == "cpu" else {}
    return _batch, (batch.models, how, _changed(batch), batch.state, batch._last_serials, outputs)


def _batch(
    models: tuple[Model, ...],
    how: tuple[Any, ...],
    changed: dict[str, Any],
    state: State,
    last_serials: list[int],
    recorded: dict[str, Any],
) -> Batch:
    n_envs, precision, threads, options, outputs, device, env_model = how
    batch = Batch(models, n_envs, precision, threads, options=options, record=outputs, device=device, env_model=env_model)
    for name, values in changed.items():
        batch._restore_param(name, values)
    batch.state = state
    batch._last_serials = last_serials
    if recorded:
        batch._restore_outputs(recorded)
    return batch


def target_fields(target: Target) -> dict[str, Any]:
    """Returns the constructor arguments of a target of inverse kinematics."""
    return {name: getattr(target, name) for name in _TARGETS[type(target)]}


def _reduce_target(target: Target) -> tuple[Any, ...]:
    return _target, (type(target), target_fields(target))


def _reduce_camera(camera: FreeCamera) -> tuple[Any, ...]:
    return _camera, (camera.lookat, camera.distance, camera.azimuth, camera.elevation, camera.fovy)


def _camera(lookat: list[float], distance: float, azimuth: float, elevation: float, fovy: float) -> FreeCamera:
    return FreeCamera(lookat, distance, azimuth, elevation, fovy=fovy)


def _target(kind: Any, fields: dict[str, Any]) -> Any:
    return kind(**fields)


copyreg.pickle(Sim, _reduce_sim)
copyreg.pickle(Batch, _reduce_batch)
copyreg.pickle(FreeCamera, _reduce_camera)
for _kind in _TARGETS:
    copyreg.pickle(_kind, _reduce_target)
