"""Threads, signals and processes: one call at a time in a batch, without deadlocks or lost errors."""

from __future__ import annotations

import copy
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import clench
import numpy as np
import pytest
from scenes import ROOT, ball, example, same_state

ENVS = 16


def humanoids(threads: int = 1) -> clench.Batch:
    batch = clench.Batch(example("humanoid"), ENVS, threads=threads)
    batch.reset(keyframe="crouched")
    batch.qvel += np.linspace(-0.2, 0.2, batch.qvel.size).reshape(batch.qvel.shape)
    return batch


def humanoid() -> clench.Sim:
    sim = clench.Sim(example("humanoid"))
    sim.reset("crouched")
    return sim


class Meanwhile:
    """A call in a separate thread, concurrent with the `with` block."""

    def __init__(self, call: Callable[..., Any], *args: Any) -> None:
        self.failure: Exception | None = None

        def run() -> Any:
            try:
                call(*args)
            except Exception as error:
                self.failure = error

        self.thread = threading.Thread(target=run, daemon=True)

    def __enter__(self) -> Meanwhile:
        self.thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.thread.join()

    @property
    def running(self) -> bool:
        return self.thread.is_alive()


def steps_of(seconds: float, make: Callable[[], Any]) -> int:
    """Returns the approximate number of steps that take `seconds`."""
    own, steps, start = make(), 0, time.perf_counter()
    while time.perf_counter() - start < 0.05:
        own.step(10)
        steps += 10
    return int(steps * seconds / 0.05)


def refused(call: Callable[[], Any]) -> bool:
    try:
        call()
    except clench.BusyError as error:
        assert isinstance(error, clench.ClenchError) and "thread" in str(error)
        return True
    except ValueError:
        pass
    return False


# Calls without effect if they are not refused.
OF_BOTH = {
    "step": lambda own: own.step(0),
    "param": lambda own: own.param("body_mass"),
    "state": lambda own: own.state,
    "set state": lambda own: setattr(own, "state", clench.Sim(ball()).state),
}
OF_SIM = OF_BOTH | {
    "forward": lambda sim: sim.forward(),
    "contacts": lambda sim: sim.contacts,
    "constraints": lambda sim: sim.constraints,
    "solver_stats": lambda sim: sim.solver_stats,
    "contact_overflow": lambda sim: sim.contact_overflow,
    "mass_matrix": lambda sim: sim.mass_matrix(),
    "set_param": lambda sim: sim.set_param("timestep", -1),
    "output": lambda sim: sim.output("xpos"),
    "attribute": lambda sim: sim.xpos,
}
NOBODY = np.zeros(ENVS, bool)
OF_BATCH = OF_BOTH | {
    "forward": lambda batch: batch.forward(NOBODY),
    "reset": lambda batch: batch.reset(NOBODY),
    "revive": lambda batch: batch.revive(NOBODY),
    "status": lambda batch: batch.status,
    "running": lambda batch: batch.running,
    "fault": lambda batch: batch.fault(0),
    "sim": lambda batch: batch.sim(0),
    "randomize": lambda batch: batch.randomize("timestep", [], []),
    "rollout": lambda batch: batch.rollout(steps=0),
    "record": lambda batch: batch.record(),
    "bytes_per_env": lambda batch: batch.bytes_per_env,
}


@pytest.mark.parametrize(
    ("make", "calls"), [pytest.param(humanoid, OF_SIM, id="sim"), pytest.param(humanoids, OF_BATCH, id="batch")]
)
def test_a_second_thread_is_told_so(make: Callable[[], Any], calls: Any) -> None:
    own, alone, steps = make(), make(), steps_of(0.3, make)
    left = set(calls)
    with Meanwhile(own.step, steps) as other:
        while other.running and left:
            for name in list(left):
                if refused(partial(calls[name], own)):
                    left.remove(name)
    assert other.failure is None and not left
    alone.step(steps)
    assert same_state(own.state, alone.state)


def test_one_of_two_steps_is_done() -> None:
    batch, alone, steps = humanoids(), humanoids(), steps_of(0.2, humanoids)
    failures = []
    with Meanwhile(batch.step, steps) as other:
        while other.running:
            try:
                batch.step(0)
            except clench.BusyError as error:
                failures.append(error)
            assert repr(batch) == repr(alone)
    alone.step(steps)
    assert other.failure is None and len(failures) > 10
    assert same_state(batch.state, alone.state)


def turns_during(call: Callable[[], Any]) -> float:
    """Returns the loop iterations per second of this thread during a call in another."""
    turns, start = 0, time.perf_counter()
    with Meanwhile(call) as other:
        while other.running:
            turns += 1
        took = time.perf_counter() - start
    assert other.failure is None
    return turns / took


