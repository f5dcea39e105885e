"""Compares `Batch` with `Sim`: each environment is bitwise equal to a single simulation."""

from __future__ import annotations

from typing import Any

import clench
import numpy as np
import pytest
from scenes import FIELDS, example, puppet, same_bits

# More environments than lanes of any instruction set, and not a multiple of their number.
ENVS = 21

SCENES = [
    pytest.param("humanoid", 120, id="humanoid"),
    pytest.param("quadruped", 200, id="quadruped"),
    pytest.param("box_stack", 60, id="box_stack"),
    pytest.param("puppet", 200, id="puppet"),
]


def scene(name: str) -> clench.Model:
    return puppet() if name == "puppet" else example(name)


def scatter(batch: clench.Batch, seed: int) -> None:
    """Gives environments different states and parameters."""
    rng = np.random.default_rng(seed)
    model, n = batch.model, batch.n_envs
    keyframes = rng.integers(model.nkey + 1, size=n) - 1
    for key in range(model.nkey):
        batch.reset(keyframes == key, key)
    batch.qvel += rng.normal(0, 0.3, batch.qvel.shape)
    batch.eq_active[:] = rng.random(batch.eq_active.shape) < 0.7
    some = np.flatnonzero(rng.random(n) < 0.6)
    scales = rng.uniform(0.7, 1.4, (len(some), 1))
    batch.randomize("body_mass", model.body_mass * scales, some)
    batch.randomize("geom_friction", model.geom_friction * rng.uniform(0.5, 2, (n, 1, 1)))


def push(batch: clench.Batch, rng: np.random.Generator) -> None:
    """Gives every environment new controls and forces of its own."""
    batch.ctrl[:] = rng.uniform(-0.5, 0.5, batch.ctrl.shape)
    batch.qfrc_applied[:] = rng.normal(0, 0.2, batch.qfrc_applied.shape)
    batch.xfrc_applied[:, -1] = rng.normal(0, 2, (batch.n_envs, 6)) * (rng.random((batch.n_envs, 1)) < 0.3)


def differences(batch: clench.Batch, sims: list[clench.Sim], outputs: list[str]) -> list[tuple[str, int]]:
    """Returns the fields that differ between environments and their simulations."""
    found = []
    for env, sim in enumerate(sims):
        for name in FIELDS:
            own = np.asarray(getattr(sim, name), getattr(batch, name).dtype)
            if not same_bits(getattr(batch, name)[env], own):
                found.append((name, env))
        for name in outputs:
            own = np.asarray(sim.output(name), batch.output(name).dtype)
            if not same_bits(batch.output(name)[env], own):
                found.append((name, env))
    return found


@pytest.mark.parametrize("precision", ["64", "32"])
@pytest.mark.parametrize(("name", "steps"), SCENES)
def test_environments_move_as_if_alone(name: str, steps: int, precision: Any) -> None:
    # Reading `energy` recomputes positions from the state, so that later outputs would not be those of the step.
    outputs = [name for name in clench.OUTPUTS if name != "energy"]
    batch = clench.Batch(scene(name), ENVS, precision, threads=2, record=outputs)
    scatter(batch, 1)
    sims = [batch.sim(env) for env in range(ENVS)]
    assert not differences(batch, sims, [])
    rng, contacts = np.random.default_rng(2), 0
    for chunk in (1, 2, steps // 2, steps - steps // 2):
        push(batch, rng)
        for env, sim in enumerate(sims):
            for field in ("ctrl", "qfrc_applied", "xfrc_applied"):
                setattr(sim, field, getattr(batch, field)[env])
            sim.step(chunk)
        assert batch.step(chunk) == 0
        assert not differences(batch, sims, outputs)
        contacts += batch.contact_count.sum()
    assert contacts > 0
    assert len(np.unique(batch.qpos, axis=0)) == ENVS


@pytest.mark.parametrize("precision", ["64", "32"])
def test_threads_and_neighbours_do_not_matter(precision: Any) -> None:
    def run(envs: list[int], threads: int) -> clench.Batch:
        batch = clench.Batch(example("quadruped"), len(envs), precision, threads=threads, record=["cvel"])
        rng = np.random.default_rng(3)
        velocities = rng.normal(0, 1, (40, batch.qvel.shape[1]))
        batch.reset(keyframe="dropped")
        batch.qvel = velocities[envs]
        batch.randomize("body_mass", batch.model.body_mass * (1 + np.array(envs)[:, None] / 40))
        assert batch.step(150) == 0
        return batch

    everyone = list(range(40))
    reference = run(everyone, 1)
    assert reference.threads == 1
    for threads in (2, 3, 7):
        other = run(everyone, threads)
        for name in (*FIELDS, "cvel"):
            assert same_bits(getattr(other, name), getattr(reference, name)), (threads, name)
    some = [31, 7, 7, 0]
    fewer = run(some, 2)
    for name in ("qpos", "qvel", "cvel"):
        assert same_bits(getattr(fewer, name), getattr(reference, name)[some]), name


def test_simulations_of_environments_go_their_own_way() -> None:
    batch = clench.Batch(example("quadruped"), 3, options=clench.RigidOptions(iterations=9))
    batch.step(10)
    batch.randomize("body_mass", batch.model.body_mass[None] * 2, [1])
    sim = batch.sim(1)
    assert sim.model is batch.model and sim.options == batch.options
    np.testing.assert_array_equal(sim.param("body_mass"), batch.param("body_mass")[1])
    before = batch.state
    sim.step(5)
    sim.qpos[:] = 0
    sim.set_param("body_mass", batch.model.body_mass)
    for name in FIELDS:
        assert same_bits(getattr(batch, name), getattr(before, name)), name
    np.testing.assert_array_equal(batch.param("body_mass")[1], batch.model.body_mass * 2)
    cases: list[tuple[Any, type[Exception]]] = [(3, IndexError), (-1, IndexError), ("0", TypeError), (2**64, IndexError)]
    for bad, error in cases:
        with pytest.raises(error):
            batch.sim(bad)


def test_states_travel_between_both() -> None:
    batch = clench.Batch(example("humanoid"), 2)
    batch.reset(keyframe="falling")
    batch.step(100)
    sim = clench.Sim(example("humanoid"))
    for name in FIELDS:
        setattr(sim, name, getattr(batch, name)[1])
    batch.step(50)
    sim.step(50)
    for name in FIELDS:
        assert same_bits(np.asarray(getattr(sim, name)), getattr(batch, name)[1]), name
