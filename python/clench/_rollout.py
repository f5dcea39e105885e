"""The Python part of `Batch.rollout`: progress, controls that are computed at each step, and interrupts."""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from clench._core import Batch
from clench._state import State

_INTERVAL = 0.1  # s


class Progress:
    """Writes the progress of a rollout of `n_envs` environments to stderr, in one line."""

    def __init__(self, n_envs: int) -> None:
        self._n_envs = n_envs
        self._begin = time.monotonic()
        self._written = self._begin
        self._width = 0

    def __call__(self, done: int, steps: int) -> None:
        now = time.monotonic()
        if done < steps and now - self._written < _INTERVAL:
            return
        self._written = now
        rate = done / max(now - self._begin, 1e-9)
        left = f", {(steps - done) / rate:.0f} s left" if 0 < done < steps else ""
        line = f"rollout: {done} of {steps} steps, {self._n_envs * rate:.3g} environment steps/s{left}"
        sys.stderr.write(f"\r{line:{self._width}}" + ("\n" if done == steps else ""))
        sys.stderr.flush()
        self._width = len(line)


def interrupted(done: int, steps: int, depth: int = 2) -> None:
    """Warns that Ctrl-C ended a rollout, which was called `depth` Python frames above."""
    warnings.warn(f"the rollout was interrupted after {done} of {steps} steps", RuntimeWarning, stacklevel=depth)


def controlled(
    batch: Batch,
    initial: State | ArrayLike | None,
    policy: Callable[[int], ArrayLike | None],
    record: Sequence[str],
    steps: int,
    progress: Callable[[int, int], object] | None,
) -> dict[str, NDArray[Any]]:
    """Runs a rollout whose controls are computed at each step."""
    # This call sets the initial states and validates the names.
    none = batch.rollout(initial, None, record, 0)
    rows = {name: np.full((batch.n_envs, steps, *array.shape[2:]), np.nan, array.dtype) for name, array in none.items()}
    step = 0
    try:
        for step in range(steps):
            ctrl = policy(step)
            # Adds an axis of steps before that of actuators.
            part = batch.rollout(None, None if ctrl is None else np.atleast_1d(ctrl)[..., None, :], record, 1)
            for name, array in part.items():
                rows[name][:, step] = array[:, 0]
            if progress is not None:
                progress(step + 1, steps)
    except KeyboardInterrupt:
        interrupted(step, steps, 3)
    return rows
