//! Bodies in MuJoCo's order, each with its elements.

use super::check::describe;
use super::element::Element;
use super::inertia::{MassProperties, mass_properties};
use super::model_builder::ModelBuilder;
use super::placed::Assets;
use super::{
    BodySpec, BuildError, CompilerSpec, GeomMass, GeomSpec, InertiaFromGeom, JointSpec, cameras,
    geoms, joints, lights,
};
use clench_dynamics::model::{Body, JointKind, Model};
use clench_math::{Quat, Vec3};
use std::sync::Arc;

/// Offsets (m, and components of a quaternion) below which frames count as equal (MuJoCo's `kFrameEps`).
const SAME_FRAME: f64 = 1e-6;
/// Maximum number of degrees of freedom between a body and its parent.
const MAX_DOFS: usize = 6;

/// Returns the author's bodies depth first: children in order of appearance, each followed by its own.
///
/// # Errors
/// Returns an error if a body's parent does not come before it.
pub(super) fn depth_first(bodies: &[BodySpec]) -> Result<Vec<usize>, BuildError> {
    let mut children = vec![Vec::new(); bodies.len()];
    for (index, body) in bodies.iter().enumerate().skip(1) {
        if body.parent >= index {
            return Err(body.error(format!(
                "its parent must come before it, but this is body {index} and its parent body {}",
                body.parent
            )));
        }
        children[body.parent].push(index);
    }
    let mut order = Vec::with_capacity(bodies.len());
    let mut pending = vec![0];
    while let Some(index) = pending.pop() {
        order.push(index);
        pending.extend(children[index].iter().rev());
    }
    Ok(order)
}

/// Adds all bodies, with their joints, geoms and sites.
///
/// # Errors
/// Returns an error if a body, its inertia or an element on it is invalid.
pub(super) fn add_all(
    builder: &ModelBuilder,
    order: &[usize],
    assets: &Assets,
    model: &mut Model,
) -> Result<(), BuildError> {
    let mut number = vec![0; order.len()];
    let mut has_children = vec![false; order.len()];
    for (new, &old) in order.iter().enumerate() {
        number[old] = new;
        has_children[builder.bodies[old].parent] |= old != 0;
    }
    for &old in order {
        let spec = &builder.bodies[old];
        let context = BodyContext {
            name: describe(&spec.name, old),
            parent: number[spec.parent],
            has_children: has_children[old],
        };
        add(builder, spec, &context, assets, model)?;
    }
    Ok(())
}

/// The context of a body.
struct BodyContext {
    /// Its name in messages.
    name: String,
    /// Index in the model's order.
    parent: usize,
    has_children: bool,
}

/// A body's own frame, and the transformation of its geoms and sites if that frame was moved.
struct Frame {
    pos: Vec3<f64>,
    quat: Quat<f64>,
    /// From the author's body frame to the model's, if they differ.
    moved: Option<(Vec3<f64>, Quat<f64>)>,
}

fn add(
    builder: &ModelBuilder,
    spec: &BodySpec,
    context: &BodyContext,
    assets: &Assets,
    model: &mut Model,
) -> Result<(), BuildError> {
    let b = model.bodies.len();
    let is_world = b == 0;
    let parent = context.parent;
    check_joints(spec, parent).map_err(|e| e.about(&context.name))?;
    let mut inertia = match is_world {
        true => MassProperties::NONE,
        false => mass_properties(spec, &context.name, builder.settings_of(spec), assets)?,
    };
    let frame = align(builder, spec, context.has_children, &mut inertia);
    let within = |e: BuildError| e.of_body(&context.name);

    push_body(model, spec, parent, is_null(inertia.pos, inertia.quat));
    push_params(model, spec, &frame, &inertia);

    for joint in &spec.joints {
        joints::add(builder, joint, b, (frame.pos, frame.quat), model).map_err(within)?;
    }
    model.bodies[b].joints.end = model.joints.len();
    model.bodies[b].dofs.end = model.nv;
    for geom in &spec.geoms {
        match assets.uses.is_discarded(geom) {
            true if !is_world && is_needed(&builder.compiler, geom) => {
                let message = "cannot be discarded as visual: the inertia of its body comes from geoms of its group";
                return Err(within(geom.error(message)));
            }
            true => assets.check_discarded(geom).map_err(within)?,
            false => geoms::add_geom(geom, b, frame.moved, assets, model).map_err(within)?,
        }
    }
    model.bodies[b].geoms.end = model.geoms.len();
    for site in &spec.sites {
        geoms::add_site(site, b, frame.moved, assets, model).map_err(within)?;
    }
    model.bodies[b].sites.end = model.sites.len();
    for camera in &spec.cameras {
        cameras::add(camera, b, frame.moved, builder.znear, model);
    }
    model.bodies[b].cameras.end = model.cameras.len();
    for light in &spec.lights {
        lights::add(light, b, frame.moved, model);
    }
    Ok(())
}

