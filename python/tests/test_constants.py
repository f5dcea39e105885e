"""Compares constants derived from parameters with MuJoCo's `mj_setConst`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import clench
import mujoco  # type: ignore[import-untyped]
import numpy as np
import pytest
from models import FEATURES, PUBLIC, ROOT
from scenes import example, puppet

FOLDER = ROOT / ".venv/models"
# Relative to the largest number of a field.
TOLERANCE = 1e-9
FIELDS = (
    "body_subtreemass body_invweight0 dof_invweight0 dof_length tendon_length0 tendon_invweight0 actuator_acc0 cam_pos0 "
    "cam_poscom0 cam_mat0"
).split()


def changed(model: Any, rng: np.random.Generator) -> dict[str, Any]:
    """Returns changed values of parameters. MuJoCo refuses to move the centre of mass of a simple body."""
    scale = rng.uniform(0.7, 1.4, model.nbody)
    shifted = (model.body_simple == 0)[:, None] * rng.normal(0, 0.02, (model.nbody, 3))
    shifted[0] = 0
    return {
        "body_mass": model.body_mass * scale,
        "body_inertia": model.body_inertia * scale[:, None],
        "body_pos": model.body_pos + 0.01 * rng.normal(size=(model.nbody, 3)) * (np.arange(model.nbody) > 0)[:, None],
        "body_ipos": model.body_ipos + shifted,
        "dof_armature": model.dof_armature + rng.uniform(0, 0.02, model.nv) * (model.body_simple[model.dof_bodyid] < 2),
        "qpos0": model.qpos0 + 0.01 * rng.normal(size=model.nq) * scalar(model),
        "cam_pos": model.cam_pos + 0.1 * rng.normal(size=(model.ncam, 3)),
    }


def scalar(model: Any) -> Any:
    """Returns a mask of the coordinates of hinges and slides."""
    found = np.zeros(model.nq)
    one = np.isin(model.jnt_type, (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE))
    found[model.jnt_qposadr[one]] = 1
    return found


def expected(path: Path, values: dict[str, Any]) -> dict[str, Any]:
    """Returns MuJoCo's constants by field."""
    model = mujoco.MjModel.from_xml_path(str(path))
    for name, value in values.items():
        getattr(model, name)[:] = value
    mujoco.mj_setConst(model, mujoco.MjData(model))
    found = {name: getattr(model, name) for name in FIELDS}
    found["actuator_acc0"] = model.actuator_acc0[model.actuator_outadr]
    found["eq_anchor2"] = np.zeros((model.neq, 3))
    of_bodies = model.eq_objtype == mujoco.mjtObj.mjOBJ_BODY
    connects = (model.eq_type == mujoco.mjtEq.mjEQ_CONNECT) & of_bodies
    found["eq_anchor2"][connects] = model.eq_data[connects, 3:6]
    found["connects"] = connects
    found["welds"] = (model.eq_type == mujoco.mjtEq.mjEQ_WELD) & of_bodies
    found["eq_anchor1"], found["eq_quat1"] = model.eq_data[:, 3:6], model.eq_data[:, 6:10]
    found["tracking"] = model.cam_mode != mujoco.mjtCamLight.mjCAMLIGHT_FIXED
    return found


def compare(owner: Any, env: int | None, values: dict[str, Any]) -> None:
    used = {"eq_anchor2": values["connects"], "eq_anchor1": values["welds"], "eq_quat1": values["welds"], "cam_poscom0": values["tracking"]}
    for name in [*FIELDS, "eq_anchor2", "eq_anchor1", "eq_quat1"]:
        found, wanted = owner.param(name) if env is None else owner.param(name)[env], values[name]
        # Values that an element does not use are not compared.
        if name in used:
            found, wanted = found[used[name]], wanted[used[name]]
        scale = max(1e-6, float(np.max(np.abs(wanted), initial=0.0)))
        np.testing.assert_allclose(found, np.reshape(wanted, found.shape), rtol=0, atol=TOLERANCE * scale, err_msg=name)


@pytest.mark.parametrize("path", [*FEATURES, *(FOLDER / name for name in PUBLIC)], ids=lambda path: path.stem)
def test_constants_are_mujocos(path: Path) -> None:
    model = clench.Model.from_file(path, ignore_unsupported=True)
    mujocos = mujoco.MjModel.from_xml_path(str(path))
    rng = np.random.default_rng(7)
    rows = [changed(mujocos, rng) for _ in range(3)]
    sim, batch = clench.Sim(model), clench.Batch(model, 5)
    envs = [4, 0, 2]
    for name in rows[0]:
        sim.set_param(name, rows[0][name])
        batch.randomize(name, [row[name] for row in rows], envs)
    sim.set_constants()
    batch.set_constants(np.isin(np.arange(5), envs))
    compare(sim, None, expected(path, rows[0]))
    for env, row in zip(envs, rows, strict=True):
        compare(batch, env, expected(path, row))
    for name in FIELDS:
        np.testing.assert_array_equal(batch.param(name)[1], getattr(model, name), err_msg=name)


