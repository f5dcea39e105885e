"""Compares public URDF files with MuJoCo: mass matrix, bias and accelerations, on eight states each."""

import functools

import mujoco
import numpy as np
import pytest

import oracle
import program
import public
import states
import urdf
from compare import assert_close, largest

ROLLOUTS, SAMPLES = 4, 2
PRECISION = 1e-6  # values span many orders of magnitude, and meshes have 24 bits
FILES = 103  # in both packages; MuJoCo reads AS_WRITTEN of them, and REPAIRED more after repair
AS_WRITTEN, REPAIRED = 60, 17


def identity(entry):
    return entry.name


@functools.lru_cache(maxsize=None)
def answers(name, how):
    """Returns the oracle's model, and pairs of Clench's and MuJoCo's results."""
    path = urdf.copy(name, how == "repaired")
    model = oracle.load(path)
    found = states.sample(path, ROLLOUTS, SAMPLES, may_be_unstable=True) or [{}]
    references = [oracle.reference(model, state) for state in found]
    ours = path if how == "repaired" else public.path(name)
    flags = ("--iterations", 300, *program.EXACT, "--mass", *urdf.FLAGS)
    with program.Forward(ours, *flags) as forward:
        return model, [(forward(oracle.fed(s, r)), r) for s, r in zip(found, references, strict=True)]


def test_every_file_is_listed():
    entries = list(urdf.listed())
    assert sorted(entry.name for entry in entries) == urdf.found()
    assert len(entries) == FILES
    counts = [sum(entry.how == how for entry in entries) for how in ("as written", "repaired")]
    assert counts == [AS_WRITTEN, REPAIRED]


@pytest.mark.parametrize("entry", urdf.compared(), ids=identity)
def test_dynamics(entry, record_property):
    model, pairs = answers(entry.name, entry.how)
    worst = dict.fromkeys(("mass", "bias", "qacc"), 0.0)
    for k, (ours, theirs) in enumerate(pairs):
        diagonal = np.sqrt(np.diag(theirs.mass))
        smooth = largest(theirs.qfrc_bias, theirs.qfrc_passive, theirs.qfrc_actuator)
        compare = (
            ("mass", ours["mass"], theirs.mass, np.outer(diagonal, diagonal)),
            ("bias", ours["qfrc_bias"], theirs.qfrc_bias, smooth),
            ("qacc", ours["qacc"], theirs.qacc, oracle.acceleration_scale(theirs) if model.nv else 1.0),
        )
        for what, actual, expected, scale in compare:
            assert_close(f"state {k}: {what}", actual, expected, PRECISION, scale)
            error = np.abs(np.asarray(actual) - expected) / scale
            worst[what] = max(worst[what], error.max(initial=0.0))
    errors = "  ".join(f"{what} {error:.0e}" for what, error in worst.items())
    record_property("urdf", f"{entry.name:<90} {entry.how:<10} {model.nbody:3} bodies {model.nv:3} dofs  {errors}")


@pytest.mark.parametrize("entry", urdf.refused(), ids=identity)
def test_what_mujoco_refuses(entry, record_property):
    """MuJoCo still gives this reason; if Clench refuses the file too, it reports the location."""
    for repair in (False, True):
        with pytest.raises(ValueError, match=entry.reason):
            mujoco.MjModel.from_xml_path(str(urdf.copy(entry.name, repair)))
    done = program.run("inspect", public.path(entry.name), *urdf.FLAGS)
    answer = "read" if done.returncode == 0 else done.stderr.strip().splitlines()[-1]
    assert done.returncode == 0 or f"{entry.name}:" in done.stderr
    record_property("urdf", f"{entry.name:<90} refused by MuJoCo: {entry.reason}\n    clench: {answer}")
