"""`clench forward` against MuJoCo, each finding its own contacts.

Held to it are the pairs of shapes that MuJoCo solves in closed form. For the rest (a cylinder on a capsule, box or
cylinder) MuJoCo iterates to a tolerance of its own and chooses points by another rule, so states in which such a pair
touches are left out, and a model must keep some states.
"""

import functools

import mujoco
import numpy as np

import oracle
import program
import states
from compare import assert_close

SAME_POINT = 1e-8  # metres, and radians of the frame
SOLVED = 1e-6

PLANE, SPHERE, CAPSULE, BOX, CYLINDER = (
    int(getattr(mujoco.mjtGeom, f"mjGEOM_{name}")) for name in ("PLANE", "SPHERE", "CAPSULE", "BOX", "CYLINDER")
)
CLOSED_FORM = {(a, b) for a in (PLANE, SPHERE, CAPSULE, BOX) for b in (PLANE, SPHERE, CAPSULE, BOX)}
CLOSED_FORM |= {(PLANE, CYLINDER), (SPHERE, CYLINDER)}


@functools.lru_cache(maxsize=None)
def comparable(model, cone):
    """(state number, clench's result, MuJoCo's result) where every touching pair has a closed form."""
    geom_type = oracle.load(model, cone).geom_type
    closed = lambda c: tuple(sorted(int(geom_type[g]) for g in c["geom"])) in CLOSED_FORM
    with program.Forward(model, "--cone", cone, "--iterations", 300, *program.EXACT) as forward:
        pairs = zip(states.sample(model), oracle.references(model, cone), strict=True)
        both = [(k, forward(state), theirs) for k, (state, theirs) in enumerate(pairs)]
    return [(k, ours, theirs) for k, ours, theirs in both if all(map(closed, ours["contacts"] + theirs.contacts))]


def test_some_states_are_comparable(model):
    assert len(comparable(model, "pyramidal")) >= len(states.sample(model)) // 4


def test_contact_sets(model):
    """The same pairs, points, depths, frames, dimensions and friction, whatever their order."""
    for k, ours, theirs in comparable(model, "pyramidal"):
        left = list(ours["contacts"])
        for contact in theirs.contacts:
            same_pair = [c for c in left if c["geom"] == contact["geom"]]
            assert same_pair, f"state {k}: MuJoCo has {brief(contact)}, we have left {list(map(brief, left))}"
            nearest = min(same_pair, key=lambda c: np.linalg.norm(np.subtract(c["pos"], contact["pos"])))
            left.remove(nearest)
            for field in ("dim", "dist", "pos", "frame", "friction"):
                actual, expected = (np.ravel(c[field]) for c in (nearest, contact))
                assert_close(f"state {k}: {brief(contact)} {field}", actual, expected, SAME_POINT, 1.0)
        assert not left, f"state {k}: MuJoCo has no {list(map(brief, left))}"


def test_acceleration(model, cone):
    for k, ours, theirs in comparable(model, cone):
        assert_close(f"state {k}: qacc", ours["qacc"], theirs.qacc, SOLVED, oracle.acceleration_scale(theirs))


def brief(contact):
    point = ", ".join(f"{x:.4f}" for x in contact["pos"])
    return f"geoms {contact['geom']} at ({point}) dist {contact['dist']:.2e}"
