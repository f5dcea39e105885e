//! The transmission of an actuator, from the attributes of its target.

use crate::document::Element;
use crate::error::LoadError;
use clench_builder::TransmissionSpec;

/// The attributes that name a target; an actuator has one.
const TARGETS: &[&str] = &[
    "joint",
    "jointinparent",
    "tendon",
    "site",
    "cranksite",
    "body",
];

/// Reads the target of an actuator.
pub(super) fn read(element: &Element) -> Result<TransmissionSpec, LoadError> {
    element.at_most_one(TARGETS)?;
    let name = |attribute| element.text(attribute).map(str::to_owned);
    let (reference, slider) = (name("refsite"), name("slidersite"));
    if reference.is_some() && element.text("site").is_none() {
        return Err(element.error("refsite needs site"));
    }
    if element.text("cranksite").is_none() {
        let has = |attribute: &&str| element.text(attribute).is_some();
        if let Some(attribute) = ["slidersite", "cranklength"].iter().find(|a| has(a)) {
            return Err(element.error(format!("{attribute} needs cranksite")));
        }
    }
    if let Some(crank) = name("cranksite") {
        return Ok(TransmissionSpec::SliderCrank {
            crank,
            slider: slider.ok_or_else(|| element.missing("slidersite"))?,
        });
    }
    let site = |site| match reference {
        Some(reference) => TransmissionSpec::SiteInFrame { site, reference },
        None => TransmissionSpec::Site(site),
    };
    name("joint")
        .map(TransmissionSpec::Joint)
        .or_else(|| name("jointinparent").map(TransmissionSpec::JointInParent))
        .or_else(|| name("tendon").map(TransmissionSpec::Tendon))
        .or_else(|| name("body").map(TransmissionSpec::Body))
        .or_else(|| name("site").map(site))
        .ok_or_else(|| match element.tag.as_str() {
            "adhesion" => element.missing("body"),
            _ => element
                .incomplete("one of joint, jointinparent, tendon, site or cranksite is required"),
        })
}
