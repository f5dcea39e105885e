"""Sensors whose values may differ from MuJoCo's, since they depend on rounding or MuJoCo's search is incomplete."""

import mujoco
import numpy as np

import oracle

IDLE = 1e-14  # metres: a lever that is only rounding
MIN_FORCE = 1e-9  # newtons
NEARER = 1e-3  # metres
NEXT_TO = 1e-10  # metres
JUMP = 1e-6  # metres
LENS = 1e-6  # relative, of lengths and angles in the view of a camera
LIMITS_OF_TENDONS = (
    mujoco.mjtSensor.mjSENS_TENDONLIMITPOS,
    mujoco.mjtSensor.mjSENS_TENDONLIMITVEL,
    mujoco.mjtSensor.mjSENS_TENDONLIMITFRC,
)
BETWEEN_BODIES = (mujoco.mjtSensor.mjSENS_FORCE, mujoco.mjtSensor.mjSENS_TORQUE)
OF_TENDONS = (mujoco.mjtConstraint.mjCNSTR_FRICTION_TENDON, mujoco.mjtConstraint.mjCNSTR_LIMIT_TENDON)


def is_undecided(model, sensor, ours, theirs, held):
    """Returns True if a sensor's value may differ from MuJoCo's, for one of these reasons.

    - Parallel faces have many nearest points, and equal moments of inertia have no unique principal axes.
    - Rounding gives a tendon that moves nothing a Jacobian, so that the sensor of its limit is not zero.
    - `held`: rounding holds such a tendon or ties a body to itself, which changes the forces between bodies.
    - MuJoCo finds the depth of curved shapes to some thousandths (`test_shapes.py` compares depths), misses a capsule
      that pierces a box, and inspects only the first cells of a height field.
    - A ray that starts on a surface or passes an edge hits it or not.
    - MuJoCo does not move cameras of the world if bodies may sleep.
    """
    kind = mujoco.mjtSensor(model.sensor_type[sensor])
    if kind in (mujoco.mjtSensor.mjSENS_GEOMNORMAL, mujoco.mjtSensor.mjSENS_GEOMFROMTO):
        return True
    if kind == mujoco.mjtSensor.mjSENS_GEOMDIST:
        return theirs.sensordata[model.sensor_adr[sensor]] < 0 or pierces(model, sensor, theirs) or cut_short(model, sensor, theirs)
    if kind == mujoco.mjtSensor.mjSENS_RANGEFINDER:
        return jumps(model, sensor, ours, theirs)
    if kind in BETWEEN_BODIES:
        return held
    if kind == mujoco.mjtSensor.mjSENS_CAMPROJECTION:
        return stands_still(model, model.sensor_refid[sensor]) or seen_alike(model, sensor, ours, theirs)
    if kind in LIMITS_OF_TENDONS and theirs.sensordata[model.sensor_adr[sensor]] != 0:
        limits = theirs.efc_type == int(mujoco.mjtConstraint.mjCNSTR_LIMIT_TENDON)  # of tendons that move something
        return model.sensor_objid[sensor] not in theirs.efc_id[limits]
    ends = ((model.sensor_objtype, model.sensor_objid), (model.sensor_reftype, model.sensor_refid))
    for kind, index in ends:
        if kind[sensor] == mujoco.mjtObj.mjOBJ_BODY and index[sensor] >= 0:
            moments = np.sort(model.body_inertia[index[sensor]])
            if (np.diff(moments) <= 1e-6 * moments[-1]).any():
                return True
    return False


def held_by_rounding(theirs):
    """Returns True if friction or a limit holds a tendon that moves nothing, or an equality ties a body to itself.

    Rounding decides whether it is a constraint, and its reference acceleration is a quotient of rounding errors. It
    moves nothing, but exerts a force between the bodies at its ends.
    """
    tendons = np.isin(theirs.efc_type, [int(kind) for kind in OF_TENDONS])
    idle = np.abs(theirs.jacobian).max(axis=1, initial=0) <= IDLE
    equality = theirs.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
    alone = equality & ~np.isin(theirs.efc_id, theirs.efc_id[equality & ~idle])
    return bool((np.abs(theirs.efc_force[idle & (tendons | alone)]) > MIN_FORCE).any())


def pierces(model, sensor, theirs):
    """Returns True if a sensor measures the distance of a box and a capsule whose axis pierces the box.

    MuJoCo compares the axis with the box's edges and the ends of the axis with its faces, so it finds too small a depth
    or a positive distance.
    """
    data = oracle.assigned(model, theirs.state)
    mujoco.mj_kinematics(model, data)
    first, second = both(model, sensor)
    pairs = [pair for a in first for b in second for pair in ((a, b), (b, a))]
    return any(goes_through(model, data, capsule, box) for capsule, box in pairs)