def test_randomizing_consistently_computes_the_constants_of_what_it_changed() -> None:
    model = example("humanoid")
    batch, other = clench.Batch(model, 6, "32"), clench.Batch(model, 6, "32")
    mass = model.body_mass * np.linspace(0.5, 2, 4)[:, None]
    batch.randomize("body_mass", mass, [0, 1, 4, 5], consistent=True)
    other.randomize("body_mass", mass, [0, 1, 4, 5])
    weights = batch.param("body_invweight0")
    assert np.all(weights[0, 1:, 0] > 1.5 * model.body_invweight0[1:, 0])
    np.testing.assert_array_equal(weights[2], model.body_invweight0.astype(np.float32))
    np.testing.assert_array_equal(other.param("body_invweight0")[0], model.body_invweight0.astype(np.float32))
    other.set_constants()
    same = [0, 1, 4, 5]
    for name in clench.PARAMETERS:
        np.testing.assert_array_equal(batch.param(name)[same], other.param(name)[same], err_msg=name)
    # The other two have the model's masses, rounded.
    np.testing.assert_allclose(other.param("body_invweight0")[2], weights[2], rtol=1e-6)
    batch.step(200)
    other.step(200)
    np.testing.assert_array_equal(batch.qpos[same], other.qpos[same])


def test_the_constants_of_a_model_are_its_own() -> None:
    for model in (puppet(), example("humanoid"), example("quadruped")):
        sim, batch = clench.Sim(model), clench.Batch(model, 2)
        sim.set_constants()
        batch.set_constants()
        for name in clench.PARAMETERS:
            scale = 1e-15 * max(1.0, float(np.max(np.abs(getattr(model, name)), initial=0.0, where=np.isfinite(getattr(model, name)))))
            np.testing.assert_allclose(sim.param(name), getattr(model, name), rtol=1e-14, atol=scale, err_msg=name)
            np.testing.assert_allclose(batch.param(name)[1], getattr(model, name), rtol=1e-14, atol=scale, err_msg=name)


def test_a_mass_matrix_that_is_not_positive_definite_is_told() -> None:
    model = example("humanoid")
    batch = clench.Batch(model, 3)
    before = {name: batch.param(name) for name in FIELDS}
    inertia = np.where(model.body_inertia > 0, 1e-300, 0.0)
    batch.randomize("dof_armature", np.zeros((1, model.nv)), [1])
    batch.randomize("body_inertia", inertia[None], [1])
    batch.randomize("body_mass", np.where(model.body_mass > 0, 1e-300, 0.0)[None], [1])
    with pytest.raises(ValueError, match=r"not positive definite in environment 1"):
        batch.set_constants()
    for name in FIELDS[1:]:
        np.testing.assert_array_equal(batch.param(name), before[name], err_msg=name)
    with pytest.raises(ValueError, match="mask"):
        batch.set_constants([True])


@pytest.mark.parametrize("kind", ["connect", "weld"])
def test_equalities_between_sites_follow_the_sites(kind: str) -> None:
    bodies = "".join(
        f'<body pos="{x} 0 1"><freejoint/><geom size=".1"/><site name="{name}" pos=".1 0 0" euler="10 20 30"/></body>'
        for name, x in (("a", 0), ("b", 0.3))
    )
    equality = f'<equality><{kind} site1="a" site2="b"/></equality>'
    text = f'<mujoco><option tolerance="0"/><worldbody>{bodies}</worldbody>{equality}</mujoco>'
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    sim, batch = clench.Sim(clench.Model.from_xml(text)), clench.Batch(clench.Model.from_xml(text), 2)
    rng = np.random.default_rng(0)
    model.site_pos += rng.uniform(-0.05, 0.05, model.site_pos.shape)
    model.site_quat += rng.uniform(-0.2, 0.2, model.site_quat.shape)
    model.site_quat /= np.linalg.norm(model.site_quat, axis=1, keepdims=True)
    model.site_sameframe[:] = 0
    for field in ("site_pos", "site_quat"):
        sim.set_param(field, getattr(model, field))
        batch.randomize(field, getattr(model, field)[None], [1])
    mujoco.mj_step(model, data, 5)
    sim.step(5)
    batch.step(5)
    np.testing.assert_allclose(sim.qpos, data.qpos, atol=1e-9)
    np.testing.assert_array_equal(batch.qpos[1], sim.qpos)
    assert np.abs(batch.qpos[0] - data.qpos).max() > 1e-3
