"""Compares arrays; a failure reports the index and both numbers."""

import contextlib

import numpy as np

slack = 1.0


@contextlib.contextmanager
def looser(factor):
    """Multiplies every tolerance inside a `with` block."""
    global slack
    slack = factor
    try:
        yield
    finally:
        slack = 1.0


def assert_close(what, actual, expected, tolerance, scale):
    """Fails unless |actual − expected| ≤ tolerance · scale everywhere; scale is a number or shaped like expected."""
    tolerance *= slack
    actual, expected = np.asarray(actual, dtype=float), np.asarray(expected, dtype=float)
    if expected.size == 0:
        assert actual.size == 0, f"{what}: {actual.size} numbers, MuJoCo has none"
        return
    assert actual.shape == expected.shape, f"{what}: shape {actual.shape}, MuJoCo's is {expected.shape}"
    error = np.abs(actual - expected) / scale
    worst = np.unravel_index(np.argmax(np.where(np.isfinite(error), error, np.inf)), error.shape)
    assert np.isfinite(actual).all() and error[worst] <= tolerance, (
        f"{what}{list(map(int, worst))}: {actual[worst]:.17g}, MuJoCo {expected[worst]:.17g}, "
        f"error {error[worst]:.2e} of its scale, allowed {tolerance:.0e}"
    )


def largest(*arrays, floor=1e-9):
    """Returns the largest magnitude in the arrays, at least `floor`: the scale of sums of their elements."""
    return max([floor] + [np.abs(a).max() for a in map(np.asarray, arrays) if a.size])
