//! MuJoCo's constraint model in Rust: load a robot, step it, read its contact forces.
//!
//! Every constraint of a scene (contacts, joint limits, dry friction, equalities) enters one convex problem, solved once
//! a step for the accelerations that satisfy them all together, softly. What follows is a tour from a file to a force.
//!
//! # Load
//!
//! [`load`] reads an MJCF file, [`load_str`] the same from text. Names, units and defaults are MuJoCo's.
//!
//! ```
//! let model = clench::load_str(
//!     "<mujoco>
//!        <worldbody>
//!          <geom name='floor' type='plane' size='1 1 1'/>
//!          <body name='ball' pos='0 0 0.1'>
//!            <freejoint/>
//!            <geom size='0.1' mass='2'/>
//!          </body>
//!        </worldbody>
//!      </mujoco>",
//! )?;
//! assert_eq!((model.nq, model.nv), (7, 6));
//! # Ok::<(), clench::LoadError>(())
//! ```
//!
//! A mistake in a file is an error that says where it is:
//!
//! ```
//! let error = clench::load_str("<mujoco>\n  <option timestop='0.001'/>\n</mujoco>").unwrap_err();
//! assert_eq!(error.line, Some(2));
//! assert!(error.to_string().contains("did you mean \"timestep\"?"));
//! ```
//!
//! # The crates behind
//!
//! | module | what it is |
//! | --- | --- |
//! | [`math`] | numbers, lanes, vectors, quaternions |
//! | [`solver`] | the convex problem and its solvers, without any body in sight |
//! | [`collide`] | shapes in, contact points out |
//! | [`rigid`] | models, dynamics, constraints, the simulation |
//! | [`formats`] | model files |

pub use clench_collide as collide;
pub use clench_formats as formats;
pub use clench_math as math;
pub use clench_rigid as rigid;
pub use clench_solver as solver;

pub use clench_formats::{LoadError, load, load_str};
pub use clench_rigid::{Model, Sim, State};
pub use clench_solver::RigidOptions;

/// What most programs need: `use clench::prelude::*`.
pub mod prelude {
    pub use crate::{Model, RigidOptions, Sim, State, load, load_str};
    pub use clench_math::{Quat, Vec3};
    pub use clench_solver::{ConstraintSolver, FrictionCone, MaxContacts, Switch};
}