@pytest.mark.parametrize("call", ["step", "rollout", "forward"])
def test_python_goes_on_meanwhile(call: str) -> None:
    batch, many = humanoids(), clench.Batch(example("humanoid"), 20_000, threads=1)
    steps = steps_of(0.3, humanoids)
    calls: dict[str, Callable[[], Any]] = {
        "step": lambda: batch.step(steps),
        "rollout": lambda: batch.rollout(steps=steps, record=["time"]),
        "forward": many.forward,
    }
    undisturbed = turns_during(lambda: time.sleep(0.1))
    # If the call held the interpreter lock, this thread would hardly run before its end.
    assert turns_during(calls[call]) > 0.1 * undisturbed


def test_batches_step_side_by_side() -> None:
    steps = steps_of(0.3, humanoids)
    batches, alone = [humanoids(), humanoids(2)], humanoids()
    both = False
    with Meanwhile(batches[0].step, steps) as first, Meanwhile(batches[1].step, steps) as second:
        end = steps * alone.model.timestep
        while first.running and second.running:
            both |= all((0 < batch.time[0] < 0.99 * end) for batch in batches)
    assert both and first.failure is None and second.failure is None
    alone.step(steps)
    for batch in batches:
        assert same_state(batch.state, alone.state)


def test_many_threads_with_batches_of_their_own() -> None:
    model, found, expected = example("quadruped"), {}, clench.Batch(example("quadruped"), 5)
    expected.step(100)

    def work(index: int) -> None:
        batch = clench.Batch(model, 5, threads=1 + index % 3)
        for _ in range(10):
            batch.step(10)
        found[index] = batch.state

    threads = [threading.Thread(target=work, args=(index,)) for index in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 8
    assert all(same_state(state, expected.state) for state in found.values())


def test_writers_from_other_threads_cannot_break_a_step() -> None:
    """Concurrent writes may change results or make environments fail, but have no other effect."""
    batch, fresh = humanoids(2), humanoids()
    batch.record("cfrc_ext", "contact_force")
    stop, rng = threading.Event(), np.random.default_rng(7)
    noise = rng.choice([0.0, 1.0, -3.0, np.nan, np.inf, 1e300, -1e300, 5e-324], (50, *batch.qpos.shape))

    def write() -> None:
        views = [batch.qpos, batch.qvel, batch.ctrl, batch.qacc_warmstart, batch.xfrc_applied[:, 0], batch.time]
        switches = batch.eq_active.view(np.uint8)
        while not stop.is_set():
            for numbers in noise:
                for view in views:
                    view[...] = numbers[:, : view.shape[1]] if view.ndim == 2 else numbers[:, 0]
                switches[...] = 7

    with Meanwhile(write) as other:
        end = time.perf_counter() + 0.5
        while time.perf_counter() < end:
            batch.step(3)
            batch.forward()
            batch.rollout(steps=2, record=["cvel", "energy"])
            batch.reset()
        stop.set()
    assert other.failure is None
    batch.state = fresh.state
    assert batch.step(20) == 0
    fresh.step(20)
    assert same_state(batch.state, fresh.state)


def interrupt_soon(number: int = signal.SIGINT) -> None:
    threading.Timer(0.2, os.kill, (os.getpid(), number)).start()


@pytest.mark.parametrize("make", [humanoid, humanoids, lambda: humanoids(2)], ids=["sim", "batch", "two threads"])
def test_control_c_ends_a_long_step(make: Callable[[], Any]) -> None:
    own = make()
    interrupt_soon()
    start = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        own.step(10**12)
    assert time.perf_counter() - start < 20
    # The state is that of a call for the completed number of steps.
    done = round(np.max(own.time) / own.model.timestep)
    assert done > 0
    alone = make()
    alone.step(done)
    assert same_state(own.state, alone.state)
    own.step(10)
    alone.step(10)
    assert same_state(own.state, alone.state)


@pytest.mark.parametrize("make", [humanoid, humanoids, lambda: humanoids(2)], ids=["sim", "batch", "two threads"])
def test_control_c_ends_the_gradient_of_a_rollout(make: Callable[[], Any]) -> None:
    own = make()
    before = own.qpos.copy()
    lead = (40_000 // (ENVS if own.qpos.ndim == 2 else 1), *own.qpos.shape[:-1])
    controls, gradients = np.zeros((*lead, own.model.nu)), np.zeros((*lead, 2 * own.model.nv + own.model.na))
    interrupt_soon()
    start = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        own.rollout_vjp(controls, gradients)
    assert time.perf_counter() - start < 3
    np.testing.assert_array_equal(own.qpos, before)
    few = own.rollout_vjp(controls[:3], gradients[:3])
    assert all(np.isfinite(part).all() for part in few)


def test_steps_end_where_nobody_runs() -> None:
    batch = clench.Batch(ball(), 2)
    batch.qvel[:] = np.nan
    assert batch.step(2**63) == 2
    assert batch.step(2**63) == 0
    with pytest.raises(MemoryError):
        clench.Batch(ball(), 0).rollout(steps=2**60)


def test_control_c_ends_a_rollout() -> None:
    batch = clench.Batch(ball(), 2)
    interrupt_soon()
    with pytest.warns(RuntimeWarning, match=r"interrupted after \d+ of"):
        assert batch.rollout(steps=2**50, record=[]) == {}
    assert batch.time[0] > 0
    assert batch.step() == 0


@pytest.mark.parametrize("ctrl", [None, lambda _: None], ids=["held", "function"])
def test_what_was_recorded_until_control_c_is_returned(ctrl: Any) -> None:
    batch, other = humanoids(), humanoids()
    # Far more steps than fit in the time until the signal, and a small record, which is allocated before the first step.
    steps = steps_of(10, humanoids)
    interrupt_soon()
    with pytest.warns(RuntimeWarning, match="interrupted after") as warned:
        rows = batch.rollout(None, ctrl, steps=steps, record=["energy"])
    found = re.search(r"after (\d+) of (\d+) steps", str(warned[0].message))
    assert found is not None
    done, whole = map(int, found.groups())
    assert 0 < done < steps == whole
    # With a function, Ctrl-C may occur after a step and before it is recorded.
    assert round(float(batch.time[0]) / batch.model.timestep) - done in ([0] if ctrl is None else [0, 1])
    expected = other.rollout(steps=done, record=["energy"])
    assert list(rows) == ["energy"]
    for name, array in rows.items():
        np.testing.assert_array_equal(array[:, :done], expected[name])
        assert np.isnan(array[:, done:]).all()


def test_handlers_run_meanwhile() -> None:
    batch, calls = humanoids(), []

    def handle(*_: object) -> None:
        calls.append(refused(lambda: batch.step(1)))

    before = signal.signal(signal.SIGUSR1, handle)
    try:
        interrupt_soon(signal.SIGUSR1)
        batch.step(steps_of(0.5, humanoids))
    finally:
        signal.signal(signal.SIGUSR1, before)
    assert calls == [True]


def python(program: str, *args: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", program, *args], capture_output=True, text=True, timeout=120)


def test_the_interpreter_may_end_during_a_step() -> None:
    program = """
import sys, threading, time
import clench
model = clench.Model.from_file(sys.argv[1])
batch = clench.Batch(model, 64, threads=2)
thread = threading.Thread(target=batch.step, args=(10**12,), daemon=True)
thread.start()
while batch.time[0] == 0:
    time.sleep(0.001)
"""
    done = python(program, str(ROOT / "models/humanoid.xml"))
    assert (done.returncode, done.stderr) == (0, "")


def test_threads_of_a_simulation_change_no_bit() -> None:
    alone, shared = humanoid(), clench.Sim(example("humanoid"), threads=2)
    shared.reset("crouched")
    for sim in (alone, shared):
        sim.step(50)
    assert (alone.threads, shared.threads, copy.deepcopy(shared).threads) == (1, 2, 2)
    assert same_state(alone.state, shared.state)
    shared.threads = 1
    assert shared.threads == 1
    for wrong in (0, 1025):
        with pytest.raises(ValueError, match="threads"):
            shared.threads = wrong


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork here")
def test_processes_that_fork() -> None:
    """A child process has only the thread that forked.

    Batches that it creates, and simulations whose threads it sets, have their own.
    """
    program = """
import os, sys
import numpy as np
import clench
model = clench.Model.from_file(sys.argv[1])
sim, alone, threaded = clench.Sim(model), clench.Batch(model, 20, threads=1), clench.Batch(model, 20, threads=2)
shared = clench.Sim(model, threads=2)
for own in (sim, alone, threaded, shared):
    own.step(5)
child = os.fork()
if child == 0:
    sim.step(5), alone.step(5)
    own = clench.Batch(model, 20, threads=2)
    own.step(10)
    ok = np.array_equal(own.qpos, alone.qpos) and np.array_equal(own.qpos[0], sim.qpos)
    for lost in (threaded, shared):
        try:
            lost.step(5)
            ok = False
        except clench.ClenchError as error:
            ok = ok and "fork" in str(error)
    shared.threads = 2
    shared.step(5)
    ok = ok and np.array_equal(shared.qpos, sim.qpos)
    os._exit(0 if ok else 1)
threaded.step(5)
_, status = os.waitpid(child, 0)
sys.exit(os.waitstatus_to_exitcode(status))
"""
    done = python(program, str(ROOT / "models/quadruped.xml"))
    assert done.returncode == 0, done.stderr
