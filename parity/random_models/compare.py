"""Compares both engines on one model: their results on a few states, and the next state of each.

MuJoCo's contacts are fed in, since different contact points may both be right. Every step starts from MuJoCo's state,
so that a difference shows where it arises. If both engines' own contacts are equal, everything else must agree too; if
not, only the parameters that follow from the pair of geoms must.
"""

import dataclasses
import json
import pathlib
import re
import tempfile

import mujoco
import numpy as np

import agreement
import oracle
import program
from compare import assert_close, largest, looser
from random_models.undecided import IDLE, held_by_rounding, is_undecided
from random_models.values import Draw
from test_own_contacts import CLOSED_FORM, SAME_POINT

STEPS = 3
ITERATIONS = 60  # of MuJoCo's solver, which continues after it has converged
PRECISE = 1e-15  # tolerance of a solver
SEARCHES = 35  # MuJoCo's default iterations of the search for distances of convex shapes, to SEARCHED metres
SEARCHED = 1e-6
FASTEST = 1.0  # radians or metres per step
OF_MESHES = 1e4  # factor of the tolerance of other models
STIFFEST = 1e12  # D of bodies without inverse inertia in some direction: their centre of mass is on the axis
STILL = 1e-11  # m/s² or rad/s² per newton
NEXT = 1e-8  # relative to the change in a step
FOUND = 1e-6  # relative to the accelerations, for own contacts, which differ by up to SAME_POINT
SINGULAR = 1e14  # condition number of a mass matrix
PARALLEL = 1e-6  # cosine: smaller ones are right angles
CLEARLY = 1e-6  # metres: beyond this the existence of a contact is certain
# Models that only MuJoCo accepts: a `general` of a motor's class that changes the kind of gain but keeps the motor's
# bias, or that changes the kind of dynamics.
REFUSED_HERE = ("a bias of the kind dcmotor needs a gain of that kind", "but its parameters are those of a dcmotor")
FLAGS = ("--solver", "newton", "--iterations", 1000, "--noslip-iterations", 0, *program.EXACT, "--mass", "--jacobian", "--step")


class Refused(Exception):
    """MuJoCo refuses the model or cannot step it, or Clench refuses it as intended."""


@dataclasses.dataclass
class Difference:
    """A difference between the engines: its kind, and a message with the numbers."""

    kind: str
    message: str
    lines: str = ""

    def __str__(self):
        return f"{self.kind}: {self.message}"


@dataclasses.dataclass
class Question:
    """A state for Clench, and MuJoCo's results on it."""

    what: str
    state: dict
    theirs: object
    after: dict | None = None  # the state one step later
    own: bool = False  # contacts are found by Clench, not fed in

    def later(self, model):
        """Returns MuJoCo's results on the state one step later."""
        state = {name: value for name, value in self.state.items() if name != "contacts"}
        return oracle.reference(model, {**state, **self.after})


def compiled(text):
    """Compiles a text with MuJoCo; it solves as exactly as possible and searches at least as long as by default."""
    try:
        model = oracle.exact(mujoco.MjModel.from_xml_string(text))
    except (ValueError, RuntimeError) as error:  # The compiler may fail without a message.
        raise Refused(str(error)) from None
    model.opt.iterations = ITERATIONS
    model.opt.ccd_iterations = max(model.opt.ccd_iterations, SEARCHES)
    model.opt.ccd_tolerance = min(model.opt.ccd_tolerance, SEARCHED)
    if slides_twice(model):
        raise Refused("a body of two sliders along one axis, whose mass matrix is singular, has a diagonal one in MuJoCo")
    if strong_by_rounding(model):
        raise Refused("an actuator that moves nothing pulls with a quotient of roundings")
    return model


def slides_twice(model):
    """Returns True if a body that MuJoCo considers simple (diagonal mass matrix) has two sliders along one axis."""
    for body in np.flatnonzero(model.body_simple):
        joints = slice(model.body_jntadr[body], model.body_jntadr[body] + model.body_jntnum[body])
        axes = model.jnt_axis[joints][model.jnt_type[joints] == mujoco.mjtJoint.mjJNT_SLIDE]
        if (np.abs(np.triu(axes @ axes.T, 1)) > PARALLEL).any():
            return True
    return False


