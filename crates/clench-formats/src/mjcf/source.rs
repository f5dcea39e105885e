//! Settings for reading the files of a model: an attached model retains its own units, directories, default classes and
//! rules for inertia.

use super::compiler::{self, CompilerOptions};
use super::defaults::Classes;
use super::files::Files;
use super::sections::sections;
use crate::document::Element;
use crate::error::LoadError;
use crate::spending::Spending;
use clench_builder::CompilerSpec;
use std::path::Path;
use std::sync::Arc;

/// A model's own settings, for its elements wherever attached.
#[derive(Debug)]
pub(crate) struct Source {
    pub compiler: CompilerOptions,
    /// The settings used when the model is built.
    pub spec: Arc<CompilerSpec>,
    pub classes: Classes,
    pub files: Files,
}

/// The settings of the main model, which come first, and those of attached models.
#[derive(Debug, Default)]
pub(crate) struct Sources(Vec<Source>);

impl Sources {
    /// Reads a model's settings, assigns them to its elements, and returns their index.
    pub(super) fn add(
        &mut self,
        root: &mut Element,
        directory: &Path,
        spending: &mut Spending,
    ) -> Result<usize, LoadError> {
        let (mut compiler, mut spec) = (CompilerOptions::default(), CompilerSpec::default());
        for section in sections(root, "compiler") {
            compiler::read(section, &mut compiler, &mut spec)?;
        }
        let mut classes = Classes::default();
        for section in sections(root, "default") {
            classes.read(section, spending)?;
        }
        let index = self.0.len();
        root.set_source(index);
        self.0.push(Source {
            files: Files::new(directory, &compiler),
            compiler,
            spec: Arc::new(spec),
            classes,
        });
        Ok(index)
    }

    /// Returns the main model's settings.
    pub(super) fn main(&self) -> &Source {
        &self.0[0]
    }

    /// Returns the settings for an element.
    pub(super) fn of(&self, element: &Element) -> &Source {
        &self.0[element.source]
    }

    /// Lets elements of one model refer to the classes of another by their prefixed names.
    ///
    /// # Errors
    /// Returns a message if the names exceed the memory budget.
    pub(super) fn lend_classes(
        &mut self,
        from: usize,
        to: usize,
        prefix: &str,
        spending: &mut Spending,
    ) -> Result<(), String> {
        if from == to {
            return Ok(());
        }
        let lent = self.0[from].classes.prefixed(prefix, spending)?;
        self.0[to].classes.borrow(lent);
        Ok(())
    }

    /// Decides whether a range limits, for an element whose model's `autolimits` differs from the main model's.
    ///
    /// # Errors
    /// Returns an error if `autolimits` is off and the flag of a range is missing.
    pub(super) fn resolve_limit(
        &self,
        element: &Element,
        what: &str,
        range: [f64; 2],
        limited: &mut Option<bool>,
    ) -> Result<(), LoadError> {
        let own = self.of(element).spec.autolimits;
        if own == self.main().spec.autolimits || limited.is_some() || range == [0.0; 2] {
            return Ok(());
        }
        if !own {
            return Err(element.error(format!(
                "has a {what}range, but does not say whether it is {what}limited, and autolimits is off"
            )));
        }
        *limited = Some(range[0] < range[1]);
        Ok(())
    }
}
