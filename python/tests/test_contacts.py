"""`Sim.contacts` and `Sim.constraints`: forces are in the documented frames."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import clench
import numpy as np
import pytest
from scenes import ball, example, puppet

GRAVITY = 9.81


def resting(model: clench.Model, steps: int, keyframe: str | None = None, **options: Any) -> clench.Sim:
    sim = clench.Sim(model, clench.RigidOptions(tolerance=0, iterations=200, **options))
    sim.reset(keyframe)
    sim.step(steps)
    sim.forward()
    return sim


def test_a_resting_ball_weighs_what_it_weighs() -> None:
    sim = resting(ball(), 2000)
    contacts = sim.contacts
    assert len(contacts) == 1
    assert contacts.geom_names == [("floor", "ball")]
    np.testing.assert_array_equal(contacts.geom, [[0, 1]])
    np.testing.assert_array_equal(contacts.dim, [3])
    np.testing.assert_allclose(contacts.force, [[2 * GRAVITY, 0, 0, 0, 0, 0]], atol=1e-6)
    np.testing.assert_allclose(contacts.wrench, [[0, 0, 2 * GRAVITY, 0, 0, 0]], atol=1e-6)
    np.testing.assert_allclose(contacts.frame[0, 0], [0, 0, 1], atol=1e-12)
    assert -1e-2 < contacts.dist[0] < 0
    np.testing.assert_allclose(contacts.pos[0], [0, 0, contacts.dist[0] / 2], atol=1e-12)
    assert contacts.includemargin[0] == 0
    np.testing.assert_allclose(contacts.friction[0], [1, 1, 0.005, 0.0001, 0.0001])


@pytest.mark.parametrize("name", ["humanoid", "quadruped", "pinch", "box_stack", "rolling_sphere"])
def test_frames_turn_forces_into_wrenches(name: str) -> None:
    sim = clench.Sim(example(name))
    sim.qvel += np.linspace(-0.5, 0.5, sim.model.nv)
    sim.step(150)
    contacts = sim.contacts
    count = len(contacts)
    assert count > 0
    assert contacts.force.shape == contacts.wrench.shape == (count, 6)
    assert contacts.frame.shape == (count, 3, 3) and contacts.friction.shape == (count, 5)
    frame = contacts.frame
    np.testing.assert_allclose(frame @ frame.transpose(0, 2, 1), np.broadcast_to(np.eye(3), frame.shape), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(frame), 1, atol=1e-12)
    # The rows of the frame are its axes: a force is the sum of components along them.
    for part in (slice(0, 3), slice(3, 6)):
        world = np.einsum("cij,ci->cj", frame, contacts.force[:, part])
        np.testing.assert_allclose(contacts.wrench[:, part], world, atol=1e-9 * np.abs(world).max())
    # Friction is in its cone, and normal forces do not pull.
    normal, sliding = contacts.force[:, 0], contacts.force[:, 1:3] / contacts.friction[:, :2]
    assert (normal >= 0).all() and normal.max() > 0
    assert (np.abs(sliding).max(axis=1) <= normal * (1 + 1e-6) + 1e-9).all()


@pytest.mark.parametrize("name", ["humanoid", "quadruped", "pinch", "box_stack"])
def test_contact_forces_add_up_on_bodies(name: str) -> None:
    sim = resting(example(name), 150)
    model, contacts = sim.model, sim.contacts
    total = np.zeros((model.nbody, 6))
    for geoms, pos, wrench in zip(contacts.geom, contacts.pos, contacts.wrench, strict=True):
        for geom, sign in zip(geoms, (-1, 1), strict=True):
            body = model.geom_bodyid[geom]
            force, torque = sign * wrench[:3], sign * wrench[3:]
            total[body, :3] += force
            total[body, 3:] += torque + np.cross(pos - sim.xipos[body], force)
    total[0] = sim.contact_force[0]
    np.testing.assert_allclose(total, sim.contact_force, atol=1e-9 * (1 + np.abs(total).max()))
    assert sim.contact_count == len(contacts)


@pytest.mark.parametrize(
    ("make", "keyframe"),
    [
        pytest.param(lambda: example("humanoid"), "standing", id="humanoid"),
        pytest.param(lambda: example("quadruped"), "dropped", id="quadruped"),
        pytest.param(lambda: example("pinch"), None, id="pinch"),
        pytest.param(lambda: example("four_bar"), "driven", id="four_bar"),
        pytest.param(lambda: example("pendulum"), "against_stop", id="pendulum"),
        pytest.param(puppet, "bent", id="puppet"),
    ],
)
def test_rows_make_up_the_constraint_force(make: Callable[[], Any], keyframe: Any) -> None:
    sim = resting(make(), 200, keyframe)
    rows = sim.constraints
    count, nv = len(rows), sim.model.nv
    assert count > 0
    assert rows.J.shape == (count, nv)
    assert len(rows.kind) == len(rows.name) == count
    for name in ("id", "pos", "margin", "vel", "aref", "D", "impedance", "frictionloss", "force"):
        assert getattr(rows, name).shape == (count,), name
    scale = 1 + np.abs(sim.qfrc_constraint).max()
    np.testing.assert_allclose(rows.J.T @ rows.force, sim.qfrc_constraint, atol=1e-9 * scale)
    np.testing.assert_allclose(rows.J @ sim.qvel, rows.vel, atol=1e-9 * (1 + np.abs(rows.vel).max()))
    assert ((rows.impedance > 0) & (rows.impedance < 1)).all()
    assert (rows.D > 0).all()


def test_rows_of_equalities_and_limits_push_as_their_costs_say() -> None:
    sim = resting(puppet(), 200, "bent")
    rows = sim.constraints
    kinds = np.array(rows.kind)
    residual = rows.J @ sim.qacc - rows.aref
    held = kinds == "equality"
    assert held.sum() == 6 and set(np.array(rows.name)[held]) == {"held"} and set(rows.id[held]) == {0}
    np.testing.assert_allclose(rows.force[held], -(rows.D * residual)[held], rtol=1e-6, atol=1e-8)
    dry = kinds == "friction_dof"
    assert dry.sum() == 1 and np.array(rows.name)[dry] == ["elbow"] and rows.frictionloss[dry] == [0.02]
    assert np.abs(rows.force[dry]) <= 0.02
    assert (rows.frictionloss[~dry] == 0).all()

    sim.reset("bent")
    sim.eq_active[:] = True
    sim.forward()
    assert set(sim.constraints.name) >= {"held", "coupled"}

    stopped = clench.Sim(example("pendulum"))
    stopped.reset("against_stop")
    stopped.step(5)
    rows = stopped.constraints
    limit = rows.kind.index("limit_joint")
    assert rows.name[limit] == "bearing" and rows.force[limit] > 0
    residual = rows.J[limit] @ stopped.qacc - rows.aref[limit]
    assert rows.force[limit] == pytest.approx(-rows.D[limit] * residual, rel=1e-6)


def test_pyramids_and_cones_agree_with_contacts() -> None:
    for cone in ("pyramidal", "elliptic"):
        sim = resting(example("box_stack"), 100, "struck", friction_cone=cone)
        rows, contacts = sim.constraints, sim.contacts
        kinds = np.array(rows.kind)
        assert set(kinds) == {"contact"}
        for index in range(len(contacts)):
            own = rows.force[rows.id == index]
            assert own.size in ((0, 4) if cone == "pyramidal" else (0, 3))
            normal = own.sum() if cone == "pyramidal" else own[:1].sum()
            assert contacts.force[index, 0] == pytest.approx(normal, abs=1e-9 * (1 + abs(normal)))


def test_arrays_are_copies() -> None:
    sim = clench.Sim(example("box_stack"))
    sim.step(20)
    contacts, rows = sim.contacts, sim.constraints
    kept = contacts.dist.copy(), rows.force.copy()
    sim.reset("dropped")
    sim.step()
    np.testing.assert_array_equal(contacts.dist, kept[0])
    np.testing.assert_array_equal(rows.force, kept[1])
    contacts.dist[:] = 7
    assert (sim.contacts.dist != 7).all()


def test_without_any() -> None:
    sim = clench.Sim(ball())
    sim.qpos[2] = 5
    for _ in range(2):
        assert len(sim.contacts) == len(sim.constraints) == 0
        assert sim.contacts.frame.shape == (0, 3, 3)
        assert sim.contacts.geom.shape == (0, 2)
        assert sim.constraints.J.shape == (0, 6)
        sim.step()
    assert sim.contact_count == 0


def test_kinds_of_numbers() -> None:
    sim = clench.Sim(example("quadruped"), precision="32")
    sim.step(10)
    contacts, rows = sim.contacts, sim.constraints
    for name in ("dist", "pos", "frame", "includemargin", "friction", "force", "wrench"):
        assert getattr(contacts, name).dtype == np.float64, name
    for name in ("geom", "dim"):
        assert getattr(contacts, name).dtype == np.int64, name
    for name in ("pos", "margin", "vel", "aref", "D", "impedance", "frictionloss", "force", "J"):
        assert getattr(rows, name).dtype == np.float64, name
    assert rows.id.dtype == np.int64
    assert repr(contacts) == f"<clench.Contacts: {len(contacts)}>"
    assert repr(rows) == f"<clench.Constraints: {len(rows)} rows>"