def precise(text):
    """Sets a precise solver tolerance, which limits the precision of length ranges that engines find by simulation."""
    return f'<option tolerance="{PRECISE}"/></mujoco>'.join(text.rsplit("</mujoco>", 1))


def strong_by_rounding(model):
    """Returns True if a muscle's peak force (scale / acc0) follows from an acceleration that is only rounding."""
    by_scale = (model.actuator_gaintype == mujoco.mjtGain.mjGAIN_MUSCLE) & (model.actuator_gainprm[:, 2] < 0)
    by_scale |= (model.actuator_biastype == mujoco.mjtBias.mjBIAS_MUSCLE) & (model.actuator_biasprm[:, 2] < 0)
    return bool((by_scale & (model.actuator_acc0[model.actuator_outadr] < STILL)).any())


def examine(text, seed):
    """Returns the first difference between the engines on states that depend on the seed, or None."""
    text = precise(text)
    model = compiled(text)
    questions = list(ask(model, Draw(seed)))
    with tempfile.NamedTemporaryFile("w", suffix=".xml") as file:
        file.write(text)
        file.flush()
        lines = "".join(json.dumps(q.state) + "\n" for q in questions)
        bounds = ("--ccd-iterations", model.opt.ccd_iterations, "--ccd-tolerance", model.opt.ccd_tolerance)
        done = program.run("forward", file.name, *FLAGS, *bounds, stdin=lines)
    answers = [json.loads(line) for line in done.stdout.splitlines()]
    for question, ours in zip(questions, answers):
        try:
            judge(model, question, ours)
        except AssertionError as error:
            if agrees(model, question, ours):
                continue
            message = str(error).splitlines()[0]
            return Difference(kind_of(message.removeprefix(question.what)), message, json.dumps(question.state))
    if any(reason in done.stderr for reason in REFUSED_HERE):
        raise Refused(done.stderr)
    if done.returncode != 0:
        failing = questions[len(answers)]
        if "mass matrix is not positive definite" in done.stderr and condition(model) > SINGULAR:
            raise Refused("a mass matrix that is singular but for rounding")
        if failing.own and "diverged" in done.stderr and explodes(model, failing.state):
            raise Refused("with contacts of its own each engine diverges")
        message = done.stderr.replace(file.name, "model.xml").strip().splitlines()[-1]
        return Difference(kind_of(message, "refused"), message, json.dumps(failing.state))
    return None


def explodes(model, state):
    """Returns True if MuJoCo diverges too within a few steps."""
    data = oracle.assigned(model, state)
    mujoco.mj_step(model, data, STEPS)
    return any(w.number for w in data.warning)


def agrees(model, question, ours):
    """Returns True if an answer is right within the precision of mesh data (24 bits) and of the mass matrix."""
    try:
        with looser(max(OF_MESHES if model.nmesh else 1.0, lost(model))):
            judge(model, question, ours)
    except AssertionError:
        return False
    return True


