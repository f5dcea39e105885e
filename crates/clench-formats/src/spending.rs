//! A model's files, on disk or in memory, and their budget.

use clench_dynamics::Budget;
use clench_dynamics::budget::RAISE;
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Files in memory, by lower-case base name; they take precedence over those on disk.
pub(crate) type Memory = HashMap<String, Vec<u8>>;

/// Returns the name of a file in memory: as in MuJoCo, folders and letter case are ignored.
pub(crate) fn memory_name(path: &Path) -> String {
    let text = path.to_string_lossy().replace('\\', "/");
    let last = text.rsplit('/').next().unwrap_or_default();
    last.to_lowercase()
}

/// A budget and its consumption so far.
#[derive(Clone, Debug)]
pub(crate) struct Spending {
    pub budget: Budget,
    memory: Arc<Memory>,
    bytes: u64,
    elements: u64,
}

impl Spending {
    /// Creates an unused budget.
    pub(crate) fn new(budget: Budget, memory: Arc<Memory>) -> Self {
        Spending {
            budget,
            memory,
            bytes: 0,
            elements: 0,
        }
    }

    /// Counts memory against the budget, before it is allocated.
    ///
    /// # Errors
    /// Returns a message if it exceeds the budget.
    pub(crate) fn bytes(&mut self, count: u64) -> Result<(), String> {
        self.bytes = self.bytes.saturating_add(count);
        let limit = self.budget.bytes;
        match self.bytes > limit {
            true => Err(format!(
                "up to here the model takes more than {limit} bytes; {RAISE}"
            )),
            false => Ok(()),
        }
    }

    /// Counts elements against the budget.
    ///
    /// # Errors
    /// Returns a message if they exceed the budget.
    pub(crate) fn elements(&mut self, count: u64) -> Result<(), String> {
        self.elements = self.elements.saturating_add(count);
        let limit = self.budget.elements;
        match self.elements > limit {
            true => Err(format!(
                "up to here the model has more than {limit} elements; {RAISE}"
            )),
            false => Ok(()),
        }
    }

    /// Returns true if the file exists.
    pub(crate) fn has_file(&self, path: &Path) -> bool {
        self.memory.contains_key(&memory_name(path)) || path.is_file()
    }

    /// Returns a unique identity of a file, independent of the path to it.
    ///
    /// # Errors
    /// Returns a message if the file does not exist.
    pub(crate) fn identity(&self, path: &Path) -> Result<PathBuf, String> {
        let name = memory_name(path);
        match self.memory.contains_key(&name) {
            true => Ok(PathBuf::from(name)),
            false => path.canonicalize().map_err(|error| error.to_string()),
        }
    }

    /// Reads a file and counts its length against the budget.
    ///
    /// # Errors
    /// Returns a message if it is unreadable or too long.
    pub(crate) fn read(&mut self, path: &Path) -> Result<Vec<u8>, String> {
        if let Some(bytes) = self.memory.clone().get(&memory_name(path)) {
            self.bytes(bytes.len() as u64)?;
            return Ok(bytes.clone());
        }
        let read = || -> io::Result<Vec<u8>> {
            let remaining = self.budget.bytes.saturating_sub(self.bytes);
            let mut bytes = Vec::new();
            File::open(path)?
                .take(remaining.saturating_add(1))
                .read_to_end(&mut bytes)?;
            Ok(bytes)
        };
        let bytes = read().map_err(|error| error.to_string())?;
        self.bytes(bytes.len() as u64)?;
        Ok(bytes)
    }
}
