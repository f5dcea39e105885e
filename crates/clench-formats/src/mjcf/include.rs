//! `<include file="..."/>`: replaced by the children of another file's root.
//!
//! As in MuJoCo 4.0, a file is looked up in the directory of the main model, then in that of the including file, and no
//! file may appear twice, by any path; so includes cannot recurse.

use crate::document::{self, Element, MAX_DEPTH};
use crate::error::LoadError;
use crate::spending::Spending;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

/// The state of splicing included files into a model.
pub(crate) struct Includes {
    model_directory: PathBuf,
    seen: HashSet<PathBuf>,
}

impl Includes {
    /// Creates the state for a model in a file, or from text (`None`), with includes resolved from the working
    /// directory.
    pub(super) fn new(model: Option<&Path>, spending: &Spending) -> Self {
        Includes {
            model_directory: model
                .and_then(Path::parent)
                .unwrap_or(Path::new(""))
                .to_owned(),
            seen: model
                .and_then(|path| spending.identity(path).ok())
                .into_iter()
                .collect(),
        }
    }

    /// Replaces every include below `root`, which was read from a file in `directory`.
    ///
    /// # Errors
    /// Returns an error if a file is missing, unreadable, empty, malformed, or already included.
    pub(super) fn expand(
        &mut self,
        root: &mut Element,
        directory: &Path,
        spending: &mut Spending,
    ) -> Result<(), LoadError> {
        // The open lists of children, outermost first.
        let mut open = vec![Siblings::of(root, directory.into(), 1)];
        while let Some(siblings) = open.last_mut() {
            let Some(mut child) = siblings.remaining.next() else {
                let done = std::mem::take(&mut siblings.done);
                let owner = siblings.owner.take();
                open.pop();
                match (owner, open.last_mut()) {
                    // The content of an included file replaces the include.
                    (None, Some(around)) => around.done.extend(done),
                    (Some(mut element), Some(around)) => {
                        element.children = done;
                        around.done.push(element);
                    }
                    (_, None) => root.children = done,
                }
                continue;
            };
            let (directory, depth) = (siblings.directory.clone(), siblings.depth);
            if child.tag == "include" {
                let (mut included, directory) = self.include(&child, &directory, spending)?;
                open.push(Siblings::of(&mut included, directory, depth));
                continue;
            }
            if depth >= MAX_DEPTH {
                return Err(child.error(document::too_deep()));
            }
            let inside = Siblings::of(&mut child, directory, depth + 1);
            open.push(Siblings {
                owner: Some(child),
                ..inside
            });
        }
        Ok(())
    }

    /// Returns the root of the file that an include names, and the file's directory.
    fn include(
        &mut self,
        element: &Element,
        directory: &Path,
        spending: &mut Spending,
    ) -> Result<(Element, Rc<Path>), LoadError> {
        if !element.children.is_empty() {
            return Err(element.error("an include cannot have children"));
        }
        let name = element.required_text("file")?;
        let path = [self.model_directory.join(name), directory.join(name)]
            .into_iter()
            .find(|path| spending.has_file(path))
            .ok_or_else(|| element.error(format!("cannot find the file \"{name}\"")))?;
        let unreadable =
            |error: String| element.error(format!("cannot read \"{}\": {error}", path.display()));
        let identity = spending.identity(&path).map_err(unreadable)?;
        if !self.seen.insert(identity) {
            return Err(element.error(format!("\"{name}\" is already included")));
        }
        let bytes = spending.read(&path).map_err(unreadable)?;
        let root = document::parse(&bytes, &Arc::from(path.to_string_lossy()), spending)?;
        if root.children.is_empty() {
            return Err(element.error(format!("\"{name}\" holds no elements to include")));
        }
        Ok((root, path.parent().unwrap_or(Path::new("")).into()))
    }
}

/// The children of an element while includes among them are replaced.
struct Siblings {
    /// The element; `None` for the root of a file, of which only the children are used.
    owner: Option<Element>,
    remaining: std::vec::IntoIter<Element>,
    done: Vec<Element>,
    /// The directory of the file that they were read from.
    directory: Rc<Path>,
    /// The depth of their parent; the root is at 1.
    depth: usize,
}

impl Siblings {
    /// Takes the children of an element.
    fn of(element: &mut Element, directory: Rc<Path>, depth: usize) -> Self {
        Siblings {
            owner: None,
            remaining: std::mem::take(&mut element.children).into_iter(),
            done: Vec::new(),
            directory,
            depth,
        }
    }
}
