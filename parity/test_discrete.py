"""The integrator `discrete` compared with MuJoCo, on every model of the other tests.

It solves in its own metric and evaluates constraint rows at the end of the step. MuJoCo's contacts are fed in.
"""

import pathlib
import re

import mujoco
import numpy as np
import pytest

import agreement
import oracle
import program
import states
from compare import assert_close, largest

# Rounding decides in MuJoCo whether a torque at its limit counts in the metric.
UNDECIDED = ("orientations",)
FLAGS = (*program.EXACT, "--mass", "--jacobian", "--step")
SOLVERS = {"newton": 300, "cg": 3000}
STEPS = 200
NEAR = 1e-10  # tolerance after STEPS steps: rounding, amplified by motion


def discrete(path, folder, options=""):
    """Copies a model, sets the integrator and links the neighbouring files; returns the copy's path."""
    path = pathlib.Path(path).resolve()
    for beside in path.parent.iterdir():
        (folder / beside.name).symlink_to(beside)
    # PGS steps in another metric and is refused.
    text = re.sub(r'\b(integrator="\w+"|solver="PGS")', "", path.read_text())
    root = re.search(r"<mujoco[^>]*>", text).end()
    copy = folder / f"discrete {path.name}"
    copy.write_text(f'{text[:root]}<option integrator="discrete">{options}</option>{text[root:]}')
    assert mujoco.MjModel.from_xml_path(str(copy)).opt.integrator == mujoco.mjtIntegrator.mjINT_DISCRETE
    return copy


def compare(path, cone, rollouts=3, samples=2, solver="newton"):
    """Compares all results of both engines on sampled states, and the step from each state."""
    model, found = oracle.load(path, cone), 0
    flags = ("--cone", cone, "--solver", solver, "--iterations", SOLVERS[solver], *FLAGS)
    with program.Forward(path, *flags) as forward:
        for k, state in enumerate(states.sample(path, rollouts, samples, may_be_unstable=True)):
            theirs = oracle.reference(model, state)
            data = oracle.assigned(model, state)
            mujoco.mj_step(model, data)
            ours, what = forward(oracle.fed(state, theirs)), f"state {k}: "
            agreement.mass_matrix(what, ours, theirs)
            agreement.smooth_forces(what, ours, theirs)
            agreement.constraint_rows(what, ours, theirs)
            # Without constraints MuJoCo iterates for the acceleration, and sometimes terminates early.
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


@pytest.mark.parametrize("name", ["tendons", "spatial_tendons", "contacts", "equalities", "transmissions", "reflected"])
def test_with_conjugate_gradients(name, tmp_path):
    compare(discrete(program.ROOT / f"parity/models/{name}.xml", tmp_path), "elliptic", 2, 1, "cg")


@pytest.mark.parametrize(
    "name",
    ["models/humanoid", "models/arm_and_box", "models/pinch"]
    + [f"parity/models/{name}" for name in ("joints", "tendons", "spatial_tendons", "contacts", "transmissions", "reflected", "equalities")],
)
def test_without_slip(name, cone, tmp_path):
    path, sweeps = discrete(program.ROOT / f"{name}.xml", tmp_path), 100
    model = oracle.load(path, cone)
    model.opt.noslip_iterations, model.opt.noslip_tolerance = sweeps, 0.0
    flags = ("--cone", cone, "--iterations", SOLVERS["newton"], "--noslip-iterations", sweeps, "--noslip-tolerance", 0)
    with program.Forward(path, *flags, *program.EXACT) as forward:
        for k, state in enumerate(states.sample(path, 2, 2)):
            theirs = oracle.reference(model, state)
            agreement.acceleration(f"state {k}: ", forward(oracle.fed(state, theirs)), theirs)


@pytest.mark.parametrize("name", ["joints", "spatial_tendons", "controllers", "muscles", "equalities", "contacts", "medium", "transmissions"])
def test_trajectory(name, tmp_path):
    """Compares each step from the initial state with own contacts: one environment, and environments in lanes."""
    path = discrete(program.ROOT / f"parity/models/{name}.xml", tmp_path)
    model = oracle.load(path)
    data, expected = mujoco.MjData(model), []
    for _ in range(STEPS):
        mujoco.mj_step(model, data)
        expected.append(data.qpos.copy())
    flags = ("--steps", STEPS, "--iterations", SOLVERS["newton"], *program.EXACT)
    alone, _ = program.simulate(path, *flags)
    assert_close("qpos", alone["qpos"][-STEPS:], expected, NEAR, 1.0)
    many, _ = program.simulate(path, *flags, "--envs", 5)
    for env in range(5):
        assert np.array_equal(many["qpos"][env], alone["qpos"]), f"environment {env}"


@pytest.mark.parametrize("name", ["stack_and_ball", "couplings"])
def test_sleep(name, tmp_path):
    """Trees fall asleep in the same step."""
    path, steps = discrete(program.ROOT / f"parity/sleeping/{name}.xml", tmp_path), 1200
    model = oracle.load(path)
    data, expected = mujoco.MjData(model), []
    for _ in range(steps):
        mujoco.mj_step(model, data)
        expected.append(data.tree_asleep.copy())
    record, _ = program.simulate(path, "--steps", steps, "--iterations", SOLVERS["newton"], *program.EXACT)
    assert (np.diff((np.array(expected) >= 0).astype(int), axis=0) != 0).sum() >= 4, "nothing to compare"
    assert np.array_equal(record["tree_asleep"], expected)


@pytest.mark.parametrize(
    "name, options, words",
    [
        ("models/tendons", "<flag sleep='enable'/>", ""),
        ("sleeping/couplings", "", ""),
        ("models/contacts", "<flag sleep='enable' island='disable'/>", "islands"),
    ],
)
def test_what_is_refused(name, options, words, tmp_path):
    """Sleep without islands is refused, as in MuJoCo; couplings of trees that never sleep are accepted."""
    path = discrete(program.ROOT / f"parity/{name}.xml", tmp_path, options)
    done = program.run("simulate", path, "--steps", 1)
    assert (done.returncode == 0) == (words == "") and words in done.stderr, done.stderr


def test_an_actuator_over_a_tree_that_sleeps_is_refused(tmp_path):
    """MuJoCo accepts it, and a limit with zero force changes the acceleration of the tree that is awake."""
    path = tmp_path / "winch.xml"
    path.write_text("""
        <mujoco>
          <option integrator="discrete"><flag sleep="enable"/></option>
          <worldbody>
            <body sleep="allowed"><joint name="left" type="slide"/><geom size="0.1"/></body>
            <body pos="0 1 0"><joint name="right" type="slide"/><geom size="0.1"/></body>
          </worldbody>
          <tendon><fixed name="rope"><joint joint="left" coef="1"/><joint joint="right" coef="-1"/></fixed></tendon>
          <actuator><position name="winch" tendon="rope"/></actuator>
        </mujoco>""")
    assert oracle.load(path).opt.integrator == mujoco.mjtIntegrator.mjINT_DISCRETE
    done = program.run("simulate", path, "--steps", 1)
    assert done.returncode != 0 and 'sleep and actuator "winch"' in done.stderr, done.stderr
