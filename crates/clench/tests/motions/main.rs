//! Motions of whole models whose outcome mechanics predicts.

mod heaps;
mod sticking;
