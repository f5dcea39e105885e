"""Equal solutions of a problem by different algorithms: sparse or dense, islands or not, CG or Newton, warm or cold.

These tests compare Clench with itself, with its own contacts, at tolerance 0.
"""

import functools

import numpy as np

import program
import states
from compare import assert_close, largest


@functools.lru_cache(maxsize=None)
def accelerations(model, cone, *flags):
    with program.Forward(model, "--cone", cone, *program.EXACT, *flags) as forward:
        return [forward(state) for state in states.sample(model)]


def assert_same(model, cone, flags, other_flags, tolerance):
    pairs = zip(accelerations(model, cone, *flags), accelerations(model, cone, *other_flags), strict=True)
    for k, (one, other) in enumerate(pairs):
        scale = largest(one["qacc"], one["qacc_smooth"])
        assert_close(f"state {k}: qacc", other["qacc"], one["qacc"], tolerance, scale)


def test_sparse_equals_dense(model, cone):
    assert_same(model, cone, ("--sparse", "off"), ("--sparse", "on"), 1e-9)


def test_islands_change_nothing(model, cone):
    assert_same(model, cone, ("--islands", "off"), ("--islands", "on"), 1e-9)


def test_cg_reaches_newton(model, cone):
    newton, cg = (("--solver", name, "--iterations", "1000") for name in ("newton", "cg"))
    assert_same(model, cone, newton, cg, 1e-7)


def test_every_solve_reports_itself(model, cone):
    for result in accelerations(model, cone, "--iterations", "1000"):
        report = result["solver"]
        assert {"status", "iterations", "gradient", "improvement", "gap"} <= report.keys()
        numbers = [report[name] for name in ("gradient", "improvement", "gap")]
        assert np.isfinite(numbers).all() and report["iterations"] >= 0
