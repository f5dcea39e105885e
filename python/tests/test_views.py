"""The arrays of `Sim` and `Batch`: their memory, lifetime and sharing."""

from __future__ import annotations

import gc
import subprocess
import sys
import weakref
from typing import Any

import clench
import numpy as np
import pytest
from numpy.typing import NDArray
from scenes import FIELDS, ROOT, address, ball, puppet

QUADRUPED = ROOT / "models/quadruped.xml"


def live_arrays(owner: clench.Sim | clench.Batch) -> dict[str, NDArray[Any]]:
    """Returns all arrays that are views, by name."""
    names = [name for name in FIELDS if isinstance(getattr(owner, name), np.ndarray)]
    arrays = {name: getattr(owner, name) for name in names}
    if isinstance(owner, clench.Batch):
        arrays |= {f"output {name}": owner.output(name) for name in owner.outputs}
    return arrays


def make(kind: str, model: Any = None, n: Any = 3, precision: Any = "64") -> Any:
    model = model or puppet()
    if kind == "sim":
        return clench.Sim(model, precision=precision)
    return clench.Batch(model, n, precision, threads=2, record=clench.OUTPUTS)


@pytest.mark.parametrize("precision", ["64", "32"])
@pytest.mark.parametrize("n", [1, 2, 3, 17, 256])
def test_memory_is_aligned(n: Any, precision: Any) -> None:
    for kind in ("sim", "batch"):
        for name, array in live_arrays(make(kind, n=n, precision=precision)).items():
            if array.size:
                assert address(array) % 64 == 0, (kind, name)
            assert array.flags.aligned and array.flags.c_contiguous, (kind, name)


def test_memory_never_moves() -> None:
    batch = clench.Batch(puppet(), 9, threads=2, record=["xpos"])
    arrays = live_arrays(batch)
    places = {name: address(array) for name, array in arrays.items()}
    rng = np.random.default_rng(0)
    state = batch.state
    for round_ in range(len(clench.OUTPUTS)):
        batch.step(50)
        batch.reset(rng.random(9) < 0.5, keyframe=None if round_ % 2 else 0)
        batch.record(clench.OUTPUTS[round_ % len(clench.OUTPUTS)])
        batch.randomize("body_mass", batch.model.body_mass * rng.uniform(0.9, 1.1, (9, 1)))
        batch.randomize("geom_size", batch.model.geom_size[None].repeat(2, 0), [round_ % 9, 8])
        batch.rollout(steps=5, record=["qpos", "xpos"])
        batch.qpos = batch.qpos
        batch.qvel[round_ % 9, 0] = np.nan
        batch.step()
        batch.revive()
        batch.forward()
        batch.state = state
        batch.sim(3).step()
    for name, array in live_arrays(batch).items():
        if name in arrays:
            assert array is arrays[name] and address(array) == places[name], name
    assert set(batch.outputs) == set(clench.OUTPUTS)

    sim = clench.Sim(puppet())
    arrays = live_arrays(sim)
    places = {name: address(array) for name, array in arrays.items()}
    state = sim.state
    for _ in range(20):
        sim.step(50)
        sim.reset("bent")
        sim.set_param("body_mass", sim.model.body_mass * 1.5)
        sim.state = state
    for name, array in live_arrays(sim).items():
        assert array is arrays[name] and address(array) == places[name], name


def test_arrays_do_not_overlap() -> None:
    for kind in ("sim", "batch"):
        places = []
        for array in live_arrays(make(kind)).values():
            if array.size:
                places.append((address(array), address(array) + array.nbytes))
        places.sort()
        for (_, end), (start, _) in zip(places, places[1:], strict=False):
            assert end <= start


@pytest.mark.parametrize("kind", ["sim", "batch"])
def test_arrays_outlive_their_owner(kind: str) -> None:
    model = clench.Model.from_file(QUADRUPED)
    owner = make(kind, model)
    owner.step(3)
    arrays = live_arrays(owner)
    expected = {name: array.copy() for name, array in arrays.items()}
    slices = {name: array[..., :1] for name, array in arrays.items()}
    if kind == "batch":
        recorded = owner.rollout(steps=3)
        kept = {name: values.copy() for name, values in recorded.items()}
        expected |= {name: array.copy() for name, array in arrays.items()}
    del owner, model
    gc.collect()
    others = [make(kind) for _ in range(5)]  # these would reuse freed memory
    for other in others:
        other.step(5)
    for name, array in arrays.items():
        np.testing.assert_array_equal(array, expected[name])
    if kind == "batch":
        for name, values in recorded.items():
            np.testing.assert_array_equal(values, kept[name])
    writable = [name for name, array in arrays.items() if array.flags.writeable]
    assert set(writable) >= {"qpos", "qvel", "ctrl"}
    for name in writable:
        arrays[name][...] = 1
    del arrays
    gc.collect()
    for name in writable:
        assert (slices[name] == 1).all()


