"""The integrator `discrete` beside MuJoCo, on every model of the other tests: it solves in a metric of its own, and takes rows of
constraints at the end of the step. MuJoCo's contacts are fed in."""

import pathlib
import re

import mujoco
import pytest

import agreement
import oracle
import program
import states
from compare import assert_close, largest

# Rounding decides in MuJoCo whether a torque at its limit counts in the metric.
UNDECIDED = ("orientations",)
FLAGS = ("--solver", "newton", "--iterations", 300, *program.EXACT, "--mass", "--jacobian", "--step")


def discrete(path, folder, options=""):
    """A copy of a model that steps with the integrator, beside links to what lies beside the model."""
    path = pathlib.Path(path).resolve()
    for beside in path.parent.iterdir():
        (folder / beside.name).symlink_to(beside)
    text = re.sub(r'\b(integrator="\w+"|solver="PGS")', "", path.read_text())  # PGS steps in another metric, and is refused
    root = re.search(r"<mujoco[^>]*>", text).end()
    copy = folder / f"discrete {path.name}"
    copy.write_text(f'{text[:root]}<option integrator="discrete">{options}</option>{text[root:]}')
    assert mujoco.MjModel.from_xml_path(str(copy)).opt.integrator == mujoco.mjtIntegrator.mjINT_DISCRETE
    return copy


def compare(path, cone, rollouts=3, samples=2):
    """Everything that both say of sampled states, and of the step from them."""
    model, found = oracle.load(path, cone), 0
    with program.Forward(path, "--cone", cone, *FLAGS) as forward:
        for k, state in enumerate(states.sample(path, rollouts, samples, may_be_unstable=True)):
            theirs = oracle.reference(model, state)
            data = oracle.assigned(model, state)
            mujoco.mj_step(model, data)
            ours, what = forward(oracle.fed(state, theirs)), f"state {k}: "
            agreement.mass_matrix(what, ours, theirs)
            agreement.smooth_forces(what, ours, theirs)
            agreement.constraint_rows(what, ours, theirs)
            # Without constraints MuJoCo's acceleration is what its iterations have found, some of which end early.
            solved = agreement.SOLVED + 2 * oracle.distance_to_optimum(theirs)
            agreement.acceleration(what, ours, theirs, solved)
            scale = largest(theirs.qfrc_constraint, theirs.qfrc_smooth)
            assert_close(what + "qfrc_constraint", ours["qfrc_constraint"], theirs.qfrc_constraint, solved, scale)
            agreement.sensors(model, what, ours, theirs, 10 * solved)
            change = model.opt.timestep * oracle.acceleration_scale(theirs)
            assert_close(what + "next qvel", ours["next"]["qvel"], data.qvel, solved, change + 1e-8 * largest(data.qvel))
            found += 1
    assert found > 0


def test_as_mujoco(model, cone, tmp_path):
    if model.stem in UNDECIDED:
        pytest.skip("rounding decides")
    compare(discrete(model, tmp_path), cone)


@pytest.mark.parametrize("flag", ["refsafe='disable'", "diagexact='enable'", "spring='disable'", "damper='disable'", "actuation='disable'"])
@pytest.mark.parametrize("name", ["tendons", "spatial_tendons", "joints", "contacts", "equalities", "transmissions"])
def test_with_flags(name, flag, tmp_path):
    compare(discrete(program.ROOT / f"parity/models/{name}.xml", tmp_path, f"<flag {flag}/>"), "elliptic", 2, 1)
