//! Checks of single elements, before anything is computed: NaN and infinity are refused, and so are numbers that must
//! be positive.

use super::element::{Element, check_pose};
use super::element_number::{ElementNumber, NumberRange};
use super::model_builder::ModelBuilder;
use super::{
    ActuatorSpec, BodySpec, BuildError, CameraLens, CameraSpec, DOF_NUMBERS, EqualitySpec,
    GeomMass, GeomSpec, InertiaSpec, JOINT_NUMBERS, JointSpec, KeyframeSpec, PairSpec, SiteSpec,
    TENDON_NUMBERS, TendonSpec, WrapSpec, equalities, lights,
};
use clench_collide::ShapeKind;
use clench_dynamics::model::Integrator;
use clench_math::{Quat, Vec3};

/// Checks every element.
///
/// # Errors
/// Returns an error for the first invalid number found.
pub(super) fn check(builder: &ModelBuilder) -> Result<(), BuildError> {
    check_physics(builder)?;
    check_world(&builder.bodies[0])?;
    for (index, body) in builder.bodies.iter().enumerate() {
        let body_name = describe(&body.name, index);
        check_body(body, &body_name)?;
        let within = |e: BuildError| e.of_body(&body_name);
        body.joints
            .iter()
            .try_for_each(check_joint)
            .map_err(within)?;
        body.geoms.iter().try_for_each(check_geom).map_err(within)?;
        body.sites.iter().try_for_each(check_site).map_err(within)?;
        (body.cameras.iter())
            .try_for_each(check_camera)
            .map_err(within)?;
        (body.lights.iter())
            .try_for_each(lights::check)
            .map_err(within)?;
    }
    builder.tendons.iter().try_for_each(check_tendon)?;
    builder.actuators.iter().try_for_each(check_actuator)?;
    builder.equalities.iter().try_for_each(check_equality)?;
    builder.pairs.iter().try_for_each(check_pair)?;
    builder.keyframes.iter().try_for_each(check_keyframe)
}

/// Returns the name of a body in messages.
pub(super) fn describe(name: &str, index: usize) -> String {
    match name {
        "" => format!("body {index}"),
        name => format!("body \"{name}\""),
    }
}

fn check_physics(builder: &ModelBuilder) -> Result<(), BuildError> {
    let (physics, compiler) = (&builder.physics, &builder.compiler);
    let require = |holds: bool, field: &str, condition: &str| match holds {
        true => Ok(()),
        false => Err(BuildError::new(
            "model",
            format!("{field} must be {condition}"),
        )),
    };
    let finite = |values: &[f64]| values.iter().all(|v| v.is_finite());
    let not_negative = |v: f64| v.is_finite() && v >= 0.0;
    require(
        physics.timestep.is_finite() && physics.timestep > 0.0,
        "timestep",
        "a positive number",
    )?;
    require(finite(&physics.gravity), "gravity", "finite")?;
    require(finite(&physics.wind), "wind", "finite")?;
    require(finite(&physics.magnetic), "magnetic", "finite")?;
    require(not_negative(physics.density), "density", "zero or more")?;
    require(not_negative(physics.viscosity), "viscosity", "zero or more")?;
    require(
        physics.sleep_tolerance.is_finite(),
        "sleep_tolerance",
        "finite",
    )?;
    require(
        !(physics.flags.sleep && physics.integrator == Integrator::Rk4),
        "the integrator",
        "other than RK4 if the flag sleep is on: trees that fall asleep between its stages would wake up again",
    )?;
    require(
        not_negative(compiler.boundmass),
        "boundmass",
        "zero or more",
    )?;
    require(
        not_negative(compiler.boundinertia),
        "boundinertia",
        "zero or more",
    )?;
    if let Some(total) = compiler.settotalmass {
        require(total.is_finite() && total > 0.0, "settotalmass", "positive")?;
    }
    (builder.options.check()).map_err(|wrong| BuildError::new("model", wrong.to_string()))?;
    if let Some(o) = &physics.contact_override {
        let numbers = [&[o.margin][..], &o.solref, &o.solimp, &o.friction].concat();
        require(finite(&numbers), "every contact override", "finite")?;
    }
    Ok(())
}