/// Returns true if the inertia of a geom's body would be lost without the geom. MuJoCo does not discard it then.
fn is_needed(compiler: &CompilerSpec, geom: &GeomSpec) -> bool {
    let [first, last] = compiler.inertiagrouprange;
    let (GeomMass::Mass(amount) | GeomMass::Density(amount)) = geom.mass;
    compiler.inertiafromgeom == InertiaFromGeom::Always
        && (first..=last).contains(&geom.group)
        && amount != 0.0
}

/// Adds the record of a body that has no joints, geoms and sites yet.
fn push_body(model: &mut Model, spec: &BodySpec, parent: usize, simple_inertia: bool) {
    let b = model.bodies.len();
    let is_world = b == 0;
    let parent_body = (!is_world).then(|| &model.bodies[parent]);
    let empty = |start: usize| start..start;
    let body = Body {
        name: match &spec.name[..] {
            "" if is_world => "world".to_owned(),
            name => name.to_owned(),
        },
        parent,
        root: match parent_body {
            Some(above) if parent != 0 => above.root,
            _ => b,
        },
        weld: match parent_body {
            Some(above) if !spec.mocap && spec.joints.is_empty() => above.weld,
            _ => b,
        },
        joints: empty(model.joints.len()),
        dofs: empty(model.nv),
        geoms: empty(model.geoms.len()),
        sites: empty(model.sites.len()),
        cameras: empty(model.cameras.len()),
        mocap: spec.mocap.then_some(model.nmocap),
        last_dof: parent_body.and_then(|above| above.last_dof),
        simple_inertia,
        diagonal_inertia: false,
        fluid_ellipsoids: false,
        never_simple: spec.never_simple,
        user: Arc::clone(&spec.user),
        origin: spec.origin.clone(),
    };
    model.bodies.push(body);
    model.nmocap += usize::from(spec.mocap);
}

/// Checks the joints of a body.
fn check_joints(spec: &BodySpec, parent: usize) -> Result<(), BuildError> {
    if spec.mocap && (parent != 0 || !spec.joints.is_empty()) {
        return Err(spec.error("a mocap body must be a child of the world and have no joints"));
    }
    let is = |kind: JointKind| move |j: &JointSpec| j.kind == kind;
    if spec.joints.iter().any(is(JointKind::Free)) {
        if spec.joints.len() > 1 {
            return Err(spec.error("a free joint must be the only joint of its body"));
        }
        if parent != 0 {
            return Err(spec.error("a free joint is only possible on a child of the world"));
        }
    }
    let dofs: usize = spec.joints.iter().map(|j| j.kind.nv()).sum();
    if dofs > MAX_DOFS {
        return Err(spec.error(format!(
            "its joints have {dofs} degrees of freedom, more than {MAX_DOFS}"
        )));
    }
    let mut after_ball = spec
        .joints
        .iter()
        .skip_while(|j| j.kind != JointKind::Ball)
        .skip(1);
    if after_ball.any(|j| matches!(j.kind, JointKind::Ball | JointKind::Hinge)) {
        return Err(spec.error("no hinge or ball joint can follow a ball joint"));
    }
    Ok(())
}

/// Applies MuJoCo's `alignfree`: a free body without children may take its inertial frame as its frame, which makes its
/// mass matrix diagonal.
fn align(
    builder: &ModelBuilder,
    spec: &BodySpec,
    has_children: bool,
    inertia: &mut MassProperties,
) -> Frame {
    let (pos, quat) = (spec.pos, spec.quat.normalize());
    let wanted = match &spec.joints[..] {
        [joint] if joint.kind == JointKind::Free => {
            joint.align.unwrap_or(builder.settings_of(spec).alignfree)
        }
        _ => false,
    };
    if !wanted || has_children {
        return Frame {
            pos,
            quat,
            moved: None,
        };
    }
    let back = inertia.quat.conjugate();
    let moved = Some((-back.rotate(inertia.pos), back));
    let frame = Frame {
        pos: pos + quat.rotate(inertia.pos),
        quat: (quat * inertia.quat).normalize(),
        moved,
    };
    (inertia.pos, inertia.quat) = (Vec3::ZERO, Quat::IDENTITY);
    frame
}

fn push_params(model: &mut Model, spec: &BodySpec, frame: &Frame, inertia: &MassProperties) {
    let p = &mut model.params;
    p.body_pos.push(frame.pos);
    p.body_quat.push(frame.quat);
    p.body_ipos.push(inertia.pos);
    p.body_iquat.push(inertia.quat);
    p.body_mass.push(inertia.mass);
    p.body_inertia.push(inertia.moments);
    p.body_gravcomp.push(spec.gravcomp);
}

/// Returns true if a frame is that of its body, up to [`SAME_FRAME`].
pub(super) fn is_null(pos: Vec3<f64>, quat: Quat<f64>) -> bool {
    let small = |v: f64| v.abs() < SAME_FRAME;
    let rotation = quat.imaginary();
    is_null_position(pos)
        && small(rotation.x)
        && small(rotation.y)
        && small(rotation.z)
        && small(quat.w.abs() - 1.0)
}

/// Returns true if a point is its body's origin, up to [`SAME_FRAME`].
pub(super) fn is_null_position(pos: Vec3<f64>) -> bool {
    pos.to_array().iter().all(|v| v.abs() < SAME_FRAME)
}
