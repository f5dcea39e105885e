//! The six constraint costs. Each file derives one: its value, force, Hessian block, and its restriction to a ray.

mod block_cost;
mod coulomb;
mod elliptic;
mod huber;
mod one_sided;
mod pyramid;
mod quadratic;
mod slip;
#[cfg(test)]
mod tests;

pub(crate) use block_cost::{BlockCost, Form, MAX_DIM, RankOne, Rows, Slope, Totals, Weight};
pub(crate) use coulomb::Coulomb;
pub(crate) use elliptic::Elliptic;
pub(crate) use huber::Huber;
pub(crate) use one_sided::OneSided;
pub(crate) use pyramid::Pyramid;
pub(crate) use quadratic::Quadratic;

/// Evaluates an expression with `$c` set to the [`BlockCost`] of `$cost`.
macro_rules! with_cost {
    ($cost:expr, $c:ident => $body:expr) => {
        match $cost {
            $crate::Cost::Quadratic => {
                type $c = $crate::costs::Quadratic;
                $body
            }
            $crate::Cost::OneSided => {
                type $c = $crate::costs::OneSided;
                $body
            }
            $crate::Cost::Huber => {
                type $c = $crate::costs::Huber;
                $body
            }
            $crate::Cost::Pyramid => {
                type $c = $crate::costs::Pyramid;
                $body
            }
            $crate::Cost::Elliptic => {
                type $c = $crate::costs::Elliptic;
                $body
            }
            $crate::Cost::Coulomb => {
                type $c = $crate::costs::Coulomb;
                $body
            }
        }
    };
}
pub(crate) use with_cost;

/// Returns the number of active-set entries of a block with this cost.
pub(crate) fn active_len(cost: Cost, dim: usize) -> usize {
    with_cost!(cost, C => <C as BlockCost<f64>>::active_len(dim))
}

/// Declares the enumeration of costs and the list of all.
macro_rules! costs {
    ($($(#[$attribute:meta])* $name:ident,)*) => {
        /// The shape of a constraint's cost s(y), y = J a − aref.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
        pub enum Cost {
            $($(#[$attribute])* $name,)*
        }

        impl Cost {
            /// All costs.
            pub const ALL: &[Cost] = &[$(Cost::$name),*];
        }
    };
}

costs! {
    /// ½ D y² always: equalities.
    #[default]
    Quadratic,
    /// ½ D y² for y < 0, else 0: limits, frictionless contacts.
    OneSided,
    /// ½ D y² near zero, η |y| − ½ R η² beyond: dry friction of loss η.
    Huber,
    /// One-sided on each of the 2 (dim − 1) edges y₀ ± μ_j y_j: frictional contact, linearised.
    Pyramid,
    /// Distance to a circular cone after scaling: frictional contact, exact.
    Elliptic,
    /// One-sided in the normal; friction within a disc whose radius is the normal force: frictional contact by
    /// Coulomb's law.
    Coulomb,
}

impl Cost {
    /// Returns true for a frictional contact: its first row is normal, and the ratios of its R describe its friction.
    #[inline(always)]
    pub fn is_cone(self) -> bool {
        match self {
            Cost::Quadratic | Cost::OneSided | Cost::Huber => false,
            Cost::Pyramid | Cost::Elliptic | Cost::Coulomb => true,
        }
    }

    /// Returns the index of the first row with friction; `None` if there is none.
    #[inline(always)]
    pub(crate) fn first_friction(self) -> Option<usize> {
        match self {
            Cost::Quadratic | Cost::OneSided => None,
            Cost::Huber => Some(0),
            Cost::Pyramid | Cost::Elliptic | Cost::Coulomb => Some(1),
        }
    }

    /// Returns true if its forces act along the edges y₀ ± μ_j y_j, not along the rows.
    #[inline(always)]
    pub fn has_edges(self) -> bool {
        match self {
            Cost::Pyramid => true,
            Cost::Quadratic | Cost::OneSided | Cost::Huber | Cost::Elliptic | Cost::Coulomb => {
                false
            }
        }
    }

    /// Returns true if its rows have numbers `shape`: losses or friction coefficients.
    #[inline(always)]
    pub fn has_shape(self) -> bool {
        match self {
            Cost::Quadratic | Cost::OneSided => false,
            Cost::Huber | Cost::Pyramid | Cost::Elliptic | Cost::Coulomb => true,
        }
    }
}
