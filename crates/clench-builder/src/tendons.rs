//! Tendons: their paths, and the quantities that follow from them in the initial configuration.

use super::element::{Element, resolve_range};
use super::model_builder::ModelBuilder;
use super::resolve::AllNames;
use super::visuals::Palette;
use super::{BuildError, TENDON_NUMBERS, TendonSpec, WrapSpec, element_number};
use clench_collide::ShapeKind;
use clench_dynamics::dynamics::chains::Chains;
use clench_dynamics::model::{JointKind, Model, Tendon, Wrap};
use clench_dynamics::stages::Positions;
use std::sync::Arc;

/// Adds all tendons.
///
/// # Errors
/// Returns an error if a path is empty, mixes joints and sites, repeats a joint, has a joint without a scalar position,
/// a branch that does not begin and end with a site, or a geom that is neither a sphere nor a cylinder, or if a range
/// is not ascending.
pub(super) fn add_all(
    builder: &ModelBuilder,
    names: &AllNames,
    palette: &Palette,
    model: &mut Model,
) -> Result<(), BuildError> {
    for spec in &builder.tendons {
        let path = path(spec, names, model)?;
        let autolimits = builder.compiler.autolimits;
        let limited = resolve_range(spec, "", spec.limited, spec.range, autolimits)?;
        let (said, range) = (spec.actuatorfrclimited, spec.actuatorfrcrange);
        let actfrclimited = resolve_range(spec, "actuatorfrc", said, range, autolimits)?;
        if actfrclimited && (range[0] > 0.0 || range[1] < 0.0) {
            return Err(spec.error("actuatorfrcrange must contain 0"));
        }
        if spec.springlength.is_some_and(|[low, high]| low > high) {
            return Err(spec.error("springlength must not be decreasing"));
        }
        let yields = spec.springyield > 0.0;
        let plastic = yields.then_some(model.nplastic);
        model.nplastic += if yields { 2 } else { 0 };
        let start = model.params.wrap_coef.len();
        let tendon = Tendon {
            name: spec.name.clone(),
            coefs: start..start + path.len(),
            path,
            plastic,
            limited,
            actfrclimited,
            frictionloss: spec.frictionloss > 0.0,
            reflecting: Vec::new(),
            user: Arc::clone(&spec.user),
        };
        if spec.armature > 0.0 && tendon.has_obstacles() {
            return Err(spec.error("a tendon that wraps around geoms cannot have an armature"));
        }
        let dofs = dofs(&tendon, model);
        model.tendon_dofs.push(dofs);
        model.tendons.push(tendon);
        push_params(spec, model);
        let visuals = &mut model.visuals;
        visuals.tendons.push(palette.resolve(&spec.appearance));
        visuals.tendon_width.push(spec.width);
    }
    Ok(())
}

fn path(spec: &TendonSpec, names: &AllNames, model: &Model) -> Result<Vec<Wrap>, BuildError> {
    let mut path = Vec::with_capacity(spec.path.len());
    for element in &spec.path {
        path.push(match element {
            WrapSpec::Joint { joint: name, .. } => {
                let joint = names.joints.find(name, spec)?;
                if path.contains(&Wrap::Joint(joint)) {
                    return Err(spec.error(format!("has the joint \"{name}\" twice")));
                }
                require_scalar(spec, name, joint, model)?;
                Wrap::Joint(joint)
            }
            WrapSpec::Site(name) => Wrap::Site(names.sites.find(name, spec)?),
            WrapSpec::Geom { geom: name, side } => {
                let geom = names.geoms.find(name, spec)?;
                let kind = model.geoms[geom].kind;
                if !matches!(kind, ShapeKind::Sphere | ShapeKind::Cylinder) {
                    return Err(spec.error(format!(
                        "wraps around the geom \"{name}\", which must be a sphere or a cylinder"
                    )));
                }
                let side = side.as_ref().map(|name| names.sites.find(name, spec));
                Wrap::Geom {
                    geom,
                    side: side.transpose()?,
                }
            }
            WrapSpec::Pulley(divisor) if *divisor <= 0.0 => {
                return Err(spec.error("the divisor of a pulley must be positive"));
            }
            WrapSpec::Pulley(_) => Wrap::Pulley,
        });
    }
    check_order(spec, &path)?;
    Ok(path)
}

