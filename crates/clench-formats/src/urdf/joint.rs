//! `<joint>`: the pose of a link on its parent, and its degrees of freedom.

use super::element::{consume, inside};
use super::geometry::read_origin;
use super::tree::Tree;
use crate::document::Element;
use crate::error::LoadError;
use crate::spending::Spending;
use clench_builder::{EqualityKind, EqualitySpec, JointSpec, ModelBuilder};
use clench_dynamics::model::JointKind;
use clench_math::{Quat, Vec3};
use std::collections::{HashMap, hash_map::Entry};

/// The kinds of URDF joints. `spherical` is not in URDF, but in MuJoCo's and Bullet's readers.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Revolute,
    Continuous,
    Prismatic,
    Fixed,
    Floating,
    Planar,
    Spherical,
}

const KINDS: [(&str, Kind); 7] = [
    ("revolute", Kind::Revolute),
    ("continuous", Kind::Continuous),
    ("prismatic", Kind::Prismatic),
    ("fixed", Kind::Fixed),
    ("floating", Kind::Floating),
    ("planar", Kind::Planar),
    ("spherical", Kind::Spherical),
];

impl Kind {
    /// Returns the kind of an element.
    fn of(element: &Element) -> Result<Kind, LoadError> {
        let kind = element.keyword("type", &KINDS)?;
        kind.ok_or_else(|| element.missing("type"))
    }
}

/// The kinds of the model's joints by their names. A planar joint `j` has the joints `j_TX`, `j_TY` and `j_RZ`.
#[derive(Default)]
struct Named(HashMap<String, JointKind>);

impl Named {
    /// Adds a joint, or clears its name if another joint has it; returns that name.
    fn add(&mut self, joint: &mut JointSpec) -> Option<String> {
        match self.0.entry(joint.name.clone()) {
            Entry::Vacant(entry) => {
                entry.insert(joint.kind);
                None
            }
            Entry::Occupied(_) => Some(std::mem::take(&mut joint.name)),
        }
    }

    /// Returns true if the position of a joint is one number, which another joint may mimic.
    fn is_scalar(&self, name: &str) -> bool {
        match self.0.get(name) {
            Some(JointKind::Slide | JointKind::Hinge) => true,
            Some(JointKind::Free | JointKind::Ball) | None => false,
        }
    }
}

/// Reads all joints into the bodies that they move, then the mimic relations.
///
/// # Errors
/// Returns an error if a joint is invalid.
pub(super) fn read_all(
    tree: &Tree,
    builder: &mut ModelBuilder,
    spending: &mut Spending,
) -> Result<(), LoadError> {
    let mut named = Named::default();
    for joint in &tree.joints {
        let element = joint.element;
        let kind = Kind::of(element)?;
        let mut notes = Vec::new();
        let mut joints = read(element, kind, &mut notes).map_err(inside(element))?;
        let name = element.required_text("name")?;
        for taken in joints.iter_mut().filter_map(|joint| named.add(joint)) {
            notes.push(format!(
                "another joint has the name \"{taken}\"; this one gets no name"
            ));
        }
        let line = element.origin.line;
        let located = notes
            .into_iter()
            .map(|note| format!("line {line}: {}: {note}", element.label()));
        builder.notes.extend(located);
        consume(
            element,
            joints.len() * size_of::<JointSpec>(),
            &[name],
            spending,
        )?;
        let body = &mut builder.bodies[tree.child(joint)];
        let pose = read_origin(element).map_err(inside(element))?;
        (body.pos, body.quat) = (pose.pos, pose.quat);
        body.joints = joints;
    }
    for joint in &tree.joints {
        let mimic = read_mimic(joint.element, &named, &mut builder.notes);
        builder
            .equalities
            .extend(mimic.map_err(inside(joint.element))?);
    }
    Ok(())
}

