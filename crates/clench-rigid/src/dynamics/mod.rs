//! Smooth dynamics: everything of the equation of motion but constraints, one idea a file.
//!
//! ```text
//! M(q) a = τ,   τ = passive + actuation + applied − bias(q, v)
//! ```
//!
//! Spatial vectors of a kinematic tree are about the tree's centre of mass (`subtree_com` of its root), in world axes, as
//! in MuJoCo: the numbers stay small wherever the tree is.

pub(crate) mod activation;
pub(crate) mod activation_rates;
pub(crate) mod actuation;
pub(crate) mod actuator;
pub(crate) mod actuator_derivatives;
pub(crate) mod adhesion;
pub mod articulated;
pub(crate) mod bias;
pub(crate) mod camera;
pub(crate) mod chains;
pub mod com;
pub mod coriolis;
pub mod dc_motor;
pub mod derivatives;
pub(crate) mod discrete;
pub(crate) mod discrete_limits;
pub mod ellipsoid;
pub(crate) mod energy;
pub(crate) mod euler;
pub(crate) mod fluid;
pub(crate) mod frames;
pub(crate) mod gain;
pub(crate) mod gyroscopic;
pub(crate) mod implicit;
pub mod inertia;
pub mod integrate;
pub(crate) mod integration;
pub(crate) mod jacobian;
pub mod kinematics;
pub(crate) mod metric;
pub mod muscle;
pub mod orientation;
pub(crate) mod passive;
pub mod pid;
pub mod plastic;
pub(crate) mod polynomial;
pub mod project;
pub(crate) mod reflected;
pub(crate) mod rk4;
pub(crate) mod setpoint;
pub(crate) mod site_transmission;
pub(crate) mod smooth;
pub(crate) mod spring;
pub(crate) mod tendon;
pub(crate) mod tendon_armature;
pub(crate) mod tendon_path;
pub(crate) mod transmission;
pub(crate) mod velocity;
pub mod wrap;
