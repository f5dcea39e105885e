"""Models, simulations and batches in copies, pickles and other processes; steps in halves; controls by callback."""

from __future__ import annotations

import copy
import multiprocessing
import pickle
from pathlib import Path
from typing import Any

import clench
import numpy as np
import pytest
from scenes import ROOT, example, moving, puppet


def stepped(sim: clench.Sim) -> clench.State:
    sim.step(20)
    return sim.state


@pytest.mark.parametrize("model", [example("humanoid"), puppet()], ids=["file", "text"])
def test_a_model_survives_a_pickle(model: clench.Model) -> None:
    other = pickle.loads(pickle.dumps(model))
    assert stepped(clench.Sim(other)) == stepped(clench.Sim(model))
    assert copy.copy(model) is copy.deepcopy(model) is model


def test_a_file_that_changed_is_told(tmp_path: Path) -> None:
    path = tmp_path / "model.xml"
    path.write_text((ROOT / "models/pendulum.xml").read_text())
    data = pickle.dumps(clench.Model.from_file(path))
    path.write_text((ROOT / "models/four_bar.xml").read_text())
    with pytest.raises(ValueError, match="has changed"):
        pickle.loads(data)


@pytest.mark.parametrize("way", [copy.copy, copy.deepcopy, lambda own: pickle.loads(pickle.dumps(own))], ids=["copy", "deep", "pickle"])
@pytest.mark.parametrize("precision", ["64", "32"])
@pytest.mark.parametrize("kind", ["sim", "batch"])
def test_copies_move_on_to_the_bit(kind: str, precision: str, way: Any) -> None:
    own: Any = moving(kind, precision)
    own.body("arm").mass = 0.7
    own.options = clench.RigidOptions(iterations=7)
    other = way(own)
    assert other is not own and other.precision == precision and other.options.iterations == 7
    np.testing.assert_array_equal(other.param("body_mass"), own.param("body_mass"))
    own.step(20)
    other.step(20)
    assert other.state == own.state
    other.qpos[...] = 0
    assert other.state != own.state


@pytest.mark.parametrize("way", [copy.deepcopy, lambda own: pickle.loads(pickle.dumps(own))], ids=["deep", "pickle"])
@pytest.mark.parametrize("kind", ["sim", "batch"])
def test_views_are_copied_with_their_owner(kind: str, way: Any) -> None:
    own: Any = moving(kind)
    own.qpos[...] += 0.1
    owner, arm, params = way((own, own.body("arm"), own.params))
    np.testing.assert_array_equal(arm.mass, own.body("arm").mass)
    arm.mass = 0.7
    params.gravity = [0, 0, -1]
    np.testing.assert_array_equal(owner.body("arm").mass, arm.mass)
    np.testing.assert_array_equal(owner.param("gravity"), params.gravity)
    assert (own.param("gravity") != owner.param("gravity")).any()


@pytest.mark.parametrize("way", [copy.copy, copy.deepcopy, lambda own: pickle.loads(pickle.dumps(own))], ids=["copy", "deep", "pickle"])
def test_copies_of_a_batch_have_the_outputs_of_its_last_step(way: Any) -> None:
    own: Any = moving("batch")
    own.record("xpos", "qacc")
    own.step(20)
    other = way(own)
    for name in ("xpos", "qacc"):
        np.testing.assert_array_equal(other.output(name), own.output(name))
    other.qpos[0] += 0.1
    assert (other.xpos[0] != own.xpos[0]).any()
    np.testing.assert_array_equal(other.xpos[1:], own.xpos[1:])


def test_a_camera_survives_a_pickle() -> None:
    camera = clench.FreeCamera([1, 2, 3], 4, 5, 6, fovy=7)
    for other in (copy.deepcopy(camera), pickle.loads(pickle.dumps(camera))):
        for name in ("lookat", "distance", "azimuth", "elevation", "fovy"):
            assert getattr(other, name) == getattr(camera, name), name


