//! Pairs of geoms that may collide, with the parameters of their contacts: mixed here, once, by the rules of `clench-rigid`.

use super::{Capacity, Tables};
use crate::check::points_of_pair;
use clench_collide::{ShapeKind, allowance};
use clench_rigid::contact::{Candidate, contact_params, contact_range};
use clench_rigid::model::Model;
use clench_rigid::options::MaxContacts;
use clench_rigid::settings::StepSettings;

/// The pool of an environment, where the options leave it open and the pairs could fill a larger one. Contacts beyond are a fault,
/// never left out in silence.
const POOL: usize = 48;
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
        ] {
            self.count(name, kind as usize);
        }
        let geoms = || candidates.iter().flat_map(|c| c.geoms);
        let dim = |c: &Candidate| contact_params::<f64>(m, &m.params, c).dim;
        self.count("NPAIR", candidates.len());
        self.words("PAIR_GEOM", geoms().map(|g| g as usize));
        self.words("PAIR_BODY", geoms().map(|g| m.geoms[g as usize].body));
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
