"""Constraints at run time: `add_weld`, `add_connect`, `remove`, `weld_here`."""

from __future__ import annotations

import pickle

import clench
import numpy as np
import pytest
from scenes import ROOT, example


def gripping() -> tuple[clench.Sim, int]:
    """Returns a simulation in which the cup holds the box."""
    sim = clench.Sim(example("suction_gripper"))
    sim.ctrl = [0.3, -0.475]
    sim.step(750)
    assert len(sim.contacts.between("cup", "box")) > 0
    return sim, sim.add_weld("cup", "box")


def test_a_box_is_lifted_and_let_go() -> None:
    sim, grip = gripping()
    assert sim.dynamic_constraints == [grip]
    sim.actuator("z").ctrl = 0
    sim.step(1000)
    assert sim.body("box").xpos[2] > 0.5
    kinds = sim.constraints.kind
    assert kinds.count("dynamic") == 6
    weight = 9.81 * sim.body("box").mass
    np.testing.assert_allclose(sim.body("box").cfrc_ext[3:], [0, 0, weight], atol=0.05)
    sim.remove(grip)
    sim.step(1000)
    np.testing.assert_allclose(sim.body("box").xpos[2], 0.08, atol=1e-3)
    assert sim.dynamic_constraints == []
    with pytest.raises(ValueError, match="it was removed"):
        sim.remove(grip)


def test_states_carry_what_is_held() -> None:
    sim, grip = gripping()
    state = sim.state
    sim.actuator("z").ctrl = 0
    state.ctrl = sim.ctrl.copy()
    sim.step(300)
    for copy in (state, pickle.loads(pickle.dumps(state)), clench.State.from_bytes(state.to_bytes())):
        other = clench.Sim(sim.model)
        other.state = copy
        other.step(300)
        assert other.state == sim.state
        other.remove(grip)
    sim.reset()
    with pytest.raises(ValueError, match="does not exist"):
        sim.remove(grip)


def test_environments_hold_what_each_was_told_to() -> None:
    sim, _ = gripping()
    batch = clench.Batch(sim.model, 4, record=["xpos"])
    sim.reset()
    batch.ctrl = [0.3, -0.475]
    batch.step(750)
    grips = batch.add_weld("cup", "box", [1, 3])
    assert grips.shape == (2,) and grips.dtype == np.int64
    batch.ctrl[:, 1] = 0
    batch.step(1000)
    heights = batch.body("box").xpos[:, 2]
    assert (heights[[1, 3]] > 0.5).all() and (heights[[0, 2]] < 0.1).all()
    with pytest.raises(ValueError, match="does not exist"):
        batch.remove(grips, [1, 2])
    batch.remove(grips[1:], [3])
    batch.step(1000)
    heights = batch.body("box").xpos[:, 2]
    assert heights[1] > 0.5 and (heights[[0, 2, 3]] < 0.1).all()
    assert batch.sim(1).dynamic_constraints == [grips[0]]


def test_a_connect_lets_turn_and_holds_the_point() -> None:
    sim = clench.Sim(example("suction_gripper"))
    sim.joint("box").qpos[2] = 0.4
    sim.add_connect("box", "world", [0.08, 0.08, 0.08])
    corner = np.array([0.38, 0.08, 0.48])
    sim.step(200)
    box = sim.body("box")
    np.testing.assert_allclose(box.xpos + box.xmat.reshape(3, 3) @ [0.08, 0.08, 0.08], corner, atol=5e-3)
    assert abs(box.xmat[0] - 1) > 0.1


def test_slots_are_as_many_as_the_model_says() -> None:
    model = clench.Model.from_file(ROOT / "models/suction_gripper.xml", max_dynamic_constraints=1)
    sim = clench.Sim(model)
    assert model.max_dynamic_constraints == 1 and sim.dynamic_kind.shape == (1,)
    sim.add_weld("cup", "box")
    with pytest.raises(ValueError, match="all 1 slots"):
        sim.add_weld("gantry", "box")
    with pytest.raises(ValueError, match="they are the same body"):
        clench.Sim(example("suction_gripper")).add_weld("cup", "cup")
    with pytest.raises(ValueError, match='there is no body "cop"; did you mean "cup"'):
        sim.add_weld("cop", "box")


def test_an_equality_of_the_file_holds_the_present_pose() -> None:
    model = example("toggled_weld")
    sim, batch = clench.Sim(model), clench.Batch(model, 3)
    sim.joint("crate").qpos[:3] = [0.1, 0.05, 0.4]
    batch.joint("crate").qpos[1:, :3] = [0.1, 0.05, 0.4]
    sim.weld_here("grip")
    batch.weld_here("grip", [1])
    assert sim.equality("grip").active and batch.eq_active[:, 0].tolist() == [False, True, False]
    np.testing.assert_allclose(sim.constraints.pos[:6], 0, atol=1e-12)
    sim.step(100)
    batch.step(100)
    np.testing.assert_array_equal(batch.qpos[1], sim.qpos)
    assert batch.qpos[2, 4] != sim.qpos[4]


def test_copies_never_give_the_number_of_what_was_removed() -> None:
    model = example("suction_gripper")
    sim, batch = clench.Sim(model), clench.Batch(model, 2)
    gone = sim.add_weld("cup", "box")
    sim.remove(gone)
    (also_gone,) = batch.add_weld("cup", "box", envs=[1])
    batch.remove([also_gone], envs=[1])
    twin, twins = (pickle.loads(pickle.dumps(own)) for own in (sim, batch))
    assert twin.add_weld("cup", "box") == sim.add_weld("cup", "box") != gone
    np.testing.assert_array_equal(twins.add_weld("cup", "box"), batch.add_weld("cup", "box"))
    with pytest.raises(ValueError, match="does not exist"):
        twins.remove([also_gone], envs=[1])