def condition(model):
    """Returns the condition number of the mass matrix in the initial state, independent of the units of dofs."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    scale = 1 / np.sqrt(np.diag(inertia))
    return np.linalg.cond(scale[:, None] * inertia * scale)


def lost(model):
    """Returns the rounding error that the initial mass matrix amplifies, in units of `agreement.ROUNDING`."""
    return condition(model) * np.finfo(float).eps / agreement.ROUNDING


def kind_of(message, prefix=""):
    """Returns the words of a message up to its first number, which identify a difference while its model is reduced."""
    words, message = [], re.sub(r"\{.*?\}|\"[^\"]*\"|error: model.xml:\d*:?", "", message)
    for word in message.replace("[", " [").split():
        if any(c.isdigit() for c in word) or len(words) == 6:
            break
        words.append(word)
    return " ".join([prefix, *words]).strip()


def ask(model, draw):
    """Yields the initial state and consecutive states from a random one; states with contacts also with own ones."""
    rng = np.random.default_rng(draw.getrandbits(32))
    free = without_contacts(model)
    initial = mujoco.MjData(free)
    theirs, after = stepped(free, {"qpos": initial.qpos.tolist(), "qvel": initial.qvel.tolist()})
    if after is None or not np.isfinite(theirs.qfrc_actuator).all():
        raise Refused("MuJoCo cannot step it")
    theirs = oracle.reference(free, {})
    yield Question("initial: ", {"contacts": []}, theirs)
    state = random_state(model, draw, rng)
    stages = model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4
    for step in range(STEPS):
        what = f"step {step}: "
        theirs, after = stepped(model, state)
        if after is None or not all(map(orthonormal, theirs.contacts)):
            return
        if not stages:
            yield Question(what, oracle.fed(state, theirs), theirs, after)
        else:  # the later stages of RK4 find their own contacts
            theirs = oracle.reference(model, state)
            yield Question(what, oracle.fed(state, theirs), theirs)
            free_after = stepped(free, state)[1]
            if free_after is not None:
                yield Question(what + "no contacts: ", {**state, "contacts": []}, oracle.reference(free, state), free_after)
        if theirs.contacts:
            yield Question(what + "own contacts: ", state, theirs, own=True)
        state = {**state, **after, "ctrl": controls(model, draw, rng)}


def without_contacts(model):
    free = mujoco.MjModel.__copy__(model)
    free.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    return free


def stepped(model, state):
    """Returns MuJoCo's results on a state and the state one step later.

    Both are None if MuJoCo warns, a number is not finite (MuJoCo does not warn about activations and stages of RK4), or
    the motion is too fast to be integrated.
    """
    data = oracle.assigned(model, state)
    mujoco.mj_step(model, data)
    complains = any(w.number for w in data.warning) or not all(np.isfinite(x).all() for x in (data.qpos, data.qvel, data.act))
    if complains or model.opt.timestep * largest(data.qvel, state["qvel"]) > FASTEST:
        return None, None
    after = {"time": data.time, **{name: getattr(data, name).tolist() for name in ("qpos", "qvel", "act", "plastic")}}
    return oracle.results(model, data, state), after


def orthonormal(contact):
    """Returns True if the frame of a contact is orthonormal. MuJoCo's may not be if two centres coincide."""
    frame = np.reshape(contact["frame"], (3, 3))
    return np.abs(frame @ frame.T - np.eye(3)).max() < 1e-6


def controls(model, draw, rng):
    return (draw.choice((0, 1, 3)) * rng.standard_normal(model.nu)).tolist()


def random_state(model, draw, rng):
    """Returns a state around the initial one or a keyframe, with random distance, speed and applied forces."""
    data = mujoco.MjData(model)
    if model.nkey and draw.chance(0.5):
        mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_integratePos(model, data.qpos, draw.choice((0, 0.03, 0.3)) * rng.standard_normal(model.nv), 1.0)
    mujoco.mj_forward(model, data)
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    pulled = draw.choice((0, 1, 10))
    xfrc_applied = pulled * model.body_mass[:, None] * rng.standard_normal((model.nbody, 6)) * [1, 1, 1, 0.1, 0.1, 0.1]
    mocap_quat = data.mocap_quat + 0.1 * rng.standard_normal(data.mocap_quat.shape)
    mocap_quat /= np.linalg.norm(mocap_quat, axis=1, keepdims=True)
    state = {
        "time": data.time,
        "qpos": data.qpos,
        "qvel": draw.choice((0, 0.1, 1, 5)) * rng.standard_normal(model.nv),
        "act": draw.choice((0, 1)) * rng.standard_normal(model.na),
        "plastic": data.plastic,
        "ctrl": controls(model, draw, rng),
        "qfrc_applied": pulled * np.diag(inertia) * rng.standard_normal(model.nv),
        "xfrc_applied": xfrc_applied,
        "mocap_pos": data.mocap_pos + 0.05 * rng.standard_normal(data.mocap_pos.shape),
        "mocap_quat": mocap_quat,
        "eq_active": data.eq_active.astype(bool) ^ (rng.random(model.neq) < 0.2),
    }
    return {name: np.asarray(value).tolist() for name, value in state.items()}