/// Returns the model's joints for a URDF joint.
fn read(
    element: &Element,
    kind: Kind,
    notes: &mut Vec<String>,
) -> Result<Vec<JointSpec>, LoadError> {
    let mut axis = Vec3::new(1.0, 0.0, 0.0);
    if let Some(written) = element.child("axis")? {
        axis = Vec3::from_array(written.required_numbers("xyz")?);
    }
    let name = element.string("name");
    let of = |kind: JointKind, name: String, axis: Vec3<f64>| JointSpec {
        name,
        kind,
        axis,
        origin: Some(element.origin.clone()),
        ..JointSpec::default()
    };
    let mut joints = match kind {
        Kind::Fixed => return Ok(Vec::new()),
        Kind::Revolute | Kind::Continuous => vec![of(JointKind::Hinge, name, axis)],
        Kind::Prismatic => vec![of(JointKind::Slide, name, axis)],
        Kind::Floating => vec![of(JointKind::Free, name, axis)],
        Kind::Spherical => vec![of(JointKind::Ball, name, axis)],
        Kind::Planar => {
            let [x, y] = across(axis);
            vec![
                of(JointKind::Slide, format!("{name}_TX"), x),
                of(JointKind::Slide, format!("{name}_TY"), y),
                of(JointKind::Hinge, format!("{name}_RZ"), axis),
            ]
        }
    };
    if let Some(dynamics) = element.child("dynamics")? {
        for joint in &mut joints {
            dynamics.set_number("damping", &mut joint.damping[0])?;
            dynamics.set_number("friction", &mut joint.frictionloss)?;
        }
    }
    // The limits of a planar joint apply only to its first direction, as in MuJoCo.
    read_limit(element, kind, &mut joints[0], notes)?;
    Ok(joints)
}

/// Returns two axes perpendicular to an axis: x and y under the minimal rotation of z to it.
fn across(axis: Vec3<f64>) -> [Vec3<f64>; 2] {
    let (unit, _) = axis.normalize();
    let rotation = Quat::from_two_vectors(Vec3::new(0.0, 0.0, 1.0), unit);
    [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0)].map(|v| rotation.rotate(v))
}

/// Reads the limits of position, and of effort as limits of total actuator force; ignores velocity limits.
fn read_limit(
    element: &Element,
    kind: Kind,
    joint: &mut JointSpec,
    notes: &mut Vec<String>,
) -> Result<(), LoadError> {
    if kind == Kind::Continuous {
        joint.limited = Some(false);
    }
    let Some(limit) = element.child("limit")? else {
        return Ok(());
    };
    if kind != Kind::Continuous {
        let lower = limit.range_end("lower")?;
        let upper = limit.range_end("upper")?;
        joint.range = [lower.unwrap_or(0.0), upper.unwrap_or(0.0)];
        let [low, high] = joint.range;
        let ignored = match (lower, upper) {
            (None, None) => None,
            (Some(_), None) => Some("has a lower limit but no upper one".to_owned()),
            (None, Some(_)) => Some("has an upper limit but no lower one".to_owned()),
            _ if low >= high => Some(format!("its limits {low} and {high} are not increasing")),
            _ => None,
        };
        if let Some(why) = &ignored {
            notes.push(format!("{why}: it is not limited"));
        }
        if low >= high || ignored.is_some() {
            joint.limited = Some(false);
        }
    }
    if let Some(effort) = limit.range_end("effort")?
        && effort != 0.0
        && effort.is_finite()
    {
        joint.actuatorfrcrange = [-effort.abs(), effort.abs()];
    }
    Ok(())
}

/// Reads a mimic relation: an equality constraint to `multiplier · other + offset`, as in MuJoCo 4.0.
fn read_mimic(
    element: &Element,
    named: &Named,
    notes: &mut Vec<String>,
) -> Result<Option<EqualitySpec>, LoadError> {
    let Some(mimic) = element.child("mimic")? else {
        return Ok(None);
    };
    let (own, other) = (
        element.required_text("name")?,
        mimic.required_text("joint")?,
    );
    if !named.is_scalar(own) || !named.is_scalar(other) {
        if Kind::of(element)? != Kind::Fixed {
            notes.push(format!(
                "line {}: {} does not mimic \"{other}\": both must be revolute, continuous or prismatic",
                mimic.origin.line,
                element.label()
            ));
        }
        return Ok(None);
    }
    let mut multiplier = 1.0;
    let mut offset = 0.0;
    mimic.set_number("multiplier", &mut multiplier)?;
    mimic.set_number("offset", &mut offset)?;
    let kind = EqualityKind::Joint {
        joint1: own.to_owned(),
        joint2: Some(other.to_owned()),
        polycoef: [offset, multiplier, 0.0, 0.0, 0.0],
    };
    Ok(Some(EqualitySpec {
        origin: Some(mimic.origin.clone()),
        ..EqualitySpec::new("", kind)
    }))
}
