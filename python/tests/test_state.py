"""`clench.State`: stored states, in memory and as bytes."""

from __future__ import annotations

import copy
import io
import pathlib
import pickle
import random
import subprocess
import sys
import tracemalloc
import warnings
import zipfile
from typing import Any

import clench
import numpy as np
import pytest
from scenes import FIELDS, PUPPET, example, moving, puppet, same_bits, same_state

CONTINUE = """
import pathlib, sys
import clench
folder = pathlib.Path(sys.argv[1])
model = clench.Model.from_xml((folder / "model.xml").read_text())
state = clench.State.from_bytes((folder / "before").read_bytes())
if state.qpos.ndim == 1:
    own = clench.Sim(model, precision=sys.argv[2])
else:
    own = clench.Batch(model, len(state.qpos), sys.argv[2])
own.state = state
own.step(100)
(folder / "after").write_bytes(own.state.to_bytes())
"""


@pytest.mark.parametrize("precision", ["64", "32"])
@pytest.mark.parametrize("kind", ["sim", "batch"])
def test_bytes_survive_a_restart(kind: str, precision: Any, tmp_path: pathlib.Path) -> None:
    own = moving(kind, precision)
    (tmp_path / "model.xml").write_text(PUPPET)
    (tmp_path / "before").write_bytes(own.state.to_bytes())
    own.step(100)
    subprocess.run([sys.executable, "-c", CONTINUE, str(tmp_path), precision], check=True, timeout=60)
    assert same_state(clench.State.from_bytes((tmp_path / "after").read_bytes()), own.state)


@pytest.mark.parametrize("precision", ["64", "32"])
@pytest.mark.parametrize("kind", ["sim", "batch"])
def test_assigning_brings_it_back(kind: str, precision: Any) -> None:
    own = moving(kind, precision)
    state = own.state
    assert same_state(own.state, state) and own.state is not state
    for name in FIELDS:
        assert not np.shares_memory(getattr(state, name), getattr(own, name)), name
    own.step(30)
    after = own.state
    own.reset()
    own.xfrc_applied[..., 0] = 9
    own.state = state
    assert same_state(own.state, state)
    own.step(30)
    assert same_state(own.state, after)
    again = clench.State.from_bytes(state.to_bytes())
    own.state = again
    own.step(30)
    assert same_state(own.state, after)


def test_it_can_be_changed_and_made() -> None:
    sim = moving("sim")
    state = sim.state
    state.qvel[:] = 0.25
    state.eq_active = np.array([False, False])
    sim.state = state
    assert (sim.qvel == 0.25).all() and not sim.eq_active.any()
    made = clench.State(**{name: np.array(getattr(sim, name)) for name in FIELDS})
    assert same_state(made, sim.state)
    assert repr(made) == "<clench.State, float64>"
    assert repr(moving("batch", "32").state) == "<clench.State of 3 environments, float32>"


def test_it_can_be_pickled() -> None:
    state = moving("batch").state
    assert same_state(pickle.loads(pickle.dumps(state)), state)


def test_numbers_that_are_not_finite_are_kept() -> None:
    sim = moving("sim")
    sim.qpos[:3] = [np.nan, np.inf, -0.0]
    assert same_state(clench.State.from_bytes(sim.state.to_bytes()), sim.state)


def test_states_of_others() -> None:
    sim, batch = moving("sim"), moving("batch")
    before = sim.state, batch.state
    for state in (batch.state, clench.Sim(example("quadruped")).state):
        with pytest.raises(ValueError, match="shape"):
            sim.state = state
    for state in (clench.Sim(example("quadruped")).state, clench.Batch(puppet(), 2).state):
        with pytest.raises(ValueError, match="shape"):
            batch.state = state
    for state in (None, 3, "state", {}, sim.state.to_bytes(), sim):
        if state is not sim:
            with pytest.raises((TypeError, ValueError)):
                sim.state = state
    assert same_state(sim.state, before[0]) and same_state(batch.state, before[1])


@pytest.mark.parametrize("name", FIELDS)
@pytest.mark.parametrize("kind", ["sim", "batch"])
def test_states_that_were_spoilt(kind: str, name: str) -> None:
    own = moving(kind)
    before = own.state
    own.step(10)
    after = own.state
    for spoilt in (np.zeros(99), "text", None, before.qpos.astype(complex), np.array([object()]), 1j):
        state = own.state
        for other in FIELDS:
            setattr(state, other, getattr(before, other))
        setattr(state, name, spoilt)
        with pytest.raises((TypeError, ValueError)):
            own.state = state
        assert same_state(own.state, after)


