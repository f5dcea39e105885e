"""Sleep of bodies at rest in Python's API."""

from __future__ import annotations

import functools
from typing import Any

import clench
import numpy as np
import pytest
from scenes import same_state

BOXES = """
<mujoco>
  <option timestep="0.004"><flag sleep="enable"/></option>
  <worldbody>
    <geom type="plane" size="0 0 1"/>
    <body><freejoint/><geom type="box" size="0.1 0.1 0.1" pos="0 0 0.1"/></body>
    <body pos="0 0 0.2"><freejoint/><geom type="box" size="0.1 0.1 0.1" pos="0 0 0.1"/></body>
    <body pos="1 0 0.5" sleep="init"><freejoint/><geom size="0.1"/></body>
  </worldbody>
</mujoco>"""


@functools.cache
def boxes() -> clench.Model:
    return clench.Model.from_xml(BOXES)


def rested(kind: str) -> Any:
    own = clench.Sim(boxes()) if kind == "sim" else clench.Batch(boxes(), 5)
    own.step(400)
    return own


def test_what_rests_sleeps_until_it_is_moved() -> None:
    sim = clench.Sim(boxes())
    assert sim.tree_asleep.dtype == np.int32 and sim.pose_asleep.shape == (21,)
    np.testing.assert_array_equal(sim.tree_asleep, [-10, -10, 2])
    sim.step(400)
    np.testing.assert_array_equal(sim.tree_asleep, [1, 0, 2])
    qpos = sim.qpos.copy()
    sim.step(50)
    np.testing.assert_array_equal(sim.qpos, qpos)
    assert not sim.qvel.any() and not sim.qacc.any()
    sim.qpos[7] += 1e-6
    sim.step()
    assert (sim.tree_asleep[:2] < 0).all() and sim.tree_asleep[2] == 2


def test_environments_sleep_each_on_its_own() -> None:
    batch = rested("batch")
    batch.qvel[3, 0] = 0.1
    batch.step()
    assert ((batch.tree_asleep < 0).any(axis=1) == [False, False, False, True, False]).all()


@pytest.mark.parametrize("kind", ["sim", "batch"])
def test_states_hold_what_sleeps(kind: str) -> None:
    own, other = rested(kind), clench.Sim(boxes()) if kind == "sim" else clench.Batch(boxes(), 5)
    other.state = clench.State.from_bytes(own.state.to_bytes())
    for each in (own, other):
        each.step(20)
    assert same_state(own.state, other.state)
    assert (own.tree_asleep >= 0).all()


def test_nothing_is_kept_where_nothing_may_sleep() -> None:
    batch = clench.Batch(clench.Model.from_xml(BOXES.replace("enable", "disable")), 2)
    assert batch.tree_asleep.shape == batch.pose_asleep.shape == (2, 0)