def judge(model, question, ours):
    """Raises an AssertionError if an answer is wrong."""
    what, theirs = question.what, question.theirs
    if model.nv == 0:
        return
    agreement.mass_matrix(what, ours, theirs)
    if at_rest_by_rounding(model, question.state):
        return
    if not question.own:  # contacts that adhere make passive forces
        agreement.smooth_forces(what, ours, theirs, oracle.SLOW * np.diag(theirs.mass).max())
    if question.own and not same_contacts(model, what, ours, theirs):
        return
    if not question.own:
        if pushed_by_rounding(theirs):
            return
        held = held_by_rounding(theirs)
        drop_idle_rows(ours, theirs)
        clear_rounding(ours, theirs)
        agreement.constraint_rows(what, ours, theirs)
    if oracle.distance_to_optimum(theirs) > agreement.SOLVED / 10 or largest(theirs.efc_D) > STIFFEST:
        return  # MuJoCo has not converged, or rounding decides the forces of nearly rigid rows
    if largest(theirs.qacc_smooth, theirs.efc_aref, floor=0) < STILL:
        return  # only rounding causes an acceleration, which light bodies amplify
    agreement.acceleration(what, ours, theirs, FOUND if question.own else agreement.SOLVED)
    if not question.own:
        forces(what, ours, theirs)
        agreement.sensors(model, what, ours, theirs, is_undecided=lambda sensor: is_undecided(model, sensor, ours, theirs, held))
    if question.after is not None:
        next_state(model, what, question, ours["next"])


def at_rest_by_rounding(model, state):
    """Returns True if a yielding tendon spring is exactly at rest, with the integrator `discrete`.

    A spring at rest has no slope, and rounding decides whether it is at rest.
    """
    if model.opt.integrator != mujoco.mjtIntegrator.mjINT_DISCRETE or not model.ntendon or not state.get("plastic"):
        return False
    data = oracle.assigned(model, {name: value for name, value in state.items() if name != "contacts"})
    mujoco.mj_fwdPosition(model, data)
    return bool((np.abs(np.subtract.outer(data.ten_length, state["plastic"])) < CLEARLY**2).any())


def forces(what, ours, theirs):
    """Compares forces like `agreement.constraint_forces`, but a row's tolerance also grows with D · aref."""
    slow = oracle.SLOW * np.diag(theirs.mass)
    scale = largest(theirs.qfrc_constraint, theirs.qfrc_smooth, slow)
    assert_close(what + "qfrc_constraint", ours["qfrc_constraint"], theirs.qfrc_constraint, agreement.SOLVED, scale)
    scale = largest(theirs.efc_force, slow, floor=1e-3) + 1e-3 * theirs.efc_D * agreement.asked(theirs)
    assert_close(what + "force", program.rows(ours, "force"), theirs.efc_force, 10 * agreement.SOLVED, scale)


def pushed_by_rounding(theirs):
    """Returns True if rows push whose levers are only rounding; their stiffness is the reciprocal of rounding."""
    idle = np.abs(theirs.jacobian).max(axis=1, initial=0) <= IDLE
    return largest(theirs.jacobian[idle].T @ theirs.efc_force[idle]) > NEXT


def drop_idle_rows(ours, theirs):
    """Removes rows without effect, such as those of a weld of a body to itself or of a tendon of one body.

    Rounding, or MuJoCo's storage of the Jacobian, decides whether such rows exist.
    """
    sources = [(row["kind"], row["source"]) for row in ours["constraints"]]
    kept = acted_on(sources, ours["jacobian"], [kind == "contact" for kind, _ in sources])
    for name in ("constraints", "jacobian"):
        ours[name] = [ours[name][k] for k in kept]
    contact = theirs.efc_type >= int(mujoco.mjtConstraint.mjCNSTR_CONTACT_FRICTIONLESS)
    kept = acted_on(list(zip(theirs.efc_type, theirs.efc_id)), theirs.jacobian, contact)
    for name in ("jacobian", *(name for name in vars(theirs) if name.startswith("efc_"))):
        setattr(theirs, name, getattr(theirs, name)[kept])


