//! Exact derivatives of a step.
//!
//! A [`Linearizer`] differentiates most steps by recursions over the tree (see `recursive`, whose `scope` names them),
//! and runs all others in [dual numbers](clench_math::Dual), several directions at a time. Every kernel
//! of the step is generic over its number type, so every feature of the step has derivatives. Passes along velocities
//! or controls alone keep the results of the stages that do not depend on them. Linear systems are solved with one
//! factorization in plain numbers. The solution of the convex problem is differentiated by the implicit function
//! theorem, with the Hessian that Newton's method factors.
//!
//! The derivative of a constraint that switches (a contact that begins, a limit that is reached) is that of the active
//! side.

#![deny(unreachable_pub, unsafe_code)]

mod batch;
mod direction;
mod field;
mod jvp;
mod linearizer;
mod matrix;
mod pass;
mod reads;
mod recursive;
mod request;
mod rollout;
mod seed;
mod sensing;
mod source;
mod stage;
mod tangent;
mod vjp;

pub use batch::{BatchLinearizer, EnvError};
pub use clench_solver::ErrorBound;
pub use field::StateField;
pub use linearizer::{Linearization, Linearizer};
pub use matrix::{
    InputGradient, InputTangent, Matrix, OutputGradient, OutputTangent, RolloutGradient,
};
pub use request::Request;
