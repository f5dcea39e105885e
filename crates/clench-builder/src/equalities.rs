//! Equality constraints: their elements, and their anchors in the initial configuration.

use super::element::{Element, check_pose};
use super::model_builder::ModelBuilder;
use super::resolve::AllNames;
use super::tendons::require_scalar;
use super::{BuildError, ConnectAnchor, EqualityKind, EqualitySpec};
use clench_dynamics::constants::{carry, relative_pose};
use clench_dynamics::model::{Equality, EqualityTarget, Model};
use clench_dynamics::stages::Positions;
use clench_math::{Quat, Vec3};

/// Adds all equality constraints; `pose0` are the poses at qpos0.
///
/// # Errors
/// Returns an error for an unknown name, an element equated with itself, or a joint without a scalar position.
pub(super) fn add_all(
    builder: &ModelBuilder,
    names: &AllNames,
    pose0: &Positions<f64>,
    model: &mut Model,
) -> Result<(), BuildError> {
    for spec in &builder.equalities {
        let scene = EqualityContext {
            names,
            pose0,
            model,
        };
        let (target, data) = scene.resolve(spec)?;
        model.equalities.push(Equality {
            name: spec.name.clone(),
            target,
            sites: data.sites,
            pose_at_qpos0: data.pose_at_qpos0,
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

/// Checks the numbers of a constraint.
///
/// # Errors
/// Returns an error if a number is invalid for its kind.
pub(super) fn check(e: &EqualitySpec) -> Result<(), BuildError> {
    match &e.kind {
        EqualityKind::Connect(_) => Ok(()),
        EqualityKind::Weld {
            relpose,
            torquescale,
            ..
        } => {
            e.require_not_negative("torquescale", &[*torquescale])?;
            match relpose {
                Some((pos, quat)) => check_pose(e, *pos, *quat),
                None => Ok(()),
            }
        }
        EqualityKind::Joint { polycoef, .. } | EqualityKind::Tendon { polycoef, .. } => {
            e.require_finite("polycoef", polycoef)
        }
    }
}

/// The numbers of a constraint; those that a kind does not use have their defaults.
#[derive(Default)]
struct Data {
    sites: Option<[usize; 2]>,
    pose_at_qpos0: bool,
    /// Anchors in the frames of the first and the second body.
    points: [Vec3<f64>; 2],
    quats: [Quat<f64>; 2],
    torquescale: f64,
    polycoef: [f64; 5],
}

/// The target of a constraint, and its numbers.
type Resolved = Result<(EqualityTarget, Data), BuildError>;

/// The context for resolving names and poses.
struct EqualityContext<'a> {
    names: &'a AllNames<'a>,
    pose0: &'a Positions<f64>,
    model: &'a Model,
}

impl EqualityContext<'_> {
    fn resolve(&self, spec: &EqualitySpec) -> Resolved {
        match &spec.kind {
            EqualityKind::Connect(anchor) => self.connect(spec, anchor),
            EqualityKind::Weld {
                anchor,
                relpose,
                torquescale,
            } => self.weld(spec, anchor, *relpose, *torquescale),
            EqualityKind::Joint {
                joint1,
                joint2,
                polycoef,
            } => {
                let (joint1, joint2) = two(spec, joint1, joint2, |name| self.scalar(spec, name))?;
                let target = EqualityTarget::Joint { joint1, joint2 };
                Ok((target, polynomial(polycoef)))
            }
            EqualityKind::Tendon {
                tendon1,
                tendon2,
                polycoef,
            } => {
                let find = |name: &str| self.names.tendons.find(name, spec);
                let (tendon1, tendon2) = two(spec, tendon1, tendon2, find)?;
                let target = EqualityTarget::Tendon { tendon1, tendon2 };
                Ok((target, polynomial(polycoef)))
            }
        }
    }

    fn connect(&self, spec: &EqualitySpec, anchor: &ConnectAnchor) -> Resolved {
        let ([body1, body2], (points, sites)) = match anchor {
            ConnectAnchor::Bodies {
                body1,
                body2,
                anchor,
            } => {
                let bodies = self.two_bodies(spec, body1, body2)?;
                let points = [*anchor, carry(self.pose0, bodies, *anchor)];
                (bodies, (points, None))
            }
            ConnectAnchor::Sites { site1, site2 } => {
                let (bodies, data) = self.two_sites(spec, site1, site2)?;
                (bodies, (data.points, data.sites))
            }
        };
        let data = Data {
            sites,
            points,
            ..Data::default()
        };
        require_finite_points(spec, &data)?;
        Ok((EqualityTarget::Connect { body1, body2 }, data))
    }

    fn weld(
        &self,
        spec: &EqualitySpec,
        anchor: &ConnectAnchor,
        relpose: Option<(Vec3<f64>, Quat<f64>)>,
        torquescale: f64,
    ) -> Resolved {
        let ([body1, body2], data) = match anchor {
            ConnectAnchor::Bodies {
                body1,
                body2,
                anchor,
            } => {
                let bodies = self.two_bodies(spec, body1, body2)?;
                (bodies, weld_bodies(self.pose0, bodies, *anchor, relpose))
            }
            ConnectAnchor::Sites { site1, site2 } => self.two_sites(spec, site1, site2)?,
        };
        require_finite_points(spec, &data)?;
        let data = Data {
            torquescale,
            ..data
        };
        Ok((EqualityTarget::Weld { body1, body2 }, data))
    }

    fn scalar(&self, spec: &EqualitySpec, name: &str) -> Result<usize, BuildError> {
        let joint = self.names.joints.find(name, spec)?;
        require_scalar(spec, name, joint, self.model)?;
        Ok(joint)
    }

    fn two_bodies(
        &self,
        spec: &EqualitySpec,
        body1: &str,
        body2: &str,
    ) -> Result<[usize; 2], BuildError> {
        let world_if_empty = |name| match name {
            "" => "world",
            name => name,
        };
        let bodies = [
            self.names.bodies.find(body1, spec)?,
            self.names.bodies.find(world_if_empty(body2), spec)?,
        ];
        require_different(spec, bodies[0] != bodies[1])?;
        Ok(bodies)
    }

    /// Returns the bodies of two sites, and the sites' poses in them.
    fn two_sites(
        &self,
        spec: &EqualitySpec,
        site1: &str,
        site2: &str,
    ) -> Result<([usize; 2], Data), BuildError> {
        let sites = [
            self.names.sites.find(site1, spec)?,
            self.names.sites.find(site2, spec)?,
        ];
        require_different(spec, sites[0] != sites[1])?;
        let data = Data {
            sites: Some(sites),
            points: sites.map(|s| self.model.params.site_pos[s]),
            quats: sites.map(|s| self.model.params.site_quat[s]),
            ..Data::default()
        };
        Ok((sites.map(|s| self.model.sites[s].body), data))
    }
}

/// Finds the follower, and the leader if any; they must differ.
fn two(
    spec: &EqualitySpec,
    follower: &str,
    leader: &Option<String>,
    find: impl Fn(&str) -> Result<usize, BuildError>,
) -> Result<(usize, Option<usize>), BuildError> {
    let follower = find(follower)?;
    let leader = leader.as_deref().map(find).transpose()?;
    require_different(spec, Some(follower) != leader)?;
    Ok((follower, leader))
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
        false => Err(spec.error("constrains an element to itself")),
    }
}

fn require_finite_points(spec: &EqualitySpec, data: &Data) -> Result<(), BuildError> {
    let numbers = data.points.map(Vec3::to_array);
    spec.require_finite("anchor", numbers.as_flattened())
}

/// Computes the frames of a weld. Its anchor is a point of the second body; its relative pose is that point's pose in
/// the first.
fn weld_bodies(
    pose0: &Positions<f64>,
    bodies: [usize; 2],
    anchor: Vec3<f64>,
    relpose: Option<(Vec3<f64>, Quat<f64>)>,
) -> Data {
    let (point, quat) = match relpose {
        Some((pos, quat)) => (pos, quat.normalize()),
        None => relative_pose(pose0, bodies, anchor),
    };
    Data {
        pose_at_qpos0: relpose.is_none(),
        points: [point, anchor],
        quats: [quat, Quat::IDENTITY],
        ..Data::default()
    }
}
