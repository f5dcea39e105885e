//! Contact detection: the pairs that may touch, their contact points and contact parameters. `constraint::contact`
//! turns contacts into constraints.

mod awake_pairs;
mod body_pairs;
mod bounding_box;
mod bounding_sphere;
pub(crate) mod collision;
mod depth_proofs;
mod detect;
mod dynamic_broad_phase;
mod mix;
pub(crate) mod pair_clock;
mod pair_finder;
mod placed_shape;
mod select;
mod separating_axes;
mod surface;

pub use collision::{Collision, Excess};
pub use detect::detect;
pub use mix::mixed_params;
pub use mix::{ContactParams, contact_params, contact_range};
pub(crate) use placed_shape::{ALL_LANES, AssetLanes, exists, mask_of, mesh_in, shape_in};
pub use placed_shape::{heights_in, shape};
pub use select::check_supported;
pub use select::{Candidate, candidates};

use clench_math::{Mask, Mat3, Real, Vec3};

/// A contact between two geoms, one for each lane where it is active.
#[derive(Clone, Copy, Debug)]
pub struct Contact<T: Real> {
    /// The geoms; the normal points from the first to the second.
    pub geoms: [usize; 2],
    /// The lanes in which the contact is active.
    pub active: T::Mask,
    /// Dimensions: 1, 3, 4 or 6.
    pub dim: usize,
    /// Signed distance, negative in penetration, m.
    pub dist: T,
    /// Midpoint between the surfaces, m.
    pub pos: Vec3<T>,
    /// The rows: normal, first tangent, second tangent.
    pub frame: Mat3<T>,
    /// The constraint exists if `dist < includemargin` (the margins of both geoms), m.
    pub includemargin: T,
    /// Two slides, spin, two rolls.
    pub friction: [T; 5],
    /// Reference dynamics.
    pub solref: [T; 2],
    /// Reference dynamics of the friction dimensions; equal to `solref` if both are zero.
    pub solreffriction: [T; 2],
    /// Impedance.
    pub solimp: [T; 5],
    /// The adhesive force, N: pulls the bodies together, so that the constraint can pull as much. If it is not zero,
    /// the contact also acts within the gap, without friction.
    pub adhesion: T,
    /// The velocity of the second surface minus that of the first along the tangents, m/s, and about the normal, rad/s.
    pub surfacevel: [T; 3],
    /// The block in the problem, if the contact became a constraint.
    pub block: Option<usize>,
}

impl<T: Real> Contact<T> {
    /// Copies the contact of one environment to every lane.
    pub fn splat(contact: &Contact<T::Scalar>) -> Self {
        Self::convert(contact, T::splat)
    }

    /// Converts the numbers of the contact of one environment.
    pub fn convert<S: Real<Mask = bool>>(contact: &Contact<S>, number: impl Fn(S) -> T) -> Self {
        let vector = |v: Vec3<S>| Vec3::from_array(v.to_array().map(&number));
        let [x, y, z] = contact.frame.rows.map(vector);
        Contact {
            geoms: contact.geoms,
            active: T::Mask::splat(contact.active),
            dim: contact.dim,
            dist: number(contact.dist),
            pos: vector(contact.pos),
            frame: Mat3::from_rows(x, y, z),
            includemargin: number(contact.includemargin),
            friction: contact.friction.map(&number),
            solref: contact.solref.map(&number),
            solreffriction: contact.solreffriction.map(&number),
            solimp: contact.solimp.map(&number),
            adhesion: number(contact.adhesion),
            surfacevel: contact.surfacevel.map(&number),
            block: contact.block,
        }
    }

    /// Returns the lanes in which it is a constraint, if any dof is between its bodies.
    #[inline(always)]
    pub fn acts(&self) -> T::Mask {
        let adheres = !self.adhesion.eq(T::ZERO);
        self.active & (self.dist.lt(self.includemargin) | adheres)
    }
}
