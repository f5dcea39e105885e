//! Smooth dynamics: everything of the equation of motion but constraints, one idea a file.
//!
//! ```text
//! M(q) a = τ,   τ = passive + actuation + applied − bias(q, v)
//! ```
//!
//! Spatial vectors of a kinematic tree are about the tree's centre of mass (`subtree_com` of its root), in world axes, as
//! in MuJoCo: the numbers stay small wherever the tree is.

pub mod activation;
pub mod activation_rates;
pub mod actuation;
pub mod actuator;
pub mod actuator_derivatives;
pub mod adhesion;
pub mod articulated;
pub mod bias;
pub mod camera;
pub mod chains;
pub mod com;
pub mod coriolis;
pub mod dc_motor;
pub mod derivatives;
pub mod discrete;
pub mod discrete_limits;
pub mod ellipsoid;
pub mod energy;
pub mod euler;
pub mod fluid;
pub(crate) mod frames;
pub mod gain;
pub mod gyroscopic;
pub mod implicit;
pub mod inertia;
pub mod integrate;
pub mod integration;
pub mod jacobian;
pub mod kinematics;
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
pub mod site_transmission;
pub mod smooth;
pub mod spring;
pub mod tendon;
pub mod tendon_armature;
pub mod tendon_path;
pub mod transmission;
pub mod velocity;
pub mod wrap;
