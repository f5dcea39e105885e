//! Bodies and their elements.

use super::names::{SaveError, body_name, label, named};
use super::xml::{Tag, Xml};
use crate::document::MAX_DEPTH;
use clench_builder::{
    DEFAULT_SOLIMP, DEFAULT_SOLREF, DOF_NUMBERS, ElementNumber, JOINT_NUMBERS, surfacevel_in_frame,
};
use clench_collide::ShapeKind;
use clench_dynamics::Model;
use clench_dynamics::model::{
    Appearance, Body, Camera, CameraMode, Dof, Geom, Joint, JointKind, Site, SleepPolicy, Visuals,
};
use clench_math::{Quat, Vec3};

const IDENTITY_QUAT: [f64; 4] = [1.0, 0.0, 0.0, 0.0];

/// Writes all bodies, each in its parent.
pub(super) fn write(model: &Model, xml: &mut Xml) -> Result<(), SaveError> {
    // The open bodies, innermost last.
    let mut open: Vec<usize> = Vec::new();
    for (b, body) in model.bodies.iter().enumerate() {
        while open
            .last()
            .is_some_and(|&last| b > 0 && last != body.parent)
        {
            open.pop();
            xml.close();
        }
        if xml.depth() + 2 > MAX_DEPTH {
            let reason = format!("it would be nested more than {MAX_DEPTH} deep");
            return Err(SaveError::new(label("body", &body.name, b), reason));
        }
        write_body(model, b, xml)?;
        open.push(b);
    }
    open.iter().for_each(|_| xml.close());
    Ok(())
}

/// Writes a body without its children, and leaves it open.
fn write_body(model: &Model, b: usize, xml: &mut Xml) -> Result<(), SaveError> {
    let Body {
        name,
        parent: _,
        root: _,
        weld: _,
        joints,
        dofs: _,
        geoms,
        sites,
        cameras,
        mocap,
        last_dof: _,
        simple_inertia: _,
        diagonal_inertia: _,
        fluid_ellipsoids: _,
        never_simple,
        user,
        origin: _,
    } = &model.bodies[b];
    let p = &model.params;
    if b == 0 {
        xml.tag("worldbody").open();
    } else {
        let mut tag = write_pose(xml.tag("body").name(name), p.body_pos[b], p.body_quat[b]);
        if mocap.is_some() {
            tag = tag.boolean("mocap", true);
        }
        if *never_simple {
            tag = tag.boolean("simple", false);
        }
        let tree = model.trees.iter().find(|tree| tree.bodies.start == b);
        if let Some(tree) = tree.filter(|_| model.flags.sleep) {
            tag = tag.text("sleep", sleep_policy(tree.sleep));
        }
        tag.number_unless("gravcomp", p.body_gravcomp[b], 0.0)
            .numbers_unless("user", user, &[])
            .open();
        let inertial = xml
            .tag("inertial")
            .numbers("pos", &p.body_ipos[b].to_array())
            .numbers_unless("quat", &p.body_iquat[b].to_array(), &IDENTITY_QUAT);
        inertial
            .numbers("mass", &[p.body_mass[b]])
            .numbers("diaginertia", &p.body_inertia[b].to_array())
            .end();
    }
    for j in joints.clone() {
        write_joint(model, j, xml)?;
    }
    for g in geoms.clone() {
        write_geom(model, g, xml)?;
    }
    for s in sites.clone() {
        write_site(model, s, xml);
    }
    for c in cameras.clone() {
        write_camera(model, c, xml)?;
    }
    Ok(())
}

fn sleep_policy(policy: SleepPolicy) -> &'static str {
    match policy {
        SleepPolicy::Auto => "auto",
        SleepPolicy::Never => "never",
        SleepPolicy::Allowed => "allowed",
        SleepPolicy::Init => "init",
    }
}

/// Writes the pose of an element in its body.
fn write_pose<'a>(tag: Tag<'a>, pos: Vec3<f64>, quat: Quat<f64>) -> Tag<'a> {
    tag.numbers_unless("pos", &pos.to_array(), &[0.0; 3])
        .numbers_unless("quat", &quat.to_array(), &IDENTITY_QUAT)
}

