//! The Hessian H = M + Jᵀ W J of the problem, and its factorization H = LᵀDL.
//!
//! Rows are eliminated from the last to the first, as for M itself: then a constraint within one branch of the tree
//! creates no fill. [`Pattern`] says which entries can be nonzero: for the sparse choice the tree, the couplings that
//! constraints add between branches, and their fill; for the dense choice all of them. Both run the same kernels, in
//! which an entry that is zero contributes an exact zero: **sparse and dense agree to the bit**.

mod factor;
mod pattern;

pub(crate) use factor::Hessian;
pub(crate) use pattern::Pattern;
