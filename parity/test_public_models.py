"""Compares accelerations and sensors of public models with MuJoCo, whose contacts are fed in, on a few states each."""

import functools

import pytest

import agreement
import oracle
import program
import public
import states
from compare import assert_close

ROLLOUTS, SAMPLES = 2, 2
# Relative to the accelerations involved: masses and stiffnesses of public models span many orders of magnitude.
PRECISION = 1e-6


@functools.lru_cache(maxsize=None)
def answers(name):
    """Returns the oracle's model, and pairs of Clench's and MuJoCo's results."""
    path = public.path(name)
    model = oracle.load(path)
    found = states.sample(path, ROLLOUTS, SAMPLES, may_be_unstable=True)
    references = [oracle.reference(model, state) for state in found]
    with program.Forward(path, "--iterations", 300, "--noslip-iterations", 0, *program.EXACT) as forward:
        return model, [(forward(oracle.fed(s, r)), r) for s, r in zip(found, references, strict=True)]


@pytest.mark.parametrize("name", public.compared(), ids=lambda name: name)
def test_accelerations_and_sensors(name):
    model, pairs = answers(name)
    for k, (ours, theirs) in enumerate(pairs):
        scale = oracle.acceleration_scale(theirs) if model.nv else 1.0
        assert_close(f"state {k}: qacc", ours["qacc"], theirs.qacc, PRECISION, scale)
        agreement.sensors(model, f"state {k}: ", ours, theirs, PRECISION)
