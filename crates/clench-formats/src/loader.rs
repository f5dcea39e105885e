//! Model loading: reads the bytes, detects the format and configures its reader.

use crate::document;
use crate::error::LoadError;
use crate::spending::{Memory, Spending, memory_name};
use crate::{mjcf, urdf};
use clench_builder::ModelBuilder;
use clench_dynamics::{Budget, Model};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A loader of model files: its [`Budget`], the package folders of URDF files, the files in memory, and whether
/// unsupported elements may be omitted.
///
/// ```no_run
/// let model = clench_formats::Loader::new()
///     .package_path(["/opt/ros/jazzy/share", "robots"])
///     .load("robots/arm_description/urdf/arm.urdf")?;
/// # Ok::<(), clench_formats::LoadError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Loader {
    budget: Budget,
    packages: Vec<PathBuf>,
    floating: bool,
    ignore_unsupported: bool,
    memory: Arc<Memory>,
}

impl Loader {
    /// Creates a loader with the default budget and no packages.
    pub fn new() -> Self {
        Loader::default()
    }

    /// Sets the limit on memory and work.
    #[must_use]
    pub fn budget(mut self, budget: Budget) -> Self {
        self.budget = budget;
        self
    }

    /// Adds package folders: `package://NAME/REST` is the file `NAME/REST` in the first folder that has it, or `REST`
    /// in a folder that is itself called `NAME`. The model's folder and its ancestors are searched last, in the same
    /// way.
    #[must_use]
    pub fn package_path<P: Into<PathBuf>>(mut self, folders: impl IntoIterator<Item = P>) -> Self {
        self.packages.extend(folders.into_iter().map(Into::into));
        self
    }

    /// Frees the base of a URDF robot: the link fixed to the world gets a free joint, `floating_base`, and retains its
    /// name, pose and inertia. A base with a free joint is unchanged. An MJCF model is rejected: its file says
    /// `<freejoint/>`.
    ///
    /// ```
    /// let robot = "<robot name='box'><link name='trunk'><inertial><mass value='2'/>
    ///   <inertia ixx='0.1' iyy='0.1' izz='0.1' ixy='0' ixz='0' iyz='0'/></inertial></link></robot>";
    /// assert_eq!(clench_formats::Loader::new().floating(true).load_str(robot)?.nv, 6);
    /// # Ok::<(), clench_formats::LoadError>(())
    /// ```
    #[must_use]
    pub fn floating(mut self, floating: bool) -> Self {
        self.floating = floating;
        self
    }

    /// Omits unsupported elements of an MJCF model if the remainder keeps its meaning: plugins, deformable bodies,
    /// sensors, forces and flags, but no joint, tendon or actuator. `omitted` of the model lists them.
    #[must_use]
    pub fn ignore_unsupported(mut self, ignore: bool) -> Self {
        self.ignore_unsupported = ignore;
        self
    }

    /// Adds files in memory, by name: meshes, height fields, included and attached models. As in MuJoCo, folders and
    /// letter case of a name are ignored, and these files take precedence over those on disk.
    ///
    /// ```
    /// let tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4";
    /// let model = clench_formats::Loader::new()
    ///     .assets([("tetrahedron.obj", tetrahedron)])
    ///     .load_str(
    ///         "<mujoco>
    ///            <asset><mesh file='tetrahedron.obj'/></asset>
    ///            <worldbody><geom type='mesh' mesh='tetrahedron'/></worldbody>
    ///          </mujoco>",
    ///     )?;
    /// assert_eq!(model.meshes.len(), 1);
    /// # Ok::<(), clench_formats::LoadError>(())
    /// ```
    #[must_use]
    pub fn assets<N: AsRef<Path>, B: Into<Vec<u8>>>(
        mut self,
        files: impl IntoIterator<Item = (N, B)>,
    ) -> Self {
        let files = files.into_iter();
        let named = files.map(|(name, bytes)| (memory_name(name.as_ref()), bytes.into()));
        Arc::make_mut(&mut self.memory).extend(named);
        self
    }

    /// Loads a model file, MJCF or URDF; the root element determines the format.
    ///
    /// # Errors
    /// See [`load`](crate::load).
    pub fn load(&self, path: impl AsRef<Path>) -> Result<Model, LoadError> {
        let path = path.as_ref();
        self.read(path)?.build().map_err(|error| {
            let mut error = LoadError::from(error);
            if error.line.is_none() {
                error.file = path.to_string_lossy().into();
            }
            error
        })
    }

    /// Loads a model from text; other files are resolved from the working directory.
    ///
    /// # Errors
    /// See [`load`](crate::load); the file name of an error is empty.
    pub fn load_str(&self, text: &str) -> Result<Model, LoadError> {
        Ok(self.read_str(text)?.build()?)
    }

    /// Reads a model file into a builder, before anything is computed.
    ///
    /// # Errors
    /// See [`read`](crate::read).
    pub fn read(&self, path: impl AsRef<Path>) -> Result<ModelBuilder, LoadError> {
        let path = path.as_ref();
        let file = Arc::from(path.to_string_lossy());
        let mut spending = Spending::new(self.budget, self.memory.clone());
        let unreadable = |error| LoadError::file(&file, format!("cannot read the file: {error}"));
        let bytes = spending.read(path).map_err(unreadable)?;
        self.read_bytes(&bytes, &file, Some(path), &mut spending)
    }

    /// Reads a model from text, like [`read`](Self::read); other files are resolved from the working directory.
    ///
    /// # Errors
    /// See [`read`](crate::read); the file name of an error is empty.
    pub fn read_str(&self, text: &str) -> Result<ModelBuilder, LoadError> {
        let mut spending = Spending::new(self.budget, self.memory.clone());
        self.read_bytes(text.as_bytes(), &Arc::from(""), None, &mut spending)
    }

    fn read_bytes(
        &self,
        bytes: &[u8],
        file: &Arc<str>,
        path: Option<&Path>,
        spending: &mut Spending,
    ) -> Result<ModelBuilder, LoadError> {
        let root = document::parse(bytes, file, spending)?;
        let directory = path.and_then(Path::parent).unwrap_or(Path::new(""));
        if root.tag == "mujoco" {
            if self.floating {
                return Err(root.error(
                    "only a URDF robot can be made to float: an MJCF body floats by <freejoint/>",
                ));
            }
            return mjcf::read(
                root,
                path,
                &self.packages,
                self.ignore_unsupported,
                spending,
            );
        }
        if document::is_urdf(&root.tag) {
            return urdf::read(&root, directory, &self.packages, self.floating, spending);
        }
        Err(root.error("the root element of a model is <mujoco> (MJCF) or <robot> (URDF)"))
    }
}
