"""Compares files that `clench convert` writes with their sources in MuJoCo: sizes, parameters and dynamics."""

import mujoco
import numpy as np
import pytest

import agreement
import conftest
import oracle
import program
import public
import states
import urdf
from compare import assert_close, largest

PRECISION = 1e-6  # of values derived from meshes, whose vertices have 24 bits
SIZES = ("nq", "nv", "nu", "na", "nbody", "njnt", "ngeom", "nsite", "ntendon", "neq", "npair", "nexclude", "nsensor", "nkey", "nplastic")
# Fields of a model that affect motion and that MuJoCo does not compute on the way.
FIELDS = (
    "qpos0 qpos_spring body_parentid body_mocapid body_mass body_subtreemass body_ipos body_gravcomp body_invweight0 jnt_type "
    "jnt_limited jnt_actfrclimited jnt_actgravcomp jnt_solref jnt_solimp jnt_pos jnt_axis jnt_stiffness jnt_range jnt_actfrcrange "
    "jnt_margin dof_solref dof_solimp dof_frictionloss dof_armature dof_damping dof_invweight0 geom_type geom_contype "
    "geom_conaffinity geom_condim geom_priority geom_solmix geom_solref geom_solimp geom_friction geom_margin geom_gap geom_pos "
    "site_type site_size site_pos site_quat tendon_limited tendon_actfrclimited tendon_solref_lim tendon_solimp_lim tendon_solref_fri "
    "tendon_solimp_fri tendon_range tendon_actfrcrange tendon_margin tendon_stiffness tendon_damping tendon_frictionloss "
    "tendon_lengthspring tendon_length0 tendon_invweight0 wrap_prm actuator_trntype actuator_dyntype actuator_gaintype actuator_biastype "
    "actuator_trnid actuator_gear actuator_dynprm actuator_gainprm actuator_biasprm actuator_ctrllimited actuator_forcelimited "
    "actuator_actlimited actuator_ctrlrange actuator_forcerange actuator_actrange actuator_actearly eq_type eq_obj1id eq_obj2id "
    "eq_objtype eq_active0 eq_solref eq_solimp eq_data pair_dim pair_geom1 pair_geom2 pair_solref pair_solreffriction pair_friction "
    "pair_solimp pair_margin pair_gap sensor_type sensor_objid sensor_objtype sensor_refid sensor_reftype sensor_cutoff key_time "
    "key_qpos key_qvel key_act key_ctrl key_plastic jnt_springyield jnt_plasticadr tendon_springyield tendon_plasticadr "
    "body_user jnt_user geom_user site_user cam_user tendon_user actuator_user sensor_user"
).split()
OPTIONS = ("timestep", "gravity", "wind", "magnetic", "density", "viscosity", "integrator", "cone", "impratio")
# Flags that select between algorithms for the same contacts. Our models do not store them.
ALGORITHMS = int(mujoco.mjtDisableBit.mjDSBL_NATIVECCD | mujoco.mjtDisableBit.mjDSBL_MIDPHASE)


def sources():
    """Returns all of our models and gymnasium's and, to save time, every fifth of other packages."""
    ours = [(param.id, param.values[0], param.values[0]) for param in conftest.models()]
    theirs = [(name, public.path(name), public.path(name)) for name in public.compared()[::5]]
    robots = [e.name for e in urdf.compared() if e.how == "as written"][::5]
    return ours + theirs + [(name, public.path(name), urdf.copy(name, False)) for name in robots]


def convert(source, folder):
    path = folder / "saved.xml"
    done = program.run("convert", source, path, *urdf.FLAGS)
    assert done.returncode == 0, done.stderr
    return path


@pytest.mark.parametrize("name, source, readable", [pytest.param(*s, id=s[0]) for s in sources()])
def test_mujoco_reads_what_was_saved(name, source, readable, tmp_path):
    path = convert(source, tmp_path)
    saved, model = mujoco.MjModel.from_xml_path(str(path)), mujoco.MjModel.from_xml_path(str(readable))
    assert [getattr(saved, size) for size in SIZES] == [getattr(model, size) for size in SIZES]
    for field in FIELDS:
        actual, expected = getattr(saved, field), getattr(model, field)
        if field == "eq_data":  # the last number records the source of the others
            actual, expected = actual[:, :-1], expected[:, :-1]
        if field in ("sensor_objid", "sensor_objtype", "sensor_refid", "sensor_reftype"):
            # For a distance, a body with one geom is equivalent to that geom.
            searched = np.isin(model.sensor_type, agreement.SEARCHED)
            actual, expected = actual[~searched], expected[~searched]
        compare(field, actual, expected)
    assert saved.opt.disableflags & ~ALGORITHMS == model.opt.disableflags & ~ALGORITHMS
    for field in OPTIONS:
        compare(field, getattr(saved.opt, field), getattr(model.opt, field))
    found = states.sample(readable, 1, 1, may_be_unstable=True)
    for state in found:
        ours, theirs = (oracle.reference(oracle.exact(m), state) for m in (saved, model))
        diagonal = np.sqrt(np.diag(theirs.mass))
        assert_close("mass", ours.mass, theirs.mass, PRECISION, np.outer(diagonal, diagonal))
        scale = largest(theirs.qfrc_bias, theirs.qfrc_passive, theirs.qfrc_actuator)
        assert_close("smooth", ours.qfrc_smooth, theirs.qfrc_smooth, PRECISION, scale)
        if len(ours.contacts) == len(theirs.contacts):
            scale = oracle.acceleration_scale(theirs) if model.nv else 1.0
            assert_close("qacc", ours.qacc, theirs.qacc, 100 * PRECISION, scale)


def compare(field, actual, expected):
    actual, expected = (np.asarray(x, dtype=float) for x in (actual, expected))
    assert_close(field, actual, expected, PRECISION, largest(expected, floor=1e-3))
