"""`clench.Batch`: many environments."""

from __future__ import annotations

from typing import Any

import clench
import numpy as np
import pytest
from scenes import FIELDS, ball, example, poisoned, puppet, same_bits, same_state


@pytest.mark.parametrize("precision", ["64", "32"])
def test_state_arrays_are_the_state(precision: Any) -> None:
    model = puppet()
    batch = clench.Batch(model, 3, precision)
    shapes = {
        "time": (),
        "qpos": (model.nq,),
        "qvel": (model.nv,),
        "act": (model.na,),
        "history": (model.nhistory,),
        "ctrl": (model.nu,),
        "qfrc_applied": (model.nv,),
        "xfrc_applied": (model.nbody, 6),
        "mocap_pos": (model.nmocap, 3),
        "mocap_quat": (model.nmocap, 4),
        "eq_active": (model.neq,),
        "qacc_warmstart": (model.nv,),
    }
    number = np.float64 if precision == "64" else np.float32
    special = {"time": np.float64, "eq_active": bool}
    for name, shape in shapes.items():
        array = getattr(batch, name)
        assert array.shape == (3, *shape), name
        assert array.dtype == special.get(name, number), name
        assert array is getattr(batch, name), name
        assert array.flags.writeable and array.flags.c_contiguous and not array.flags.owndata, name
    np.testing.assert_array_equal(batch.qpos, np.tile(model.qpos0.astype(number), (3, 1)))
    assert len(batch) == batch.n_envs == 3 and batch.precision == precision


def test_writes_take_effect_where_they_are() -> None:
    batch = clench.Batch(example("pendulum"), 4)
    qvel = batch.qvel
    batch.ctrl[2] = 3
    batch.step()
    assert (qvel[[0, 1, 3]] == qvel[0]).all() and qvel[2] != qvel[0]
    batch.time[1] = 5
    batch.step()
    np.testing.assert_allclose(batch.time, np.array([2, 1, 2, 2]) * 0.002 + [0, 5, 0, 0])
    batch.qpos = np.arange(4)[:, None] / 10
    np.testing.assert_array_equal(batch.qpos[:, 0], np.arange(4) / 10)
    batch.qvel = 0
    assert (batch.qvel == 0).all()
    for bad, error in ((np.zeros(3), ValueError), (np.zeros((4, 2)), ValueError), ("x", TypeError), (1j, TypeError)):
        with pytest.raises(error):
            batch.qpos = bad
    np.testing.assert_array_equal(batch.qpos[:, 0], np.arange(4) / 10)


def test_many_steps_are_steps() -> None:
    one, all_at_once = (clench.Batch(example("humanoid"), 5, threads=2, record=["cvel"]) for _ in range(2))
    for batch in (one, all_at_once):
        batch.reset(keyframe="falling")
        batch.qvel += np.linspace(-1, 1, batch.qvel.size).reshape(batch.qvel.shape)
    for _ in range(101):
        assert one.step() == 0
    assert all_at_once.step(101) == 0
    assert same_state(one.state, all_at_once.state)
    assert same_bits(one.cvel, all_at_once.cvel)
    before = one.state
    assert one.step(0) == 0
    assert same_state(one.state, before)


@pytest.mark.parametrize("n", [-1, 1.5, "2", None, 2**64])
def test_counts_that_make_no_sense(n: Any) -> None:
    batch = clench.Batch(ball(), 2)
    with pytest.raises((TypeError, ValueError)):
        batch.step(n)
    assert (batch.time == 0).all()


def test_reset_of_some() -> None:
    batch = clench.Batch(puppet(), 4)
    initial = batch.state
    batch.reset(keyframe="bent")
    np.testing.assert_array_equal(batch.ctrl, [[0.2, -0.3]] * 4)
    np.testing.assert_array_equal(batch.time, 1)
    batch.step(20)
    moved = batch.state
    batch.reset([True, False, False, True])
    for name in FIELDS:
        now = getattr(batch, name)
        assert same_bits(now[[0, 3]], getattr(initial, name)[[0, 3]]), name
        assert same_bits(now[[1, 2]], getattr(moved, name)[[1, 2]]), name
    batch.reset(np.array([False, True, False, False]), 0)
    np.testing.assert_array_equal(batch.act, [[0], [0.5], moved.act[2], [0]])
    batch.reset(np.zeros(4, bool))
    np.testing.assert_array_equal(batch.time[1], 1)
    batch.reset()
    assert same_state(batch.state, initial)


