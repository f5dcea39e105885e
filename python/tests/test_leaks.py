"""Long loops of any call need no more memory than short ones."""

from __future__ import annotations

import gc
import os
import pathlib
import subprocess
import sys
from collections.abc import Callable

import clench
import numpy as np
import pytest
from scenes import PUPPET, example, puppet

STATM = pathlib.Path("/proc/self/statm")
PAGE = 4096

pytestmark = [pytest.mark.long, pytest.mark.skipif(not STATM.exists(), reason="resident memory is read from /proc")]

# The memory that the allocator may retain in a loop of any length, and the number of objects that the interpreter may.
SLACK, OBJECTS = 512 * 1024, 400


def resident() -> int:
    """Returns the resident memory, bytes."""
    gc.collect()
    return int(STATM.read_text().split()[1]) * PAGE


class Loops:
    """The bodies of the loops; each leaves the state unchanged."""

    def __init__(self) -> None:
        self.model = puppet()
        self.sim = clench.Sim(self.model)
        self.batch = clench.Batch(self.model, 16, threads=2, record=["cvel"])
        self.state = self.batch.state
        self.data = self.state.to_bytes()
        self.stack = clench.Sim(example("box_stack"))
        self.stack.step(50)
        self.ctrl = np.zeros((4, self.model.nu))
        self.mass = np.broadcast_to(self.model.body_mass, (16, self.model.nbody))

    def step(self) -> None:
        self.batch.step()
        self.sim.step()

    def views(self) -> None:
        for owner in (self.batch, self.sim):
            owner.qpos, owner.qvel[..., 1:], owner.time, owner.eq_active
            owner.ctrl = self.ctrl[0]
        self.batch.cvel, self.batch.status, self.batch.running

    def outputs(self) -> None:
        self.sim.xpos, self.sim.output("cinert"), self.sim.mass_matrix()
        self.batch.forward()

    def contacts(self) -> None:
        contacts, rows = self.stack.contacts, self.stack.constraints
        contacts.force, contacts.geom_names, rows.J, rows.name, self.stack.solver_stats

    def rollouts(self) -> None:
        self.batch.rollout(ctrl=self.ctrl, record=["qpos", "cvel"])
        self.batch.rollout(np.zeros((16, 1 + 9 + 8 + 1)) + [0, 0, 0, 1, 1, *[0] * 14], steps=3)

    def parameters(self) -> None:
        self.batch.randomize("body_mass", self.mass)
        self.batch.param("geom_size")
        self.sim.set_param("body_mass", self.model.body_mass)
        self.sim.param("body_mass")

    def states(self) -> None:
        self.batch.state = self.state
        clench.State.from_bytes(self.data).to_bytes()
        self.sim.state = self.sim.state

    def resets(self) -> None:
        self.batch.reset(keyframe="bent")
        self.batch.reset([True, False] * 8)
        self.batch.revive()
        self.sim.reset(0)

    def simulations(self) -> None:
        sim = clench.Sim(self.model)
        sim.step()
        sim.qpos, sim.contacts
        self.batch.sim(3).step()

    def batches(self) -> None:
        batch = clench.Batch(self.model, 16, threads=2, record=["xpos"])
        batch.step()
        kept = batch.qpos, batch.xpos
        del batch
        kept[0][:] = 0

    def models(self) -> None:
        model = clench.Model.from_xml(PUPPET)
        model.body("torso").mass, model.body_mass, model.names("geom")

    def problems(self) -> None:
        limit = clench.Block("one_sided", [0.0, 1.0], aref=0.0, R=0.25)
        clench.solve([[1.0, 0.0], [0.0, 1.0]], [-1.0, -1.0], [limit] * 5).forces

    def exceptions(self) -> None:
        calls: list[Callable[[], object]] = [
            *(lambda: self.batch.output("nothing"), lambda: getattr(self.sim, "nothing"), lambda: self.batch.step(-1)),
            lambda: self.batch.randomize("body_mass", [1]),
            lambda: setattr(self.batch, "qpos", "x"),
            *(lambda: self.batch.rollout(steps=2, record=["x"]), lambda: clench.Batch(self.model, 2, record=["x"])),
            *(lambda: clench.Model.from_xml("<mujoco><worldbody>"), lambda: clench.State.from_bytes(b"x")),
            *(lambda: clench.RigidOptions(iterations=-1), lambda: self.batch.reset([1]), lambda: self.sim.reset("x")),
        ]
        for call in calls:
            with pytest.raises((ValueError, TypeError, AttributeError)):
                call()

    def faults(self) -> None:
        self.sim.qpos[0] = np.nan
        with pytest.raises(clench.SimulationError):
            self.sim.step()
        self.sim.reset()
        self.batch.qvel[2] = np.nan
        self.batch.step()
        self.batch.fault(2)
        self.batch.reset()


@pytest.mark.parametrize(
    ("name", "times"),
    [
        ("step", 5000),
        ("views", 10_000),
        ("outputs", 5000),
        ("contacts", 5000),
        ("rollouts", 2000),
        ("parameters", 5000),
        ("states", 1000),
        ("resets", 10_000),
        ("simulations", 2000),
        ("batches", 1000),
        ("models", 1000),
        ("problems", 5000),
        ("exceptions", 1000),
        ("faults", 3000),
    ],
)
def test_loops_take_no_memory(name: str, times: int) -> None:
    loop = getattr(Loops(), name)
    # Threads free the memory of others, so the allocator needs many iterations until it grows no more.
    for _ in range(times):
        loop()
    memory, blocks = resident(), sys.getallocatedblocks()
    for _ in range(times):
        loop()
    # This detects a leak of one Python object per iteration, or in most loops of 100 bytes of other memory.
    assert resident() - memory < SLACK
    assert sys.getallocatedblocks() - blocks < OBJECTS


LARGE = """
import gc, sys
sys.path.insert(0, sys.argv[1])
import clench
from scenes import ball
from test_leaks import resident

N = 50_000
clench.Batch(ball(), 3).step()
before = resident()

# Large arrays are given back.
for _ in range(20):
    batch = clench.Batch(ball(), N, record=["cvel"])
    view = batch.rollout(steps=2)["qpos"]
    size = N * batch.bytes_per_env
    del batch
    assert view.shape == (N, 2, 7)
    del view
assert resident() - before < size / 4, (before, resident(), size)

# They live as long as any view.
corners, size = [], 0
for _ in range(12):
    batch = clench.Batch(ball(), N)
    size += N * batch.bytes_per_env
    corners.append(batch.qpos[:1, :1])
    del batch
assert resident() - before > 0.9 * size, (before, resident(), size)
assert all(corner[0, 0] == 0 for corner in corners)
del corners
assert resident() - before < size / 20, (before, resident(), size)
"""


def test_large_arrays_live_as_long_as_their_views() -> None:
    # With this threshold the C allocator returns freed arrays to the system.
    environment = os.environ | {"MALLOC_MMAP_THRESHOLD_": "65536"}
    tests = str(pathlib.Path(__file__).parent)
    command = [sys.executable, "-c", LARGE, tests]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stderr) == (0, "")
