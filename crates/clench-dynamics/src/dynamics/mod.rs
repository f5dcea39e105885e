//! Smooth dynamics: all terms of the equation of motion except constraints, one topic per file.
//!
//! ```text
//! M(q) a = τ,   τ = passive + actuation + applied − bias(q, v)
//! ```
//!
//! Spatial vectors of a kinematic tree are about the tree's centre of mass (`subtree_com` of its root), in world axes,
//! as in MuJoCo: the numbers stay small at any position of the tree.

pub(crate) mod activation;
pub(crate) mod activation_rates;
pub mod actuation;
pub(crate) mod actuator;
pub(crate) mod actuator_derivatives;
pub(crate) mod added_mass;
pub(crate) mod adhesion;
pub mod articulated;
pub mod bias;
pub mod camera;
pub mod chains;
pub mod com;
pub mod coriolis;
pub mod dc_motor;
pub mod derivatives;
pub(crate) mod discrete;
pub(crate) mod discrete_limits;
pub mod ellipsoid;
pub mod energy;
pub(crate) mod euler;
pub(crate) mod fluid;
pub mod force_derivatives;
pub mod frames;
pub(crate) mod gain;
pub mod gyroscopic;
pub(crate) mod implicit;
pub mod inertia;
pub mod integrate;
pub mod integration;
pub mod inverse_derivatives;
pub mod jacobian;
pub mod kinematics;
pub mod local;
pub mod metric;
pub mod muscle;
pub mod orientation;
pub mod passive;
pub mod pid;
pub mod plastic;
pub mod polynomial;
pub mod project;
pub mod reflected;
pub mod rk4;
pub mod setpoint;
pub(crate) mod site_transmission;
pub(crate) mod smooth;
pub mod spring;
pub mod tendon;
pub mod tendon_armature;
pub mod tendon_path;
pub mod transmission;
pub mod velocity;
pub mod wrap;
