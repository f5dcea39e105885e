//! The fields of a model by name: its parameters, and its structure with MuJoCo's names and codes.

use crate::assets::ASSETS;
use crate::field::{
    Field, NONE, Numbers, Reader, codes, first, flags, id, id_or_none, reals, user_rows,
};
use clench::Model;
use clench::collide::ShapeKind;
use clench::rigid::model::{
    Coupled, EqualityTarget, JointKind, Keyframe, ParamField, Transmission, Wrap,
};

/// Returns the names of all fields.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    let structure = STRUCTURE.iter().chain(ASSETS).map(|(name, _)| *name);
    ParamField::ALL
        .iter()
        .map(|field| field.name())
        .chain(structure)
}

/// Returns the field with this name.
pub(crate) fn find(model: &Model, name: &str) -> Option<Field> {
    let param = ParamField::ALL.iter().find(|field| field.name() == name);
    let param = param.map(|&field| Field {
        shape: field.shape(model),
        numbers: Numbers::Real(model.params.read_lane(field, 0)),
    });
    param.or_else(|| {
        let mut structure = STRUCTURE.iter().chain(ASSETS);
        let (_, read) = structure.find(|(known, _)| *known == name)?;
        Some(read(model))
    })
}

/// The structure, read from the records of the model. An index is −1 if there is no element to refer to.
const STRUCTURE: &[Reader] = &[
    ("body_parentid", |m| codes(&m.bodies, |b| id(b.parent))),
    ("body_rootid", |m| codes(&m.bodies, |b| id(b.root))),
    ("body_weldid", |m| codes(&m.bodies, |b| id(b.weld))),
    ("body_mocapid", |m| {
        codes(&m.bodies, |b| id_or_none(b.mocap))
    }),
    ("body_jntnum", |m| codes(&m.bodies, |b| id(b.joints.len()))),
    ("body_jntadr", |m| codes(&m.bodies, |b| first(&b.joints))),
    ("body_dofnum", |m| codes(&m.bodies, |b| id(b.dofs.len()))),
    ("body_dofadr", |m| codes(&m.bodies, |b| first(&b.dofs))),
    ("body_geomnum", |m| codes(&m.bodies, |b| id(b.geoms.len()))),
    ("body_geomadr", |m| codes(&m.bodies, |b| first(&b.geoms))),
    ("body_user", |m| user_rows(&m.bodies, |b| &b.user)),
    ("jnt_type", |m| codes(&m.joints, |j| joint_type(j.kind))),
    ("jnt_bodyid", |m| codes(&m.joints, |j| id(j.body))),
    ("jnt_qposadr", |m| codes(&m.joints, |j| id(j.qpos))),
    ("jnt_dofadr", |m| codes(&m.joints, |j| id(j.dof))),
    ("jnt_plasticadr", |m| {
        codes(&m.joints, |j| id_or_none(j.plastic))
    }),
    ("jnt_group", |m| codes(&m.joints, |j| j.group)),
    ("jnt_limited", |m| flags(&m.joints, |j| j.limited)),
    ("jnt_actfrclimited", |m| {
        flags(&m.joints, |j| j.actfrclimited)
    }),
    ("jnt_actgravcomp", |m| flags(&m.joints, |j| j.actgravcomp)),
    ("jnt_user", |m| user_rows(&m.joints, |j| &j.user)),
    ("dof_bodyid", |m| codes(&m.dofs, |d| id(d.body))),
    ("dof_jntid", |m| codes(&m.dofs, |d| id(d.joint))),
    ("dof_parentid", |m| codes(&m.dofs, |d| id_or_none(d.parent))),
    ("geom_type", |m| codes(&m.geoms, |g| geom_type(g.kind))),
    ("geom_dataid", |m| {
        codes(&m.geoms, |g| id_or_none(g.mesh.or(g.height_field)))
    }),
    ("geom_bodyid", |m| codes(&m.geoms, |g| id(g.body))),
    ("geom_contype", |m| {
        codes(&m.geoms, |g| g.contype.cast_signed())
    }),
    ("geom_conaffinity", |m| {
        codes(&m.geoms, |g| g.conaffinity.cast_signed())
    }),
    ("geom_condim", |m| {
        codes(&m.geoms, |g| g.condim.cast_signed())
    }),
    ("geom_priority", |m| codes(&m.geoms, |g| g.priority)),
    ("geom_group", |m| codes(&m.geoms, |g| g.group)),
    ("geom_user", |m| user_rows(&m.geoms, |g| &g.user)),
    ("site_bodyid", |m| codes(&m.sites, |s| id(s.body))),
    ("site_user", |m| user_rows(&m.sites, |s| &s.user)),
    ("cam_bodyid", |m| codes(&m.cameras, |c| id(c.body))),
    ("cam_resolution", resolutions),
    ("cam_user", |m| user_rows(&m.cameras, |c| &c.user)),
    ("tendon_num", |m| codes(&m.tendons, |t| id(t.coefs.len()))),
    ("tendon_adr", |m| codes(&m.tendons, |t| first(&t.coefs))),
    ("tendon_plasticadr", |m| {
        codes(&m.tendons, |t| id_or_none(t.plastic))
    }),
    ("tendon_limited", |m| flags(&m.tendons, |t| t.limited)),
    ("tendon_actfrclimited", |m| {
        flags(&m.tendons, |t| t.actfrclimited)
    }),
    ("tendon_type", |m| {
        codes(&m.tendons, |t| i32::from(t.is_spatial()))
    }),
    ("tendon_user", |m| user_rows(&m.tendons, |t| &t.user)),
    ("wrap_type", |m| wraps(m, |wrap| wrap.0)),
    ("wrap_objid", |m| wraps(m, |wrap| wrap.1)),
    ("wrap_sideid", |m| wraps(m, |wrap| wrap.2)),
    ("actuator_trntype", |m| {
        codes(&m.actuators, |a| transmission(a.transmission).0)
    }),
    ("actuator_trnid", transmission_targets),
    ("actuator_dyntype", |m| {
        codes(&m.actuators, |a| a.dynamics.number())
    }),
    ("actuator_gaintype", |m| {
        codes(&m.actuators, |a| a.gain.number())
    }),
    ("actuator_biastype", |m| {
        codes(&m.actuators, |a| a.bias.number())
    }),
    ("actuator_actadr", |m| {
        codes(&m.actuators, |a| first(&a.acts))
    }),
    ("actuator_actnum", |m| {
        codes(&m.actuators, |a| id(a.acts.len()))
    }),
    ("actuator_ctrladr", |m| {
        codes(&m.actuators, |a| id(a.controls.start))
    }),
    ("actuator_ctrlnum", |m| {
        codes(&m.actuators, |a| id(a.controls.len()))
    }),
    ("actuator_outadr", |m| {
        codes(&m.actuators, |a| id(a.outputs.start))
    }),
    ("actuator_outnum", |m| {
        codes(&m.actuators, |a| id(a.outputs.len()))
    }),
    ("actuator_group", |m| codes(&m.actuators, |a| a.group)),
    ("actuator_ctrllimited", |m| {
        let limited: Vec<bool> = (m.actuators.iter())
            .flat_map(|a| a.ctrllimited.iter().copied())
            .collect();
        flags(&limited, |&limited| limited)
    }),
    ("actuator_forcelimited", |m| {
        flags(&m.actuators, |a| a.forcelimited)
    }),
    ("actuator_actlimited", |m| {
        flags(&m.actuators, |a| a.actlimited)
    }),
    ("actuator_actearly", |m| flags(&m.actuators, |a| a.actearly)),
    ("actuator_user", |m| user_rows(&m.actuators, |a| &a.user)),
    ("sensor_adr", |m| codes(&m.sensors, |s| id(s.numbers.start))),
    ("sensor_dim", |m| codes(&m.sensors, |s| id(s.numbers.len()))),
    ("sensor_cutoff", |m| reals(&m.sensors, |s| s.cutoff)),
    ("sensor_noise", |m| reals(&m.sensors, |s| s.noise)),
    ("sensor_phase", |m| reals(&m.sensors, |s| s.phase)),
    ("sensor_user", |m| user_rows(&m.sensors, |s| &s.user)),
    ("eq_type", |m| {
        codes(&m.equalities, |e| equality(e.target).0)
    }),
    ("eq_obj1id", |m| {
        codes(&m.equalities, |e| equality(e.target).1)
    }),
    ("eq_obj2id", |m| {
        codes(&m.equalities, |e| equality(e.target).2)
    }),
    ("eq_active0", |m| flags(&m.equalities, |e| e.active0)),
    ("pair_dim", |m| codes(&m.pairs, |p| p.condim.cast_signed())),
    ("pair_geom1", |m| codes(&m.pairs, |p| id(p.geoms[0]))),
    ("pair_geom2", |m| codes(&m.pairs, |p| id(p.geoms[1]))),
    ("key_time", |m| {
        stored(m, &[], |k| std::slice::from_ref(&k.time))
    }),
    ("key_qpos", |m| stored(m, &[m.nq], |k| &k.qpos)),
    ("key_qvel", |m| stored(m, &[m.nv], |k| &k.qvel)),
    ("key_act", |m| stored(m, &[m.na], |k| &k.act)),
    ("key_plastic", |m| stored(m, &[m.nplastic], |k| &k.plastic)),
    ("key_ctrl", |m| stored(m, &[m.nu()], |k| &k.ctrl)),
    ("key_mpos", |m| stored(m, &[m.nmocap, 3], |k| &k.mocap_pos)),
    ("key_mquat", |m| {
        stored(m, &[m.nmocap, 4], |k| &k.mocap_quat)
    }),
];

