//! `<joint>` and `<freejoint>`.

use super::compiler::CompilerOptions;
use super::orientation::Pose;
use crate::document::Element;
use crate::error::LoadError;
use clench_builder::{DOF_NUMBERS, JOINT_NUMBERS, JointSpec};
use clench_dynamics::model::JointKind;

/// Overwrites the values that the element has; angles remain in the file's unit until [`finish`].
pub(crate) fn read(element: &Element, joint: &mut JointSpec) -> Result<(), LoadError> {
    let kinds = [
        ("free", JointKind::Free),
        ("ball", JointKind::Ball),
        ("slide", JointKind::Slide),
        ("hinge", JointKind::Hinge),
    ];
    element.set_keyword("type", &kinds, &mut joint.kind)?;
    element.set_vector("pos", &mut joint.pos)?;
    element.set_vector("axis", &mut joint.axis)?;
    element.set_range("range", &mut joint.range)?;
    element.set_tristate("limited", &mut joint.limited)?;
    element.set_range("actuatorfrcrange", &mut joint.actuatorfrcrange)?;
    element.set_tristate("actuatorfrclimited", &mut joint.actuatorfrclimited)?;
    element.set_boolean("actuatorgravcomp", &mut joint.actuatorgravcomp)?;
    element.set_number("ref", &mut joint.reference)?;
    element.set_number("springref", &mut joint.springref)?;
    element.overlay("stiffness", &mut joint.stiffness)?;
    element.overlay("damping", &mut joint.damping)?;
    element.set_numbers("springdamper", &mut joint.springdamper)?;
    element.set_element_numbers(&JOINT_NUMBERS, &mut joint.joint_numbers_mut())?;
    element.set_element_numbers(&DOF_NUMBERS, &mut joint.dof_numbers_mut())?;
    element.set_user(&mut joint.user)?;
    element.overlay("solreflimit", &mut joint.solref_limit)?;
    element.overlay("solimplimit", &mut joint.solimp_limit)?;
    element.overlay("solreffriction", &mut joint.solref_friction)?;
    element.overlay("solimpfriction", &mut joint.solimp_friction)?;
    element.set_integer("group", &mut joint.group)
}

/// Reads a free joint, which inherits nothing from default classes.
pub(crate) fn read_free(element: &Element) -> Result<JointSpec, LoadError> {
    let mut joint = JointSpec {
        name: element.string("name"),
        kind: JointKind::Free,
        origin: Some(element.origin.clone()),
        ..JointSpec::default()
    };
    element.set_integer("group", &mut joint.group)?;
    element.set_tristate("align", &mut joint.align)?;
    Ok(joint)
}

/// Converts angles to radians and transforms the joint by the enclosing frame.
///
/// As in MuJoCo, degrees apply to the range of hinge and ball joints if it is a limit, their yield, and the reference
/// angles of hinge joints.
pub(crate) fn finish(mut joint: JointSpec, compiler: &CompilerOptions, frame: &Pose) -> JointSpec {
    let limits = joint.limited.unwrap_or(joint.range[0] < joint.range[1]);
    if limits && matches!(joint.kind, JointKind::Hinge | JointKind::Ball) {
        joint.range = joint.range.map(|angle| compiler.radians(angle));
    }
    if matches!(joint.kind, JointKind::Hinge | JointKind::Ball) {
        joint.springyield = compiler.radians(joint.springyield);
    }
    if joint.kind == JointKind::Hinge {
        joint.reference = compiler.radians(joint.reference);
        joint.springref = compiler.radians(joint.springref);
    }
    if joint.kind != JointKind::Free {
        joint.pos = frame.point(joint.pos);
        joint.axis = frame.quat.rotate(joint.axis);
    }
    joint
}
