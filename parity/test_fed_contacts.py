"""`clench forward` against MuJoCo with MuJoCo's own contacts fed in: dynamics, constraint rows, accelerations, forces.

What precedes the solver differs by rounding alone (1e-10); accelerations agree to 1e-8 of the accelerations involved.
"""

import functools

import numpy as np

import oracle
import program
import states
from compare import assert_close, largest

ROUNDING = 1e-10
SOLVED = 1e-8
KIND = dict(enumerate(("equality", "friction_dof", "friction_tendon", "limit_joint", "limit_tendon", *3 * ["contact"])))
ITERATIONS = {"newton": 300, "cg": 3000}


@functools.lru_cache(maxsize=None)
def answers(model, cone, solver):
    """Pairs of clench's and MuJoCo's results on every sampled state."""
    flags = ("--cone", cone, "--solver", solver, "--iterations", ITERATIONS[solver], *program.EXACT)
    with program.Forward(model, *flags, "--mass", "--jacobian") as forward:
        pairs = zip(states.sample(model), oracle.references(model, cone), strict=True)
        return [(forward(oracle.fed(state, reference)), reference) for state, reference in pairs]


def numbered(model, cone, solver="newton"):
    for k, (ours, theirs) in enumerate(answers(model, cone, solver)):
        yield f"state {k}: ", ours, theirs


def test_the_oracle_has_converged(model, cone):
    for k, reference in enumerate(oracle.references(model, cone)):
        assert oracle.distance_to_optimum(reference) < SOLVED / 10, f"state {k}"


def test_mass_matrix(model):
    for state, ours, theirs in numbered(model, "pyramidal"):
        diagonal = np.sqrt(np.diag(theirs.mass))
        assert_close(state + "mass", ours["mass"], theirs.mass, ROUNDING, np.outer(diagonal, diagonal))


def test_smooth_forces(model):
    """Bias, passive and actuator forces share one scale a state: they come from sums that may cancel."""
    for state, ours, theirs in numbered(model, "pyramidal"):
        scale = largest(theirs.qfrc_bias, theirs.qfrc_passive, theirs.qfrc_actuator)
        for name in ("qfrc_bias", "qfrc_passive", "qfrc_actuator"):
            assert_close(state + name, ours[name], getattr(theirs, name), ROUNDING, scale)
        scale = oracle.acceleration_scale(theirs)
        assert_close(state + "qacc_smooth", ours["qacc_smooth"], theirs.qacc_smooth, 10 * ROUNDING, scale)


def test_constraint_rows(model, cone):
    """Violation, Jacobian, velocity, reference acceleration and D, row by row in MuJoCo's order."""
    for state, ours, theirs in numbered(model, cone):
        count = len(theirs.efc_pos)
        assert len(ours["constraints"]) == count, f"{state}{len(ours['constraints'])} rows, MuJoCo has {count}"
        assert [row["kind"] for row in ours["constraints"]] == [KIND[t] for t in theirs.efc_type], state
        if count == 0:
            continue
        row_size = np.abs(theirs.jacobian).max(axis=1, initial=1e-9)
        speed = row_size * largest(theirs.qvel)
        stiffness, damping, impedance = np.abs(theirs.efc_KBIP[:, :3].T)
        # The reference acceleration is a sum: damping times a velocity, stiffness times a violation known to 1e-15 m.
        violation = np.abs(theirs.efc_pos - theirs.efc_margin)
        asked = np.abs(theirs.efc_aref) + damping * speed + stiffness * impedance * (violation + 1e-5)
        assert_close(state + "pos", program.rows(ours, "pos"), theirs.efc_pos, ROUNDING, 1.0)
        assert_close(state + "jacobian", ours["jacobian"], theirs.jacobian, ROUNDING, row_size[:, None])
        assert_close(state + "vel", program.rows(ours, "vel"), theirs.efc_vel, ROUNDING, speed)
        assert_close(state + "D", program.rows(ours, "D"), theirs.efc_D, ROUNDING, theirs.efc_D)
        assert_close(state + "aref", program.rows(ours, "aref"), theirs.efc_aref, ROUNDING, asked)


def test_acceleration(model, cone, solver):
    for state, ours, theirs in numbered(model, cone, solver):
        solve = f"{state}{ours['solver']} "
        assert_close(solve + "qacc", ours["qacc"], theirs.qacc, SOLVED, oracle.acceleration_scale(theirs))


def test_constraint_forces(model, cone, solver):
    """Row forces and what they do together; each contact's force in its frame."""
    for state, ours, theirs in numbered(model, cone, solver):
        scale = largest(theirs.qfrc_constraint, theirs.qfrc_smooth)
        assert_close(state + "qfrc_constraint", ours["qfrc_constraint"], theirs.qfrc_constraint, SOLVED, scale)
        scale = largest(theirs.efc_force, floor=1e-3)
        assert_close(state + "force", program.rows(ours, "force"), theirs.efc_force, 10 * SOLVED, scale)
        count = len(theirs.contacts)
        assert len(ours["contacts"]) == count, f"{state}{len(ours['contacts'])} contacts, fed {count}"
        for k, contact in enumerate(theirs.contacts):
            actual = ours["contacts"][k]["force"]
            assert_close(f"{state}contact {k} force", actual, contact["force"], 10 * SOLVED, scale)
