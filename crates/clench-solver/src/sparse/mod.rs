//! Symmetric matrices that store only the entries filled by the factorization, and that factorization.
//!
//! The pattern of a [`Tree`](crate::Tree) stores whole paths to a root. With many coupled trees, as in a heap of
//! bodies, a path of the elimination tree passes through most of them, while few of its entries are ever filled. Here a
//! row stores only the entries that elimination fills. Rows that fill equally form a supernode: a dense block, on which
//! the arithmetic runs.
//!
//! This module contains the analysis of a pattern ([`SparsePattern`]) and its numbers ([`SparseFactor`]). It does not
//! depend on costs or constraints.

mod elimination;
mod factor;
mod pattern;
mod solve;
#[cfg(test)]
mod tests;
mod tiles;
mod window;

pub(crate) use factor::SparseFactor;
pub(crate) use pattern::SparsePattern;
pub(crate) use window::Window;
