//! Pairs of geoms that may collide, with the parameters of their contacts: mixed here, once, by the rules of `clench-rigid`.

use super::{Capacity, Tables};
use crate::check::{METHODS, may_be_general, method_of_pair, points_of_pair};
use clench_collide::{ShapeKind, allowance};
use clench_rigid::contact::{Candidate, contact_params, contact_range};
use clench_rigid::model::Model;
use clench_rigid::options::MaxContacts;
use clench_rigid::settings::StepSettings;

/// The pool of an environment, where the options leave it open and the pairs could fill a larger one. Contacts beyond are a fault,
/// never left out in silence.
const POOL: usize = 48;
/// Vertices of the polytope of overlapping shapes. Single precision has no use for the 128 that the processor has room for.
const POLYTOPE_VERTICES: usize = 64;
/// Numbers of a contact: pair, distance, position, normal, two tangents.
pub(crate) const CONTACT_SIZE: usize = 14;

/// The parameters of the contacts of a pair, in the order in which kernels read them.
fn parameters(m: &Model, pair: &Candidate) -> Vec<f64> {
    let mixed = contact_params::<f64>(m, &m.params, pair);
    let weight = |g: u32| m.params.body_invweight0[m.geoms[g as usize].body][0];
    let mut row = vec![
        mixed.includemargin,
        weight(pair.geoms[0]) + weight(pair.geoms[1]),
    ];
    row.extend(mixed.friction);
    row.extend(mixed.solref);
    row.extend(mixed.solimp);
    row.extend(mixed.solreffriction);
    row
}

/// Within what distance of their centres (of a plane: of the second's to it) two geoms may touch.
fn reach(m: &Model, pair: &Candidate) -> f64 {
    let radius = |g: u32| m.params.geom_rbound[g as usize];
    let (_, range) = contact_range::<f64>(m, &m.params, pair);
    let radii = radius(pair.geoms[0]) + radius(pair.geoms[1]);
    (radii + range) * f64::from(allowance::<f32>())
}

impl Tables {
    pub(super) fn pairs(
        &mut self,
        m: &Model,
        s: &StepSettings,
        candidates: &[Candidate],
        capacity: &mut Capacity,
    ) {
        for (name, kind) in [
            ("PLANE", ShapeKind::Plane),
            ("SPHERE", ShapeKind::Sphere),
            ("CAPSULE", ShapeKind::Capsule),
            ("ELLIPSOID", ShapeKind::Ellipsoid),
            ("CYLINDER", ShapeKind::Cylinder),
            ("BOX", ShapeKind::Box),
        ] {
            self.count(name, kind as usize);
        }
        for (code, name) in METHODS.iter().enumerate() {
            self.count(name, code);
        }
        let geoms = || candidates.iter().flat_map(|c| c.geoms);
        let dim = |c: &Candidate| contact_params::<f64>(m, &m.params, c).dim;
        self.count("NPAIR", candidates.len());
        self.words("PAIR_GEOM", geoms().map(|g| g as usize));
        self.words("PAIR_BODY", geoms().map(|g| m.geoms[g as usize].body));
        let method = |c: &Candidate| method_of_pair(c.kinds).unwrap_or(0);
        self.words("PAIR_METHOD", candidates.iter().map(method));
        let general = candidates.iter().any(|c| may_be_general(c.kinds));
        for (code, name) in METHODS.iter().enumerate() {
            let used = candidates.iter().any(|c| method(c) == code);
            self.flag(
                &format!("ANY_{name}"),
                used || (general && *name == "CONVEX"),
            );
        }
        // What kinds of shape general pairs have.
        let has = |kind: ShapeKind| {
            let mut all = candidates.iter().filter(|c| may_be_general(c.kinds));
            all.any(|c| c.kinds.contains(&kind))
        };
        let flat = |c: &Candidate| may_be_general(c.kinds) && method(c) + 1 < METHODS.len();
        self.flag("ANY_ELLIPSOID", has(ShapeKind::Ellipsoid));
        self.flag("ANY_CYLINDER", has(ShapeKind::Cylinder));
        self.flag(
            "CURVED_PAIRS",
            has(ShapeKind::Ellipsoid) || has(ShapeKind::Cylinder),
        );
        self.flag("FLAT_PAIRS", candidates.iter().any(flat));
        let vertices = if general { POLYTOPE_VERTICES } else { 4 };
        let faces = 2 * vertices - 4;
        self.count("POLYTOPE_VERTICES", vertices);
        self.count("POLYTOPE_FACES", faces);
        // Nine numbers of a vertex, twelve of a face; a list of sides, of faces, and three numbers of each side of the horizon.
        capacity.polytope = if general {
            9 * vertices + 17 * faces + 4
        } else {
            0
        };
        self.words("PAIR_DIM", candidates.iter().map(dim));
        let range = |c: &Candidate| contact_range::<f64>(m, &m.params, c).1;
        self.numbers("PAIR_RANGE", candidates.iter().map(range));
        self.numbers("PAIR_REACH", candidates.iter().map(|c| reach(m, c)));
        let rows = Vec::from_iter(candidates.iter().map(|c| parameters(m, c)));
        self.count("PAIR_PRM_SIZE", rows.first().map_or(0, Vec::len));
        self.numbers("PAIR_PRM", rows.into_iter().flatten());

        let most = candidates.iter().map(|c| points_of_pair(c.kinds)).sum();
        capacity.contacts = match s.max_contacts {
            MaxContacts::Limit(limit) => limit.min(most),
            MaxContacts::Auto => POOL.min(most),
        };
        let widest = candidates.iter().map(dim).max().unwrap_or(0);
        capacity.blocks += capacity.contacts;
        capacity.rows += capacity.contacts * widest;
        self.count("MAX_CONTACTS", capacity.contacts);
        self.count("CONTACT_SIZE", CONTACT_SIZE);
    }
}
