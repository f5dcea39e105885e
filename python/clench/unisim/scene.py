"""The model of a UniSim scene: a file, fragments that are merged into it, a timestep, gains, and sensors of bodies."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from unisim.scene import SceneCfg, resolve_scene_fragment_path

from clench import Model, ModelSpec

# Sensors of tracked bodies: UniSim's names, and MJCF's elements. Each is a block over the bodies.
WORLD_SENSORS = {
    "track_pos_w": "framepos",
    "track_quat_w": "framequat",
    "track_linvel_w": "framelinvel",
    "track_angvel_w": "frameangvel",
}
BASE_SENSORS = {"track_pos_b": "framepos", "track_quat_b": "framequat"}
# Sections that a fragment extends instead of adding its own.
_MERGED = {"sensor", "keyframe", "actuator"}


def check_scene(scene: Any) -> None:
    """Refuses parts of a scene that this backend cannot build.

    Parameters
    ----------
    scene : unisim.scene.SceneCfg
        The scene.

    Raises
    ------
    TypeError
        If it is no scene.
    ValueError
        If it names no model file.
    NotImplementedError
        If it has entities, fixed variants or generated terrain.
    """
    if not isinstance(scene, SceneCfg):
        raise TypeError(f"scene must be a unisim.scene.SceneCfg, not {type(scene).__name__}")
    unsupported = {
        "entity_assets": bool(scene.entity_assets),
        "fixed_variant_plan": scene.fixed_variant_plan is not None,
        "terrain": scene.terrain is not None,
    }
    for name, used in unsupported.items():
        if used:
            raise NotImplementedError(f"clench does not support SceneCfg.{name}; compose the scene in one MJCF file")
    if not scene.model_file:
        raise ValueError("SceneCfg.model_file must name the model's file")


def spec_of_scene(scene: Any) -> ModelSpec:
    """Returns the document of a scene: its file, with the fragments merged.

    Raises
    ------
    clench.LoadError
        If a file cannot be read.
    """
    spec = ModelSpec.from_file(scene.model_file)
    for name in scene.fragment_files:
        _merge(spec, ModelSpec.from_file(resolve_scene_fragment_path(name, Path(scene.model_file).resolve())))
    return spec


def _merge(spec: ModelSpec, fragment: ModelSpec) -> None:
    root = spec._document.root
    for section in fragment._document.root:
        existing = root.find(section.tag) if section.tag in _MERGED else None
        if existing is None:
            root.append(copy.deepcopy(section))
        else:
            existing.extend(copy.deepcopy(child) for child in section)
    spec.assets.update(fragment.assets)


def set_timestep(spec: ModelSpec, timestep: float) -> None:
    """Sets the timestep, s.

    Raises
    ------
    ValueError
        If it is not positive and finite.
    """
    if not (np.isfinite(timestep) and timestep > 0):
        raise ValueError(f"sim_dt must be positive and finite, not {timestep}")
    spec.section("option")["timestep"] = float(timestep)


def add_tracking_sensors(spec: ModelSpec, bodies: Sequence[str] | None, base: str | None) -> tuple[str, ...]:
    """Adds sensors of the poses and velocities of bodies, under UniSim's names.

    Parameters
    ----------
    spec : ModelSpec
        The document.
    bodies : sequence of str, optional
        The bodies; by default all named ones.
    base : str, optional
        A tracked body in whose frame the poses are measured too.

    Returns
    -------
    tuple of str
        The tracked bodies.

    Raises
    ------
    ValueError
        If no body has one of the names, or there is none.
    """
    known = [name for name in spec.build().names("body")[1:] if name]
    names = known if bodies is None else list(dict.fromkeys(bodies))
    unknown = [name for name in names if name not in known]
    if unknown or not names:
        raise ValueError(
            f"no body {unknown[0]!r} to track; bodies are {known}" if unknown else "no named body to track"
        )
    for prefix, tag in WORLD_SENSORS.items():
        for name in names:
            spec.add_sensor(tag, name=f"{prefix}_{name}", objtype="xbody", objname=name)
    if base in names:
        for prefix, tag in BASE_SENSORS.items():
            for name in names:
                # The dictionary holds MJCF's names of the frame that the sensor measures in.
                frame = {"reftype": "xbody", "refname": base}
                spec.add_sensor(tag, name=f"{prefix}_{name}", objtype="xbody", objname=name, **frame)
    return tuple(names)


def position_gains(model: Model, gains: Mapping[str, Any]) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Computes parameters of actuators with other gains.

    Parameters
    ----------
    model : Model
        The model.
    gains : mapping
        ``kp`` and ``kd``, numbers or (nactuator,), and optionally ``actuator_ids``.

    Returns
    -------
    gainprm, biasprm : ndarray
        (nactuator, 10) Parameters of gain and bias.

    Raises
    ------
    ValueError
        If a key is missing or unknown, a value is not finite, or an actuator is no position servo.
    """
    unknown = set(gains) - {"kp", "kd", "actuator_ids"}
    if unknown or not {"kp", "kd"} <= set(gains):
        raise ValueError(f"position_actuator_gains takes kp, kd and optionally actuator_ids, not {sorted(gains)}")
    which = gains.get("actuator_ids", slice(None))
    gainprm, biasprm = model.actuator_gainprm.copy(), model.actuator_biasprm.copy()
    kp, kd = (np.asarray(gains[key], dtype=np.float64) for key in ("kp", "kd"))
    if not (np.isfinite(kp).all() and np.isfinite(kd).all()):
        raise ValueError("position_actuator_gains must be finite")
    if (model.actuator_biastype[which] != 1).any():
        raise ValueError("position_actuator_gains: an actuator has no affine bias, so it is no position servo")
    gainprm[which, 0], biasprm[which, 1], biasprm[which, 2] = kp, -kp, -kd
    return gainprm, biasprm
