"""Compares `clench forward` with MuJoCo, each with its own contacts.

The comparison covers pairs of shapes that MuJoCo solves in closed form. For other pairs (a cylinder on a capsule, box
or cylinder) MuJoCo iterates to a tolerance and selects points by another rule, so states with such contacts are
omitted. Some states of each model must remain.

If shapes are exactly at the distance where contact begins, as gymnasium's point on its floor always is, the last bit
decides whether there is a contact, and either result is valid. In such states the acceleration must be MuJoCo's either
with all such contacts or with none of them.
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
LAST_BIT = 1e-12  # metres

PLANE, SPHERE, CAPSULE, BOX, CYLINDER = (
    int(getattr(mujoco.mjtGeom, f"mjGEOM_{name}")) for name in ("PLANE", "SPHERE", "CAPSULE", "BOX", "CYLINDER")
)
CLOSED_FORM = {(a, b) for a in (PLANE, SPHERE, CAPSULE, BOX) for b in (PLANE, SPHERE, CAPSULE, BOX)}
CLOSED_FORM |= {(PLANE, CYLINDER), (SPHERE, CYLINDER)}


@functools.lru_cache(maxsize=None)
def comparable(model, cone):
    """Returns (index, state, Clench's result, MuJoCo's result) of states whose contacts all have a closed form."""
    geom_type = oracle.load(model, cone).geom_type
    closed = lambda c: tuple(sorted(int(geom_type[g]) for g in c["geom"])) in CLOSED_FORM
    with program.Forward(model, "--cone", cone, "--iterations", 300, *program.EXACT) as forward:
        pairs = zip(states.sample(model), oracle.references(model, cone), strict=True)
        both = [(k, state, forward(state), theirs) for k, (state, theirs) in enumerate(pairs)]
    return [case for case in both if all(map(closed, case[2]["contacts"] + case[3].contacts))]


def certain(contacts):
    """Returns the contacts whose existence does not depend on the last bit."""
    return [c for c in contacts if abs(c["dist"] - c["includemargin"]) > LAST_BIT]


def test_some_states_are_comparable(model):
    assert len(comparable(model, "pyramidal")) >= len(states.sample(model)) // 4


def test_contact_sets(model):
    """Pairs, points, depths, frames, dimensions and friction are equal, in any order."""
    for k, _, ours, theirs in comparable(model, "pyramidal"):
        left = certain(ours["contacts"])
        for contact in certain(theirs.contacts):
            same_pair = [c for c in left if c["geom"] == contact["geom"]]
            assert same_pair, f"state {k}: MuJoCo has {brief(contact)}, we have left {list(map(brief, left))}"
            nearest = min(same_pair, key=lambda c: np.linalg.norm(np.subtract(c["pos"], contact["pos"])))
            left.remove(nearest)
            for field in ("dim", "dist", "pos", "frame", "includemargin", "friction"):
                actual, expected = (np.ravel(c[field]) for c in (nearest, contact))
                assert_close(f"state {k}: {brief(contact)} {field}", actual, expected, SAME_POINT, 1.0)
        assert not left, f"state {k}: MuJoCo has no {list(map(brief, left))}"


def test_acceleration(model, cone):
    for k, state, ours, theirs in comparable(model, cone):
        answers = [theirs]
        if len(certain(theirs.contacts)) < len(theirs.contacts):
            answers = [oracle.reference(widened(model, cone, margin), state) for margin in (LAST_BIT, -LAST_BIT)]
        nearest = min(answers, key=lambda a: np.abs(a.qacc - ours["qacc"]).max())
        assert_close(f"state {k}: qacc", ours["qacc"], nearest.qacc, SOLVED, oracle.acceleration_scale(nearest))


def widened(model, cone, margin):
    """Returns MuJoCo's model with all contact margins changed by more than rounding, but insignificantly."""
    mjmodel = oracle.load(model, cone)
    mjmodel.geom_margin += margin
    return mjmodel


def brief(contact):
    point = ", ".join(f"{x:.4f}" for x in contact["pos"])
    return f"geoms {contact['geom']} at ({point}) dist {contact['dist']:.2e}"
