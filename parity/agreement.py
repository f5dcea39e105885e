"""Compares the dynamics of both engines on one state with the same contacts.

Dynamics, constraint rows, accelerations and forces must agree. Quantities that precede the solver differ by rounding
only (1e-10); accelerations agree to 1e-8 of the accelerations involved. `what` is the prefix of messages.
"""

import mujoco
import numpy as np

import oracle
import program
from compare import assert_close, largest

ROUNDING = 1e-10
SOLVED = 1e-8
SEARCH = 1e-5  # metres: the precision of MuJoCo's search for distances of convex shapes
SMALL_VIOLATION = 1e-4  # metres: a violation is a difference of positions of some metres, known to 1e-14
SMALL_ROW = 1e-5  # metres: a lever is a difference of positions of about a metre, known to 1e-15
KIND = dict(enumerate(("equality", "friction_dof", "friction_tendon", "limit_joint", "limit_tendon", *3 * ["contact"])))
SEARCHED = (mujoco.mjtSensor.mjSENS_GEOMDIST, mujoco.mjtSensor.mjSENS_GEOMNORMAL, mujoco.mjtSensor.mjSENS_GEOMFROMTO)


def mass_matrix(what, ours, theirs):
    diagonal = np.sqrt(np.diag(theirs.mass))
    assert_close(what + "mass", ours["mass"], theirs.mass, ROUNDING, np.outer(diagonal, diagonal))


def smooth_forces(what, ours, theirs, floor=1e-9):
    """Compares bias, passive and actuator forces with one scale, at least `floor`, since their sums may cancel."""
    scale = largest(theirs.qfrc_bias, theirs.qfrc_passive, theirs.qfrc_actuator, floor=floor)
    for name in ("qfrc_bias", "qfrc_passive", "qfrc_actuator"):
        assert_close(what + name, ours[name], getattr(theirs, name), ROUNDING, scale)
    scale = oracle.acceleration_scale(theirs)
    assert_close(what + "qacc_smooth", ours["qacc_smooth"], theirs.qacc_smooth, 10 * ROUNDING, scale)


def constraint_rows(what, ours, theirs):
    """Compares violation, Jacobian, velocity, reference acceleration and D, row by row in MuJoCo's order."""
    count = len(theirs.efc_pos)
    assert len(ours["constraints"]) == count, f"{what}{len(ours['constraints'])} rows, MuJoCo has {count}"
    assert [row["kind"] for row in ours["constraints"]] == [KIND[t] for t in theirs.efc_type], what
    if count == 0:
        return
    row_size = np.abs(theirs.jacobian).max(axis=1, initial=SMALL_ROW)
    speed = row_size * largest(theirs.qvel) + np.abs(theirs.efc_vel)  # includes surface velocities
    assert_close(what + "pos", program.rows(ours, "pos"), theirs.efc_pos, ROUNDING, 1.0)
    assert_close(what + "jacobian", ours["jacobian"], theirs.jacobian, ROUNDING, row_size[:, None])
    assert_close(what + "vel", program.rows(ours, "vel"), theirs.efc_vel, ROUNDING, speed)
    assert_close(what + "D", program.rows(ours, "D"), theirs.efc_D, ROUNDING, theirs.efc_D)
    assert_close(what + "aref", program.rows(ours, "aref"), theirs.efc_aref, ROUNDING, asked(theirs))


def asked(theirs):
    """Returns each row's scale of the reference acceleration, a sum of damping and stiffness terms."""
    row_size = np.abs(theirs.jacobian).max(axis=1, initial=SMALL_ROW)
    stiffness, damping, impedance = np.abs(theirs.efc_KBIP[:, :3].T)
    violation = np.abs(theirs.efc_pos - theirs.efc_margin) + SMALL_VIOLATION
    speed = row_size * largest(theirs.qvel) + np.abs(theirs.efc_vel)
    return np.abs(theirs.efc_aref) + damping * speed + stiffness * impedance * violation + 1e-9


def acceleration(what, ours, theirs, tolerance=SOLVED):
    assert_close(f"{what}{ours['solver']} qacc", ours["qacc"], theirs.qacc, tolerance, oracle.acceleration_scale(theirs))


def constraint_forces(what, ours, theirs):
    """Compares row forces, their generalized force, and each contact's force in its frame."""
    slow = oracle.SLOW * np.diag(theirs.mass)
    scale = largest(theirs.qfrc_constraint, theirs.qfrc_smooth, slow)
    assert_close(what + "qfrc_constraint", ours["qfrc_constraint"], theirs.qfrc_constraint, SOLVED, scale)
    scale = largest(theirs.efc_force, slow, floor=1e-3)
    assert_close(what + "force", program.rows(ours, "force"), theirs.efc_force, 10 * SOLVED, scale)
    count = len(theirs.contacts)
    assert len(ours["contacts"]) == count, f"{what}{len(ours['contacts'])} contacts, fed {count}"
    for k, contact in enumerate(theirs.contacts):
        actual = ours["contacts"][k]["force"]
        assert_close(f"{what}contact {k} force", actual, contact["force"], 10 * SOLVED, scale)


def sensors(model, what, ours, theirs, solved=10 * SOLVED, is_undecided=lambda sensor: False):
    """Compares every sensor whose value does not depend on rounding.

    The tolerance is rounding before the solver, `solved` after it, and the precision of MuJoCo's search for distances.
    """
    for k in range(model.nsensor):
        kind = mujoco.mjtSensor(model.sensor_type[k])
        numbers = slice(model.sensor_adr[k], model.sensor_adr[k] + model.sensor_dim[k])
        expected = theirs.sensordata[numbers]
        if is_undecided(k):
            continue
        enclosed = kind == mujoco.mjtSensor.mjSENS_INSIDESITE and model.sensor_intprm[k, 0]
        if kind in SEARCHED or enclosed:
            tolerance = SEARCH
        elif model.sensor_needstage[k] == mujoco.mjtStage.mjSTAGE_ACC:
            tolerance = solved
        else:
            tolerance = 10 * ROUNDING
        name = f"{what}sensor {k} {kind.name} {model.sensor(k).name}"
        actual = ours.get("sensordata", [])[numbers]
        if kind == mujoco.mjtSensor.mjSENS_TOUCH and on_the_border(model, k, theirs):
            continue
        assert_close(name, actual, expected, tolerance, largest(expected, floor=1.0))


def on_the_border(model, sensor, theirs):
    """Returns True if rounding decides whether a contact counts.

    MuJoCo's own sum then changes if the site is larger by a millionth.
    """
    site = model.sensor_objid[sensor]
    size = model.site_size[site].copy()
    model.site_size[site] = size * (1 + 1e-6)
    larger = oracle.reference(model, theirs.state).sensordata[model.sensor_adr[sensor]]
    model.site_size[site] = size
    return larger != theirs.sensordata[model.sensor_adr[sensor]]
