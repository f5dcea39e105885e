//! `<equality>`: connect, weld, joint and tendon.

use super::document::Element;
use crate::LoadError;
use clench_math::{Quat, Vec3};
use clench_rigid::builder::{
    ConnectAnchor, DEFAULT_SOLIMP, DEFAULT_SOLREF, EqualityKind, EqualitySpec,
};

/// What all kinds of equality share, and what a default class has of them.
#[derive(Clone, Debug)]
pub(crate) struct EqualityDraft {
    active: bool,
    solref: [f64; 2],
    solimp: [f64; 5],
}

impl Default for EqualityDraft {
    fn default() -> Self {
        EqualityDraft {
            active: true,
            solref: DEFAULT_SOLREF,
            solimp: DEFAULT_SOLIMP,
        }
    }
}

impl EqualityDraft {
    /// Overwrites what the element gives.
    pub(super) fn read(&mut self, element: &Element) -> Result<(), LoadError> {
        element.set_boolean("active", &mut self.active)?;
        element.overlay("solref", &mut self.solref)?;
        element.overlay("solimp", &mut self.solimp)?;
        Ok(())
    }
}

/// The constraint that an element of the section `<equality>` describes.
pub(crate) fn read(element: &Element, mut draft: EqualityDraft) -> Result<EqualitySpec, LoadError> {
    draft.read(element)?;
    let kind = match element.tag.as_str() {
        "connect" => EqualityKind::Connect(read_connect(element)?),
        "weld" => read_weld(element)?,
        "joint" => EqualityKind::Joint {
            joint1: element.required_text("joint1")?.to_owned(),
            joint2: element.text("joint2").map(str::to_owned),
            polycoef: read_polycoef(element)?,
        },
        _ => EqualityKind::Tendon {
            tendon1: element.required_text("tendon1")?.to_owned(),
            tendon2: element.text("tendon2").map(str::to_owned),
            polycoef: read_polycoef(element)?,
        },
    };
    Ok(EqualitySpec {
        name: element.string("name"),
        kind,
        active: draft.active,
        solref: draft.solref,
        solimp: draft.solimp,
        origin: Some(element.origin.clone()),
    })
}

fn read_polycoef(element: &Element) -> Result<[f64; 5], LoadError> {
    let mut polycoef = [0.0, 1.0, 0.0, 0.0, 0.0];
    element.overlay("polycoef", &mut polycoef)?;
    Ok(polycoef)
}

/// Two sites, if the element names any; nothing that belongs to bodies may then be given.
fn read_sites(element: &Element, of_bodies: &[&str]) -> Result<Option<ConnectAnchor>, LoadError> {
    match (element.text("site1"), element.text("site2")) {
        (None, None) => Ok(None),
        (Some(site1), Some(site2)) => {
            match of_bodies.iter().find(|name| element.text(name).is_some()) {
                Some(name) => Err(element.error(format!("site1 and {name} cannot both be given"))),
                None => Ok(Some(ConnectAnchor::Sites {
                    site1: site1.to_owned(),
                    site2: site2.to_owned(),
                })),
            }
        }
        _ => Err(element.error("site1 and site2 must be given together")),
    }
}

fn bodies(element: &Element, anchor: [f64; 3]) -> Result<ConnectAnchor, LoadError> {
    let either = || element.error("either body1 or site1 and site2 must be given");
    Ok(ConnectAnchor::Bodies {
        body1: element.text("body1").ok_or_else(either)?.to_owned(),
        body2: element.string("body2"),
        anchor: Vec3::from_array(anchor),
    })
}

fn read_connect(element: &Element) -> Result<ConnectAnchor, LoadError> {
    if let Some(sites) = read_sites(element, &["body1", "body2", "anchor"])? {
        return Ok(sites);
    }
    bodies(element, [0.0; 3])?;
    bodies(element, element.required_numbers("anchor")?)
}

fn read_weld(element: &Element) -> Result<EqualityKind, LoadError> {
    let sites = read_sites(element, &["body1", "body2", "anchor", "relpose"])?;
    let anchor = match sites {
        Some(sites) => sites,
        None => bodies(element, element.numbers("anchor")?.unwrap_or_default())?,
    };
    // A zero quaternion, also the default, asks for the relative pose of the initial configuration.
    let relpose = element
        .numbers("relpose")?
        .filter(|[_, _, _, w, x, y, z]: &[f64; 7]| [*w, *x, *y, *z] != [0.0; 4])
        .map(|[px, py, pz, w, x, y, z]| (Vec3::new(px, py, pz), Quat::new(w, x, y, z).normalize()));
    let mut torquescale = 1.0;
    element.set_number("torquescale", &mut torquescale)?;
    Ok(EqualityKind::Weld {
        anchor,
        relpose,
        torquescale,
    })
}
