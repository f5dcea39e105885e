"""Sensors of which MuJoCo's numbers need not be ours, since rounding decides them or MuJoCo does not find what it looks for."""

import mujoco
import numpy as np

import oracle

IDLE = 1e-14  # metres: a lever that is nothing but rounding
HELD = 1e-9  # newtons
NEARER = 1e-3  # metres
NEXT_TO = 1e-10  # metres
JUMP = 1e-6  # metres
LENS = 1e-6  # of lengths and angles that a camera sees
LIMITS_OF_TENDONS = (
    mujoco.mjtSensor.mjSENS_TENDONLIMITPOS,
    mujoco.mjtSensor.mjSENS_TENDONLIMITVEL,
    mujoco.mjtSensor.mjSENS_TENDONLIMITFRC,
)
BETWEEN_BODIES = (mujoco.mjtSensor.mjSENS_FORCE, mujoco.mjtSensor.mjSENS_TORQUE)
OF_TENDONS = (mujoco.mjtConstraint.mjCNSTR_FRICTION_TENDON, mujoco.mjtConstraint.mjCNSTR_LIMIT_TENDON)


def is_undecided(model, sensor, ours, theirs, held):
    """Whether MuJoCo's numbers need not be ours: many points of parallel faces are nearest, equal moments have no principal axes, the
    limit of a tendon that moves nothing is felt where rounding gives it a Jacobian, and so are forces between bodies where rounding
    `held` such a tendon, or tied a body to itself; how deep curved shapes are in each other MuJoCo finds to some thousandths (`test_shapes.py` judges depths), that
    a capsule goes through a box not at all, and of a height field what is near among the first of its cells alone; and a ray that starts on
    a surface, or passes an edge, meets it or not; and a camera of the world stands still where bodies may sleep."""
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
    """Whether friction or a limit holds a tendon that moves nothing, or an equality ties a body to itself: that it is a constraint at all,
    rounding decides, and what it asks for is a quotient of roundings. It moves nothing, and yet is a force between the bodies of its ends."""
    tendons = np.isin(theirs.efc_type, [int(kind) for kind in OF_TENDONS])
    idle = np.abs(theirs.jacobian).max(axis=1, initial=0) <= IDLE
    equality = theirs.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
    alone = equality & ~np.isin(theirs.efc_id, theirs.efc_id[equality & ~idle])
    return bool((np.abs(theirs.efc_force[idle & (tendons | alone)]) > HELD).any())


def pierces(model, sensor, theirs):
    """Whether a sensor of distances looks at a box and a capsule whose axis goes through the box: MuJoCo compares the axis with the box's
    edges and the axis's ends with its faces, and so says that they are apart, or less deep in each other than they are."""
    data = oracle.assigned(model, theirs.state)
    mujoco.mj_kinematics(model, data)
    first, second = both(model, sensor)
    pairs = [pair for a in first for b in second for pair in ((a, b), (b, a))]
    return any(goes_through(model, data, capsule, box) for capsule, box in pairs)


def cut_short(model, sensor, theirs):
    """Whether a sensor of distances looks at a height field that MuJoCo does not look at all of: it stops at fifty cells within the
    cutoff, near or far, so that with a cutoff just above what it found it finds another distance."""
    if not any((model.geom_type[list(side)] == mujoco.mjtGeom.mjGEOM_HFIELD).any() for side in both(model, sensor)):
        return False
    found = theirs.sensordata[model.sensor_adr[sensor]]
    cutoff = model.sensor_cutoff[sensor]
    model.sensor_cutoff[sensor] = min(cutoff, found * (1 + NEARER) + NEARER)
    again = oracle.reference(model, theirs.state).sensordata[model.sensor_adr[sensor]]
    model.sensor_cutoff[sensor] = cutoff
    return abs(again - found) > NEARER


def jumps(model, sensor, ours, theirs):
    """Whether rays meet something else than MuJoCo's, and MuJoCo's do too from a place next to the sensor's, less apart than lengths are
    known; or rays of a camera meet the same within what MuJoCo knows of its lens."""
    numbers = slice(model.sensor_adr[sensor], model.sensor_adr[sensor] + model.sensor_dim[sensor])
    expected = theirs.sensordata[numbers]
    if np.allclose(ours["sensordata"][numbers], expected, rtol=0, atol=JUMP):
        return model.sensor_objtype[sensor] == mujoco.mjtObj.mjOBJ_CAMERA and seen_alike(model, sensor, ours, theirs)
    places = model.site_pos if model.sensor_objtype[sensor] == mujoco.mjtObj.mjOBJ_SITE else model.cam_pos
    index = model.sensor_objid[sensor]
    place = places[index].copy()
    frames = model.site_sameframe.copy()
    model.site_sameframe[:] = mujoco.mjtSameFrame.mjSAMEFRAME_NONE  # or a site that stands where its body does would not move
    found = []
    for step in [*np.eye(3), *-np.eye(3)]:
        places[index] = place + NEXT_TO * step
        found.append(oracle.reference(model, theirs.state).sensordata[numbers])
    places[index] = place
    model.site_sameframe[:] = frames
    return bool((np.abs(np.array(found) - expected) > JUMP).any())


def seen_alike(model, sensor, ours, theirs):
    """Whether a camera sees the same as far as its lens is known, which MuJoCo stores in single precision."""
    numbers = slice(model.sensor_adr[sensor], model.sensor_adr[sensor] + model.sensor_dim[sensor])
    return np.allclose(ours["sensordata"][numbers], theirs.sensordata[numbers], rtol=LENS, atol=LENS)


def stands_still(model, camera):
    """Whether a camera that follows bodies is fixed to the world of a model that may sleep: MuJoCo places it when it resets, and then no more."""
    fixed = model.body_weldid[model.cam_bodyid[camera]] == 0
    sleeps = model.opt.enableflags & mujoco.mjtEnableBit.mjENBL_SLEEP
    return bool(sleeps and fixed and model.cam_mode[camera] != mujoco.mjtCamLight.mjCAMLIGHT_FIXED)


def both(model, sensor):
    """The geoms on both sides of a sensor of distances."""
    return (
        geoms(model, model.sensor_objtype[sensor], model.sensor_objid[sensor]),
        geoms(model, model.sensor_reftype[sensor], model.sensor_refid[sensor]),
    )


def geoms(model, kind, index):
    """The geoms of what a sensor looks at, a geom or a body."""
    if kind == mujoco.mjtObj.mjOBJ_GEOM:
        return [index]
    return range(model.body_geomadr[index], model.body_geomadr[index] + model.body_geomnum[index])


def goes_through(model, data, capsule, box):
    """Whether the axis of a capsule meets a box."""
    kinds = (model.geom_type[capsule], model.geom_type[box])
    if kinds != (mujoco.mjtGeom.mjGEOM_CAPSULE, mujoco.mjtGeom.mjGEOM_BOX):
        return False
    half = model.geom_size[capsule, 1] * np.reshape(data.geom_xmat[capsule], (3, 3))[:, 2]
    end = data.geom_xpos[capsule] - half
    met = mujoco.mju_rayGeom(data.geom_xpos[box], data.geom_xmat[box], model.geom_size[box], end, 2 * half, kinds[1], None)
    return 0 <= met <= 1