/// Returns a quantity of all keyframes, each of shape `shape`.
fn stored(model: &Model, shape: &[usize], numbers: impl Fn(&Keyframe) -> &[f64]) -> Field {
    let keyframes = &model.keyframes;
    Field {
        shape: [&[keyframes.len()], shape].concat(),
        numbers: Numbers::Real(keyframes.iter().flat_map(numbers).copied().collect()),
    }
}

/// Returns the resolutions of cameras, in pixels.
fn resolutions(model: &Model) -> Field {
    let pixels = (model.cameras.iter()).flat_map(|camera| camera.resolution.map(id));
    Field {
        shape: vec![model.cameras.len(), 2],
        numbers: Numbers::Code(pixels.collect()),
    }
}

/// Returns one code for each element of each tendon's path.
fn wraps(model: &Model, code: impl Fn((i32, i32, i32)) -> i32) -> Field {
    let path = model.tendons.iter().flat_map(|tendon| &tendon.path);
    let found: Vec<i32> = path.map(|&element| code(wrap(model, element))).collect();
    codes(&found, |&code| code)
}

/// Returns the targets of each actuator's transmission. The second index is for transmissions with two targets.
fn transmission_targets(model: &Model) -> Field {
    let targets = (model.actuators.iter()).flat_map(|a| transmission(a.transmission).1);
    Field {
        shape: vec![model.actuators.len(), 2],
        numbers: Numbers::Code(targets.collect()),
    }
}

