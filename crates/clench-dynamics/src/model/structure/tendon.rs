//! Tendons.

use std::ops::Range;
use std::sync::Arc;

/// An element of the path of a tendon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// A joint of a fixed tendon, times its coefficient.
    Joint(usize),
    /// A site that a spatial tendon passes.
    Site(usize),
    /// A sphere or cylinder around which a spatial tendon wraps between two sites.
    Geom {
        /// The geom.
        geom: usize,
        /// The site on the side where the tendon must pass, or inside the geom.
        side: Option<usize>,
    },
    /// The start of a branch of a spatial tendon, whose length is divided by a number.
    Pulley,
}

/// A tendon: fixed, a sum of joint positions, or spatial, a string through sites and around geoms.
#[derive(Clone, Debug)]
pub struct Tendon {
    /// Name, possibly empty.
    pub name: String,
    /// Its path: only joints, or branches that begin and end with a site.
    pub path: Vec<Wrap>,
    /// The range of the path's coefficients in `params.wrap_coef`.
    pub coefs: Range<usize>,
    /// The index in [`State::plastic`](crate::State::plastic) of its spring's dead band; `None` if the spring does not
    /// yield.
    pub plastic: Option<usize>,
    /// True if its range is a limit.
    pub limited: bool,
    /// True if its total actuator force is limited.
    pub actfrclimited: bool,
    /// True if it may have dry friction.
    pub frictionloss: bool,
    /// The actuators that may damp it or add inertia to it, in order.
    pub reflecting: Vec<usize>,
    /// The user's own numbers.
    pub user: Arc<[f64]>,
}

/// A part of a spatial tendon between two successive sites.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Section {
    /// The sites.
    pub sites: [usize; 2],
    /// The geom to wrap around, and its side site.
    pub obstacle: Option<(usize, Option<usize>)>,
    /// The index in `params.wrap_coef` of the divisor of its length.
    pub divisor: Option<usize>,
}

impl Tendon {
    /// Returns true if it is spatial.
    #[inline(always)]
    pub fn is_spatial(&self) -> bool {
        !matches!(self.path.first(), Some(Wrap::Joint(_)))
    }

    /// Returns true if it wraps around or through geoms.
    pub fn has_obstacles(&self) -> bool {
        self.path
            .iter()
            .any(|wrap| matches!(wrap, Wrap::Geom { .. }))
    }

    /// Returns the sections of a spatial tendon, starting at its first site.
    #[inline(always)]
    pub fn sections(&self) -> impl Iterator<Item = Section> + '_ {
        let (mut from, mut obstacle, mut divisor) = (None, None, None);
        self.path.iter().enumerate().filter_map(move |(i, &wrap)| {
            match wrap {
                Wrap::Joint(_) => {}
                Wrap::Pulley => {
                    divisor = Some(self.coefs.start + i);
                    from = None;
                }
                Wrap::Geom { geom, side } => obstacle = Some((geom, side)),
                Wrap::Site(site) => {
                    let before = from.replace(site);
                    return before.map(|before| Section {
                        sites: [before, site],
                        obstacle: obstacle.take(),
                        divisor,
                    });
                }
            }
            None
        })
    }
}
