//! `<tendon>`: weighted sums of joint positions, and strings through sites and around geoms.

use super::appearance::read_appearance;
use crate::document::Element;
use crate::error::LoadError;
use clench_builder::{TENDON_NUMBERS, TendonSpec, WrapSpec};

/// Overwrites the attributes that the element gives and default classes can also set.
pub(crate) fn read_common(element: &Element, tendon: &mut TendonSpec) -> Result<(), LoadError> {
    element.set_range("range", &mut tendon.range)?;
    element.set_tristate("limited", &mut tendon.limited)?;
    element.set_range("actuatorfrcrange", &mut tendon.actuatorfrcrange)?;
    element.set_tristate("actuatorfrclimited", &mut tendon.actuatorfrclimited)?;
    element.overlay("stiffness", &mut tendon.stiffness)?;
    element.overlay("damping", &mut tendon.damping)?;
    element.set_element_numbers(&TENDON_NUMBERS, &mut tendon.numbers_mut())?;
    element.overlay("solreflimit", &mut tendon.solref_limit)?;
    element.overlay("solimplimit", &mut tendon.solimp_limit)?;
    element.overlay("solreffriction", &mut tendon.solref_friction)?;
    element.overlay("solimpfriction", &mut tendon.solimp_friction)?;
    read_appearance(element, &mut tendon.appearance)?;
    element.set_number("width", &mut tendon.width)?;
    element.set_user(&mut tendon.user)?;
    let mut rest = tendon.springlength.unwrap_or([-1.0; 2]);
    match element.overlay("springlength", &mut rest)? {
        0 => {}
        1 => tendon.springlength = Some([rest[0]; 2]),
        _ => tendon.springlength = Some(rest),
    }
    // MuJoCo writes -1 for "the length at which springs rest".
    tendon.springlength = tendon.springlength.filter(|rest| *rest != [-1.0; 2]);
    Ok(())
}

/// Reads the tendon of a `<fixed>` or `<spatial>`.
pub(crate) fn read(element: &Element, mut tendon: TendonSpec) -> Result<TendonSpec, LoadError> {
    read_common(element, &mut tendon)?;
    for child in &element.children {
        tendon.path.push(read_wrap(child)?);
    }
    if tendon.path.is_empty() {
        return Err(element.incomplete(match element.tag.as_str() {
            "fixed" => "a fixed tendon needs at least one joint",
            _ => "a spatial tendon needs at least two sites",
        }));
    }
    Ok(TendonSpec {
        name: element.string("name"),
        origin: Some(element.origin.clone()),
        ..tendon
    })
}

fn read_wrap(element: &Element) -> Result<WrapSpec, LoadError> {
    let named = |attribute| Ok::<_, LoadError>(element.required_text(attribute)?.to_owned());
    Ok(match element.tag.as_str() {
        "joint" => WrapSpec::Joint {
            joint: named("joint")?,
            coef: element.required_numbers::<1>("coef")?[0],
        },
        "geom" => WrapSpec::Geom {
            geom: named("geom")?,
            side: (element.text("sidesite").filter(|side| !side.is_empty())).map(str::to_owned),
        },
        "pulley" => {
            let [divisor] = element.required_numbers("divisor")?;
            if divisor <= 0.0 {
                return Err(element.error("divisor must be positive"));
            }
            WrapSpec::Pulley(divisor)
        }
        _ => WrapSpec::Site(named("site")?),
    })
}