fn write_joint(model: &Model, j: usize, xml: &mut Xml) -> Result<(), SaveError> {
    let Joint {
        name,
        kind,
        body: _,
        qpos,
        dof,
        plastic: _,
        limited,
        actfrclimited,
        actgravcomp,
        reflecting: _,
        group,
        user,
        origin: _,
    } = &model.joints[j];
    let p = &model.params;
    for d in *dof..*dof + kind.nv() {
        let Dof {
            body: _,
            joint: _,
            parent: _,
            frictionloss: _,
        } = &model.dofs[d];
        let same_number =
            |row: &ElementNumber| p.number(row.param, 0, d) == p.number(row.param, 0, *dof);
        let same = DOF_NUMBERS.iter().all(same_number)
            && p.dof_damping[d] == p.dof_damping[*dof]
            && p.dof_dampingpoly[d] == p.dof_dampingpoly[*dof]
            && p.dof_solref[d] == p.dof_solref[*dof]
            && p.dof_solimp[d] == p.dof_solimp[*dof];
        if !same {
            let reason = "its degrees of freedom differ in armature, damping or dry friction";
            return Err(SaveError::new(label("joint", name, j), reason));
        }
    }
    let d = *dof;
    let polynomial = |linear: f64, [quadratic, cubic]: [f64; 2]| [linear, quadratic, cubic];
    let stiffness = polynomial(p.jnt_stiffness[j], p.jnt_stiffnesspoly[j]);
    let damping = polynomial(p.dof_damping[d], p.dof_dampingpoly[d]);
    let mut tag = xml.tag("joint").name(name).text("type", joint_type(*kind));
    if *kind != JointKind::Free {
        tag = tag.numbers_unless("pos", &p.jnt_pos[j].to_array(), &[0.0; 3]);
    }
    if matches!(kind, JointKind::Slide | JointKind::Hinge) {
        tag = tag
            .numbers("axis", &p.jnt_axis[j].to_array())
            .number_unless("ref", p.qpos0[*qpos], 0.0)
            .number_unless("springref", p.qpos_spring[*qpos], 0.0);
    }
    tag = tag
        .numbers_unless("range", &p.jnt_range[j], &[0.0; 2])
        .boolean("limited", *limited)
        .numbers_unless("actuatorfrcrange", &p.jnt_actfrcrange[j], &[0.0; 2])
        .boolean("actuatorfrclimited", *actfrclimited)
        .numbers_unless("solreflimit", &p.jnt_solref[j], &DEFAULT_SOLREF)
        .numbers_unless("solimplimit", &p.jnt_solimp[j], &DEFAULT_SOLIMP)
        .polynomial("stiffness", stiffness)
        .polynomial("damping", damping)
        .element_numbers(&JOINT_NUMBERS, p, j)
        .element_numbers(&DOF_NUMBERS, p, d)
        .numbers_unless("solreffriction", &p.dof_solref[d], &DEFAULT_SOLREF)
        .numbers_unless("solimpfriction", &p.dof_solimp[d], &DEFAULT_SOLIMP)
        .integer_unless("group", (*group).into(), 0);
    tag = tag.numbers_unless("user", user, &[]);
    if *actgravcomp {
        tag = tag.boolean("actuatorgravcomp", true);
    }
    tag.end();
    Ok(())
}

fn joint_type(kind: JointKind) -> &'static str {
    match kind {
        JointKind::Free => "free",
        JointKind::Ball => "ball",
        JointKind::Slide => "slide",
        JointKind::Hinge => "hinge",
    }
}

fn geom_type(kind: ShapeKind) -> &'static str {
    match kind {
        ShapeKind::Plane => "plane",
        ShapeKind::HeightField => "hfield",
        ShapeKind::Sphere => "sphere",
        ShapeKind::Capsule => "capsule",
        ShapeKind::Ellipsoid => "ellipsoid",
        ShapeKind::Cylinder => "cylinder",
        ShapeKind::Box => "box",
        ShapeKind::Mesh => "mesh",
    }
}

