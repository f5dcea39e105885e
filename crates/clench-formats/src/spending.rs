//! A model's files, on disk or in memory, and what they have asked for so far, held against their budget.

use clench_dynamics::Budget;
use clench_dynamics::budget::RAISE;
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Files in memory, by the last part of their names in small letters; they go before those on disk.
pub(crate) type Memory = HashMap<String, Vec<u8>>;

/// What a file in memory is called: as in MuJoCo, neither folders nor capitals count.
pub(crate) fn memory_name(path: &Path) -> String {
    let text = path.to_string_lossy().replace('\\', "/");
    let last = text.rsplit('/').next().unwrap_or_default();
    last.to_lowercase()
}

/// A budget and what has been taken from it.
#[derive(Clone, Debug)]
pub(crate) struct Spending {
    pub budget: Budget,
    memory: Arc<Memory>,
    bytes: u64,
    elements: u64,
}

impl Spending {
    /// Nothing taken yet.
    pub(crate) fn new(budget: Budget, memory: Arc<Memory>) -> Self {
        Spending {
            budget,
            memory,
            bytes: 0,
            elements: 0,
        }
    }

    /// Takes memory, before it is allocated.
    ///
    /// # Errors
    /// What to say where it is more than is left.
    pub(crate) fn bytes(&mut self, count: u64) -> Result<(), String> {
        self.bytes = self.bytes.saturating_add(count);
        let most = self.budget.bytes;
        match self.bytes > most {
            true => Err(format!(
                "up to here the model takes more than {most} bytes; {RAISE}"
            )),
            false => Ok(()),
        }
    }

    /// Takes elements.
    ///
    /// # Errors
    /// What to say where they are more than are left.
    pub(crate) fn elements(&mut self, count: u64) -> Result<(), String> {
        self.elements = self.elements.saturating_add(count);
        let most = self.budget.elements;
        match self.elements > most {
            true => Err(format!(
                "up to here the model has more than {most} elements; {RAISE}"
            )),
            false => Ok(()),
        }
    }

    /// Whether there is a file.
    pub(crate) fn has_file(&self, path: &Path) -> bool {
        self.memory.contains_key(&memory_name(path)) || path.is_file()
    }

    /// What tells a file from others, whatever path leads to it.
    ///
    /// # Errors
    /// What to say where there is no such file.
    pub(crate) fn identity(&self, path: &Path) -> Result<PathBuf, String> {
        let name = memory_name(path);
        match self.memory.contains_key(&name) {
            true => Ok(PathBuf::from(name)),
            false => path.canonicalize().map_err(|error| error.to_string()),
        }
    }

    /// Reads a file, and takes its length.
    ///
    /// # Errors
    /// What to say where it cannot be read or is too long.
    pub(crate) fn read(&mut self, path: &Path) -> Result<Vec<u8>, String> {
        if let Some(bytes) = self.memory.clone().get(&memory_name(path)) {
            self.bytes(bytes.len() as u64)?;
            return Ok(bytes.clone());
        }
        let read = || -> io::Result<Vec<u8>> {
            let left = self.budget.bytes.saturating_sub(self.bytes);
            let mut bytes = Vec::new();
            File::open(path)?
                .take(left.saturating_add(1))
                .read_to_end(&mut bytes)?;
            Ok(bytes)
        };
        let bytes = read().map_err(|error| error.to_string())?;
        self.bytes(bytes.len() as u64)?;
        Ok(bytes)
    }
}