@pytest.mark.parametrize("kind", ["sim", "batch"])
def test_the_last_view_frees_the_memory(kind: str) -> None:
    """A Python object owns the memory and must be freed with the last array."""
    owner = make(kind)
    views = [owner.qpos, owner.qvel[..., 1:]]
    keeper = owner.qpos.base
    counts = [sys.getrefcount(keeper)]
    del owner
    gc.collect()
    counts.append(sys.getrefcount(keeper))
    views.clear()
    gc.collect()
    counts.append(sys.getrefcount(keeper))
    alone = object()
    assert counts[0] > counts[1] > counts[2] == sys.getrefcount(alone), counts


def test_access_leaves_no_references() -> None:
    batch, sim = make("batch"), make("sim")
    batch.step()
    sim.step()
    watched = [batch, sim, batch.qpos, sim.qpos, batch.qpos.base, sim.qpos.base, batch.xpos, batch.model]
    before = [sys.getrefcount(item) for item in watched]
    for _ in range(100):
        batch.qpos, sim.qpos, batch.xpos, batch.output("xpos"), batch.model, sim.model
        batch.time, sim.time, batch.status, batch.running, batch.outputs, batch.options
        sim.contacts, sim.constraints, sim.solver_stats, sim.xpos, sim.state, batch.state
        batch.sim(0), batch.rollout(steps=1), batch.param("body_mass"), sim.param("body_mass")
        batch.qpos = batch.qpos
        repr(batch), repr(sim), dir(batch), dir(sim)
        with pytest.raises(ValueError):
            batch.output("nothing")
        with pytest.raises(AttributeError):
            sim.nothing
    assert [sys.getrefcount(item) for item in watched] == before


def test_outputs_cannot_be_written() -> None:
    batch = make("batch")
    batch.step()
    for name in batch.outputs:
        output = batch.output(name)
        with pytest.raises(ValueError):
            output[...] = 0
        with pytest.raises(ValueError):
            output.flags.writeable = True
        with pytest.raises(ValueError):
            output[...].flags.writeable = True
        assert memoryview(output).readonly
    sim = make("sim")
    sim.step()
    for name in ("xpos", "cvel", "qacc"):
        with pytest.raises(ValueError):
            getattr(sim, name)[...] = 0
        with pytest.raises(AttributeError):
            setattr(sim, name, 0)
        with pytest.raises(AttributeError):
            setattr(batch, name, 0)


def test_arrays_cannot_be_resized() -> None:
    batch = make("batch")
    for array in live_arrays(batch).values():
        with pytest.raises(ValueError):
            array.resize(1000)
    with pytest.raises((AttributeError, ValueError)):
        batch.qpos.base = None


def test_numpy_takes_arrays_without_a_copy() -> None:
    batch = make("batch")
    batch.step()
    for name in ("qpos", "ctrl", "xfrc_applied", "time", "eq_active"):
        array = getattr(batch, name)
        for taken in (np.asarray(array), np.from_dlpack(array), np.frombuffer(array, array.dtype)):
            assert address(taken) == address(array) and np.shares_memory(taken, array), name
    taken = np.from_dlpack(batch.qpos)
    batch.qpos[1, 2] = 7
    assert taken[1, 2] == 7
    batch.step()
    np.testing.assert_array_equal(taken, batch.qpos)
    del batch
    gc.collect()
    assert taken.shape == (3, puppet().nq) and np.isfinite(taken).all()


def test_models_are_shared_and_freed() -> None:
    model = clench.Model.from_file(QUADRUPED)
    count = sys.getrefcount(model)
    sims = [clench.Sim(model) for _ in range(3)] + [clench.Batch(model, 2)]
    # A batch has it as its model and as the first of its models.
    assert sys.getrefcount(model) == count + 5
    del sims
    gc.collect()
    assert sys.getrefcount(model) == count


def test_weak_references_and_attributes_of_ones_own() -> None:
    """Neither is supported: both would need memory in every object."""
    sim = clench.Sim(ball())
    with pytest.raises(TypeError):
        weakref.ref(sim)
    with pytest.raises(AttributeError):
        setattr(sim, "own", 1)


def test_arrays_at_the_end_of_the_interpreter() -> None:
    program = """
import clench, numpy as np, sys
model = clench.Model.from_xml('<mujoco><worldbody><body><freejoint/><geom size="1"/></body></worldbody></mujoco>')
batch = clench.Batch(model, 5, threads=2, record=["xpos"])
batch.step()
sys.kept = [batch.qpos, batch.xpos, batch.rollout(steps=3), clench.Sim(model).qvel]
import builtins
builtins.also = batch
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