MASKS_THAT_MAKE_NO_SENSE = [
    pytest.param([True], ValueError, id="short"),
    pytest.param([True] * 6, ValueError, id="long"),
    pytest.param([[True] * 5], ValueError, id="square"),
    pytest.param(True, ValueError, id="one"),
    pytest.param([1, 0, 0, 0, 1], TypeError, id="integers"),
    pytest.param([0.5] * 5, TypeError, id="floats"),
    pytest.param("yes", TypeError, id="text"),
    pytest.param([None] * 5, TypeError, id="none"),
]


@pytest.mark.parametrize(("mask", "error"), MASKS_THAT_MAKE_NO_SENSE)
@pytest.mark.parametrize("method", ["reset", "revive", "forward"])
def test_masks_that_make_no_sense(method: str, mask: Any, error: type[Exception]) -> None:
    batch = poisoned()
    before, status = batch.state, batch.status
    with pytest.raises(error):
        getattr(batch, method)(mask)
    assert same_state(batch.state, before)
    np.testing.assert_array_equal(batch.status, status)


def test_keyframes_that_there_are_not() -> None:
    batch = clench.Batch(example("quadruped"), 2)
    batch.step(3)
    before = batch.state
    cases: list[tuple[Any, type[Exception]]] = [("drop", ValueError), (2, IndexError), (-1, IndexError), (0.5, TypeError)]
    for bad, error in cases:
        with pytest.raises(error):
            batch.reset(keyframe=bad)
    assert same_state(batch.state, before)


@pytest.mark.parametrize("precision", ["64", "32"])
def test_the_clock_has_64_bits(precision: Any) -> None:
    batch = clench.Batch(ball(), 2, precision)
    assert batch.time.dtype == np.float64 and batch.state.time.dtype == np.float64
    batch.time[:] = 30_000
    batch.step(100)
    np.testing.assert_allclose(batch.time, 30_000 + 100 * batch.model.timestep, rtol=0, atol=1e-7)
    sim = clench.Sim(ball(), precision=precision)
    sim.time = 1e6 + 0.001
    assert sim.time == 1e6 + 0.001 and clench.State.from_bytes(sim.state.to_bytes()).time == sim.time


@pytest.mark.parametrize("precision", ["64", "32"])
@pytest.mark.parametrize("field", clench.PARAMETERS)
def test_parameters_of_environments(field: str, precision: Any) -> None:
    model = puppet()
    batch = clench.Batch(model, 5, precision)
    number = batch.qpos.dtype
    shared = np.asarray(getattr(model, field)).astype(number)
    values = batch.param(field)
    assert values.shape == (5, *shared.shape) and values.dtype == number
    np.testing.assert_array_equal(values, np.broadcast_to(shared, values.shape))
    try:
        batch.randomize(field, shared[None].repeat(2, axis=0), [3, 1])
    except ValueError as error:
        assert "is computed from" in str(error)
        np.testing.assert_array_equal(batch.param(field), values)
        return
    # Unit vectors are normalized again.
    np.testing.assert_allclose(batch.param(field), values, rtol=4 * np.finfo(number).eps, atol=1e-30)
    assert batch.step(2) == 0


def test_randomize() -> None:
    batch = clench.Batch(ball(), 4)
    mass = batch.model.body_mass
    batch.randomize("body_mass", mass * np.arange(1, 5)[:, None])
    np.testing.assert_array_equal(batch.param("body_mass")[:, 1], [2, 4, 6, 8])
    batch.randomize("body_mass", [mass * 10], envs=[2])
    batch.randomize("body_mass", np.stack([mass * 7, mass * 8]), envs=np.array([3, 0], np.uint8))
    np.testing.assert_array_equal(batch.param("body_mass")[:, 1], [16, 4, 20, 14])
    np.testing.assert_array_equal(batch.param("body_subtreemass")[:, 0], [16, 4, 20, 14])
    np.testing.assert_array_equal(batch.model.body_mass, mass)
    batch.xfrc_applied[:, 1, 0] = 8
    batch.qpos[:, 2] = 1
    batch.record("qacc")
    batch.forward()
    np.testing.assert_allclose(batch.qacc[:, 0], [0.5, 2, 0.4, 8 / 14], rtol=1e-12)
    batch.reset()
    np.testing.assert_array_equal(batch.param("body_mass")[:, 1], [16, 4, 20, 14])
    batch.randomize("body_mass", np.zeros((0, 2)), envs=[])
    batch.randomize("timestep", [0.001, 0.002, 0.003, 0.004])
    batch.step()
    np.testing.assert_array_equal(batch.time, [0.001, 0.002, 0.003, 0.004])
    batch.randomize("gravity", [[0, 0, -1]], [1])
    np.testing.assert_array_equal(batch.param("gravity")[:, 2], [-9.81, -1, -9.81, -9.81])


