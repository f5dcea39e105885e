//! `<include file="..."/>`: the children of another file's root, in place of the element.
//!
//! As in MuJoCo 4.0, a file is looked for in the directory of the main model, then in that of the including file, and
//! no file may appear twice, by whatever path; so includes cannot recurse.

use super::document::{self, Element, MAX_DEPTH};
use crate::LoadError;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Splices included files into the trees of a model.
pub(crate) struct Includes {
    model_directory: PathBuf,
    seen: HashSet<PathBuf>,
}

impl Includes {
    /// For a model in a file, or from text (`None`), whose includes are found from the working directory.
    pub fn new(model: Option<&Path>) -> Self {
        Includes {
            model_directory: model
                .and_then(Path::parent)
                .unwrap_or(Path::new(""))
                .to_owned(),
            seen: model
                .and_then(|path| path.canonicalize().ok())
                .into_iter()
                .collect(),
        }
    }

    /// Replaces every include below `element`, which itself was read from a file in `directory`.
    ///
    /// # Errors
    /// Where an included file is missing, unreadable, empty, broken, or included already.
    pub fn expand(
        &mut self,
        element: &mut Element,
        directory: &Path,
        depth: usize,
    ) -> Result<(), LoadError> {
        if depth > MAX_DEPTH {
            return Err(element.error(document::too_deep()));
        }
        let mut expanded = Vec::with_capacity(element.children.len());
        for mut child in std::mem::take(&mut element.children) {
            if child.tag == "include" {
                expanded.extend(self.include(&child, directory, depth)?);
            } else {
                self.expand(&mut child, directory, depth + 1)?;
                expanded.push(child);
            }
        }
        element.children = expanded;
        Ok(())
    }

    fn include(
        &mut self,
        element: &Element,
        directory: &Path,
        depth: usize,
    ) -> Result<Vec<Element>, LoadError> {
        if !element.children.is_empty() {
            return Err(element.error("an include cannot have children"));
        }
        let name = element.required_text("file")?;
        let path = [self.model_directory.join(name), directory.join(name)]
            .into_iter()
            .find(|path| path.is_file())
            .ok_or_else(|| element.error(format!("cannot find the file \"{name}\"")))?;
        let unreadable =
            |error| element.error(format!("cannot read \"{}\": {error}", path.display()));
        if !self.seen.insert(path.canonicalize().map_err(unreadable)?) {
            return Err(element.error(format!("\"{name}\" is already included")));
        }
        let bytes = std::fs::read(&path).map_err(unreadable)?;
        let mut root = document::parse(&bytes, &Arc::from(path.to_string_lossy()))?;
        if root.children.is_empty() {
            return Err(element.error(format!("\"{name}\" holds no elements to include")));
        }
        self.expand(&mut root, path.parent().unwrap_or(Path::new("")), depth)?;
        Ok(root.children)
    }
}