def clear_rounding(ours, theirs):
    """Sets values to zero that are only rounding in both engines.

    These are contact rows between bodies that cannot move along them, and the velocities of such rows.
    """
    if len(ours["jacobian"]) != len(theirs.jacobian):
        return
    still = IDLE * (1 + np.abs(theirs.qvel).sum())
    for k, (row, own, other) in enumerate(zip(ours["constraints"], ours["jacobian"], theirs.jacobian)):
        if largest(own, other, floor=0) <= IDLE:
            own[:] = other[:] = [0.0] * len(own)
            if largest(row["vel"], theirs.efc_vel[k], floor=0) <= still:
                row["vel"] = theirs.efc_vel[k] = 0.0


def acted_on(sources, jacobian, contact):
    """Returns the rows of contacts and of sources with a nonzero lever."""
    moving = {source for source, row in zip(sources, jacobian) if np.abs(row).max() > IDLE}
    return [k for k, source in enumerate(sources) if contact[k] or source in moving]


def next_state(model, what, question, ours):
    """Compares the next state: velocities relative to their change by accelerations, positions to their change."""
    step, theirs = model.opt.timestep, question.theirs
    changed = largest(np.subtract(question.after["qvel"], theirs.qvel))
    stages = (theirs, question.later(model)) if model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4 else (theirs,)
    accelerations = max(map(oracle.acceleration_scale, stages))
    speed = max(changed, step * accelerations) + 1e-8 * largest(theirs.qvel)
    assert_close(what + "next qvel", ours["qvel"], question.after["qvel"], NEXT, speed)
    travel = step * (speed + largest(theirs.qvel))
    assert_close(what + "next qpos", ours["qpos"], question.after["qpos"], NEXT, travel + 1e-6)
    assert_close(what + "next act", ours["act"], question.after["act"], NEXT, 1.0)
    assert_close(what + "next plastic", ours["plastic"], question.after["plastic"], NEXT, 1.0)
    assert_close(what + "next time", ours["time"], question.after["time"], NEXT, step)


def same_contacts(model, what, ours, theirs):
    """Returns True if both found the same points; the parameters of a pair of geoms must agree in any case."""
    left = {}
    for contact in ours["contacts"]:
        left.setdefault(tuple(contact["geom"]), []).append(contact)
    same = len(ours["contacts"]) == len(theirs.contacts)
    for contact in theirs.contacts:
        pair = tuple(contact["geom"])
        found = left.get(pair, [])
        closed = tuple(sorted(int(model.geom_type[g]) for g in pair)) in CLOSED_FORM
        if not found:
            same = False
            # Within a margin, MuJoCo does not always find the shortest distance between shapes.
            bound = min(0, contact["includemargin"]) - CLEARLY
            assert not closed or contact["dist"] > bound, f"{what}no contact of {names(model, pair)}"
            continue
        # Any of several contacts of the same two geoms may match. With adhesion, the distance decides about friction.
        within = lambda c: c["dist"] < c["includemargin"]
        known = any(within(c) == within(contact) for c in found)
        fields = ("dim", "includemargin", "friction") if known else ("includemargin", "friction")
        mixed = min(found, key=lambda c: sum(np.abs(np.subtract(c[field], contact[field])).sum() for field in fields))
        for field in fields:
            assert_close(f"{what}contact {field}", np.ravel(mixed[field]), np.ravel(contact[field]), 1e-9, 1.0)
        near = lambda c: np.abs(np.subtract(c["pos"], contact["pos"])).max() < SAME_POINT and abs(c["dist"] - contact["dist"]) < SAME_POINT
        same = same and any(near(c) and np.abs(np.subtract(c["frame"], contact["frame"])).max() < SAME_POINT for c in found)
    return same


def names(model, pair):
    kinds = (mujoco.mjtGeom(model.geom_type[g]).name.removeprefix("mjGEOM_").lower() for g in pair)
    return " and ".join(f"{kind} {model.geom(g).name or g}" for kind, g in zip(kinds, pair))


def keep(folder, name, text, difference):
    """Writes a model with its difference, and the state with the difference, into a folder."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    comment = difference.message.replace("--", "- -")
    (folder / f"{name}.xml").write_text(f"<!-- {comment} -->\n{text}\n")
    (folder / f"{name}.json").write_text(difference.lines + "\n")