/// Returns an error if the first body cannot be the world.
fn check_world(world: &BodySpec) -> Result<(), BuildError> {
    let wrong = match world {
        w if w.parent != 0 => "the world cannot have a parent",
        w if !w.joints.is_empty() => "the world cannot have joints",
        w if w.mocap => "the world cannot be a mocap body",
        w if w.inertial.is_some() => "the world cannot have an inertia",
        w if w.pos != Vec3::ZERO || w.quat != Quat::IDENTITY => "the world cannot have a pose",
        _ => return Ok(()),
    };
    Err(world.error(wrong))
}

fn check_body(body: &BodySpec, body_name: &str) -> Result<(), BuildError> {
    let as_body = |e: BuildError| e.about(body_name);
    check_pose(body, body.pos, body.quat).map_err(as_body)?;
    body.require_finite("gravcomp", &[body.gravcomp])
        .map_err(as_body)?;
    let Some(inertial) = &body.inertial else {
        return Ok(());
    };
    let as_inertial = |mut e: BuildError| {
        e.origin = inertial.origin.clone().or(e.origin);
        e.about("inertial").of_body(body_name)
    };
    check_pose(body, inertial.pos, inertial.quat).map_err(as_inertial)?;
    let inertia = match &inertial.inertia {
        InertiaSpec::Diagonal(moments) => &moments[..],
        InertiaSpec::Full(full) => &full[..],
    };
    body.require_finite("inertia", inertia)
        .map_err(as_inertial)?;
    body.require_not_negative("mass", &[inertial.mass])
        .map_err(as_inertial)
}

fn check_numbers(
    element: &impl Element,
    rows: &[ElementNumber],
    numbers: &[f64],
) -> Result<(), BuildError> {
    rows.iter().zip(numbers).try_for_each(|(row, &number)| {
        let check = match row.range {
            NumberRange::Finite => Element::require_finite,
            NumberRange::NotNegative => Element::require_not_negative,
        };
        check(element, row.name, &[number])
    })
}

fn check_joint(j: &JointSpec) -> Result<(), BuildError> {
    j.require_finite("pos", &j.pos.to_array())?;
    j.require_finite("axis", &j.axis.to_array())?;
    j.require_finite("ref", &[j.reference])?;
    j.require_finite("springref", &[j.springref])?;
    j.require_finite("stiffness", &j.stiffness)?;
    j.require_finite("damping", &j.damping)?;
    j.require_finite("springdamper", &j.springdamper)?;
    check_numbers(j, &JOINT_NUMBERS, &j.joint_numbers())?;
    check_numbers(j, &DOF_NUMBERS, &j.dof_numbers())?;
    check_softness(
        j,
        &[j.solref_limit, j.solref_friction],
        &[j.solimp_limit, j.solimp_friction],
    )
}

fn check_geom(g: &GeomSpec) -> Result<(), BuildError> {
    check_pose(g, g.pos, g.quat)?;
    g.require_finite("size", &g.size.to_array())?;
    let (GeomMass::Mass(m) | GeomMass::Density(m)) = g.mass;
    g.require_finite("mass or density", &[m])?;
    g.require_not_negative("friction", &g.friction)?;
    g.require_finite("margin", &[g.margin])?;
    g.require_finite("gap", &[g.gap])?;
    g.require_finite("surfacevel", &g.surfacevel)?;
    g.require_finite("adhesion", &[g.adhesion])?;
    g.require_finite("fluidcoef", &g.fluidcoef)?;
    g.require_finite("solmix", &[g.solmix])?;
    check_softness(g, &[g.solref], &[g.solimp])?;
    g.require_finite("fitscale", &[g.fitscale])?;
    require_condim(g, g.condim)
}

/// Checks that contacts have 1, 3, 4 or 6 dimensions.
///
/// # Errors
/// Returns an error for any other number.
pub(super) fn require_condim(element: &impl Element, condim: u32) -> Result<(), BuildError> {
    match condim {
        1 | 3 | 4 | 6 => Ok(()),
        other => Err(element.error(format!("condim must be 1, 3, 4 or 6, not {other}"))),
    }
}

fn check_site(s: &SiteSpec) -> Result<(), BuildError> {
    check_pose(s, s.pos, s.quat)?;
    let used = match s.kind {
        ShapeKind::Sphere => 1,
        ShapeKind::Capsule | ShapeKind::Cylinder => 2,
        ShapeKind::Ellipsoid | ShapeKind::Box => 3,
        ShapeKind::Mesh => 0,
        ShapeKind::Plane | ShapeKind::HeightField => {
            return Err(s.error("must be a sphere, capsule, ellipsoid, cylinder, box or mesh"));
        }
    };
    s.require_finite("size", &s.size)?;
    match s.size[..used].iter().find(|&&size| size <= 0.0) {
        Some(bad) => Err(s.error(format!("size must be positive, but has {bad}"))),
        None => Ok(()),
    }
}