def test_arguments_that_make_no_sense() -> None:
    good = vars(moving("sim").state)
    for name in FIELDS:
        for bad in (None, 1.0, [1.0], "x", np.zeros(3, int), np.zeros(3, complex), np.array(["x"])):
            with pytest.raises(TypeError, match=name):
                clench.State(**(good | {name: bad}))
        with pytest.raises(TypeError):
            clench.State(**{key: value for key, value in good.items() if key != name})
    with pytest.raises(TypeError, match="qvel"):
        clench.State(**(good | {"qvel": good["qvel"].astype(np.float32)}))
    with pytest.raises(TypeError):
        clench.State(**(good | {"energy": np.zeros(2)}))


def test_precision_follows_the_simulation() -> None:
    single, double = moving("sim", "32"), moving("sim")
    single.state = double.state
    assert single.qpos.dtype == np.float32
    np.testing.assert_array_equal(single.qpos, double.qpos.astype(np.float32))
    double.state = single.state
    np.testing.assert_array_equal(single.qpos, double.qpos)


def repacked(data: bytes, **changes: Any) -> bytes:
    """Returns the archive with some arrays changed, or removed if None."""
    arrays = dict(np.load(io.BytesIO(data), allow_pickle=False)) | changes
    buffer = io.BytesIO()
    np.savez(buffer, **{name: array for name, array in arrays.items() if array is not None})
    return buffer.getvalue()


def foreign() -> dict[str, bytes]:
    """Returns bytes that contain no state."""
    data = moving("sim").state.to_bytes()
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w") as file:
        file.writestr("qpos.npy", b"not an array")
        file.writestr("version", b"1")
    array = io.BytesIO()
    np.save(array, np.zeros(3))
    huge = io.BytesIO()
    with zipfile.ZipFile(huge, "w") as file:
        file.writestr("qpos.npy", np.lib.format.magic(1, 0) + b"\x76\x00" + header(10**15))
    packed = io.BytesIO()
    np.savez_compressed(packed, version=np.int64(1), qpos=np.zeros(10**7))
    twice = io.BytesIO()
    with zipfile.ZipFile(twice, "w") as file, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for _ in range(2):
            file.writestr("version.npy", array.getvalue())
    return {
        "nothing": b"",
        "compressed": packed.getvalue(),
        "two of a name": twice.getvalue(),
        "zeros": bytes(1000),
        "text": b"hello",
        "half": data[: len(data) // 2],
        "but one": data[:-1],
        "without its start": data[1:],
        "an array": array.getvalue(),
        "a pickle": pickle.dumps([1, 2, 3]),
        "an archive": archive.getvalue(),
        "an array larger than memory": huge.getvalue(),
        "later": repacked(data, version=np.int64(7)),
        "much later": repacked(data, version=np.float64(1e300)),
        "never": repacked(data, version=np.float64(np.nan)),
        "without version": repacked(data, version=None),
        "versions": repacked(data, version=np.arange(3)),
        "version in words": repacked(data, version=np.array("one")),
        "before the first": repacked(data, version=np.int64(0)),
        "half a version": repacked(data, version=np.float64(1.5)),
        "incomplete": repacked(data, qvel=None),
        "more": repacked(data, energy=np.zeros(2)),
        "objects": repacked(data, qpos=np.array([object()])),
        "text within": repacked(data, qpos=np.array(["x"])),
        "other numbers": repacked(data, qpos=np.zeros(9, complex)),
        "switches as numbers": repacked(data, eq_active=np.zeros(2)),
    }


def header(count: int) -> bytes:
    text = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({count},), }}".encode()
    return text.ljust(0x75) + b"\n"


@pytest.mark.parametrize("name", foreign())
def test_bytes_of_something_else(name: str) -> None:
    with pytest.raises(ValueError):
        clench.State.from_bytes(foreign()[name])


def test_later_versions_say_so() -> None:
    with pytest.raises(ValueError, match="version 7"):
        clench.State.from_bytes(foreign()["later"])


def test_times_of_the_first_version_had_the_precision_of_the_rest() -> None:
    state = moving("sim", "32").state
    old = repacked(state.to_bytes(), version=np.int64(1), time=state.time.astype(np.float32), history=None)
    assert clench.State.from_bytes(old).time == np.float32(state.time)


def test_nothing_was_delayed_and_nothing_slept_before_the_third_version() -> None:
    state = moving("batch").state
    added = {"history": None, "tree_asleep": None, "pose_asleep": None}
    old = clench.State.from_bytes(repacked(state.to_bytes(), version=np.int64(2), **added))
    for array, kind in ((old.history, state.qpos.dtype), (old.tree_asleep, np.int32), (old.pose_asleep, state.qpos.dtype)):
        assert array.shape == (len(state.qpos), 0) and array.dtype == kind


