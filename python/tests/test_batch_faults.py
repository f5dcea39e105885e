"""`clench.Batch` with failing environments: they stop and report the reason, without effect on others."""

from __future__ import annotations

from typing import Any

import clench
import numpy as np
import pytest
from scenes import FIELDS, ball, example, poisoned, same_bits


def test_failed_environments_stand_still() -> None:
    batch = poisoned()
    status = batch.status
    assert status.dtype == np.int8 and batch.running.dtype == bool
    np.testing.assert_array_equal(status, [0, 1, 0, 1, 0])
    np.testing.assert_array_equal(batch.running, [True, False, True, False, True])
    assert clench.EnvStatus(status[1]) is clench.EnvStatus.NOT_FINITE
    assert batch.fault(0) is None
    assert "qvel" in str(batch.fault(1))
    frozen = batch.state
    assert batch.step(20) == 0
    for name in FIELDS:
        assert same_bits(getattr(batch, name)[[1, 3]], getattr(frozen, name)[[1, 3]]), name
    assert (batch.time[[0, 2, 4]] > frozen.time[[0, 2, 4]]).all()
    cases: list[tuple[Any, type[Exception]]] = [(5, IndexError), (-1, IndexError), ("0", TypeError), (None, TypeError)]
    for bad, error in cases:
        with pytest.raises(error):
            batch.fault(bad)


def test_neighbours_of_failed_environments_do_not_notice() -> None:
    sick, well = poisoned(), clench.Batch(example("quadruped"), 5)
    well.step(4)
    sick.step(50)
    well.step(50)
    for name in FIELDS:
        assert same_bits(getattr(sick, name)[[0, 2, 4]], getattr(well, name)[[0, 2, 4]]), name


def test_reset_heals() -> None:
    batch = poisoned()
    batch.reset([False, True, False, False, False])
    np.testing.assert_array_equal(batch.running, [True, True, True, False, True])
    assert batch.fault(1) is None and batch.fault(3) is not None
    assert batch.step(10) == 0


def test_revive_goes_on_from_the_rows() -> None:
    batch = poisoned()
    batch.qvel[[1, 3], 2] = 0
    expected = batch.sim(1)
    batch.revive([False, True, False, False, False])
    np.testing.assert_array_equal(batch.running, [True, True, True, False, True])
    assert batch.step() == 0
    expected.step()
    np.testing.assert_array_equal(batch.qpos[1], expected.qpos)
    batch.qvel[3, 2] = np.nan
    batch.revive()
    assert batch.step() == 1
    batch.qvel[3, 2] = 0
    batch.revive()
    assert batch.running.all() and batch.step() == 0


def test_status_is_a_copy() -> None:
    batch = poisoned()
    batch.status[:] = 0
    batch.running[:] = True
    np.testing.assert_array_equal(batch.running, [True, False, True, False, True])


def test_ways_to_fail() -> None:
    tight = clench.Batch(example("box_stack"), 2, options=clench.RigidOptions(max_contacts=3))
    assert tight.step() == 2
    np.testing.assert_array_equal(tight.status, clench.EnvStatus.CONTACT_OVERFLOW)
    assert "contacts" in str(tight.fault(0))
    wild = clench.Batch(ball(), 2)
    wild.qvel[0, [0, 4]] = 1e308
    wild.step(100)
    np.testing.assert_array_equal(wild.running, [False, True])
    assert wild.status[0] in (clench.EnvStatus.DIVERGED, clench.EnvStatus.NOT_FINITE)
    assert np.isfinite(wild.qpos).all()


@pytest.mark.parametrize("precision", ["64", "32"])
def test_autoreset(precision: Any) -> None:
    options = clench.RigidOptions(autoreset=True)
    batch = clench.Batch(ball(), 3, precision, options=options)
    batch.qpos[:, 2] = 5
    batch.qvel[1, 0] = 1e11
    assert batch.step(2) == 0 and batch.running.all()
    np.testing.assert_array_equal(batch.resets, [0, 1, 0])
    assert batch.qpos[1, 2] < 4 < batch.qpos[0, 2]
    fresh = clench.Batch(ball(), 1, precision)
    fresh.step(2)
    np.testing.assert_array_equal(batch.qpos[1], fresh.qpos[0])