def cut_short(model, sensor, theirs):
    """Returns True if a sensor measures the distance of a height field that MuJoCo does not inspect completely.

    It stops at fifty cells within the cutoff, near or far, so a cutoff just above the distance changes the result.
    """
    if not any((model.geom_type[list(side)] == mujoco.mjtGeom.mjGEOM_HFIELD).any() for side in both(model, sensor)):
        return False
    found = theirs.sensordata[model.sensor_adr[sensor]]
    cutoff = model.sensor_cutoff[sensor]
    model.sensor_cutoff[sensor] = min(cutoff, found * (1 + NEARER) + NEARER)
    again = oracle.reference(model, theirs.state).sensordata[model.sensor_adr[sensor]]
    model.sensor_cutoff[sensor] = cutoff
    return abs(again - found) > NEARER


def jumps(model, sensor, ours, theirs):
    """Returns True if MuJoCo's ray jumps when the sensor moves by less than the precision of lengths.

    If rays hit the same, it returns True for a camera whose rays agree within the precision of MuJoCo's lens data.
    """
    numbers = slice(model.sensor_adr[sensor], model.sensor_adr[sensor] + model.sensor_dim[sensor])
    expected = theirs.sensordata[numbers]
    if np.allclose(ours["sensordata"][numbers], expected, rtol=0, atol=JUMP):
        return model.sensor_objtype[sensor] == mujoco.mjtObj.mjOBJ_CAMERA and seen_alike(model, sensor, ours, theirs)
    places = model.site_pos if model.sensor_objtype[sensor] == mujoco.mjtObj.mjOBJ_SITE else model.cam_pos
    index = model.sensor_objid[sensor]
    place = places[index].copy()
    frames = model.site_sameframe.copy()
    # Without this, a site in the frame of its body would not move.
    model.site_sameframe[:] = mujoco.mjtSameFrame.mjSAMEFRAME_NONE
    found = []
    for step in [*np.eye(3), *-np.eye(3)]:
        places[index] = place + NEXT_TO * step
        found.append(oracle.reference(model, theirs.state).sensordata[numbers])
    places[index] = place
    model.site_sameframe[:] = frames
    return bool((np.abs(np.array(found) - expected) > JUMP).any())


def seen_alike(model, sensor, ours, theirs):
    """Returns True if values of a camera agree within the precision of its lens, which MuJoCo stores in 24 bits."""
    numbers = slice(model.sensor_adr[sensor], model.sensor_adr[sensor] + model.sensor_dim[sensor])
    return np.allclose(ours["sensordata"][numbers], theirs.sensordata[numbers], rtol=LENS, atol=LENS)


def stands_still(model, camera):
    """Returns True if a tracking camera is fixed to the world of a model that may sleep.

    MuJoCo places such a camera only on reset.
    """
    fixed = model.body_weldid[model.cam_bodyid[camera]] == 0
    sleeps = model.opt.enableflags & mujoco.mjtEnableBit.mjENBL_SLEEP
    return bool(sleeps and fixed and model.cam_mode[camera] != mujoco.mjtCamLight.mjCAMLIGHT_FIXED)


def both(model, sensor):
    """Returns the geoms on both sides of a distance sensor."""
    return (
        geoms(model, model.sensor_objtype[sensor], model.sensor_objid[sensor]),
        geoms(model, model.sensor_reftype[sensor], model.sensor_refid[sensor]),
    )


def geoms(model, kind, index):
    """Returns the geoms of a sensor's object, a geom or a body."""
    if kind == mujoco.mjtObj.mjOBJ_GEOM:
        return [index]
    return range(model.body_geomadr[index], model.body_geomadr[index] + model.body_geomnum[index])


def goes_through(model, data, capsule, box):
    """Returns True if the axis of a capsule intersects a box."""
    kinds = (model.geom_type[capsule], model.geom_type[box])
    if kinds != (mujoco.mjtGeom.mjGEOM_CAPSULE, mujoco.mjtGeom.mjGEOM_BOX):
        return False
    half = model.geom_size[capsule, 1] * np.reshape(data.geom_xmat[capsule], (3, 3))[:, 2]
    end = data.geom_xpos[capsule] - half
    met = mujoco.mju_rayGeom(data.geom_xpos[box], data.geom_xmat[box], model.geom_size[box], end, 2 * half, kinds[1], None)
    return 0 <= met <= 1