@pytest.mark.parametrize("kind", ["sim", "batch"])
def test_nothing_was_tied_together_before_the_fourth_version(kind: str) -> None:
    own = moving(kind)
    state = own.state
    added = {name: None for name in FIELDS if name.startswith("dynamic_")}
    old = clench.State.from_bytes(repacked(state.to_bytes(), version=np.int64(3), **added))
    assert old.dynamic_quat.shape == (*state.qpos.shape[:-1], 0, 4) and old.dynamic_kind.dtype == np.int32
    own.add_weld(0, own.model.nbody - 1)
    own.state = old
    assert own.state == state


@pytest.mark.parametrize("kind", ["sim", "batch"])
def test_no_spring_yielded_before_the_fifth_version(kind: str) -> None:
    state = moving(kind).state
    old = clench.State.from_bytes(repacked(state.to_bytes(), version=np.int64(4), plastic=None))
    assert old == state and old.plastic.shape == (*state.qpos.shape[:-1], 0)


@pytest.mark.parametrize("kind", ["sim", "batch"])
def test_nothing_stuck_before_the_sixth_version(kind: str) -> None:
    state = moving(kind).state
    old = clench.State.from_bytes(repacked(state.to_bytes(), version=np.int64(5), stick_references=None, stick_friction=None))
    assert old == state and old.stick_references.shape == (*state.qpos.shape[:-1], 0, 9)


def test_what_sticks_is_part_of_the_state() -> None:
    model = example("pinch")
    options = clench.RigidOptions(stiction=True, max_stick_pairs=5)
    sim, other = clench.Sim(model, options), clench.Sim(model, options)
    sim.step(100)
    assert sim.stick_references.shape == (5, 9) and (sim.stick_references[:, 0] > 0).sum() == 2
    assert sim.stick_friction.shape == (model.nv + model.ntendon,)
    other.state = clench.State.from_bytes(sim.state.to_bytes())
    sim.step(100)
    other.step(100)
    assert sim.state == other.state
    batch = clench.Batch(model, 3, options=options)
    batch.step(200)
    assert batch.stick_references.shape == (3, 5, 9)
    assert (batch.stick_references == sim.stick_references).all() and (batch.qpos == sim.qpos).all()
    with pytest.raises(ValueError, match="stiction can only be chosen"):
        sim.options = clench.RigidOptions()


@pytest.mark.parametrize("bad", [None, 3, "text", [1], pathlib.Path("state")])
def test_what_is_not_bytes(bad: Any) -> None:
    with pytest.raises(TypeError, match=type(bad).__name__):
        clench.State.from_bytes(bad)


@pytest.mark.parametrize("kind", [bytes, bytearray, memoryview])
def test_bytes_of_every_kind(kind: Any) -> None:
    state = moving("sim").state
    assert clench.State.from_bytes(kind(state.to_bytes())) == state


@pytest.mark.parametrize("kind", ["sim", "batch"])
def test_equality_is_that_of_every_bit(kind: str) -> None:
    own = moving(kind)
    state = own.state
    assert own.state == own.state == state == pickle.loads(pickle.dumps(state)) == copy.deepcopy(state)
    assert clench.State.from_bytes(state.to_bytes()) == state and not state != own.state
    for name in FIELDS:
        other = own.state
        array = getattr(other, name)
        if array.size == 0:
            continue
        array[...] = np.nextafter(array, np.inf) if array.dtype.kind == "f" else ~array
        assert other != state and other != own.state, name
    zero, negative, nan = own.state, own.state, own.state
    zero.qvel[...], negative.qvel[...], nan.qvel[...] = 0.0, -0.0, np.nan
    assert zero != negative and nan == copy.deepcopy(nan) != zero
    assert state != moving(kind, "32").state
    assert state != moving("batch" if kind == "sim" else "sim").state
    assert state != 3 and state != None and state != vars(state)  # noqa: E711


def test_states_have_no_hash() -> None:
    with pytest.raises(TypeError, match="unhashable"):
        hash(moving("sim").state)


@pytest.mark.long
def test_bytes_take_no_more_memory_than_they_are() -> None:
    """Compressed archives that expand to much memory are refused, in any version."""
    zeros = np.zeros(10**8)
    for version in (1, 2, 3, 4):
        bomb = io.BytesIO()
        np.savez_compressed(bomb, version=np.int64(version), qpos=zeros)
        tracemalloc.start()
        with pytest.raises(ValueError, match="compressed"):
            clench.State.from_bytes(bomb.getvalue())
        most = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert most < 20 * len(bomb.getvalue()) < zeros.nbytes
    # A header that claims more than the data.
    data = moving("sim").state.to_bytes()
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as file, zipfile.ZipFile(io.BytesIO(data)) as old:
        for name in old.namelist():
            claimed = np.lib.format.magic(1, 0) + b"\x76\x00" + header(10**10)
            file.writestr(name, claimed if name == "qpos.npy" else old.read(name))
    with pytest.raises(ValueError, match="qpos.npy declares 80000000000 bytes"):
        clench.State.from_bytes(stream.getvalue())


