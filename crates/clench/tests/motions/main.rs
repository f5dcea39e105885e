//! Motions of whole models whose outcome mechanics predicts.

mod endurance;
mod heaps;
mod sliding;
mod stick_references;
mod sticking;
