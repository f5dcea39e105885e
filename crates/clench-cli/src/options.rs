//! What all subcommands share: the model, and options that override the file's.

use crate::message::tell;
use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use clench::prelude::{ConstraintSolver, FrictionCone, MaxContacts, Switch};
use clench::{Budget, Loader, Model, RigidOptions, Sim};
use std::path::PathBuf;
use std::sync::Arc;

/// A model file, and how it is read.
#[derive(Args)]
pub struct ModelFile {
    /// Model file (MJCF or URDF)
    #[arg(help_heading = "Arguments")]
    pub model: PathBuf,
    /// Allow the model this many times the usual memory and work
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    budget: f64,
    /// A folder that holds packages, of which URDF files name meshes by `package://`; may be repeated
    #[arg(long, value_name = "FOLDER")]
    package_path: Vec<PathBuf>,
    /// Leave out of an MJCF model what is not supported yet and what the rest can do without, and say what
    #[arg(long)]
    ignore_unsupported: bool,
}

/// The model file and the options that override it.
#[derive(Args)]
pub struct ModelArguments {
    #[command(flatten)]
    pub file: ModelFile,
    #[command(flatten)]
    overrides: Overrides,
}

/// Options that override the file's `<option>`; what is not given stays as the file says.
#[derive(Args)]
#[command(next_help_heading = "Options that override the file")]
struct Overrides {
    /// Constraint solver
    #[arg(long, ignore_case = true)]
    solver: Option<SolverName>,
    /// Stop when gradient and improvement (CG: the duality gap), scaled by inertia, are below this
    #[arg(long, value_name = "X")]
    tolerance: Option<f64>,
    /// Most solver iterations a step
    #[arg(long, value_name = "N")]
    iterations: Option<usize>,
    /// Most line-search evaluations a solver iteration
    #[arg(long, value_name = "N")]
    ls_iterations: Option<usize>,
    /// Slope at which a line search stops, relative to the tolerance
    #[arg(long, value_name = "X")]
    ls_tolerance: Option<f64>,
    /// Most sweeps that remove creep from friction after the solve
    #[arg(long, value_name = "N")]
    noslip_iterations: Option<usize>,
    /// Sweeps stop where their improvement, scaled by inertia, is below this
    #[arg(long, value_name = "X")]
    noslip_tolerance: Option<f64>,
    /// Friction cone
    #[arg(long, ignore_case = true)]
    cone: Option<ConeName>,
    /// Ratio of friction to normal impedance of elliptic contacts
    #[arg(long, value_name = "X")]
    impratio: Option<f64>,
    /// Sparse or dense Hessian
    #[arg(long, ignore_case = true)]
    sparse: Option<SwitchName>,
    /// Solve uncoupled groups of bodies separately
    #[arg(long, ignore_case = true)]
    islands: Option<SwitchName>,
    /// Least time constant of any constraint
    #[arg(long, value_name = "SECONDS")]
    constraint_timeconst: Option<f64>,
    /// Most contacts a step; a step that finds more says so
    #[arg(long, value_name = "N")]
    max_contacts: Option<usize>,
    /// Ignore joint limits
    #[arg(long)]
    no_joint_limit: bool,
    /// Ignore all constraints
    #[arg(long)]
    no_constraint: bool,
    /// Start each solve from the unconstrained acceleration
    #[arg(long)]
    no_warmstart: bool,
    /// Go on from the initial state when the simulation diverges, and say how often
    #[arg(long)]
    autoreset: bool,
    /// Time step
    #[arg(long, value_name = "SECONDS")]
    timestep: Option<f64>,
}

#[derive(Clone, Copy, ValueEnum)]
enum SolverName {
    Newton,
    Cg,
}

#[derive(Clone, Copy, ValueEnum)]
enum ConeName {
    Pyramidal,
    Elliptic,
}

#[derive(Clone, Copy, ValueEnum)]
enum SwitchName {
    Auto,
    On,
    Off,
}

impl From<SwitchName> for Switch {
    fn from(name: SwitchName) -> Switch {
        match name {
            SwitchName::Auto => Switch::Auto,
            SwitchName::On => Switch::On,
            SwitchName::Off => Switch::Off,
        }
    }
}

impl ModelFile {
    /// Loads the model, and says on standard error what the loader wants known.
    pub fn load(&self) -> Result<Model> {
        let loader = Loader::new()
            .budget(Budget::default().times(self.budget))
            .package_path(&self.package_path)
            .ignore_unsupported(self.ignore_unsupported);
        let model = loader.load(&self.model)?;
        for note in &model.notes {
            tell(format_args!("note: {note}"));
        }
        for left_out in &model.left_out {
            tell(format_args!("left out: {left_out}"));
        }
        Ok(model)
    }
}

impl ModelArguments {
    /// Loads the model with the user's time step.
    pub fn load(&self) -> Result<(Arc<Model>, RigidOptions)> {
        let mut model = self.file.load()?;
        if let Some(timestep) = self.overrides.timestep {
            ensure!(
                timestep > 0.0 && timestep.is_finite(),
                "--timestep: {timestep} is not a positive number of seconds"
            );
            model.params.timestep = timestep;
        }
        Ok((Arc::new(model), self.overrides.options()))
    }

    /// A simulation of one environment.
    pub fn sim(&self) -> Result<Sim> {
        let (model, options) = self.load()?;
        Ok(Sim::with_options(model, options)?)
    }
}

impl Overrides {
    fn options(&self) -> RigidOptions {
        RigidOptions {
            constraint_solver: self.solver.map(|s| match s {
                SolverName::Newton => ConstraintSolver::Newton,
                SolverName::Cg => ConstraintSolver::Cg,
            }),
            friction_cone: self.cone.map(|c| match c {
                ConeName::Pyramidal => FrictionCone::Pyramidal,
                ConeName::Elliptic => FrictionCone::Elliptic,
            }),
            tolerance: self.tolerance,
            iterations: self.iterations,
            ls_iterations: self.ls_iterations,
            ls_tolerance: self.ls_tolerance,
            noslip_iterations: self.noslip_iterations,
            noslip_tolerance: self.noslip_tolerance,
            impratio: self.impratio,
            sparse_solve: self.sparse.map(Switch::from),
            islands: self.islands.map(Switch::from),
            constraint_timeconst: self.constraint_timeconst,
            max_contacts: self.max_contacts.map(MaxContacts::Limit),
            enable_joint_limit: self.no_joint_limit.then_some(false),
            disable_constraint: self.no_constraint.then_some(true),
            warmstart: self.no_warmstart.then_some(false),
            autoreset: self.autoreset.then_some(true),
        }
    }
}
