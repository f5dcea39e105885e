//! The arguments that all subcommands share: the model, and options that override the file's.

use crate::limits::{HEADING as LIMITS, positive};
use crate::message::print_message;
use crate::overrides::{HEADING, Overrides};
use anyhow::{Result, ensure};
use clap::Args;
use clench::{Budget, Loader, Model, RigidOptions, Sim};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The heading of the options of reading the model.
const READING: &str = "Reading the model";

/// The model file and the options of reading it.
#[derive(Args)]
pub(crate) struct ModelFile {
    /// Model file (MJCF or URDF)
    #[arg(help_heading = None)]
    pub model: PathBuf,
    /// Multiply the default limits of memory and work of the model by this factor
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = positive, help_heading = LIMITS)]
    budget: f64,
    /// A folder of packages, for meshes that URDF files name by `package://`; may be repeated
    #[arg(long, value_name = "FOLDER", help_heading = READING)]
    package_path: Vec<PathBuf>,
    /// Add a free joint to the base of a URDF robot, which its file fixes to the world
    #[arg(long, help_heading = READING)]
    floating: bool,
    /// Omit unsupported elements and attributes of an MJCF model that the others do not depend on, and list them
    #[arg(long, help_heading = READING)]
    ignore_unsupported: bool,
}

/// The model file and the options that override it.
#[derive(Args)]
pub(crate) struct ModelArguments {
    #[command(flatten)]
    pub file: ModelFile,
    #[command(flatten)]
    overrides: Overrides,
    /// Time step
    #[arg(long, value_name = "SECONDS", help_heading = HEADING)]
    timestep: Option<f64>,
}

impl ModelFile {
    /// Loads the model and prints the loader's notes to standard error.
    pub(crate) fn load(&self) -> Result<Model> {
        self.load_as_well(&self.model)
    }

    /// Loads another model in the same way.
    pub(crate) fn load_as_well(&self, path: &Path) -> Result<Model> {
        let loader = Loader::new()
            .budget(Budget::default().times(self.budget))
            .package_path(&self.package_path)
            .floating(self.floating)
            .ignore_unsupported(self.ignore_unsupported);
        let model = loader.load(path)?;
        for note in &model.notes {
            print_message(format_args!("note: {note}"));
        }
        for omitted in &model.omitted {
            print_message(format_args!("omitted: {omitted}"));
        }
        Ok(model)
    }
}

impl ModelArguments {
    /// Loads the model with the user's time step.
    pub(crate) fn load(&self) -> Result<(Arc<Model>, RigidOptions)> {
        Ok((self.timed(self.file.load()?)?, self.overrides.0))
    }

    /// Loads another model in the same way.
    pub(crate) fn load_as_well(&self, path: &Path) -> Result<Arc<Model>> {
        self.timed(self.file.load_as_well(path)?)
    }

    /// Gives a model the user's time step.
    fn timed(&self, mut model: Model) -> Result<Arc<Model>> {
        if let Some(timestep) = self.timestep {
            ensure!(
                timestep > 0.0 && timestep.is_finite(),
                "--timestep: {timestep} must be finite and positive"
            );
            model.params.timestep = timestep;
        }
        Ok(Arc::new(model))
    }

    /// Creates a simulation of one environment.
    pub(crate) fn sim(&self) -> Result<Sim> {
        let (model, options) = self.load()?;
        Ok(Sim::with_options(model, options)?)
    }
}
