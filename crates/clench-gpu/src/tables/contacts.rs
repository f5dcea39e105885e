//! Pairs of geoms that may collide, with the parameters of their contacts, combined once by the rules of
//! `clench-rigid`.

use super::distances::{Measured, measured};
use super::{Capacity, Tables};
use crate::codes::{Code, codes, row};
use crate::methods::{Method, may_be_general, method_of_pair, points_of_pair};
use clench_collide::{MAX_POINTS, PATCH_POINTS, ShapeKind, allowance, multiccd_applies};
use clench_math::Scalar;
use clench_rigid::contact::{Candidate, contact_params, contact_range};
use clench_rigid::model::Model;
use clench_rigid::options::MaxContacts;
use clench_rigid::settings::StepSettings;
use std::f64::consts::PI;

/// The size of J for the contact pool of an environment, in numbers over its three copies (J, its columns, W J). It
/// limits the pool if the options leave it open and the pairs could fill a larger one. Excess contacts are a fault,
/// never dropped silently.
const POOL_NUMBERS: usize = 12_000;
/// The limits of the pool, unless the contacts of the initial states fill half of it.
const POOL: [usize; 2] = [48, 128];
/// The pairs of a model per thread of the narrow phase; most pairs are far apart.
const PAIRS_OF_A_THREAD: usize = 32;
/// The same with pairs of general convex shapes, each as costly as many others.
const CONVEX_PAIRS_OF_A_THREAD: usize = 8;
/// The same with distances from terrain, a search among its cells.
const SEARCHES_OF_A_THREAD: usize = 1;
/// The maximum number of threads of the narrow phase; each has memory for all contacts of the environment.
const MAX_THREADS: usize = 8;
/// The maximum number of vertices of the polytope of overlapping shapes. Single precision does not benefit from the
/// processor's 128.
const POLYTOPE_VERTICES: usize = 64;
/// The corners that approximate the round cap of a cylinder.
const CAP_CORNERS: usize = 16;
/// The maximum number of corners used of a hull's face, as on the processor.
const MAX_FACE_CORNERS: usize = 24;
/// The corners of a box's face.
const BOX_CORNERS: usize = 4;
/// The numbers of a contact on terrain during collection: position, normal, distance.
const TERRAIN_POINT_SIZE: usize = 7;
/// The maximum contacts of a feature clipped to a triangle, each side of which adds a corner.
const FACE_LIST_POINTS: usize = MAX_FACE_CORNERS + 3;
/// The maximum contacts of a feature and the ground below a triangle.
const PATCH_LIST_POINTS: usize = 2 * PATCH_POINTS;
/// The numbers of a contact: pair, distance, position, normal, two tangents.
pub(crate) const CONTACT_SIZE: usize = 14;

row! {
    /// The contact parameters of a pair.
    numbers PairNumbers, "PAIR" {
        margin: 1,
        /// The sum of the inverse weights of the bodies.
        invweight: 1,
        friction: 5,
        solref: 2,
        solimp: 5,
        solreffriction: 2,
        adhesion: 1,
    }
}

/// Returns the contact parameters of a pair.
fn parameters(m: &Model, pair: &Candidate) -> PairNumbers {
    let mixed = contact_params::<f64>(m, &m.params, pair);
    let weight = |g: u32| m.params.body_invweight0[m.geoms[g as usize].body][0];
    PairNumbers {
        margin: [mixed.includemargin],
        invweight: [weight(pair.geoms[0]) + weight(pair.geoms[1])],
        friction: mixed.friction,
        solref: mixed.solref,
        solimp: mixed.solimp,
        solreffriction: mixed.solreffriction,
        adhesion: [mixed.adhesion],
    }
}

codes! {
    of ShapeKind {
        Plane = "PLANE",
        HeightField = "HEIGHT_FIELD",
        Sphere = "SPHERE",
        Capsule = "CAPSULE",
        Ellipsoid = "ELLIPSOID",
        Cylinder = "CYLINDER",
        Box = "BOX",
        Mesh = "MESH",
    }
}

/// Returns the maximum distance of the centres of two geoms (for a plane: from it to the second's) at which they may be
/// within `range` of each other.
fn reach<S: Scalar>(m: &Model, pair: &Candidate, range: f64) -> f64 {
    let is_empty = |&g: &u32| {
        let mesh = m.geoms[g as usize].mesh;
        mesh.is_some_and(|mesh| m.meshes[mesh].any_hull().is_none())
    };
    if pair.geoms.iter().any(is_empty) {
        return f64::from(f32::MIN);
    }
    let radius = |g: u32| m.params.geom_rbound[g as usize];
    let radii = radius(pair.geoms[0]) + radius(pair.geoms[1]);
    (radii + range) * allowance::<S>().to_f64()
}

/// Returns the pairs that collide, followed by those whose distance is measured.
fn all_pairs(candidates: &[Candidate], measured: &[Measured]) -> Vec<Candidate> {
    let measured = measured.iter().map(|m| m.pair);
    candidates.iter().copied().chain(measured).collect()
}

