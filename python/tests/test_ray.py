"""A batch on a Ray cluster is bitwise equal to a local batch, even if a worker is killed."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from typing import Any

import clench
import numpy as np
import pytest
from scenes import ROOT, example

ray = pytest.importorskip("ray")

import clench.ray  # noqa: E402  Of use only where Ray is.

N = 7


@pytest.fixture(scope="module", autouse=True)
def cluster() -> Iterator[None]:
    """Starts Ray with processors for two workers on this machine."""
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    yield
    ray.shutdown()


def pair(name: str = "quadruped", **how: Any) -> tuple[clench.Batch, clench.ray.Batch]:
    """Returns the same environments in a local batch and on two workers."""
    model = example(name)
    alone = clench.Batch(model, N, record=("xpos", "qacc"), **{key: how[key] for key in how if key == "precision"})
    spread = clench.ray.Batch(model, N, record=("xpos", "qacc"), workers=2, threads=1, **how)
    return alone, spread


def drive(batch: Any, steps: int, rng: np.random.Generator) -> None:
    """Uses a batch as a program would: controls, steps, resets, parameters and writes."""
    for step in range(steps):
        batch.ctrl[:] = rng.uniform(-1, 1, batch.ctrl.shape)
        batch.step(3)
        if step % 4 == 1:
            batch.reset(np.arange(N) == step % N)
        if step % 5 == 2:
            batch.randomize("geom_friction", batch.param("geom_friction")[[1, 4]] * 1.1, envs=[1, 4])
            batch.randomize("body_mass", batch.param("body_mass")[[0, 4]] * 1.1, envs=[0, 4], consistent=True)
            batch.qvel[step % N, 0] += 0.3


def kill(batch: clench.ray.Batch, worker: int) -> None:
    os.kill(batch.workers[worker][1], signal.SIGKILL)


def assert_same(spread: clench.ray.Batch, alone: clench.Batch) -> None:
    assert spread.state == alone.state
    np.testing.assert_array_equal(spread.qpos, alone.qpos)
    np.testing.assert_array_equal(spread.xpos, alone.xpos)
    np.testing.assert_array_equal(spread.output("qacc"), alone.qacc)
    np.testing.assert_array_equal(spread.param("geom_friction"), alone.param("geom_friction"))
    np.testing.assert_array_equal(spread.status, alone.status)


@pytest.mark.parametrize("precision", ["64", "32"])
def test_it_moves_as_a_batch_alone(precision: str) -> None:
    alone, spread = pair(precision=precision)
    with spread:
        qpos = spread.qpos
        drive(alone, 12, np.random.default_rng(0))
        drive(spread, 12, np.random.default_rng(0))
        assert_same(spread, alone)
        assert spread.qpos is qpos and len(spread) == N and spread.precision == precision and spread.replaced == 0
        spread.qpos = alone.qpos[0]
        assert (spread.state.qpos == alone.qpos[0]).all()


def test_states_of_simulations_are_taken() -> None:
    alone, spread = pair()
    sim = clench.Sim(alone.model)
    sim.step(7)
    with spread:
        for batch in (alone, spread):
            batch.ctrl[:] = 0.1
            batch.step(3)
            batch.set_state(sim.state, [1, N - 1])
            batch.set_state(batch.state[[0, 1]], [1, 0])
        assert_same(spread, alone)
        ctrl = np.full((4, alone.model.nu), 0.2)
        np.testing.assert_array_equal(spread.rollout(sim.state, ctrl)["qpos"], alone.rollout(sim.state, ctrl)["qpos"])
        spread.state = sim.state
        assert spread.state == clench.State.stack([sim.state] * N)
        with pytest.raises(ValueError, match="a state of 2 environments"):
            spread.set_state(alone.state, [0, 1])


@pytest.mark.parametrize("snapshot_every", [1, 10, 1000])
def test_a_death_changes_no_bit(snapshot_every: int) -> None:
    alone, spread = pair(snapshot_every=snapshot_every)
    with spread:
        rng, other = np.random.default_rng(1), np.random.default_rng(1)
        for worker in (0, 1, 1):
            drive(alone, 9, rng)
            drive(spread, 9, other)
            kill(spread, worker)
        assert_same(spread, alone)
        drive(alone, 3, rng)
        drive(spread, 3, other)
        assert_same(spread, alone)
        assert spread.replaced == 3


def test_a_death_changes_no_output_that_was_read() -> None:
    alone, spread = pair()
    with spread:
        for batch in (alone, spread):
            batch.qpos[:, 2] += 0.1
            batch.qacc  # It is computed now, and later controls do not change it.
            batch.ctrl[:] = 0.5
        kill(spread, 0)
        assert_same(spread, alone)
        # Ray can free what was received.
        assert all(call.answer is None for call in spread._workers[0].journal if call.method != "write")


def test_a_death_in_a_rollout_changes_no_bit() -> None:
    alone, spread = pair(snapshot_every=5)
    ctrl = np.random.default_rng(2).uniform(-1, 1, (N, 40, alone.model.nu))
    initial = np.concatenate([[0.0], alone.model.qpos0, np.zeros(alone.model.nv)])
    with spread:
        expected = alone.rollout(initial, ctrl, record=("qpos", "contact_force"))
        kill(spread, 0)
        found = spread.rollout(initial, ctrl, record=("qpos", "contact_force"))
        for name, values in expected.items():
            np.testing.assert_array_equal(found[name], values)
        spread.step(10)
        kill(spread, 1)
        alone.step(10)
        assert_same(spread, alone)
        assert spread.replaced == 2


def test_an_environment_that_fails_does_so_after_a_death_too() -> None:
    alone, spread = pair(snapshot_every=4)
    with spread:
        for batch in (alone, spread):
            batch.qpos[5, 0] = np.nan
            assert batch.step(2) == 1
            for _ in range(5):
                batch.step(2)
        kill(spread, 1)
        assert_same(spread, alone)
        assert spread.fault(5) == alone.fault(5) is not None and spread.fault(2) is None
        assert not spread.running[5] and spread.running.sum() == N - 1
        for batch in (alone, spread):
            batch.reset(np.arange(N) == 5)
            batch.step(20)
        assert_same(spread, alone)
        assert spread.running.all()


def test_snapshots_shorten_what_is_done_again() -> None:
    _, spread = pair(snapshot_every=6)
    with spread:
        drive(spread, 9, np.random.default_rng(4))
        assert all(len(worker.journal) <= 8 for worker in spread._workers)


def test_the_example_finds_the_same_where_a_worker_is_killed() -> None:
    script = ROOT / "python/examples/cluster_plan.py"
    ways = []
    for more in ([], ["--kill"]):
        command = [sys.executable, str(script), "--quick", "--workers", "2", *more]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stderr
        ways.append(re.findall(r"the best goes (\S+) m", done.stdout))
        assert f"2 workers, {len(more)} replaced" in done.stdout
    assert ways[0] == ways[1] and float(ways[0][-1]) > float(ways[0][0])


def test_questions_are_answered_as_by_a_batch_alone() -> None:
    alone, spread = pair()
    with spread:
        for batch in (alone, spread):
            drive(batch, 2, np.random.default_rng(3))
        np.testing.assert_array_equal(spread.mass_matrix(), alone.mass_matrix())
        np.testing.assert_array_equal(spread.jacobian(body=2), alone.jacobian(body=2))
        np.testing.assert_array_equal(spread.jacobian_rate(body=2), alone.jacobian_rate(body=2))
        for point in (np.ones(3), np.random.default_rng(4).normal(size=(len(alone), 3))):
            np.testing.assert_array_equal(spread.jacobian(body=2, point=point), alone.jacobian(body=2, point=point))
            np.testing.assert_array_equal(spread.jacobian_rate(body=2, point=point), alone.jacobian_rate(body=2, point=point))
        np.testing.assert_array_equal(spread.subtree_jacobian(1), alone.subtree_jacobian(1))
        np.testing.assert_array_equal(spread.inverse(alone.qacc), alone.inverse(alone.qacc))
        np.testing.assert_array_equal(spread.body(1).xpos, alone.body(1).xpos)
        spread.body(1).mass = alone.body(1).mass * 2
        assert (spread.param("body_mass")[:, 1] == 2 * alone.param("body_mass")[:, 1]).all()
        sim = spread.sim(6)
        np.testing.assert_array_equal(sim.qpos, alone.qpos[6])
        np.testing.assert_array_equal(spread.params.gravity, alone.params.gravity)


def test_contacts_and_rows_of_an_environment_are_those_of_a_batch_alone() -> None:
    alone, spread = pair()
    with spread:
        for batch in (alone, spread):
            drive(batch, 40, np.random.default_rng(3))
        touching = [env for env in range(len(alone)) if len(alone.contacts(env))]
        assert touching
        for env in (touching[0], touching[-1]):
            for found, expected in ((spread.contacts(env), alone.contacts(env)), (spread.constraints(env), alone.constraints(env))):
                np.testing.assert_array_equal(found.force, expected.force)
                np.testing.assert_array_equal(found.pos, expected.pos)
        with pytest.raises(IndexError):
            spread.contacts(len(alone))


def test_objects_move_and_terrain_lies_as_in_a_batch_alone() -> None:
    alone, spread = pair()
    with spread:
        for batch in (alone, spread):
            drive(batch, 2, np.random.default_rng(5))
        x = np.random.default_rng(6).normal(size=(N, alone.model.nv))
        np.testing.assert_array_equal(spread.velocity(body=2, local=True), alone.velocity(body=2, local=True))
        np.testing.assert_array_equal(spread.acceleration(body=2), alone.acceleration(body=2))
        np.testing.assert_array_equal(spread.mul_mass(x), alone.mul_mass(x))
        np.testing.assert_array_equal(spread.solve_mass(x[0]), alone.solve_mass(x[0]))
        np.testing.assert_array_equal(spread.distance(0, 1), alone.distance(0, 1))
        origins = alone.xpos[:, 1:2] + [0, 0, 3]
        for start in (origins, origins[0]):
            expected, found = (batch.rays(start, [[0, 0, -1.0]], exclude_body=2) for batch in (alone, spread))
            assert (found.geom >= 0).any()
            for field in ("geom", "distance", "normal"):
                np.testing.assert_array_equal(getattr(found, field), getattr(expected, field))
        goal = clench.FrameTarget(body=1, position=alone.xpos[:, 1] + [0.1, 0, 0], quat=[1, 0, 0, 0])
        targets: list[clench.FrameTarget | clench.PostureTarget] = [goal, clench.PostureTarget(alone.qpos[0], cost=1e-3)]
        for start in (None, alone.qpos[0]):
            best, same = (batch.ik(targets, start=start, iterations=7) for batch in (alone, spread))
            for field in ("qpos", "errors", "iterations", "status", "reached"):
                np.testing.assert_array_equal(getattr(same, field), getattr(best, field))
        with pytest.raises(ValueError, match="origins has shape"):
            spread.rays(origins[:2], [[0, 0, -1.0]])


@pytest.mark.parametrize("snapshot_every", [1, 1000])
def test_what_is_tied_at_run_time_survives_a_death(snapshot_every: int) -> None:
    alone, spread = pair("pinch", snapshot_every=snapshot_every)
    first, second = alone.model.nbody - 1, alone.model.nbody - 2
    with spread:
        held = []
        for batch in (alone, spread):
            batch.step(3)
            early = batch.add_weld(first, second, envs=[6, 1])
            batch.remove(early, envs=[6, 1])
            batch.step(3)
            held.append(batch.add_connect(first, second, [0, 0, 0.01]))
            batch.step(3)
        np.testing.assert_array_equal(held[0], held[1])
        kill(spread, 0)
        kill(spread, 1)
        for batch in (alone, spread):
            batch.remove(held[0][[5, 0]], envs=[5, 0])
            held.append(batch.add_weld(first, second, envs=[0, 5]))
            batch.step(4)
        np.testing.assert_array_equal(held[2], held[3])
        assert spread.state == alone.state and spread.replaced == 2
        with pytest.raises(ValueError, match="does not exist"):
            spread.remove(held[0][[5]], envs=[5])
        with pytest.raises(IndexError, match="the environment must be"):
            spread.add_weld(first, second, envs=[7])


def test_errors_are_reported_and_change_nothing() -> None:
    alone, spread = pair()
    with spread:
        mass = alone.param("body_mass")
        mass[6, 1] = -1
        with pytest.raises(ValueError, match="body_mass"):
            spread.randomize("body_mass", mass)
        np.testing.assert_array_equal(spread.param("body_mass"), alone.param("body_mass"))
        with pytest.raises(IndexError, match="at least 0 and below 7"):
            spread.sim(7)
        with pytest.raises(ValueError, match="record"):
            spread.output("cvel")
        with pytest.raises(ValueError, match="mask must be 7 booleans"):
            spread.reset([True])
        with pytest.raises(ValueError, match="rollout needs ctrl or steps"):
            spread.rollout()
        with pytest.raises(AttributeError, match="no attribute"):
            spread.no_such_thing  # noqa: B018
        assert spread.replaced == 0
    with pytest.raises(clench.ClenchError, match="closed"):
        spread.step()
