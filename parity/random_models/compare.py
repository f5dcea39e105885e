"""Both engines on one model: what they say of a few states, and where each state goes in a step.

MuJoCo's contacts are fed in, since points of contact may differ and both be right; every step starts from MuJoCo's state, so that a
difference is seen where it arises. Where both find the same contacts by themselves, everything must agree too; where they find others,
at least what follows from the pair of geoms.
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
ITERATIONS = 60  # of MuJoCo's solver, which goes on after it has converged
PRECISE = 1e-15  # tolerance of a solver
SEARCHES = 35  # iterations of its search for distances of convex shapes, to SEARCHED metres, as where the model says nothing
SEARCHED = 1e-6
FASTEST = 1.0  # radians or metres a step
OF_MESHES = 1e4  # times what is allowed elsewhere
STIFFEST = 1e12  # D of bodies that have no inverse inertia in some direction: their centre of mass is on the axis
STILL = 1e-11  # m/s² or rad/s² for a newton
NEXT = 1e-8  # of what a step changes
FOUND = 1e-6  # of the accelerations, where contacts are found and differ by SAME_POINT
SINGULAR = 1e14  # condition of a mass matrix
PARALLEL = 1e-6  # cosine: what is less is a right angle
CLEARLY = 1e-6  # metres: whether a contact exists is certain
# What only MuJoCo takes: a `general` of a motor's class that changes the kind of gain, and keeps the motor's bias, or that changes the
# kind of dynamics.
REFUSED_HERE = ("a bias of the kind dcmotor needs a gain of that kind", "but its parameters are those of a dcmotor")
FLAGS = ("--solver", "newton", "--iterations", 1000, "--noslip-iterations", 0, *program.EXACT, "--mass", "--jacobian", "--step")


class Refused(Exception):
    """MuJoCo does not take the model, or cannot step it; or Clench refuses it as it is meant to."""


@dataclasses.dataclass
class Difference:
    """Where the engines differ: a word for the kind, and the numbers."""

    kind: str
    message: str
    lines: str = ""

    def __str__(self):
        return f"{self.kind}: {self.message}"


@dataclasses.dataclass
class Question:
    """A state for Clench, and what its answer must agree with."""

    what: str
    state: dict
    theirs: object
    after: dict | None = None  # the state one step later
    own: bool = False  # contacts are found, not fed

    def later(self, model):
        """MuJoCo's results on the state one step later."""
        state = {name: value for name, value in self.state.items() if name != "contacts"}
        return oracle.reference(model, {**state, **self.after})


def compiled(text):
    """MuJoCo's model of a text, made to solve as exactly as it can, and to search no less than is usual."""
    try:
        model = oracle.exact(mujoco.MjModel.from_xml_string(text))
    except (ValueError, RuntimeError) as error:  # Its compiler may fail without saying why.
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
    """Whether a body that MuJoCo takes for simple, one with a diagonal mass matrix, has two sliders along one axis."""
    for body in np.flatnonzero(model.body_simple):
        joints = slice(model.body_jntadr[body], model.body_jntadr[body] + model.body_jntnum[body])
        axes = model.jnt_axis[joints][model.jnt_type[joints] == mujoco.mjtJoint.mjJNT_SLIDE]
        if (np.abs(np.triu(axes @ axes.T, 1)) > PARALLEL).any():
            return True
    return False


def precise(text):
    """A model whose solver is precise: where both engines simulate to find length ranges, these are known no better than it solves."""
    return f'<option tolerance="{PRECISE}"/></mujoco>'.join(text.rsplit("</mujoco>", 1))


def strong_by_rounding(model):
    """Whether a muscle that accelerates the model by rounding alone has a peak force that follows from it (scale / acc0)."""
    by_scale = (model.actuator_gaintype == mujoco.mjtGain.mjGAIN_MUSCLE) & (model.actuator_gainprm[:, 2] < 0)
    by_scale |= (model.actuator_biastype == mujoco.mjtBias.mjBIAS_MUSCLE) & (model.actuator_biasprm[:, 2] < 0)
    return bool((by_scale & (model.actuator_acc0[model.actuator_outadr] < STILL)).any())


def examine(text, seed):
    """The first difference between the engines on a model, on states that the seed decides; None if there is none."""
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
    """Whether MuJoCo diverges too within a few steps."""
    data = oracle.assigned(model, state)
    mujoco.mj_step(model, data, STEPS)
    return any(w.number for w in data.warning)


def agrees(model, question, ours):
    """Whether an answer is right as far as one can know: numbers of meshes have 24 bits, and an ill-conditioned mass matrix loses some."""
    try:
        with looser(max(OF_MESHES if model.nmesh else 1.0, lost(model))):
            judge(model, question, ours)
    except AssertionError:
        return False
    return True


