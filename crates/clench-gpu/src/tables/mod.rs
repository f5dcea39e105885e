//! The model as the device reads it: one array of words, one of numbers, and the layout by which the kernels find what they
//! want in them. A table is one line of one of the files here; its name in capitals is its place.

mod actuators;
mod bodies;
mod cameras;
mod constraints;
mod contacts;
mod distances;
mod equalities;
mod forces;
mod histories;
mod hulls;
mod rays;
mod sensors;
mod tendons;

pub(crate) use constraints::BLOCK_SIZE;
pub(crate) use contacts::CONTACT_SIZE;
pub(crate) use rays::ray_count;
pub(crate) use sensors::{has_sensor_history, is_read};

use crate::layout::Layout;
use clench_math::Scalar;
use clench_rigid::contact::Candidate;
use clench_rigid::dynamics::articulated::articulated_bodies;
use clench_rigid::model::Model;
use clench_rigid::settings::StepSettings;
use std::fmt::Write;

/// No element.
pub(crate) const NONE: u32 = u32::MAX;
/// The word that tells whether environments have parameters of their own: the one behind the first.
pub(crate) const OWN_PARAMETERS: usize = 1;
/// The word that tells how many environments there are. It is no constant, so that batches of all sizes share their kernels.
pub(crate) const ENVS: usize = 2;
/// The word that tells whether distances are measured: somebody asks for sensors.
pub(crate) const MEASURES: usize = 3;
/// What stands for a range without an end: a device may have no infinity.
const ENDLESS: f64 = 3e38;

/// The arrays under construction, and the source text of the constants.
pub(crate) struct Tables {
    /// Structure: indices and kinds.
    pub words: Vec<u32>,
    /// Numbers of the model.
    pub numbers: Vec<f64>,
    /// Declarations in WGSL, which decide of the texts of the kernels.
    pub constants: String,
    /// Where the tables lie, and how much there is of what.
    pub layout: Layout,
    /// Whether kernels are to serve any model: they ask the layout what this one has.
    pub general_kernels: bool,
}

/// How large the constraints of an environment can become.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Capacity {
    /// Pairs of geoms that may collide, and those whose distance is measured.
    pub pairs: usize,
    /// Pairs whose distance is measured.
    pub measured: usize,
    /// Threads of the narrow phase.
    pub threads: usize,
    /// Contacts in the pool.
    pub contacts: usize,
    /// Blocks of the convex problem.
    pub blocks: usize,
    /// Rows of the convex problem.
    pub rows: usize,
    /// Bodies whose articulated inertia is kept, where paths are long.
    pub articulated: usize,
    /// Vertices of the polytope of overlapping shapes, and its faces.
    pub polytope: [usize; 2],
    /// Numbers of the manifolds on terrain, of the contacts of a face, and of those of a patch.
    pub terrain: [usize; 3],
    /// Numbers of the mass matrix as a solve multiplies with it.
    pub mass: usize,
    /// Numbers of the factor of H that lie with the rows.
    pub tiles: usize,
    /// Numbers of the solver's vectors that lie with the rows.
    pub vectors: usize,
    /// Whether any contact adheres of itself.
    pub adheres: bool,
}

impl Tables {
    /// The tables of a model, and how large its constraints can become. Numbers that environments may have for themselves; what they
    /// share comes after them.
    pub(crate) fn new<S: Scalar>(
        model: &Model,
        settings: &StepSettings,
        candidates: &[Candidate],
        general_kernels: bool,
    ) -> (Tables, Capacity) {
        let mut tables = Tables {
            words: Vec::new(),
            numbers: Vec::new(),
            constants: String::new(),
            layout: Layout::default(),
            general_kernels,
        };
        tables.words("ZERO", [0]);
        tables.words("OWN_PARAMETERS", [0]);
        tables.words("ENVS", [0]);
        tables.words("MEASURES", [0]);
        tables.bodies(model);
        tables.joints(model);
        tables.dofs(model);
        tables.geoms(model);
        tables.tendons(model);
        tables.forces(model);
        tables.interpolations();
        tables.actuators(model);
        tables.cameras(model);
        tables.sensors(model);
        tables.rays::<S>(model);
        tables.settings(model, settings);
        let mut capacity = Capacity {
            articulated: articulated_bodies::<S>(model).len(),
            ..Capacity::default()
        };
        tables.flag("LONG_PATHS", capacity.articulated > 0);
        tables.equalities(model, settings, &mut capacity);
        tables.friction(model, settings, &mut capacity);
        tables.limits(model, settings, &mut capacity);
        tables.pairs::<S>(model, settings, candidates, &mut capacity);
        (tables, capacity)
    }

    /// Adds a table of words.
    fn words(&mut self, name: &str, values: impl IntoIterator<Item = usize>) {
        self.layout.count(name, self.words.len());
        self.words.extend(values.into_iter().map(|v| v as u32));
    }

    /// Adds a table of numbers.
    pub(crate) fn numbers(&mut self, name: &str, values: impl IntoIterator<Item = f64>) {
        self.layout.count(name, self.numbers.len());
        self.numbers.extend(values);
    }

    /// The numbers of the model in the device's type.
    pub(crate) fn numbers_in<S: Scalar>(&self) -> Vec<S> {
        self.numbers.iter().map(|&x| S::new(x)).collect()
    }

    /// Tells how many there are of something.
    fn count(&mut self, name: &str, value: usize) {
        self.layout.count(name, value);
    }

    /// Tells a number.
    fn real(&mut self, name: &str, value: f64) {
        self.layout.real(name, value);
    }

    /// Declares a code, or a size on which the texts of the kernels depend.
    fn constant(&mut self, name: &str, value: usize) {
        let _ = writeln!(self.constants, "const {name}: u32 = {value}u;");
    }

    /// Tells what a model has, or what is asked for: what it has not is left out of the texts.
    fn flag(&mut self, name: &str, value: bool) {
        if self.general_kernels {
            self.layout.flag(name, value);
            return;
        }
        let _ = writeln!(self.constants, "const {name}: bool = {value};");
    }
}

/// Where the parts of consecutive owners begin, and where the last ends.
fn starts(lengths: impl IntoIterator<Item = usize>) -> Vec<usize> {
    let mut starts = vec![0];
    let mut end = 0;
    for length in lengths {
        end += length;
        starts.push(end);
    }
    starts
}
