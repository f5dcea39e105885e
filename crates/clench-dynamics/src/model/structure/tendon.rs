//! Tendons.

use std::ops::Range;
use std::sync::Arc;

/// What a tendon is made of, or passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// A joint of a fixed tendon, times its coefficient.
    Joint(usize),
    /// A site that a spatial tendon passes.
    Site(usize),
    /// A sphere or cylinder that a spatial tendon goes around between two sites.
    Geom {
        /// The geom.
        geom: usize,
        /// The site on the side where the tendon has to pass, or inside the geom.
        side: Option<usize>,
    },
    /// Starts a branch of a spatial tendon, whose length counts divided by a number.
    Pulley,
}

/// A tendon: fixed, a sum of joint positions, or spatial, a string through sites and around geoms.
#[derive(Clone, Debug)]
pub struct Tendon {
    /// Name, possibly empty.
    pub name: String,
    /// What it is made of: joints alone, or branches that begin and end with a site.
    pub path: Vec<Wrap>,
    /// Where the numbers of the path's elements are in `params.wrap_coef`.
    pub coefs: Range<usize>,
    /// The first number in [`State::plastic`](crate::State::plastic) of its spring's dead band; none where the spring does not yield.
    pub plastic: Option<usize>,
    /// Its range is a limit.
    pub limited: bool,
    /// Its total actuator force is limited.
    pub actfrclimited: bool,
    /// It may have dry friction.
    pub frictionloss: bool,
    /// The actuators that may damp it or add inertia to it, in order.
    pub reflecting: Vec<usize>,
    /// The user's own numbers, as many for each element of its kind.
    pub user: Arc<[f64]>,
}

/// A part of a spatial tendon between two sites that follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Section {
    /// The sites.
    pub sites: [usize; 2],
    /// The geom to go around, and its side site.
    pub obstacle: Option<(usize, Option<usize>)>,
    /// The number in `params.wrap_coef` by which its length is divided.
    pub divisor: Option<usize>,
}

impl Tendon {
    /// Whether it is a string in space.
    #[inline(always)]
    pub fn is_spatial(&self) -> bool {
        !matches!(self.path.first(), Some(Wrap::Joint(_)))
    }

    /// Whether it goes around or through geoms.
    pub fn has_obstacles(&self) -> bool {
        self.path
            .iter()
            .any(|wrap| matches!(wrap, Wrap::Geom { .. }))
    }

    /// The sections of a spatial tendon, from its first site on.
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