@pytest.mark.parametrize(
    ("field", "values", "envs", "error"),
    [
        ("body_mas", [[0, 1]] * 3, None, ValueError),
        ("body_mass", [0, 1], None, ValueError),
        ("body_mass", [[0, 1]], None, ValueError),
        ("body_mass", [[0, 1, 2]] * 3, None, ValueError),
        ("body_mass", [[0, 1], [0, 2], [0, -1]], None, ValueError),
        ("body_mass", [[0, 1], [0, np.nan], [0, 1]], None, ValueError),
        ("body_mass", [["a", "b"]] * 3, None, TypeError),
        ("body_mass", None, None, TypeError),
        ("body_mass", [[0, 1]], [3], IndexError),
        ("body_mass", [[0, 1]], [-1], IndexError),
        ("body_mass", [[0, 1]], [2**63], (IndexError, OverflowError)),
        ("body_mass", [[0, 1]], [0.0], TypeError),
        ("body_mass", [[0, 1]], [True], TypeError),
        ("body_mass", [[0, 1]], 0, ValueError),
        ("body_mass", [[0, 1]], [[0]], ValueError),
        ("body_mass", [[0, 1]], "0", TypeError),
        ("body_subtreemass", [[1, 1]] * 3, None, ValueError),
        ("geom_size", np.zeros((3, 2, 3)), None, ValueError),
    ],
)
def test_randomizing_that_makes_no_sense(field: str, values: Any, envs: Any, error: type[Exception]) -> None:
    batch, other = clench.Batch(ball(), 3), clench.Batch(ball(), 3)
    with pytest.raises(error):
        batch.randomize(field, values, envs)
    for name in clench.PARAMETERS:
        assert same_bits(batch.param(name), other.param(name)), name
    batch.step(3)
    other.step(3)
    assert same_state(batch.state, other.state)


def test_recorded_outputs() -> None:
    batch = clench.Batch(puppet(), 3, record=["xpos"])
    assert list(batch.outputs) == ["xpos"]
    xpos = batch.xpos
    assert xpos is batch.output("xpos") and xpos.shape == (3, batch.model.nbody, 3)
    assert not xpos.flags.writeable
    np.testing.assert_array_equal(xpos[1], batch.sim(1).xpos)
    batch.step()
    batch.record("cvel", "xpos", "cvel")
    assert list(batch.outputs) == ["xpos", "cvel"] and batch.xpos is xpos
    assert batch.cvel.shape == (3, batch.model.nbody, 6)
    np.testing.assert_array_equal(batch.cvel[2], batch.sim(2).cvel)
    batch.record(*clench.OUTPUTS)
    assert list(batch.outputs[:2]) == ["xpos", "cvel"] and set(batch.outputs) == set(clench.OUTPUTS)
    batch.record()
    batch.step(10)
    assert batch.xpos is xpos
    for name in clench.OUTPUTS:
        output = batch.output(name)
        shape = np.shape(batch.sim(0).output(name))
        assert output.shape == (3, *shape) and not output.flags.writeable, name
        with pytest.raises(ValueError):
            output.flags.writeable = True
    np.testing.assert_array_equal(batch.output("qpos"), batch.qpos)


def test_outputs_that_are_not_recorded() -> None:
    batch = clench.Batch(ball(), 2)
    with pytest.raises(ValueError, match="record"):
        batch.output("cvel")
    with pytest.raises(AttributeError, match="record"):
        batch.cvel
    with pytest.raises(ValueError, match="cvel"):
        batch.output("cvell")
    with pytest.raises(AttributeError):
        getattr(batch, "cvell")
    with pytest.raises(ValueError, match="cvel"):
        batch.record("xpos", "cvell")
    assert batch.outputs == ()
    with pytest.raises(ValueError):
        clench.Batch(ball(), 2, record=["cvell"])
    wrong: list[Any] = [3, [3], [["xpos"]]]
    for bad in wrong:
        with pytest.raises(TypeError):
            clench.Batch(ball(), 2, record=bad)
        with pytest.raises(TypeError):
            batch.record(bad)


def test_forward_of_some() -> None:
    batch = clench.Batch(example("quadruped"), 4, record=["xpos", "qacc", "cfrc_ext"])
    batch.step(20)
    # Views are held, since another request would update the outputs after writes.
    views = {name: batch.output(name) for name in batch.outputs}
    before, state = {name: view.copy() for name, view in views.items()}, batch.state
    batch.qpos[:, 2] += 0.5
    moved = batch.state
    assert batch.forward([True, False, True, False]) == 0
    assert same_state(batch.state, moved)
    for name in batch.outputs:
        for env in (1, 3):
            assert same_bits(views[name][env], before[name][env]), name
        for env in (0, 2):
            sim = batch.sim(env)
            sim.forward()
            assert same_bits(views[name][env], sim.output(name)), name
    assert batch.forward() == 0
    np.testing.assert_allclose(batch.xpos[:, 1, 2], moved.qpos[:, 2])
    batch.qpos[:] = np.nan
    assert batch.forward(np.zeros(4, bool)) == 0
    assert batch.forward([False, False, True, False]) == 1
    np.testing.assert_array_equal(batch.running, [True, True, False, True])
    batch.state = state
    assert batch.running.all() and batch.step() == 0


