"""Compares `clench forward` with MuJoCo, whose contacts are fed in: dynamics, constraint rows and forces."""

import functools

import agreement
import oracle
import program
import states

ITERATIONS = {"newton": 300, "cg": 3000}


@functools.lru_cache(maxsize=None)
def answers(model, cone, solver):
    """Returns pairs of Clench's and MuJoCo's results on every sampled state."""
    flags = ("--cone", cone, "--solver", solver, "--iterations", ITERATIONS[solver], *program.EXACT)
    with program.Forward(model, *flags, "--mass", "--jacobian") as forward:
        pairs = zip(states.sample(model), oracle.references(model, cone), strict=True)
        return [(forward(oracle.fed(state, reference)), reference) for state, reference in pairs]


def numbered(model, cone, solver="newton"):
    for k, (ours, theirs) in enumerate(answers(model, cone, solver)):
        yield f"state {k}: ", ours, theirs


def test_the_oracle_has_converged(model, cone):
    for k, reference in enumerate(oracle.references(model, cone)):
        assert oracle.distance_to_optimum(reference) < agreement.SOLVED / 10, f"state {k}"


def test_mass_matrix(model):
    for case in numbered(model, "pyramidal"):
        agreement.mass_matrix(*case)


def test_smooth_forces(model):
    for case in numbered(model, "pyramidal"):
        agreement.smooth_forces(*case)


def test_constraint_rows(model, cone):
    for case in numbered(model, cone):
        agreement.constraint_rows(*case)


def test_acceleration(model, cone, solver):
    for case in numbered(model, cone, solver):
        agreement.acceleration(*case)


def test_constraint_forces(model, cone, solver):
    for case in numbered(model, cone, solver):
        agreement.constraint_forces(*case)


def test_sensors(model, cone):
    for case in numbered(model, cone):
        agreement.sensors(oracle.load(model), *case)
