//! Symmetric matrices of which only what the factorization fills is stored, and that factorization.
//!
//! The pattern of a [`Tree`](crate::Tree) stores whole paths to a root. Among many coupled trees, as in a heap of bodies, a path of the
//! elimination tree leads past most of them, while few of its entries are ever filled. Here the entries of a row are those that
//! elimination fills, and rows that fill alike form a supernode: a dense block, at which the arithmetic runs.
//!
//! Here live the analysis of a pattern ([`SparsePattern`]) and its numbers ([`SparseFactor`]); nothing of costs or constraints.

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
