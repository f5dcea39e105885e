"""Integers of any size and sign in place of counts, sizes and indices: the errors are those that the documentation
names, never a bare OverflowError."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import clench
import numpy as np
import pytest
from scenes import example

HUGE = 2**70


def pendulum() -> clench.Sim:
    return clench.Sim(example("pendulum"))


@pytest.mark.parametrize("wrong", [-1, HUGE])
@pytest.mark.parametrize(
    ("call", "error"),
    [
        (lambda sim, k: sim.render(k, 8, device="cpu", kind="depth"), ValueError),
        (lambda sim, k: sim.render(8, k, device="cpu", kind="depth"), ValueError),
        (lambda sim, k: sim.remove(k), ValueError),
        (lambda sim, k: clench.Recording(limit=k), ValueError),
        (lambda sim, k: clench.Recording().append(sim, k), IndexError),
        (lambda sim, k: clench.Batch(sim.model, 2).fault(k), IndexError),
        (lambda sim, k: sim.body(k), IndexError),
    ],
)
def test_integers_out_of_range_are_errors_of_their_kind(call: Callable[[clench.Sim, int], Any], error: type[Exception], wrong: int) -> None:
    with pytest.raises(error):
        call(pendulum(), wrong)


@pytest.mark.parametrize("groups", [[6], [-1], [0, 9]])
def test_groups_of_pictures_are_zero_to_five(groups: list[int]) -> None:
    for owner in (pendulum(), clench.Batch(example("pendulum"), 2)):
        with pytest.raises(IndexError, match="indices go from 0 to 5"):
            owner.render(width=8, height=8, device="cpu", kind="depth", groups=groups)


def test_directions_of_rays_have_a_length() -> None:
    sim, batch = pendulum(), clench.Batch(example("pendulum"), 2, precision="32")
    down, none = [0.0, 0.0, -1.0], [0.0, 0.0, 0.0]
    with pytest.raises(ValueError, match=r"directions\[1\] has no length"):
        sim.rays([[0, 0, 1]], [down, none])
    each = np.array([[down, down], [none, down]])
    with pytest.raises(ValueError, match=r"directions\[1, 0\] has no length"):
        batch.rays([[0, 0, 1]], each)
    # This direction is zero in single precision.
    with pytest.raises(ValueError, match=r"directions\[0\] has no length"):
        batch.rays([[0, 0, 1]], [[1e-60, 0, 0]])
    assert sim.rays(np.empty((0, 3)), np.empty((0, 3))).geom.shape == (0,)