impl Tables {
    pub(super) fn pairs<S: Scalar>(
        &mut self,
        m: &Model,
        s: &StepSettings,
        candidates: &[Candidate],
        capacity: &mut Capacity,
    ) {
        self.pair_constants();
        let measured = measured(m);
        let all = all_pairs(candidates, &measured);
        let geoms = || all.iter().flat_map(|c| c.geoms);
        let dim = |c: &Candidate| contact_params::<f64>(m, &m.params, c).dim;
        self.count("NPAIR", candidates.len());
        self.count("NMEASURED", measured.len());
        let turned = measured.iter().map(|m| usize::from(m.turned));
        self.words("MEASURED_TURNED", turned);
        capacity.pairs = all.len();
        capacity.measured = measured.len();
        self.words("PAIR_GEOM", geoms().map(|g| g as usize));
        self.words("PAIR_BODY", geoms().map(|g| m.geoms[g as usize].body));
        // A batch refuses candidates without a method, see `check.rs`.
        let methods = Vec::from_iter(all.iter().filter_map(|c| method_of_pair(c.kinds)));
        self.words("PAIR_METHOD", methods.iter().map(|method| method.code()));
        let general = all.iter().any(|c| may_be_general(c.kinds));
        let on_terrain = |c: &Candidate| c.kinds[0] == ShapeKind::HeightField;
        let measured_terrain = measured.iter().any(|m| on_terrain(&m.pair));
        self.fixed_flag("MEASURES_TERRAIN", measured_terrain);
        let of_a_thread = match (measured_terrain, general) {
            (true, _) => SEARCHES_OF_A_THREAD,
            (false, true) => CONVEX_PAIRS_OF_A_THREAD,
            (false, false) => PAIRS_OF_A_THREAD,
        };
        capacity.threads = (all.len() / of_a_thread).clamp(1, MAX_THREADS);
        for method in Method::ALL {
            let used = methods.contains(method) || (general && *method == Method::Convex);
            self.flag(&format!("ANY_{}", method.constant()), used);
        }
        let deepest = |c: &Candidate| {
            let [a, b] = c.kinds;
            !s.flags.multiccd && multiccd_applies(a, b)
        };
        let deepest = candidates.iter().map(|c| usize::from(deepest(c)));
        let of_measured = measured.iter().map(|_| 1);
        self.words("PAIR_DEEPEST", deepest.chain(of_measured));
        let vertices = if general || self.general_kernels {
            POLYTOPE_VERTICES
        } else {
            4
        };
        let faces = 2 * vertices - 4;
        self.constant("POLYTOPE_VERTICES", vertices);
        self.constant("POLYTOPE_FACES", faces);
        if general {
            capacity.polytope = [vertices, faces];
        }
        // Two manifolds with one point more than their maximum, and both lists.
        let any_terrain = all.iter().any(on_terrain);
        if any_terrain {
            let points = [2 * (MAX_POINTS + 1), FACE_LIST_POINTS, PATCH_LIST_POINTS];
            capacity.terrain = points.map(|points| points * TERRAIN_POINT_SIZE);
        }
        self.flag("ANY_TERRAIN", any_terrain);
        self.words("PAIR_DIM", candidates.iter().map(dim));
        let range = |c: &Candidate| contact_range::<f64>(m, &m.params, c).1;
        let ranges = candidates.iter().map(range);
        let ranges = Vec::from_iter(ranges.chain(measured.iter().map(|m| m.cutoff)));
        self.numbers("PAIR_RANGE", ranges.iter().copied());
        let reaches = all.iter().zip(&ranges).map(|(c, &r)| reach::<S>(m, c, r));
        self.numbers("PAIR_REACH", reaches);
        let rows = candidates.iter().flat_map(|c| parameters(m, c).numbers());
        self.numbers("PAIR_PRM", rows);
        self.surfaces(m, candidates, capacity);

        let widest = candidates.iter().map(dim).max().unwrap_or(0);
        let max_points = candidates.iter().map(|c| points_of_pair(c.kinds)).sum();
        capacity.contacts = match s.max_contacts {
            MaxContacts::Limit(limit) => limit.min(max_points),
            MaxContacts::Auto => {
                let pool = POOL_NUMBERS / (3 * widest * m.nv).max(1);
                let pool = pool.clamp(POOL[0], POOL[1]).max(2 * self.contacts_at_start);
                pool.min(max_points)
            }
        };
        capacity.blocks += capacity.contacts;
        capacity.rows += capacity.contacts * widest;
        self.count("MAX_CONTACTS", capacity.contacts);
        self.count("THREAD_CONTACTS", capacity.contacts + capacity.measured);
    }

