//! `<equality>`: connect, weld, joint and tendon; their rules, reader, scaling and writer.

use super::rules::rule::{NONE, Rule, section};
use super::scale::{Along, Frames};
use super::write::names::{SaveError, body_name, named};
use super::write::xml::{Tag, Xml};
use crate::document::Element;
use crate::error::LoadError;
use clench_builder::{ConnectAnchor, DEFAULT_SOLIMP, DEFAULT_SOLREF, EqualityKind, EqualitySpec};
use clench_dynamics::Model;
use clench_dynamics::model::{Equality, EqualityTarget};
use clench_math::{Quat, Vec3};

/// The attributes of the section and its elements.
pub(super) const RULES: &[Rule] = &[
    section("equality", "connect weld joint tendon", "flex flexstrain"),
    Rule {
        element: "connect",
        read: "name class active solref solimp body1 body2 anchor site1 site2",
        ..NONE
    },
    Rule {
        element: "weld",
        read: "name class active solref solimp body1 body2 anchor relpose site1 site2 torquescale",
        ..NONE
    },
    Rule {
        element: "equality/joint",
        read: "name class active solref solimp joint1 joint2 polycoef",
        ..NONE
    },
    Rule {
        element: "equality/tendon",
        read: "name class active solref solimp tendon1 tendon2 polycoef",
        ..NONE
    },
    Rule {
        element: "default/equality",
        read: "active solref solimp",
        ..NONE
    },
];

/// The attributes that all equalities share and default classes can set.
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
    /// Overwrites the values that the element has.
    pub(super) fn read(&mut self, element: &Element) -> Result<(), LoadError> {
        element.set_boolean("active", &mut self.active)?;
        element.overlay("solref", &mut self.solref)?;
        element.overlay("solimp", &mut self.solimp)?;
        Ok(())
    }
}

/// Returns the constraint of an element in `<equality>`.
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

/// Reads two sites, if the element names any; attributes of bodies are then rejected.
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
        _ => Err(element.incomplete("site1 and site2 must be given together")),
    }
}

fn read_bodies(element: &Element, anchor: [f64; 3]) -> Result<ConnectAnchor, LoadError> {
    let either = || element.incomplete("either body1 or site1 and site2 must be given");
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
    read_bodies(element, [0.0; 3])?;
    read_bodies(element, element.required_numbers("anchor")?)
}