def condition(model):
    """Of the mass matrix of the initial state, whatever the units of its dofs."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    inertia = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, inertia)
    scale = 1 / np.sqrt(np.diag(inertia))
    return np.linalg.cond(scale[:, None] * inertia * scale)


def lost(model):
    """What the mass matrix of the initial state makes of rounding, in units of what rows are compared to."""
    return condition(model) * np.finfo(float).eps / agreement.ROUNDING


def kind_of(message, prefix=""):
    """The words of a message up to its first number, as what a difference is known by while its model is cut down."""
    words, message = [], re.sub(r"\{.*?\}|\"[^\"]*\"|error: model.xml:\d*:?", "", message)
    for word in message.replace("[", " [").split():
        if any(c.isdigit() for c in word) or len(words) == 6:
            break
        words.append(word)
    return " ".join([prefix, *words]).strip()


def ask(model, draw):
    """The states: the initial one, and some in a row from a random one. Where contacts are found by ourselves too, only if there are any."""
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
        else:  # the later stages of RK4 find contacts of their own
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
    """MuJoCo's results on a state and the state one step later, None where it complains, something becomes no number (of which it says
    nothing if it is an activation, or in a stage of RK4) or turns too fast to be integrated."""
    data = oracle.assigned(model, state)
    mujoco.mj_step(model, data)
    complains = any(w.number for w in data.warning) or not all(np.isfinite(x).all() for x in (data.qpos, data.qvel, data.act))
    if complains or model.opt.timestep * largest(data.qvel, state["qvel"]) > FASTEST:
        return None, None
    after = {"time": data.time, **{name: getattr(data, name).tolist() for name in ("qpos", "qvel", "act", "plastic")}}
    return oracle.results(model, data, state), after


def orthonormal(contact):
    """Whether a contact has a frame: MuJoCo's can be none where two centres coincide, and Clench refuses it."""
    frame = np.reshape(contact["frame"], (3, 3))
    return np.abs(frame @ frame.T - np.eye(3)).max() < 1e-6


def controls(model, draw, rng):
    return (draw.choice((0, 1, 3)) * rng.standard_normal(model.nu)).tolist()


def random_state(model, draw, rng):
    """A state about the initial one or a keyframe, near or far, slow or fast, pulled or not."""
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
    """Raises an AssertionError where an answer is not what it should be."""
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
        return  # MuJoCo has not converged, or rounding decides the forces of rows that are as good as rigid
    if largest(theirs.qacc_smooth, theirs.efc_aref, floor=0) < STILL:
        return  # nothing but rounding asks for an acceleration, and what is light takes it up
    agreement.acceleration(what, ours, theirs, FOUND if question.own else agreement.SOLVED)
    if not question.own:
        forces(what, ours, theirs)
        agreement.sensors(model, what, ours, theirs, is_undecided=lambda sensor: is_undecided(model, sensor, ours, theirs, held))
    if question.after is not None:
        next_state(model, what, question, ours["next"])


def at_rest_by_rounding(model, state):
    """Whether the integrator discrete steps from the very rest of a tendon's spring that yields: where it is at rest it has no slope, and
    rounding decides whether it is."""
    if model.opt.integrator != mujoco.mjtIntegrator.mjINT_DISCRETE or not model.ntendon or not state.get("plastic"):
        return False
    data = oracle.assigned(model, {name: value for name, value in state.items() if name != "contacts"})
    mujoco.mj_fwdPosition(model, data)
    return bool((np.abs(np.subtract.outer(data.ten_length, state["plastic"])) < CLEARLY**2).any())


def forces(what, ours, theirs):
    """As `agreement.constraint_forces`, but a row's force is only known as well as its reference acceleration is, times D."""
    slow = oracle.SLOW * np.diag(theirs.mass)
    scale = largest(theirs.qfrc_constraint, theirs.qfrc_smooth, slow)
    assert_close(what + "qfrc_constraint", ours["qfrc_constraint"], theirs.qfrc_constraint, agreement.SOLVED, scale)
    scale = largest(theirs.efc_force, slow, floor=1e-3) + 1e-3 * theirs.efc_D * agreement.asked(theirs)
    assert_close(what + "force", program.rows(ours, "force"), theirs.efc_force, 10 * agreement.SOLVED, scale)


def pushed_by_rounding(theirs):
    """Whether something pushes whose levers are nothing but rounding: its stiffness is the reciprocal of another rounding."""
    idle = np.abs(theirs.jacobian).max(axis=1, initial=0) <= IDLE
    return largest(theirs.jacobian[idle].T @ theirs.efc_force[idle]) > NEXT


def drop_idle_rows(ours, theirs):
    """Takes out what nothing can act on, such as a weld of a body to itself or a tendon of one body: it moves nothing, and rounding, or
    how MuJoCo stores the Jacobian, decides whether it has rows.
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
    """Makes zero what has no digits in either engine: rows of contacts between bodies that cannot move along them, and the velocities
    that they give."""
    if len(ours["jacobian"]) != len(theirs.jacobian):
        return
    still = IDLE * (1 + np.abs(theirs.qvel).sum())
    for k, (row, own, other) in enumerate(zip(ours["constraints"], ours["jacobian"], theirs.jacobian)):
        if largest(own, other, floor=0) <= IDLE:
            own[:] = other[:] = [0.0] * len(own)
            if largest(row["vel"], theirs.efc_vel[k], floor=0) <= still:
                row["vel"] = theirs.efc_vel[k] = 0.0


def acted_on(sources, jacobian, contact):
    """The rows that are of a contact, or belong to something that has a lever."""
    moving = {source for source, row in zip(sources, jacobian) if np.abs(row).max() > IDLE}
    return [k for k, source in enumerate(sources) if contact[k] or source in moving]


def next_state(model, what, question, ours):
    """Velocities to a share of what the accelerations involved change them by, positions of what they change in a step."""
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
    """Whether both found the same points; what they make of the same pair of geoms must agree in any case."""
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
            # How far apart shapes are within a margin MuJoCo does not always measure the shortest way.
            bound = min(0, contact["includemargin"]) - CLEARLY
            assert not closed or contact["dist"] > bound, f"{what}no contact of {names(model, pair)}"
            continue
        # Of several pairs of the same two geoms, any. Whether one that adheres has friction follows from its distance, see above.
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
    """Writes a model with its difference, and the state that shows it, into a folder."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    comment = difference.message.replace("--", "- -")
    (folder / f"{name}.xml").write_text(f"<!-- {comment} -->\n{text}\n")
    (folder / f"{name}.json").write_text(difference.lines + "\n")
