//! `<tendon>`: fixed tendons.

use super::document::Element;
use crate::LoadError;
use clench_rigid::builder::TendonSpec;

/// Overwrites what the element gives of the attributes that default classes also have.
pub(crate) fn read_common(element: &Element, tendon: &mut TendonSpec) -> Result<(), LoadError> {
    element.set_range("range", &mut tendon.range)?;
    element.set_tristate("limited", &mut tendon.limited)?;
    element.set_range("actuatorfrcrange", &mut tendon.actuatorfrcrange)?;
    element.set_tristate("actuatorfrclimited", &mut tendon.actuatorfrclimited)?;
    element.set_number("margin", &mut tendon.margin)?;
    element.set_linear("stiffness", &mut tendon.stiffness)?;
    element.set_linear("damping", &mut tendon.damping)?;
    element.set_number("frictionloss", &mut tendon.frictionloss)?;
    element.overlay("solreflimit", &mut tendon.solref_limit)?;
    element.overlay("solimplimit", &mut tendon.solimp_limit)?;
    element.overlay("solreffriction", &mut tendon.solref_friction)?;
    element.overlay("solimpfriction", &mut tendon.solimp_friction)?;
    let mut rest = tendon.springlength.unwrap_or([-1.0; 2]);
    match element.overlay("springlength", &mut rest)? {
        0 => {}
        1 => tendon.springlength = Some([rest[0]; 2]),
        _ => tendon.springlength = Some(rest),
    }
    // MuJoCo writes "the length in the initial configuration" as -1.
    tendon.springlength = tendon.springlength.filter(|rest| *rest != [-1.0; 2]);
    Ok(())
}

/// The tendon that a `<fixed>` describes.
pub(crate) fn read_fixed(
    element: &Element,
    mut tendon: TendonSpec,
) -> Result<TendonSpec, LoadError> {
    read_common(element, &mut tendon)?;
    for term in &element.children {
        let [coefficient] = term.required_numbers("coef")?;
        tendon
            .terms
            .push((term.required_text("joint")?.to_owned(), coefficient));
    }
    if tendon.terms.is_empty() {
        return Err(element.error("a fixed tendon needs at least one joint"));
    }
    Ok(TendonSpec {
        name: element.string("name"),
        origin: Some(element.origin.clone()),
        ..tendon
    })
}