@pytest.mark.parametrize("precision", ["64", "32"])
@pytest.mark.parametrize("kind", ["sim", "batch"])
def test_constants_survive_a_pickle(kind: str, precision: Any) -> None:
    model: Any = example("humanoid")
    own: Any = clench.Sim(model, precision=precision) if kind == "sim" else clench.Batch(model, 3, precision)
    own.params.body_mass = own.param("body_mass") * 1.1
    own.set_constants()
    other = copy.copy(own)
    for name in clench.PARAMETERS:
        np.testing.assert_array_equal(other.param(name), own.param(name), name)


def test_anchors_that_differ_from_their_sites_survive_a_pickle() -> None:
    bodies = "".join(f'<body name="{n}"><freejoint/><geom size=".1"/><site name="{n}"/></body>' for n in "ab")
    text = f'<mujoco><worldbody>{bodies}</worldbody><equality><weld site1="a" site2="b"/></equality></mujoco>'
    sim = clench.Sim(clench.Model.from_xml(text))
    sim.set_param("site_pos", np.full((2, 3), 0.1))
    sim.set_param("eq_anchor1", np.zeros((1, 3)))
    other = copy.copy(sim)
    for field in ("eq_anchor1", "eq_anchor2"):
        np.testing.assert_array_equal(other.param(field), sim.param(field))


@pytest.mark.parametrize("precision", ["64", "32"])
@pytest.mark.parametrize("kind", ["sim", "batch"])
def test_orientations_keep_their_bits_in_copies(kind: str, precision: str) -> None:
    own: Any = moving(kind, precision)
    assign, rng = own.set_param if kind == "sim" else own.randomize, np.random.default_rng(0)
    for field in ("body_quat", "body_iquat", "geom_quat", "jnt_axis"):
        for _ in range(5):
            assign(field, rng.normal(size=own.param(field).shape))
            np.testing.assert_array_equal(copy.copy(own).param(field), own.param(field))


def test_they_are_sent_to_spawned_workers() -> None:
    sim = moving("sim")
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        state = pool.apply(stepped, (sim,))
    assert state == stepped(sim)


@pytest.mark.parametrize("name", ["humanoid", "pinch", "quadruped", "toggled_weld"])
def test_two_halves_are_a_step(name: str) -> None:
    whole, halves = clench.Sim(example(name)), clench.Sim(example(name))
    for step in range(40):
        whole.ctrl = halves.ctrl = 0.1 * np.sin(step)
        whole.step()
        halves.step1()
        if step % 4 == 1:
            halves.xpos  # noqa: B018  What is read in between changes nothing.
        if step % 4 == 2:
            halves.qacc  # noqa: B018
        halves.step2()
        assert halves.state == whole.state
    halves.step1()
    halves.qvel[0] += 1
    whole.qvel[0] += 1
    halves.step2()
    whole.step()
    assert halves.state == whole.state


def test_a_controller_sees_the_positions_that_it_controls() -> None:
    model = example("pendulum")
    seen = []

    def control(sim: clench.Sim) -> None:
        seen.append((sim.time, sim.xpos.copy()))
        sim.qfrc_applied[0] = -sim.qvel[0]

    sim, own = clench.Sim(model), clench.Sim(model)
    for each in (sim, own):
        each.qpos[0] = 1
    sim.step(10, control)
    for time, xpos in seen:
        assert own.time == time
        own.forward()
        np.testing.assert_array_equal(own.xpos, xpos)
        own.qfrc_applied[0] = -own.qvel[0]
        own.step()
    assert sim.state == own.state and len(seen) == 10
    with pytest.raises(ZeroDivisionError):
        sim.step(3, lambda sim: 1 / 0)


def test_a_rollout_starts_from_one_state_for_all() -> None:
    model = example("pendulum")
    batch = clench.Batch(model, 5)
    row = np.concatenate([[0.25], model.qpos0 + 0.3, np.zeros(model.nv)])
    one = batch.rollout(row, steps=7)
    each = batch.rollout(np.tile(row, (5, 1)), steps=7)
    np.testing.assert_array_equal(one["qpos"], each["qpos"])
    with pytest.raises(ValueError, match="initial has shape"):
        batch.rollout(row[:-1], steps=7)
