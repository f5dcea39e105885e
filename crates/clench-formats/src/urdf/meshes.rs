//! `<mesh>`: file lookup and sharing of equal meshes.

use crate::document::Element;
use crate::error::LoadError;
use crate::mesh::{self, Format, MeshFolder, Objects};
use crate::mjcf::compiler::CompilerOptions;
use crate::mjcf::files::{Content, slashes};
use crate::spending::Spending;
use clench_builder::MeshSpec;
use clench_math::Vec3;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// The prefixes of a package name.
const PACKAGE: [&str; 2] = ["package://", "model://"];

/// The meshes of a robot.
pub(super) struct Meshes<'a> {
    directory: &'a Path,
    packages: &'a [PathBuf],
    meshdir: PathBuf,
    strippath: bool,
    pub found: Vec<MeshSpec>,
    /// The names of the meshes in `found`, by file and scale.
    names_by_file: HashMap<(PathBuf, [u64; 3]), String>,
    names: HashSet<String>,
}

impl<'a> Meshes<'a> {
    /// Creates the meshes of a robot in a directory.
    pub(super) fn new(
        directory: &'a Path,
        packages: &'a [PathBuf],
        compiler: &CompilerOptions,
    ) -> Self {
        Meshes {
            directory,
            packages,
            meshdir: directory.join(slashes(&compiler.meshdir)),
            strippath: compiler.strippath,
            found: Vec::new(),
            names_by_file: HashMap::new(),
            names: HashSet::new(),
        }
    }

    /// Reads the mesh of an element, once per file and scale, and returns its name.
    ///
    /// # Errors
    /// Returns an error if the file is missing or not a mesh.
    pub(super) fn read(
        &mut self,
        element: &Element,
        spending: &mut Spending,
    ) -> Result<String, LoadError> {
        let written = decoded(slashes(element.required_text("filename")?));
        let scale: [f64; 3] = element.numbers("scale")?.unwrap_or([1.0; 3]);
        let path = self.find(&written).map_err(|why| element.error(why))?;
        let key = (path.clone(), scale.map(f64::to_bits));
        if let Some(name) = self.names_by_file.get(&key) {
            return Ok(name.clone());
        }
        let mut file = Content::open(path, element, spending)?;
        let format = Format::from_extension(&file.extension).ok_or_else(|| {
            element.error(format!(
                "\"{written}\" is not a readable mesh: its name must end in .stl, .obj, .dae, .glb, .gltf or .msh"
            ))
        })?;
        let directory = file.directory();
        let mut mesh_folder = MeshFolder {
            directory: &directory,
            spending,
        };
        let triangles = file.parse(element, |bytes| {
            mesh::read(bytes, format, Objects::All, &mut mesh_folder)
        })?;
        spending
            .bytes(mesh::cost(&triangles))
            .map_err(|excess| element.error(excess))?;
        let name = self.name(&file.stem);
        self.names_by_file.insert(key, name.clone());
        self.found.push(MeshSpec {
            name: name.clone(),
            vertices: triangles.vertices,
            faces: triangles.faces,
            tangents: triangles.tangents,
            texcoords: triangles.texcoords,
            face_texcoords: triangles.face_texcoords,
            scale: Vec3::from_array(scale),
            origin: Some(element.origin.clone()),
            ..MeshSpec::default()
        });
        Ok(name)
    }

    /// Returns the name of the file, with a number if it is taken.
    fn name(&mut self, stem: &str) -> String {
        let numbered = (1..).map(|number| format!("{stem}{number}"));
        let mut names = std::iter::once(stem.to_owned()).chain(numbered);
        let free = names.find(|name| !self.names.contains(name));
        let name = free.unwrap_or_default();
        self.names.insert(name.clone());
        name
    }

    /// Returns the file that a written path refers to.
    fn find(&self, written: &str) -> Result<PathBuf, String> {
        if self.strippath {
            let last = Path::new(written).file_name().unwrap_or_default();
            return first_file([self.meshdir.join(last)], written);
        }
        if let Some(absolute) = written.strip_prefix("file://") {
            return first_file([PathBuf::from(absolute)], written);
        }
        let package = PACKAGE
            .iter()
            .find_map(|prefix| written.strip_prefix(prefix));
        let Some(inside) = package else {
            let places = self.packages.iter().map(|folder| folder.join(written));
            return first_file(
                [self.meshdir.join(written)].into_iter().chain(places),
                written,
            );
        };
        // Some files write three slashes.
        let inside = inside.trim_start_matches('/');
        let (name, rest) = inside.split_once('/').unwrap_or(("", inside));
        let start = self.directory.canonicalize().unwrap_or_default();
        let start = match self.directory.as_os_str().is_empty() {
            true => std::env::current_dir().unwrap_or_default(),
            false => start,
        };
        let folders = self.packages.iter().map(PathBuf::as_path);
        let places = folders.chain(start.ancestors()).flat_map(|folder| {
            let itself = folder.file_name().is_some_and(|last| last == name);
            let itself = itself.then(|| folder.join(rest));
            [Some(folder.join(inside)), itself].into_iter().flatten()
        });
        first_file(places, written).map_err(|error| {
            format!(
                "{error}: add the folder of the package \"{name}\" to the package path, or put it next to or above the model"
            )
        })
    }
}

/// Decodes a URI: each `%` with two hexadecimal digits stands for a byte. Other texts, and those that would not be
/// UTF-8, are unchanged.
fn decoded(written: String) -> String {
    if !written.contains("://") {
        return written;
    }
    let mut bytes = Vec::with_capacity(written.len());
    let mut rest = written.as_bytes();
    while let [first, after @ ..] = rest {
        let digit = |at: usize| char::from(*after.get(at)?).to_digit(16);
        let escaped = (digit(0).zip(digit(1))).filter(|_| *first == b'%');
        let (byte, used) = escaped.map_or((*first, 0), |(a, b)| ((16 * a + b) as u8, 2));
        bytes.push(byte);
        rest = &after[used..];
    }
    String::from_utf8(bytes).unwrap_or(written)
}

/// Returns the first path at which a file exists.
fn first_file(places: impl IntoIterator<Item = PathBuf>, written: &str) -> Result<PathBuf, String> {
    let mut places = places.into_iter();
    let found = places.find(|path| path.is_file());
    found.ok_or_else(|| format!("cannot find the file \"{written}\""))
}
