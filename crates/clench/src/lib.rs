//! MuJoCo's constraint model in Rust: load a robot, step it, read its contact forces.
//!
//! All constraints of a scene (contacts, joint limits, dry friction, equalities) form one convex problem. Each step
//! solves it once for the accelerations that satisfy all of them together, softly. The sections below lead from a file
//! to a force.
//!
//! # Load and step
//!
//! [`load`] reads an MJCF file and [`load_str`] MJCF text; names, units and defaults are those of MuJoCo. A [`Model`]
//! is immutable, so simulations share it. A [`Sim`] simulates a model; you can read and write its [`State`] between
//! steps.
//!
//! ```
//! use clench::prelude::*;
//! use std::sync::Arc;
//!
//! let model = Arc::new(load_str(
//!     "<mujoco>
//!        <worldbody>
//!          <geom name='floor' type='plane' size='1 1 1'/>
//!          <body name='ball' pos='0 0 0.2'>
//!            <freejoint/>
//!            <geom size='0.1' mass='2'/>
//!          </body>
//!        </worldbody>
//!      </mujoco>",
//! )?);
//! let mut sim = Sim::<f64>::new(model)?;
//! for _ in 0..2000 {
//!     sim.step()?;
//! }
//! // The ball has come to rest on the floor, sunk in by less than a millimetre: contacts are soft.
//! let height = sim.state.qpos[2];
//! assert!((0.099..0.1).contains(&height));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Read contacts and forces
//!
//! The results of a step are in its [`workspace`](Sim::workspace); [`rigid::readout`] returns them in MuJoCo's terms.
//!
//! ```
//! use clench::{prelude::*, rigid::readout};
//! # use std::sync::Arc;
//! # let model = Arc::new(load_str(
//! #     "<mujoco>
//! #        <worldbody>
//! #          <geom name='floor' type='plane' size='1 1 1'/>
//! #          <body name='ball' pos='0 0 0.2'>
//! #            <freejoint/>
//! #            <geom size='0.1' mass='2'/>
//! #          </body>
//! #        </worldbody>
//! #      </mujoco>",
//! # )?);
//! # let mut sim = Sim::<f64>::new(model)?;
//! # for _ in 0..2000 { sim.step()?; }
//! assert_eq!(sim.contacts().len(), 1);
//! // Along the normal, along two tangents, then torques about them: the floor carries the ball's weight.
//! let [normal, ..] = readout::contact_force(sim.workspace(), 0, 0);
//! assert!((normal - 2.0 * 9.81).abs() < 1e-6);
//!
//! for row in readout::constraint_rows(sim.workspace(), 0) {
//!     println!("{} violated by {:.1e} pushes with {:.3}", row.source.kind(), row.pos, row.force);
//! }
//! // Every solve says how it ended.
//! println!("{:?} after {} iterations", sim.stats().status, sim.stats().iterations);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Set options
//!
//! Options set by the user take precedence over the file's `<option>`, and the file over its format's defaults.
//!
//! ```
//! # use clench::prelude::*;
//! # use std::sync::Arc;
//! let model = Arc::new(load_str("<mujoco><option iterations='20' cone='elliptic'/></mujoco>")?);
//! let options = RigidOptions::new().iterations(7);
//! let sim = Sim::<f64>::with_options(model, options)?;
//! assert_eq!(sim.settings().solver.iterations, 7);
//! assert_eq!(sim.settings().friction_cone, FrictionCone::Elliptic);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Build a model by hand
//!
//! You can also describe a model in Rust: [`rigid::builder`] has a description with public fields, and setters for the
//! most common ones.
//!
//! ```
//! use clench::prelude::*;
//! use clench::rigid::builder::{BodySpec, GeomSpec, JointSpec, ModelBuilder};
//! # use std::sync::Arc;
//!
//! let mut builder = ModelBuilder::new("pendulum");
//! builder.add_ground(GeomSpec::plane());
//! builder.add_body(
//!     ModelBuilder::WORLD,
//!     BodySpec::new("arm")
//!         .at([0.0, 0.0, 1.0])
//!         .joint(JointSpec::hinge("pivot", [0.0, 1.0, 0.0]))
//!         .geom(GeomSpec::capsule(0.02, 0.25).at([0.25, 0.0, 0.0]).mass(0.5)),
//! );
//! let mut sim = Sim::<f64>::new(Arc::new(builder.build()?))?;
//! sim.step()?;
//! // It begins to fall.
//! assert!(sim.state.qvel[0] > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Step thousands at once
//!
//! A [`Batch`] steps many environments of one model in parallel, on all processors. States and outputs are plain rows,
//! one per environment. Each environment moves exactly as in a single `Sim`, to the bit, and can have its own
//! parameters, or a model with other geoms ([`Batch::of_models`]). An environment that fails keeps its last good state
//! and reports the reason until it is reset; the others are not affected.
//!
//! ```
//! # use clench::prelude::*;
//! # use std::sync::Arc;
//! # let model = Arc::new(load_str(
//! #     "<mujoco>
//! #        <worldbody>
//! #          <geom name='floor' type='plane' size='1 1 1'/>
//! #          <body name='ball' pos='0 0 0.2'>
//! #            <freejoint/>
//! #            <geom size='0.1' mass='2'/>
//! #          </body>
//! #        </worldbody>
//! #      </mujoco>",
//! # )?);
//! let mut batch = Batch::<f32>::new(model, 1000)?;
//! batch.record(&["contact_force"])?;
//! for env in 0..batch.count() {
//!     // Each ball is thrown in its own way, and weighs what it weighs.
//!     batch.state.qvel.row_mut(env)[0] = 0.001 * env as f32;
//!     batch.randomize("body_mass", &[env], &[0.0, 1.0 + 0.001 * env as f32])?;
//! }
//! batch.state.qpos.row_mut(7)[2] = f32::NAN;
//! let summary = batch.step_n(1000)?;
//! assert_eq!((summary.failed, summary.running), (1, 999));
//! assert!(matches!(batch.status(7), EnvStatus::Failed(Fault::NotFinite { field: "qpos", index: 2, .. })));
//! batch.reset(7)?;
//!
//! // Six numbers a body: the floor carries the ball's weight.
//! let forces = batch.output("contact_force").expect("it is recorded");
//! let weight = 9.81 * (1.0 + 0.001 * 500.0);
//! assert!((forces.row(500)[6 + 2] - weight).abs() < 0.01 * weight);
//!
//! // A rollout keeps what every step brought: here the seven coordinates of each ball, twenty times.
//! let recording = batch.rollout(20, Controls::Held, &["qpos"])?;
//! let paths = recording.get("qpos").expect("it was recorded");
//! assert_eq!(paths.row(500)[19 * 7..], *batch.state.qpos.row(500));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # When something is wrong
//!
//! A mistake in a file is an error with its location, and bad input never panics.
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
//! | [`collide`] | shapes in, contact points, distances and ray hits out |
//! | [`rigid`] | models, dynamics, constraints, simulations and batches |
//! | [`formats`] | model files |
//! | `derivatives`, with the feature of that name | exact derivatives of a step |