def test_states() -> None:
    batch = clench.Batch(puppet(), 3, threads=2)
    batch.reset(keyframe="bent")
    batch.step(30)
    kept = batch.state
    batch.step(30)
    after = batch.state
    assert not same_state(kept, after)
    batch.qvel[1, 0] = np.nan
    batch.step()
    assert not batch.running.all()
    batch.state = kept
    assert batch.running.all()
    batch.step(30)
    assert same_state(batch.state, after)


def test_sizes() -> None:
    model = ball()
    plain, recording = clench.Batch(model, 100), clench.Batch(model, 100, record=["cvel", "energy"])
    single = clench.Batch(model, 100, "32")
    # Time, 7 positions, 6 velocities, applied forces and accelerations, 6 forces of both bodies.
    numbers = 1 + 7 + 6 + 6 + 6 + 12
    assert plain.bytes_per_env >= 8 * numbers
    # The recorded outputs, and the positions and velocities to which they belong.
    assert recording.bytes_per_env == plain.bytes_per_env + 8 * (2 * 6 + 2 + 7 + 6)
    assert single.bytes_per_env < plain.bytes_per_env
    before = plain.bytes_per_env
    plain.randomize("body_mass", np.ones((100, 2)))
    assert plain.bytes_per_env > before
    assert plain.lanes >= 1 and single.lanes >= plain.lanes


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        ({"n_envs": -1}, ValueError),
        ({"n_envs": 2.0}, TypeError),
        ({"n_envs": "2"}, TypeError),
        ({"n_envs": None}, TypeError),
        ({"n_envs": 2**64}, ValueError),
        ({"n_envs": 2**32}, (ValueError, MemoryError)),
        ({"n_envs": 2**32 - 1}, MemoryError),
        ({"precision": "16"}, ValueError),
        ({"precision": 64}, TypeError),
        ({"threads": -1}, ValueError),
        ({"threads": 0}, ValueError),
        ({"threads": 1.5}, TypeError),
        ({"options": {}}, TypeError),
        ({"model": None}, TypeError),
        ({"record": "cvel"}, TypeError),
        ({"surprise": 1}, TypeError),
    ],
)
def test_batches_that_make_no_sense(arguments: Any, error: type[Exception]) -> None:
    with pytest.raises(error):
        clench.Batch(**({"model": ball(), "n_envs": 2} | arguments))


def test_empty_batches() -> None:
    batch = clench.Batch(ball(), 0, record=["xpos"])
    assert batch.qpos.shape == (0, 7) and batch.xpos.shape == (0, 2, 3)
    assert batch.step(3) == 0 and batch.forward() == 0
    batch.reset()
    batch.revive([])
    batch.randomize("body_mass", np.zeros((0, 2)))
    assert batch.rollout(steps=2)["qpos"].shape == (0, 2, 7)
    assert clench.State.from_bytes(batch.state.to_bytes()).qpos.shape == (0, 7)
    with pytest.raises(IndexError):
        batch.sim(0)


def test_models_without_anything() -> None:
    model = clench.Model.from_xml("<mujoco><worldbody/></mujoco>")
    sim, batch = clench.Sim(model), clench.Batch(model, 3, record=clench.OUTPUTS)
    sim.step(3)
    assert batch.step(3) == 0
    assert batch.qpos.shape == (3, 0) and batch.xpos.shape == (3, 1, 3)
    assert batch.rollout(steps=2, record=["qpos", "time"])["time"].shape == (3, 2)
    sim.state = clench.State.from_bytes(sim.state.to_bytes())
    assert sim.mass_matrix().shape == (0, 0)


def test_what_it_is_made_of() -> None:
    model, options = ball(), clench.RigidOptions(iterations=7)
    batch = clench.Batch(model, 2, "32", 1, options=options)
    assert batch.model is model and batch.options == options
    assert repr(batch) == f'<clench.Batch of 2 x "ball", 32 bits, {batch.lanes} lanes, 1 threads>'
    assert {"xpos", "step", "qpos"} <= set(dir(clench.Batch(model, 2, record=["xpos"])))