fn check_camera(c: &CameraSpec) -> Result<(), BuildError> {
    check_pose(c, c.pos, c.quat)?;
    match c.lens {
        CameraLens::FieldOfView(fovy) => {
            c.require_finite("fovy", &[fovy])?;
            match fovy < 180.0 {
                true => Ok(()),
                false => Err(c.error(format!("fovy must be less than 180, but is {fovy}"))),
            }
        }
        CameraLens::Intrinsic {
            sensorsize,
            focal,
            principal,
        } => {
            c.require_finite("sensorsize", &sensorsize)?;
            c.require_finite("focal length", &focal)?;
            c.require_finite("principal point", &principal)
        }
    }
}

fn check_tendon(t: &TendonSpec) -> Result<(), BuildError> {
    for element in &t.path {
        match element {
            WrapSpec::Joint { coef, .. } => t.require_finite("coef", &[*coef])?,
            WrapSpec::Pulley(divisor) => t.require_finite("divisor", &[*divisor])?,
            WrapSpec::Site(_) | WrapSpec::Geom { .. } => {}
        }
    }
    t.require_finite("stiffness", &t.stiffness)?;
    t.require_finite("damping", &t.damping)?;
    t.require_finite("springlength", &t.springlength.unwrap_or_default())?;
    check_numbers(t, &TENDON_NUMBERS, &t.numbers())?;
    check_softness(
        t,
        &[t.solref_limit, t.solref_friction],
        &[t.solimp_limit, t.solimp_friction],
    )
}

fn check_actuator(a: &ActuatorSpec) -> Result<(), BuildError> {
    a.require_finite("dynprm", &a.dynprm)?;
    a.require_finite("gainprm", &a.gainprm)?;
    a.require_finite("biasprm", &a.biasprm)?;
    a.require_finite("gear", &a.gear)?;
    a.require_finite("lengthrange", &a.lengthrange)?;
    a.require_finite("damping", &a.damping)?;
    a.require_not_negative("armature", &[a.armature])?;
    a.require_finite("cranklength", &[a.cranklength])?;
    a.require_not_negative("inheritrange", &[a.inheritrange])?;
    a.require_not_negative("dampratio", &[a.dampratio.unwrap_or(0.0)])
}

fn check_equality(e: &EqualitySpec) -> Result<(), BuildError> {
    equalities::check(e)?;
    check_softness(e, &[e.solref], &[e.solimp])
}

fn check_pair(p: &PairSpec) -> Result<(), BuildError> {
    p.require_not_negative("friction", &p.friction.unwrap_or_default())?;
    p.require_finite("margin", &[p.margin.unwrap_or(0.0)])?;
    p.require_finite("gap", &[p.gap.unwrap_or(0.0)])?;
    p.require_finite("adhesion", &[p.adhesion.unwrap_or(0.0)])?;
    let solrefs = [p.solref, p.solreffriction].map(Option::unwrap_or_default);
    check_softness(p, &solrefs, &[p.solimp.unwrap_or_default()])
}

fn check_keyframe(k: &KeyframeSpec) -> Result<(), BuildError> {
    k.require_finite("time", &[k.time])?;
    let vectors = [
        ("qpos", &k.qpos),
        ("qvel", &k.qvel),
        ("act", &k.act),
        ("ctrl", &k.ctrl),
        ("mocap_pos", &k.mocap_pos),
        ("mocap_quat", &k.mocap_quat),
    ];
    for (field, vector) in vectors {
        k.require_finite(field, vector.as_deref().unwrap_or_default())?;
    }
    for part in &k.parts {
        k.require_finite("a part", &part.first)?;
        k.require_finite("a part", &part.second)?;
    }
    Ok(())
}

fn check_softness(
    element: &impl Element,
    solrefs: &[[f64; 2]],
    solimps: &[[f64; 5]],
) -> Result<(), BuildError> {
    element.require_finite("solref", solrefs.as_flattened())?;
    element.require_finite("solimp", solimps.as_flattened())
}
