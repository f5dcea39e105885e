"""`clench.Sim` with a state that is not finite or a motion that diverges."""

from __future__ import annotations

from typing import Any

import clench
import numpy as np
import pytest
from scenes import ball, example, same_state


@pytest.mark.parametrize(
    ("name", "value"),
    [("qpos", np.nan), ("qvel", np.inf), ("ctrl", np.nan), ("qfrc_applied", -np.inf), ("xfrc_applied", np.nan)],
)
def test_numbers_that_are_not_finite(name: str, value: Any) -> None:
    sim = clench.Sim(example("quadruped"))
    sim.step(3)
    good = sim.state
    getattr(sim, name)[0] = value
    bad = sim.state
    for call in (sim.step, sim.forward, lambda: sim.step(100)):
        with pytest.raises(clench.SimulationError, match=name):
            call()
        assert same_state(sim.state, bad)
    sim.state = good
    sim.step()


def test_motion_that_diverges() -> None:
    sim = clench.Sim(ball())
    sim.qvel[0] = 1e308
    sim.qvel[4] = 1e308
    with pytest.raises(clench.SimulationError) as raised:
        sim.step(1000)
    assert isinstance(raised.value, clench.ClenchError) and isinstance(raised.value, RuntimeError)
    assert np.isfinite(sim.qpos).all() and np.isfinite(sim.qvel).all()
    sim.reset()
    sim.step()


def test_steps_before_a_fault_are_done() -> None:
    sim = clench.Sim(example("pendulum"), clench.RigidOptions(disable_constraint=True))
    sim.ctrl[0] = 5
    sim.set_param("actuator_ctrlrange", [[-1e308, 1e308]])
    sim.ctrl[0] = 1e9
    with pytest.raises(clench.SimulationError, match=r'\[0\] became .* at joint "bearing" of body'):
        sim.step(10_000)
    assert 0 < sim.time < 20
    assert np.isfinite(sim.qpos).all()


def test_autoreset() -> None:
    sim = clench.Sim(ball(), clench.RigidOptions(autoreset=True))
    assert sim.resets == 0
    sim.qvel[0] = 1e11
    sim.xfrc_applied[1, 0] = 1
    sim.step(3)
    assert sim.resets == 1 and sim.time == pytest.approx(3 * sim.model.timestep)
    assert (sim.xfrc_applied == 0).all()
    fresh = clench.Sim(ball())
    fresh.step(3)
    assert same_state(sim.state, fresh.state)


def test_with_autoreset_the_first_half_of_a_step_shows_the_initial_state() -> None:
    sim = clench.Sim(ball(), clench.RigidOptions(autoreset=True))
    start = sim.qpos.copy()
    seen = []
    sim.step(3)
    sim.qpos[0] = np.nan
    sim.step(1, lambda sim: seen.append(sim.qpos.copy()))
    np.testing.assert_array_equal(seen, [start])
    assert sim.resets == 1 and sim.time == sim.model.timestep


def test_with_autoreset_a_forward_pass_resets_nothing() -> None:
    sim = clench.Sim(ball(), clench.RigidOptions(autoreset=True))
    sim.step(3)
    sim.qfrc_applied[0] = 1e15
    before = sim.state
    with pytest.raises(clench.SimulationError, match="diverged"):
        sim.forward()
    assert same_state(sim.state, before) and sim.resets == 0