fn joint_type(kind: JointKind) -> i32 {
    match kind {
        JointKind::Free => 0,
        JointKind::Ball => 1,
        JointKind::Slide => 2,
        JointKind::Hinge => 3,
    }
}

fn geom_type(kind: ShapeKind) -> i32 {
    match kind {
        ShapeKind::Plane => 0,
        ShapeKind::HeightField => 1,
        ShapeKind::Sphere => 2,
        ShapeKind::Capsule => 3,
        ShapeKind::Ellipsoid => 4,
        ShapeKind::Cylinder => 5,
        ShapeKind::Box => 6,
        ShapeKind::Mesh => 7,
    }
}

/// Returns the type of a transmission and its targets.
fn transmission(transmission: Transmission) -> (i32, [i32; 2]) {
    match transmission {
        Transmission::Joint(joint) => (0, [id(joint), NONE]),
        Transmission::JointInParent(joint) => (1, [id(joint), NONE]),
        Transmission::SliderCrank(sites) => (2, sites.map(id)),
        Transmission::Tendon(tendon) => (3, [id(tendon), NONE]),
        Transmission::Site(site) => (4, [id(site), NONE]),
        Transmission::SiteInFrame(sites) => (4, sites.map(id)),
        Transmission::Body(body) => (5, [id(body), NONE]),
        Transmission::Rotation(joint) => (6, [id(joint), NONE]),
        Transmission::RotationInFrame(sites) => (6, sites.map(id)),
    }
}

/// Returns the type of a path element, its object, and the side site of a geom.
fn wrap(model: &Model, wrap: Wrap) -> (i32, i32, i32) {
    match wrap {
        Wrap::Joint(joint) => (1, id(joint), NONE),
        Wrap::Pulley => (2, NONE, NONE),
        Wrap::Site(site) => (3, id(site), NONE),
        Wrap::Geom { geom, side } => {
            let cylinder = model.geoms[geom].kind == ShapeKind::Cylinder;
            (4 + i32::from(cylinder), id(geom), id_or_none(side))
        }
    }
}

/// Returns the type of an equality and its objects.
fn equality(target: EqualityTarget) -> (i32, i32, i32) {
    let (first, second) = match target.coupled() {
        Coupled::Points([first, second]) | Coupled::Frames([first, second]) => {
            (first, Some(second))
        }
        Coupled::Joints(follower, leader) | Coupled::Tendons(follower, leader) => {
            (follower, leader)
        }
    };
    (target.code(), id(first), id_or_none(second))
}
