"""Models with every shape, our small ones and robots of other packages.

The tests check that they load, that dynamics agree with MuJoCo's contacts, and that own contacts are close to MuJoCo's.
If surfaces touch in more than a point, the choice of contact points is arbitrary, so only unique properties of own
contacts are compared: the pairs of geoms, the maximum depth and its normal. MuJoCo's result is exact without
`multiccd`, which moves points, and with a small tolerance. On height fields either of its algorithms may agree: the
native one leaves corners of boxes and meshes under ground by millimetres, and the older one has normals of curved
shapes that are wrong by a degree.
"""

import functools
import re

import mujoco
import numpy as np
import pytest

import agreement
import oracle
import program
import public
import states

DISABLE = mujoco.mjtDisableBit
ROLLOUTS, SAMPLES = 3, 2
SAME_PAIRS, SAME_POINT = 0.995, 0.99  # fractions
DEPTH = 1e-6  # metres
LAST_BIT = 1e-12  # metres
NORMAL = np.cos(np.radians(0.1))
OWN = [str(path) for path in [*sorted((program.ROOT / "parity/shapes").glob("*.xml")), program.ROOT / "models/towers.xml"]]
COMPARED = [*OWN, *public.compared()]


@pytest.mark.parametrize("name, reason", public.refused(), ids=lambda word: word)
def test_refusals_say_why(name, reason):
    done = program.run("inspect", public.FOLDER / name)
    assert done.returncode == 2 and reason in done.stderr, done.stderr


def test_every_model_is_listed():
    """MuJoCo refuses all files that are not listed."""
    known = {name for name, _ in public.listed()}
    files = [path.relative_to(public.FOLDER).as_posix() for path in public.FOLDER.glob("*/**/*.xml")]
    assert known <= set(files)
    for name in set(files) - known:
        path = public.FOLDER / name
        if re.search(r"<mujoco\b", path.read_text()):
            with pytest.raises(ValueError):
                mujoco.MjModel.from_xml_path(str(path))


@functools.lru_cache(maxsize=None)
def sampled(name):
    found = states.sample(public.path(name), ROLLOUTS, SAMPLES, may_be_unstable=True)
    assert len(found) >= SAMPLES
    return found


@pytest.mark.parametrize("name", COMPARED, ids=lambda name: name.removeprefix(f"{program.ROOT}/"))
def test_dynamics_with_contacts_of_mujoco(name):
    path = public.path(name)
    model = oracle.load(path)
    flags = ("--solver", "newton", "--iterations", 300, "--noslip-iterations", 0, *program.EXACT)
    with program.Forward(path, *flags, "--mass", "--jacobian") as forward:
        for k, state in enumerate(sampled(name)):
            theirs = oracle.reference(model, state)
            case = f"state {k}: ", forward(oracle.fed(state, theirs)), theirs
            agreement.mass_matrix(*case)
            agreement.smooth_forces(*case)
            agreement.constraint_rows(*case)
            agreement.acceleration(*case)
            agreement.constraint_forces(*case)


def test_own_contacts():
    """The deepest contact of each pair of touching geoms agrees, over all states and models."""
    either, differing = 0, []
    both, astray = 0, []
    for name in COMPARED:
        for k, (ours, theirs, others) in enumerate(deepest_contacts(name)):
            for pair in sorted(ours.keys() | theirs.keys()):
                here = f"{name}, state {k}, geoms {pair}: "
                either += 1
                if pair not in ours or pair not in theirs:
                    differing.append(f"{here}touch in {'ours' if pair in ours else 'MuJoCo'} only")
                    continue
                both += 1
                answers = [theirs[pair], *([others[pair]] if pair in others else [])]
                if not any(agree(ours[pair], answer) for answer in answers):
                    astray.append(here + describe(ours[pair], theirs[pair]))
    assert both > 1000, "too few to say anything"
    assert len(differing) <= (1 - SAME_PAIRS) * either, f"of {either}: {differing}"
    assert len(astray) <= (1 - SAME_POINT) * both, f"of {both}: {astray}"


@functools.lru_cache(maxsize=None)
def deepest_contacts(name):
    """Returns the deepest contact by pair of geoms for each state.

    They are ours, MuJoCo's, and those of its older algorithm on height fields.
    """
    path = public.path(name)
    native, older = (exact(path, flags) for flags in (DISABLE.mjDSBL_MULTICCD, DISABLE.mjDSBL_NATIVECCD))
    on_terrain = lambda pair: mujoco.mjtGeom.mjGEOM_HFIELD in native.geom_type[list(pair)]
    found = []
    with program.Forward(path, "--solver", "newton") as forward:
        for state in sampled(name):
            ours, theirs = deepest(forward(state)["contacts"]), deepest(oracle.reference(native, state).contacts)
            others = deepest(oracle.reference(older, state).contacts) if any(map(on_terrain, ours)) else {}
            found.append((ours, theirs, {pair: contact for pair, contact in others.items() if on_terrain(pair)}))
    return found


def exact(path, flags):
    """Returns MuJoCo's model with exact collisions and the given flags disabled."""
    model = oracle.load(path)
    model.opt.disableflags |= flags
    model.opt.ccd_tolerance, model.opt.ccd_iterations = 1e-12, 500
    return model


def deepest(contacts):
    """Returns the deepest contact by pair of geoms, without those whose existence depends on the last bit."""
    sure = [c for c in contacts if abs(c["dist"] - c["includemargin"]) > LAST_BIT]
    return {tuple(c["geom"]): c for c in sorted(sure, key=lambda c: -c["dist"])}


def agree(ours, theirs):
    return abs(ours["dist"] - theirs["dist"]) <= DEPTH and np.dot(ours["frame"][:3], theirs["frame"][:3]) >= NORMAL


def describe(ours, theirs):
    angle = np.degrees(np.arccos(np.clip(np.dot(ours["frame"][:3], theirs["frame"][:3]), -1, 1)))
    return f"{ours['dist']:.3e} m, MuJoCo {theirs['dist']:.3e}, normals {angle:.3f} degrees apart"
