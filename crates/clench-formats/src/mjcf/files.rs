//! Files that a model refers to: meshes, height fields and textures.
//!
//! As in MuJoCo, a path is relative to `meshdir` (for a texture `texturedir`), which is relative to the model's
//! directory. A file named in an included file is also looked up in `meshdir` under the path from the model to that
//! file.

use super::compiler::CompilerOptions;
use crate::document::Element;
use crate::error::LoadError;
use crate::spending::Spending;
use std::path::{Path, PathBuf};

/// The folders of a model's files.
#[derive(Debug)]
pub(crate) struct Files {
    pub model_directory: PathBuf,
    meshes: PathBuf,
    textures: PathBuf,
    strippath: bool,
}

/// The bytes of a file, and its name.
pub(crate) struct Content {
    /// The name without directory and extension.
    pub stem: String,
    /// The extension without the dot.
    pub extension: String,
    pub bytes: Vec<u8>,
    path: PathBuf,
}

impl Files {
    /// Creates the paths of a model in a directory.
    pub(crate) fn new(model_directory: &Path, compiler: &CompilerOptions) -> Self {
        Files {
            model_directory: model_directory.to_owned(),
            meshes: model_directory.join(slashes(&compiler.meshdir)),
            textures: model_directory.join(slashes(&compiler.texturedir)),
            strippath: compiler.strippath,
        }
    }

    /// Reads the file of a mesh or height field, if the element names one.
    pub(crate) fn read(
        &self,
        element: &Element,
        spending: &mut Spending,
    ) -> Result<Option<Content>, LoadError> {
        self.find(&self.meshes, element, "file", spending)
    }

    /// Reads the texture file that an attribute names, if any.
    pub(crate) fn texture(
        &self,
        element: &Element,
        attribute: &str,
        spending: &mut Spending,
    ) -> Result<Option<Content>, LoadError> {
        self.find(&self.textures, element, attribute, spending)
    }

    fn find(
        &self,
        folder: &Path,
        element: &Element,
        attribute: &str,
        spending: &mut Spending,
    ) -> Result<Option<Content>, LoadError> {
        let Some(name) = element.text(attribute).filter(|name| !name.is_empty()) else {
            return Ok(None);
        };
        let name = slashes(name);
        let name = match (self.strippath, Path::new(&name).file_name()) {
            (true, Some(last)) => PathBuf::from(last),
            _ => PathBuf::from(&name),
        };
        let mut places = vec![folder.join(&name)];
        let written = Path::new(&*element.origin.file).parent();
        let below = written.and_then(|file| file.strip_prefix(&self.model_directory).ok());
        places.extend(below.map(|below| folder.join(below).join(&name)));
        let found = places.iter().find(|path| spending.has_file(path));
        let path = found.ok_or_else(|| {
            element.error(format!("cannot find the file \"{}\"", places[0].display()))
        })?;
        Content::open(path.clone(), element, spending).map(Some)
    }
}

impl Content {
    /// Reads the file at a path, for an element that names it.
    pub(crate) fn open(
        path: PathBuf,
        element: &Element,
        spending: &mut Spending,
    ) -> Result<Self, LoadError> {
        let unreadable =
            |error: String| element.error(format!("cannot read \"{}\": {error}", path.display()));
        let bytes = spending.read(&path).map_err(unreadable)?;
        let part = |part: Option<&std::ffi::OsStr>| {
            part.map(|text| text.to_string_lossy().into_owned())
                .unwrap_or_default()
        };
        Ok(Content {
            stem: part(path.file_stem()),
            extension: part(path.extension()),
            bytes,
            path,
        })
    }

    /// Returns the folder of the file.
    pub(crate) fn directory(&self) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).to_owned()
    }

    /// Parses the bytes with a reader; adds the file and the element to its errors.
    pub(crate) fn parse<T>(
        &mut self,
        element: &Element,
        reader: impl FnOnce(Vec<u8>) -> Result<T, String>,
    ) -> Result<T, LoadError> {
        reader(std::mem::take(&mut self.bytes))
            .map_err(|message| element.error(format!("\"{}\": {message}", self.path.display())))
    }
}

/// Converts a path that may be written as on Windows.
pub(crate) fn slashes(path: &str) -> String {
    path.replace('\\', "/")
}