pub use clench_collide as collide;
#[cfg(feature = "derivatives")]
pub use clench_derivatives as derivatives;
pub use clench_formats as formats;
pub use clench_math as math;
pub use clench_rigid as rigid;
pub use clench_solver as solver;

pub use clench_formats::{
    LoadError, Loader, SaveError, SaveModel, load, load_str, load_str_within, load_within,
};
pub use clench_rigid::batch::{Anchors, Controls, QueryInput};
pub use clench_rigid::model::FrameObject;
pub use clench_rigid::{
    Acceleration, Anchor, Axes, Batch, BatchOptions, Budget, DynamicConstraint, EnvStatus, Fault,
    Ik, IkOptions, IkSolution, IkStatus, IkTarget, IkTask, Model, Output, Place, Precision, Query,
    RayFilter, RayHit, RigidOptions, Sim, SimError, State,
};

#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;

/// The most common items: `use clench::prelude::*`.
pub mod prelude {
    pub use crate::{
        Batch, BatchOptions, Controls, EnvStatus, Fault, LoadError, Model, RigidOptions, SaveModel,
        Sim, SimError, State, load, load_str,
    };
    pub use clench_math::{Quat, Vec3};
    pub use clench_rigid::options::{ContactModel, FrictionCone, MaxContacts};
    pub use clench_solver::{ConstraintSolver, Switch};
}
