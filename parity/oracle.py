"""MuJoCo 4.0 as the oracle: the results of mj_forward on a state as plain arrays."""

import functools
import types

import mujoco
import numpy as np

import discrete
import states
from compare import largest

CONES = {"pyramidal": mujoco.mjtCone.mjCONE_PYRAMIDAL, "elliptic": mujoco.mjtCone.mjCONE_ELLIPTIC}
SLOW = 1e-3  # m/s² or rad/s²: the effect of violations of 1e-14 m on constraints is far below 1e-8 of it
CONTACT_FIELDS = ("dist", "pos", "frame", "includemargin", "friction", "solref", "solreffriction", "solimp", "adhesion", "surfacevel", "dim")


def load(path, cone=None):
    """Loads a model that solves as exactly as possible, see `exact`; if `cone` is None, the file's cone stays."""
    model = mujoco.MjModel.from_xml_path(str(path))
    if cone is not None:
        model.opt.cone = CONES[cone]
    return exact(model)


def exact(model):
    """Changes the model so that Newton runs from a cold start until no progress is possible, and returns it."""
    model.opt.solver = mujoco.mjtSolver.mjSOL_NEWTON
    model.opt.iterations, model.opt.tolerance = 300, 0.0
    model.opt.ls_iterations, model.opt.ls_tolerance = 200, 1e-10
    model.opt.noslip_iterations = 0
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_WARMSTART
    return model


@functools.lru_cache(maxsize=None)
def references(path, cone):
    """Returns MuJoCo's results on every sampled state of a model."""
    model = load(path, cone)
    return [reference(model, state) for state in states.sample(path)]


def reference(model, state):
    """Returns MuJoCo's results on one state."""
    data = assigned(model, state)
    mujoco.mj_forward(model, data)
    return results(model, data, state)


def results(model, data, state):
    """Returns the results of MuJoCo's forward dynamics from its data, whose state a step may have changed since."""
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    forces = [f"qfrc_{name}" for name in ("constraint", "bias", "passive", "actuator", "smooth")]
    efc = ("type", "id", "pos", "vel", "aref", "D", "KBIP", "margin", "force")
    smooth = data.qacc_smooth.copy()
    metric, shift, still = mass, 0.0, np.zeros(model.nv, dtype=bool)
    if model.opt.integrator == mujoco.mjtIntegrator.mjINT_DISCRETE:
        metric, shift = discrete.metric(model, data, mass)
        still = discrete.untouched(model, data, jacobian(model, data))
        smooth = discrete.smooth_acceleration(data, metric, shift)
    return types.SimpleNamespace(
        state=state,
        mass=mass,
        metric=metric,
        shift=shift,
        still=still,
        qacc_smooth=smooth,
        jacobian=jacobian(model, data),
        sensordata=data.sensordata.copy(),
        contacts=[contact(model, data, k) for k in range(data.ncon)],
        qvel=np.array(state["qvel"]) if "qvel" in state else np.zeros(model.nv),
        **{name: getattr(data, name).copy() for name in ("qacc", *forces)},
        **{f"efc_{name}": getattr(data, f"efc_{name}")[: data.nefc].copy() for name in efc},
    )


def assigned(model, state):
    """Returns MuJoCo's data in a state."""
    data = mujoco.MjData(model)
    for name, value in state.items():
        if name == "time":
            data.time = value
        else:
            target = getattr(data, name)
            target[:] = np.reshape(value, target.shape)
    return data


def jacobian(model, data):
    """Returns the constraint Jacobian as a dense (nefc, nv) array, from MuJoCo's sparse or dense storage."""
    dense = np.zeros((data.nefc, model.nv))
    if data.nefc and mujoco.mj_isSparse(model):
        mujoco.mju_sparse2dense(dense, data.efc_J, data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind)
    elif data.nefc:
        dense[:] = data.efc_J.ravel()[: dense.size].reshape(dense.shape)
    return dense


def contact(model, data, index):
    """Returns a contact as a dictionary that `clench forward` accepts, with MuJoCo's contact force."""
    this = data.contact[index]
    force = np.zeros(6)
    mujoco.mj_contactForce(model, data, index, force)
    fields = {name: np.asarray(getattr(this, name)).tolist() for name in CONTACT_FIELDS}
    return {"geom": this.geom.tolist(), **fields, "exclude": int(this.exclude), "force": force.tolist()}


def fed(state, result):
    """Returns the state with MuJoCo's contacts, which replace collision detection."""
    contacts = [{name: value for name, value in c.items() if name != "force"} for c in result.contacts]
    return {**state, "contacts": contacts}


def distance_to_optimum(result):
    """Returns a bound on the distance of MuJoCo's qacc from the minimiser, relative to the accelerations involved.

    It follows from the gradient g of the convex cost at qacc: the error e = H⁻¹g has ‖e‖ ≤ ‖M⁻¹g‖ in the norm of M,
    since H = M + JᵀWJ ≥ M.
    """
    gradient = result.metric @ result.qacc - result.qfrc_smooth - result.shift - result.qfrc_constraint
    gradient[result.still] = 0.0
    error = np.linalg.solve(result.metric, gradient)
    return np.abs(error).max() / acceleration_scale(result)


def acceleration_scale(result):
    """Returns the scale of the accelerations that cancel in qacc, such as gravity of a body at rest on the floor."""
    return largest(result.qacc, result.qacc_smooth, floor=SLOW)