    fn pair_constants(&mut self) {
        self.codes::<ShapeKind>();
        // The shape below a triangle of terrain, which the host does not know.
        self.constant("PRISM", ShapeKind::ALL.len());
        self.codes::<Method>();
        self.constant("METHODS", Method::ALL.len());
        self.row::<PairNumbers>();
        self.constant("MAX_TERRAIN_POINTS", MAX_POINTS);
        self.constant("TERRAIN_POINT_SIZE", TERRAIN_POINT_SIZE);
        self.constant("PATCH_LIST_POINTS", PATCH_LIST_POINTS);
        self.constant("CONTACT_SIZE", CONTACT_SIZE);
    }

    /// Sets whether contacts have adhesion and whether surfaces move by themselves.
    fn surfaces(&mut self, m: &Model, candidates: &[Candidate], capacity: &mut Capacity) {
        let adheres = |c: &Candidate| contact_params::<f64>(m, &m.params, c).adhesion != 0.0;
        capacity.adheres = candidates.iter().any(adheres);
        self.flag("ANY_ADHESION", capacity.adheres);
        // As in MuJoCo, there are no passive forces if springs and dampers are both off.
        let passive = m.flags.spring || m.flags.damper;
        self.flag("ADHESION_PULLS", capacity.adheres && passive);
        let moves = |c: &Candidate| {
            let surfaces = c.geoms.map(|g| m.params.geom_surfacevel[g as usize]);
            surfaces.as_flattened().iter().any(|&v| v != 0.0)
        };
        self.flag("SURFACES_MOVE", candidates.iter().any(moves));
        let surfaces = m.params.geom_surfacevel.iter().copied().flatten();
        self.numbers("GEOM_SURFACEVEL", surfaces);
    }

    /// Adds the data of general pairs: hulls, curved shapes, faces that may lie on each other, and the capacity for
    /// their corners. Shape data, which is shared by all environments, follows all parameters.
    pub(crate) fn shapes(&mut self, m: &Model, candidates: &[Candidate]) {
        use ShapeKind::{Box, Cylinder, Ellipsoid, HeightField, Mesh, Plane, Sphere};
        let candidates = &all_pairs(candidates, &measured(m));
        let hull_corners = self.hulls(m, candidates);
        let general = || candidates.iter().filter(|c| may_be_general(c.kinds));
        let has = |kind: ShapeKind| general().any(|c| c.kinds.contains(&kind));
        // Both have edges.
        let flat = |c: &&Candidate| c.kinds.iter().all(|k| !matches!(k, Sphere | Ellipsoid));
        let flat_with = |kind| general().filter(flat).any(|c| c.kinds.contains(&kind));
        self.flag("ANY_MESH", has(Mesh));
        self.flag("ANY_ELLIPSOID", has(Ellipsoid));
        self.flag("ANY_CYLINDER", has(Cylinder));
        self.flag("CURVED_PAIRS", has(Ellipsoid) || has(Cylinder));
        self.flag("FLAT_PAIRS", general().any(|c| flat(&c)));
        self.flag("ANY_CAP_PATCHES", flat_with(Cylinder));
        let polyhedral =
            |c: &Candidate| matches!(c.kinds, [Cylinder, Box | Mesh] | [HeightField, Cylinder]);
        self.flag("ANY_CYLINDER_POLYHEDRON", candidates.iter().any(polyhedral));
        let cylinders = |c: &Candidate| c.kinds == [Cylinder, Cylinder];
        self.flag("ANY_CYLINDER_PAIR", candidates.iter().any(cylinders));
        let on_plane = |c: &Candidate| c.kinds == [Plane, Mesh];
        self.flag("MESH_ON_PLANE", candidates.iter().any(on_plane));
        self.flag("LARGE_FACES", hull_corners > PATCH_POINTS);

        // General kernels have the maximum capacity.
        let caps = self.general_kernels || flat_with(Cylinder);
        let hull_corners = if self.general_kernels {
            MAX_FACE_CORNERS
        } else {
            hull_corners
        };
        let mut corners = BOX_CORNERS;
        if caps {
            corners = corners.max(CAP_CORNERS);
        }
        corners = corners.max(hull_corners.min(MAX_FACE_CORNERS));
        self.constant("PATCH_POINTS", PATCH_POINTS);
        self.constant("CAP_CORNERS", CAP_CORNERS);
        // Half the angle of a direction sector of a patch.
        self.real("HALF_SECTOR", PI / PATCH_POINTS as f64);
        // The angle between the corners of a round cap.
        self.real("CAP_ANGLE", 2.0 * PI / CAP_CORNERS as f64);
        self.constant("MAX_FACE_CORNERS", MAX_FACE_CORNERS);
        self.constant("FEATURE_CORNERS", corners);
        self.flag("MANY_CORNERS", corners > BOX_CORNERS);
        // The overlap of two polygons has at most all their corners; on a round cap it also has both ends of a chord
        // for each side.
        let max_corners = if caps {
            3 * corners + CAP_CORNERS
        } else {
            2 * corners + BOX_CORNERS
        };
        self.constant("POLYGON_CORNERS", max_corners);
    }
}