def test_damaged_bytes() -> None:
    """Flipped bits and truncation cause an error or do not change the state."""
    state = moving("sim", model=puppet()).state
    data, rng = state.to_bytes(), random.Random(1)
    sim, taken = clench.Sim(puppet()), 0
    for _ in range(600):
        bytes_ = bytearray(data)
        for _ in range(rng.choice((1, 1, 1, 4, 30))):
            bytes_[rng.randrange(len(bytes_))] ^= 1 << rng.randrange(8)
        if rng.random() < 0.1:
            del bytes_[rng.randrange(len(bytes_)) :]
        try:
            read = clench.State.from_bytes(bytes(bytes_))
        except ValueError:
            continue
        taken += 1
        assert all(isinstance(getattr(read, name), np.ndarray) for name in FIELDS)
        # Each array has a checksum, so arrays are read as written, except for damaged names.
        assert same_state(read, state)
        sim.state = read
        sim.step()
    assert 0 < taken < 300


def test_same_bits_knows_the_difference() -> None:
    assert same_bits(np.array([np.nan, 0.0]), np.array([np.nan, 0.0]))
    assert not same_bits(np.array([0.0]), np.array([-0.0]))
    assert not same_bits(np.array([0.0]), np.array([0.0], np.float32))


@pytest.mark.parametrize("precision", ["64", "32"])
def test_a_state_of_one_environment_is_taken_by_all(precision: Any) -> None:
    model = example("quadruped")
    sim = clench.Sim(model, precision=precision)
    sim.ctrl += 0.1
    sim.step(30)
    batch = clench.Batch(model, 5, precision=precision)
    batch.qpos[3] = np.nan
    batch.step()
    batch.state = sim.state
    assert len(batch.state) == 5 and batch.running.all()
    assert all(same_state(batch.state[env], sim.state) for env in range(5))
    sim.step(20)
    batch.step(20)
    assert all(same_state(batch.state[env], sim.state) for env in range(5))


def test_some_environments_are_brought_to_a_state() -> None:
    model = example("quadruped")
    batch = clench.Batch(model, 4)
    batch.ctrl[:] = np.linspace(-0.1, 0.1, 4)[:, None]
    batch.step(20)
    before = batch.state
    sim = clench.Sim(model)
    sim.step(7)
    batch.set_state(sim.state, [1, 3])
    assert same_state(batch.state[[0, 2]], before[[0, 2]])
    assert same_state(batch.state[1], sim.state) and same_state(batch.state[3], sim.state)
    batch.set_state(before[1:3], np.array([2, 0]))
    assert same_state(batch.state[[2, 0]], before[1:3])
    batch.set_state(before)
    assert same_state(batch.state, before)
    assert same_state(clench.State.stack([before[env] for env in range(4)]), before)
    sim.state = batch.state[2]
    assert same_state(sim.state, before[2])
    with pytest.raises(IndexError, match="indices go from 0 to 3"):
        batch.set_state(sim.state, [0, 4])
    with pytest.raises(ValueError, match="shape"):
        batch.set_state(before, [0, 1])
    with pytest.raises(ValueError, match="shape"):
        sim.state = before
    with pytest.raises(ValueError, match="another model"):
        batch.set_state(clench.Sim(example("pendulum")).state)
    with pytest.raises(TypeError, match="no rows"):
        sim.state[0]
    with pytest.raises(TypeError, match="no length"):
        len(sim.state)
    assert sim.state and same_state(batch.state, before)


def test_a_rollout_starts_from_a_state() -> None:
    model = example("quadruped")
    sim = clench.Sim(model)
    sim.ctrl += 0.1
    sim.step(30)
    batch, ctrl = clench.Batch(model, 3), np.full((10, model.nu), 0.2)
    start = sim.state
    found = batch.rollout(start, ctrl, record=["qpos"])["qpos"]
    for step in range(10):
        sim.ctrl[:] = 0.2
        sim.step()
        for env in range(3):
            np.testing.assert_array_equal(found[env, step], sim.qpos)
    again = batch.rollout(clench.State.stack([start] * 3), ctrl, record=["qpos"])["qpos"]
    np.testing.assert_array_equal(again, found)
    before = batch.state
    with pytest.raises(ValueError, match="no output"):
        batch.rollout(start, ctrl, record=["nothing"])
    with pytest.raises(ValueError, match="ctrl"):
        batch.rollout(start, ctrl[:, 1:])
    with pytest.raises(ValueError, match="another model"):
        batch.rollout(clench.Sim(example("pendulum")).state, ctrl)
    assert same_state(batch.state, before)