fn read_weld(element: &Element) -> Result<EqualityKind, LoadError> {
    let sites = read_sites(element, &["body1", "body2", "anchor", "relpose"])?;
    let anchor = match sites {
        Some(sites) => sites,
        None => read_bodies(element, element.numbers("anchor")?.unwrap_or_default())?,
    };
    // A zero quaternion, the default, selects the relative pose of the initial configuration.
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

impl Frames {
    /// Scales the target and the softness of an equality.
    pub(super) fn scale_equality(&self, equality: &mut EqualitySpec) {
        let width = match &mut equality.kind {
            EqualityKind::Connect(ConnectAnchor::Bodies { body1, anchor, .. }) => {
                *anchor = self.in_body(body1).apply(*anchor);
                self.of_body(body1).length
            }
            EqualityKind::Connect(ConnectAnchor::Sites { site1, site2 }) => {
                self.of_site(site1).mean(self.of_site(site2)).length
            }
            EqualityKind::Weld {
                anchor,
                relpose,
                torquescale,
            } => {
                let [first, second] = match anchor {
                    ConnectAnchor::Bodies {
                        body1,
                        body2,
                        anchor,
                    } => {
                        *anchor = self.in_body(body2).apply(*anchor);
                        if let Some((pos, _)) = relpose {
                            *pos = self.in_body(body1).apply(*pos);
                        }
                        [body1, body2].map(|name| self.of_body(name))
                    }
                    ConnectAnchor::Sites { site1, site2 } => {
                        [site1, site2].map(|name| self.of_site(name))
                    }
                };
                let between = first.mean(second).length;
                *torquescale *= between;
                between
            }
            EqualityKind::Joint {
                joint1,
                joint2,
                polycoef,
            } => {
                let leader = joint2.as_ref().map(|joint| self.of_joint(joint));
                scale_coupling(self.of_joint(joint1), leader, polycoef)
            }
            EqualityKind::Tendon {
                tendon1,
                tendon2,
                polycoef,
            } => {
                let leader = tendon2.as_ref().map(|tendon| self.of_tendon(tendon));
                scale_coupling(self.of_tendon(tendon1), leader, polycoef)
            }
        };
        equality.solimp[2] *= width;
    }
}

/// Scales y = Σ coef_k xᵏ, and returns the scale of y.
fn scale_coupling(follower: Along, leader: Option<Along>, polycoef: &mut [f64; 5]) -> f64 {
    let leader = leader.map_or(1.0, |along| along.coordinate);
    let mut factor = follower.coordinate;
    for coefficient in polycoef {
        *coefficient *= factor;
        factor /= leader;
    }
    follower.coordinate
}

/// Writes all constraints of a model.
///
/// # Errors
/// Returns an error if a constraint refers to an element without a name.
pub(super) fn write(model: &Model, xml: &mut Xml) -> Result<(), SaveError> {
    for (k, equality) in model.equalities.iter().enumerate() {
        write_equality(model, k, equality, xml)?;
    }
    Ok(())
}

fn write_equality(
    model: &Model,
    k: usize,
    equality: &Equality,
    xml: &mut Xml,
) -> Result<(), SaveError> {
    let Equality {
        name,
        target,
        sites,
        pose_at_qpos0,
        active0,
    } = equality;
    let p = &model.params;
    let mut tag = xml.tag(target.kind()).name(name);
    tag = match (*target, sites) {
        (EqualityTarget::Connect { .. } | EqualityTarget::Weld { .. }, Some([site1, site2])) => {
            let site = |s: usize| named("site", &model.sites[s].name, s);
            tag.text("site1", site(*site1)?)
                .text("site2", site(*site2)?)
        }
        (EqualityTarget::Connect { body1, body2 }, None) => {
            write_bodies(model, [body1, body2], tag)?.numbers("anchor", &p.eq_anchor1[k].to_array())
        }
        (EqualityTarget::Weld { body1, body2 }, None) => {
            let tag = write_bodies(model, [body1, body2], tag)?;
            let tag = tag.numbers("anchor", &p.eq_anchor2[k].to_array());
            match pose_at_qpos0 {
                true => tag,
                false => write_relpose(p.eq_anchor1[k], p.eq_quat1[k], tag),
            }
        }
        (EqualityTarget::Joint { joint1, joint2 }, _) => {
            let joint = |j: usize| named("joint", &model.joints[j].name, j);
            let tag = tag.text("joint1", joint(joint1)?);
            let tag = match joint2 {
                Some(joint2) => tag.text("joint2", joint(joint2)?),
                None => tag,
            };
            tag.numbers("polycoef", &p.eq_polycoef[k])
        }
        (EqualityTarget::Tendon { tendon1, tendon2 }, _) => {
            let tendon = |t: usize| named("tendon", &model.tendons[t].name, t);
            let tag = tag.text("tendon1", tendon(tendon1)?);
            let tag = match tendon2 {
                Some(tendon2) => tag.text("tendon2", tendon(tendon2)?),
                None => tag,
            };
            tag.numbers("polycoef", &p.eq_polycoef[k])
        }
    };
    if let EqualityTarget::Weld { .. } = target {
        tag = tag.number_unless("torquescale", p.eq_torquescale[k], 1.0);
    }
    if !*active0 {
        tag = tag.boolean("active", false);
    }
    tag.numbers_unless("solref", &p.eq_solref[k], &DEFAULT_SOLREF)
        .numbers_unless("solimp", &p.eq_solimp[k], &DEFAULT_SOLIMP)
        .end();
    Ok(())
}

fn write_bodies<'a>(model: &Model, pair: [usize; 2], tag: Tag<'a>) -> Result<Tag<'a>, SaveError> {
    let [body1, body2] = pair;
    Ok(tag
        .text("body1", body_name(model, body1)?)
        .text("body2", body_name(model, body2)?))
}

/// Writes the pose in the first body of the anchor, which is a point of the second.
fn write_relpose<'a>(position: Vec3<f64>, rotation: Quat<f64>, tag: Tag<'a>) -> Tag<'a> {
    let [x, y, z] = position.to_array();
    let [w, a, b, c] = rotation.to_array();
    tag.numbers("relpose", &[x, y, z, w, a, b, c])
}
