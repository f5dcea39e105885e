//! Equality constraints: what they hold together, and where in the initial configuration.

use super::element::Element;
use super::resolve::AllNames;
use super::tendons::require_scalar;
use super::{BuildError, ConnectAnchor, EqualityKind, EqualitySpec, ModelBuilder};
use crate::model::{Equality, EqualityTarget, Model};
use crate::workspace::Positions;
use clench_math::{Quat, Vec3};

/// Adds all equality constraints; `pose0` are the poses at qpos0.
///
/// # Errors
/// Unknown names, something held equal to itself, joints without a scalar position.
pub(super) fn add_all(
    builder: &ModelBuilder,
    names: &AllNames,
    pose0: &Positions<f64>,
    model: &mut Model,
) -> Result<(), BuildError> {
    for spec in &builder.equalities {
        let (target, data) = resolve(spec, names, pose0, model)?;
        model.equalities.push(Equality {
            name: spec.name.clone(),
            target,
            active0: spec.active,
        });
        let p = &mut model.params;
        p.eq_anchor1.push(data.points[0]);
        p.eq_anchor2.push(data.points[1]);
        p.eq_quat1.push(data.quats[0]);
        p.eq_quat2.push(data.quats[1]);
        p.eq_torquescale.push(data.torquescale);
        p.eq_polycoef.push(data.polycoef);
        p.eq_solref.push(spec.solref);
        p.eq_solimp.push(spec.solimp);
    }
    Ok(())
}

/// The numbers of a constraint; a kind leaves those that it does not use at their defaults.
#[derive(Default)]
struct Data {
    /// In the frames of the first and the second body.
    points: [Vec3<f64>; 2],
    quats: [Quat<f64>; 2],
    torquescale: f64,
    polycoef: [f64; 5],
}

fn resolve(
    spec: &EqualitySpec,
    names: &AllNames,
    pose0: &Positions<f64>,
    model: &Model,
) -> Result<(EqualityTarget, Data), BuildError> {
    match &spec.kind {
        EqualityKind::Connect(anchor) => {
            let ([body1, body2], data) = match anchor {
                ConnectAnchor::Bodies {
                    body1,
                    body2,
                    anchor,
                } => {
                    let bodies = two_bodies(spec, names, body1, body2)?;
                    let points = [*anchor, carry(pose0, bodies, *anchor)];
                    let quats = Default::default();
                    (
                        bodies,
                        Data {
                            points,
                            quats,
                            ..Data::default()
                        },
                    )
                }
                ConnectAnchor::Sites { site1, site2 } => {
                    let (bodies, data) = two_sites(spec, names, model, site1, site2)?;
                    let quats = Default::default();
                    (bodies, Data { quats, ..data })
                }
            };
            require_finite_points(spec, &data)?;
            Ok((EqualityTarget::Connect { body1, body2 }, data))
        }
        EqualityKind::Weld {
            anchor,
            relpose,
            torquescale,
        } => {
            let ([body1, body2], data) = match anchor {
                ConnectAnchor::Bodies {
                    body1,
                    body2,
                    anchor,
                } => {
                    let bodies = two_bodies(spec, names, body1, body2)?;
                    (bodies, weld_bodies(pose0, bodies, *anchor, *relpose))
                }
                ConnectAnchor::Sites { site1, site2 } => {
                    two_sites(spec, names, model, site1, site2)?
                }
            };
            let torquescale = *torquescale;
            require_finite_points(spec, &data)?;
            let data = Data {
                torquescale,
                ..data
            };
            Ok((EqualityTarget::Weld { body1, body2 }, data))
        }
        EqualityKind::Joint {
            joint1,
            joint2,
            polycoef,
        } => {
            let scalar = |name: &String| {
                let joint = names.joints.find(name, spec)?;
                require_scalar(spec, name, joint, model)?;
                Ok(joint)
            };
            let (joint1, joint2) = (scalar(joint1)?, joint2.as_ref().map(scalar).transpose()?);
            require_different(spec, Some(joint1) != joint2)?;
            Ok((
                EqualityTarget::Joint { joint1, joint2 },
                polynomial(polycoef),
            ))
        }
        EqualityKind::Tendon {
            tendon1,
            tendon2,
            polycoef,
        } => {
            let find = |name: &String| names.tendons.find(name, spec);
            let (tendon1, tendon2) = (find(tendon1)?, tendon2.as_ref().map(find).transpose()?);
            require_different(spec, Some(tendon1) != tendon2)?;
            Ok((
                EqualityTarget::Tendon { tendon1, tendon2 },
                polynomial(polycoef),
            ))
        }
    }
}

fn polynomial(polycoef: &[f64; 5]) -> Data {
    Data {
        polycoef: *polycoef,
        ..Data::default()
    }
}

fn require_different(spec: &EqualitySpec, different: bool) -> Result<(), BuildError> {
    match different {
        true => Ok(()),
        false => Err(spec.error("holds something equal to itself")),
    }
}

fn require_finite_points(spec: &EqualitySpec, data: &Data) -> Result<(), BuildError> {
    let numbers = data.points.map(Vec3::to_array);
    spec.require_finite("anchor", numbers.as_flattened())
}

fn two_bodies(
    spec: &EqualitySpec,
    names: &AllNames,
    body1: &str,
    body2: &str,
) -> Result<[usize; 2], BuildError> {
    let world_if_empty = |name| match name {
        "" => "world",
        name => name,
    };
    let bodies = [
        names.bodies.find(body1, spec)?,
        names.bodies.find(world_if_empty(body2), spec)?,
    ];
    require_different(spec, bodies[0] != bodies[1])?;
    Ok(bodies)
}

fn two_sites(
    spec: &EqualitySpec,
    names: &AllNames,
    model: &Model,
    site1: &str,
    site2: &str,
) -> Result<([usize; 2], Data), BuildError> {
    let sites = [
        names.sites.find(site1, spec)?,
        names.sites.find(site2, spec)?,
    ];
    require_different(spec, sites[0] != sites[1])?;
    let data = Data {
        points: sites.map(|s| model.params.site_pos[s]),
        quats: sites.map(|s| model.params.site_quat[s]),
        ..Data::default()
    };
    Ok((sites.map(|s| model.sites[s].body), data))
}

/// A point of the first body in the coordinates of the second, as they are placed initially.
fn carry(pose0: &Positions<f64>, [from, to]: [usize; 2], point: Vec3<f64>) -> Vec3<f64> {
    let world = pose0.xpos[from] + pose0.xmat[from] * point;
    pose0.xmat[to].transpose_mul(world - pose0.xpos[to])
}

/// A weld's anchor is a point of the second body; its relative pose says where the first body holds it, and how turned.
fn weld_bodies(
    pose0: &Positions<f64>,
    [body1, body2]: [usize; 2],
    anchor: Vec3<f64>,
    relpose: Option<(Vec3<f64>, Quat<f64>)>,
) -> Data {
    let (point, quat) = match relpose {
        Some((pos, quat)) => (pos, quat.normalize()),
        None => (
            carry(pose0, [body2, body1], anchor),
            pose0.xquat[body1].conjugate() * pose0.xquat[body2],
        ),
    };
    Data {
        points: [point, anchor],
        quats: [quat, Quat::IDENTITY],
        ..Data::default()
    }
}