/// Checks a path. A fixed tendon has joints only. Each branch of a spatial one begins and ends with a site, has at
/// least two, and one between any two geoms.
fn check_order(spec: &TendonSpec, path: &[Wrap]) -> Result<(), BuildError> {
    let joints = path.iter().filter(|w| matches!(w, Wrap::Joint(_))).count();
    if path.is_empty() {
        return Err(spec.error("has neither joints nor sites"));
    }
    if joints == path.len() {
        return Ok(());
    }
    if joints > 0 {
        return Err(spec.error("must consist of joints, or of sites and geoms, but not of both"));
    }
    // One pulley may begin the path.
    let before = usize::from(path.first() == Some(&Wrap::Pulley));
    for branch in path.split(|wrap| *wrap == Wrap::Pulley).skip(before) {
        let is_site = |wrap: &Wrap| matches!(wrap, Wrap::Site(_));
        match branch {
            [] => return Err(spec.error("has a pulley that starts no branch")),
            [_] => return Err(spec.error("has a branch of one element; a branch needs two sites")),
            _ => {}
        }
        let mut ends = [branch.first(), branch.last()].into_iter().flatten();
        let separated = branch.windows(2).all(|pair| pair.iter().any(is_site));
        if !ends.all(is_site) || !separated {
            return Err(spec.error("wraps around a geom that is not between two sites"));
        }
        if branch.windows(2).any(|pair| pair[0] == pair[1]) {
            return Err(spec.error("passes a site twice in a row"));
        }
    }
    Ok(())
}

/// Returns the dofs that change the length of a tendon. Those of a spatial tendon move two bodies relative to each
/// other between which it can have a straight span.
fn dofs(tendon: &Tendon, model: &Model) -> Vec<u32> {
    let mut dofs = Vec::new();
    for &wrap in &tendon.path {
        if let Wrap::Joint(joint) = wrap {
            dofs.push(model.joints[joint].dof as u32);
        }
    }
    let mut between = |bodies: [usize; 2]| {
        let chains = Chains::new(model, bodies).without_common();
        dofs.extend(chains.parts().into_iter().flat_map(|(part, _)| part));
    };
    for section in tendon.sections() {
        let [first, last] = section.sites.map(|site| model.sites[site].body);
        between([first, last]);
        if let Some((geom, _)) = section.obstacle {
            let obstacle = model.geoms[geom].body;
            between([first, obstacle]);
            between([obstacle, last]);
        }
    }
    dofs
}

/// Checks that the position of a joint is one number.
///
/// # Errors
/// Returns an error for a ball or free joint.
pub(super) fn require_scalar(
    user: &impl Element,
    name: &str,
    joint: usize,
    model: &Model,
) -> Result<(), BuildError> {
    match model.joints[joint].kind {
        JointKind::Slide | JointKind::Hinge => Ok(()),
        JointKind::Ball | JointKind::Free => {
            Err(user.error(format!("the joint \"{name}\" must be a slide or a hinge")))
        }
    }
}

fn push_params(spec: &TendonSpec, model: &mut Model) {
    let p = &mut model.params;
    let number = |wrap: &WrapSpec| match wrap {
        WrapSpec::Joint { coef, .. } => *coef,
        WrapSpec::Pulley(divisor) => *divisor,
        WrapSpec::Site(_) | WrapSpec::Geom { .. } => 0.0,
    };
    p.wrap_coef.extend(spec.path.iter().map(number));
    let [linear, higher @ ..] = spec.stiffness;
    p.tendon_stiffness.push(linear);
    p.tendon_stiffnesspoly.push(higher);
    let [linear, higher @ ..] = spec.damping;
    p.tendon_damping.push(linear);
    p.tendon_dampingpoly.push(higher);
    p.tendon_range.push(spec.range);
    p.tendon_actfrcrange.push(spec.actuatorfrcrange);
    p.tendon_solref_lim.push(spec.solref_limit);
    p.tendon_solimp_lim.push(spec.solimp_limit);
    p.tendon_solref_fri.push(spec.solref_friction);
    p.tendon_solimp_fri.push(spec.solimp_friction);
    element_number::push(&TENDON_NUMBERS, &spec.numbers(), p);
}

/// Sets the rest lengths of springs: as specified, or the lengths at the rest positions of the joints' springs, which
/// `rest` computes.
pub(super) fn spring_lengths(
    builder: &ModelBuilder,
    rest: impl FnOnce(&Model) -> Positions<f64>,
    model: &mut Model,
) {
    let said = |spec: &TendonSpec| spec.springlength;
    let springs = if builder.tendons.iter().all(|spec| said(spec).is_some()) {
        builder.tendons.iter().filter_map(said).collect()
    } else {
        let rest = rest(model).ten_length;
        let springs = builder.tendons.iter().zip(rest);
        springs
            .map(|(spec, rest)| said(spec).unwrap_or([rest; 2]))
            .collect()
    };
    model.params.tendon_lengthspring = springs;
}