fn write_geom(model: &Model, g: usize, xml: &mut Xml) -> Result<(), SaveError> {
    let Geom {
        name,
        kind,
        mesh,
        height_field,
        body: _,
        contype,
        conaffinity,
        condim,
        priority,
        group,
        visible,
        fluid_ellipsoid,
        user,
        origin: _,
    } = &model.geoms[g];
    let p = &model.params;
    let (mut pos, mut quat) = (p.geom_pos[g], p.geom_quat[g]);
    let mut surfacevel = p.geom_surfacevel[g];
    let mut tag = xml.tag("geom").name(name).text("type", geom_type(*kind));
    if let Some(mesh) = mesh {
        // The model places a geom at its mesh's centre of mass, the file at the mesh's origin.
        let mesh = &model.meshes[*mesh];
        quat = (quat * mesh.quat.conjugate()).normalize();
        pos -= quat.rotate(mesh.pos);
        let back = mesh.quat.conjugate();
        surfacevel = surfacevel_in_frame(&surfacevel, -back.rotate(mesh.pos), back);
        tag = tag.text("mesh", &mesh.name);
    } else if let Some(field) = height_field {
        let field = &model.height_fields[*field];
        tag = tag.text("hfield", named("height field", &field.name, g)?);
    } else {
        tag = tag.numbers("size", &p.geom_size[g].to_array());
    }
    tag = write_pose(tag, pos, quat)
        .integer_unless("contype", (*contype as i32).into(), 1)
        .integer_unless("conaffinity", (*conaffinity as i32).into(), 1)
        .integer_unless("condim", (*condim).into(), 3)
        .integer_unless("priority", (*priority).into(), 0)
        .integer_unless("group", (*group).into(), 0)
        .numbers_unless("friction", &p.geom_friction[g], &[1.0, 0.005, 0.0001])
        .number_unless("solmix", p.geom_solmix[g], 1.0)
        .numbers_unless("solref", &p.geom_solref[g], &DEFAULT_SOLREF)
        .numbers_unless("solimp", &p.geom_solimp[g], &DEFAULT_SOLIMP)
        .number_unless("margin", p.geom_margin[g], 0.0)
        .number_unless("gap", p.geom_gap[g], 0.0);
    tag = tag
        .numbers_unless("surfacevel", &surfacevel, &[0.0; 6])
        .number_unless("adhesion", p.geom_adhesion[g], 0.0)
        .numbers_unless(
            "fluidcoef",
            &p.geom_fluidcoef[g],
            &[0.5, 0.25, 1.5, 1.0, 1.0],
        )
        .numbers_unless("user", user, &[]);
    if *fluid_ellipsoid {
        tag = tag.text("fluidshape", "ellipsoid");
    }
    let rgba = match visible {
        true => colour(&model.visuals, model.visuals.geoms[g]).filter(|rgba| rgba[3] > 0.0),
        false => Some([0.5, 0.5, 0.5, 0.0]),
    };
    coloured(tag, rgba).end();
    Ok(())
}

/// Returns the colour of an element, its own or that of its material; `None` if it has neither. Textures are not
/// written.
fn colour(visuals: &Visuals, appearance: Appearance) -> Option<[f32; 4]> {
    (appearance != Appearance::default()).then(|| visuals.rgba(appearance))
}

fn coloured<'x>(tag: Tag<'x>, rgba: Option<[f32; 4]>) -> Tag<'x> {
    match rgba {
        Some(rgba) => tag.singles("rgba", rgba.into_iter().map(f64::from)),
        None => tag,
    }
}

fn write_site(model: &Model, s: usize, xml: &mut Xml) {
    let Site {
        name,
        body: _,
        kind,
        group,
        mesh,
        user,
    } = &model.sites[s];
    let p = &model.params;
    let rgba = colour(&model.visuals, model.visuals.sites[s]);
    let tag = xml.tag("site").name(name).text("type", geom_type(*kind));
    let tag = write_pose(tag, p.site_pos[s], p.site_quat[s]);
    let tag = match mesh {
        Some(mesh) => tag.text("mesh", &model.meshes[*mesh].name),
        None => tag.numbers("size", &p.site_size[s].to_array()),
    };
    let tag = tag
        .integer_unless("group", (*group).into(), 0)
        .numbers_unless("user", user, &[]);
    coloured(tag, rgba).end();
}

fn write_camera(model: &Model, c: usize, xml: &mut Xml) -> Result<(), SaveError> {
    let Camera {
        name,
        body: _,
        mode,
        orthographic,
        resolution,
        intrinsic,
        user,
    } = &model.cameras[c];
    let p = &model.params;
    let (mode, target) = match *mode {
        CameraMode::Fixed => ("fixed", None),
        CameraMode::Track => ("track", None),
        CameraMode::TrackCom(b) => ("trackcom", b),
        CameraMode::TargetBody(b) => ("targetbody", Some(b)),
        CameraMode::TargetBodyCom(b) => ("targetbodycom", Some(b)),
    };
    let mut tag = xml.tag("camera").name(name).text("mode", mode);
    if let Some(target) = target {
        tag = tag.text("target", body_name(model, target)?);
    }
    if *orthographic {
        tag = tag.text("projection", "orthographic");
    }
    tag = write_pose(tag, p.cam_pos[c], p.cam_quat[c])
        .integers("resolution", resolution.iter().map(|&n| n as i64))
        .numbers_unless("user", user, &[]);
    let [focal_x, focal_y, principal_x, principal_y] = p.cam_intrinsic[c];
    match intrinsic {
        true => tag
            .numbers("sensorsize", &p.cam_sensorsize[c])
            .numbers("focal", &[focal_x, focal_y])
            .numbers("principal", &[principal_x, principal_y]),
        false => tag.number_unless("fovy", p.cam_fovy[c], 45.0),
    }
    .end();
    Ok(())
}
