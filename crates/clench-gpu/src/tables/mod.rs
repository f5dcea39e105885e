//! The model as the device reads it: an array of words, an array of numbers, and the layout of both. A table is one
//! line of a file of this module; its name in capitals is its offset.

mod actuators;
mod bodies;
mod cameras;
mod constraints;
mod contacts;
mod distances;
mod equalities;
mod forces;
mod frames;
mod gains;
mod histories;
mod hulls;
mod metric;
mod rays;
mod sensors;
mod skins;
mod sleep;
mod solids;
mod stiction;
mod tendons;

pub(crate) use constraints::BLOCK_SIZE;
pub(crate) use contacts::CONTACT_SIZE;
pub(crate) use rays::ray_count;
pub(crate) use sensors::has_sensor_history;
pub(crate) use skins::taxel_count;

use crate::codes::{Code, Row};
use crate::kernel_options::KernelOptions;
use crate::layout::Layout;
use clench_math::Scalar;
use clench_rigid::contact::Candidate;
use clench_rigid::dynamics::articulated::articulated_bodies;
use clench_rigid::model::{Integrator, Model};
use clench_rigid::options::ContactModel;
use clench_rigid::settings::StepSettings;
use std::fmt::Write;

/// No element.
pub(crate) const NONE: u32 = u32::MAX;
/// The index of the word that is nonzero if environments have parameters of their own.
pub(crate) const OWN_PARAMETERS: usize = 1;
/// The index of the word with the number of environments. It is not a constant, so that batches of all sizes share
/// kernels.
pub(crate) const ENVS: usize = 2;
/// The index of the word that is nonzero if sensors are requested, so that distances are measured.
pub(crate) const MEASURES: usize = 3;
/// The value of an unlimited range; a device may not support infinity.
const ENDLESS: f64 = 3e38;
/// The index of the word that is nonzero if an automatic reset keeps the controls.
pub(crate) const KEEPS_CONTROLS: usize = 4;
/// The minimum divisor, mass (kg) and squared side of a box (kg m²), MuJoCo's `mjMINVAL`.
const TINY: f64 = 1e-15;

/// The arrays under construction, and the source text of the constants.
pub(crate) struct Tables {
    /// Structure: indices and kinds.
    pub words: Vec<u32>,
    /// Numbers of the model.
    pub numbers: Vec<f64>,
    /// Declarations in WGSL, which affect the texts of the kernels.
    pub constants: String,
    /// The offsets of the tables, and counts.
    pub layout: Layout,
    /// True if kernels serve any model: they read the layout for its features.
    pub general_kernels: bool,
    /// The most contacts in an initial state or keyframe of the model.
    contacts_at_start: usize,
}

/// The maximum sizes of the constraints of an environment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Capacity {
    /// Pairs of geoms that may collide or whose distance is measured.
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
    /// Slots for constraints that are added at run time.
    pub slots: usize,
    /// Bodies whose articulated inertia is stored, if paths are long.
    pub articulated: usize,
    /// Vertices of the polytope of overlapping shapes, and its faces.
    pub polytope: [usize; 2],
    /// Numbers of the manifolds on terrain, of the contacts of a face, and of those of a patch.
    pub terrain: [usize; 3],
    /// Numbers of the mass matrix in the form that a solve multiplies with.
    pub mass: usize,
    /// Numbers of the factor of H that are stored with the rows.
    pub tiles: usize,
    /// Numbers of the solver's vectors that are stored with the rows.
    pub vectors: usize,
    /// True if any contact has adhesion.
    pub adheres: bool,
    /// True with the contact model `coulomb`.
    pub coulomb: bool,
    /// True with the integrator `discrete`.
    pub in_metric: bool,
    /// Terms of its metric that couple dofs of different branches.
    pub couplings: usize,
    /// True if inverse inertias and no-slip sweeps use another matrix.
    pub has_backbone: bool,
}

impl Tables {
    /// Builds the tables of a model and the capacity of its constraints. Numbers that can differ between environments
    /// precede shared ones.
    pub(crate) fn new<S: Scalar>(
        model: &Model,
        settings: &StepSettings,
        candidates: &[Candidate],
        kernels: KernelOptions,
    ) -> (Tables, Capacity) {
        let mut tables = Tables {
            words: Vec::new(),
            numbers: Vec::new(),
            constants: String::new(),
            layout: Layout::default(),
            general_kernels: kernels.general,
            contacts_at_start: kernels.contacts,
        };
        tables.words("ZERO", [0]);
        tables.words("OWN_PARAMETERS", [0]);
        tables.words("ENVS", [0]);
        tables.words("MEASURES", [0]);
        tables.words("KEEPS_CONTROLS", [0]);
        tables.bodies(model);
        tables.joints(model);
        tables.dofs(model);
        tables.geoms(model);
        tables.tendons(model);
        tables.forces(model);
        tables.history_rows();
        tables.actuators(model);
        tables.cameras(model);
        tables.sensors(model);
        tables.solids(model, settings);
        tables.rays::<S>(model);
        tables.settings(model, settings);
        tables.stiction(model, settings);
        let mut capacity = Capacity {
            articulated: articulated_in::<S>(model),
            coulomb: settings.contact_model == ContactModel::Coulomb,
            slots: if kernels.slots {
                model.max_dynamic_constraints
            } else {
                0
            },
            ..Capacity::default()
        };
        tables.flag("LONG_PATHS", capacity.articulated > 0);
        tables.equalities(model, settings, &mut capacity);
        let rubbing = tables.friction(model, settings, &mut capacity);
        let limited = tables.limits(model, settings, &mut capacity);
        tables.sleep(model, settings, (&limited, &rubbing), capacity.slots);
        tables.pairs::<S>(model, settings, candidates, &mut capacity);
        tables.metric(model, settings, &mut capacity);
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

    /// Returns the model's numbers in the device's type.
    pub(crate) fn numbers_in<S: Scalar>(&self) -> Vec<S> {
        self.numbers.iter().map(|&x| S::new(x)).collect()
    }

    /// Adds a count.
    fn count(&mut self, name: &str, value: usize) {
        self.layout.count(name, value);
    }

    /// Adds a real number.
    fn real(&mut self, name: &str, value: f64) {
        self.layout.real(name, value);
    }

    /// Declares a code, or a size that affects the texts of the kernels.
    fn constant(&mut self, name: &str, value: usize) {
        let _ = writeln!(self.constants, "const {name}: u32 = {value}u;");
    }

    /// Declares the codes of an enumeration.
    fn codes<C: Code>(&mut self) {
        for &variant in C::ALL {
            self.constant(variant.constant(), variant.code());
        }
    }

    /// Declares the offsets of the fields of a row, and its size.
    fn row<R: Row>(&mut self) {
        for (name, value) in R::constants() {
            self.constant(&name, value);
        }
    }

    /// Adds a feature of the model or a requested option; kernels omit code of unused ones.
    fn flag(&mut self, name: &str, value: bool) {
        if self.general_kernels {
            self.layout.flag(name, value);
            return;
        }
        self.fixed_flag(name, value);
    }

    /// Adds a flag that is a constant in general kernels too: code for both of its values would take long to compile.
    fn fixed_flag(&mut self, name: &str, value: bool) {
        let _ = writeln!(self.constants, "const {name}: bool = {value};");
    }
}

/// Returns the number of bodies whose articulated inertia a factorization stores. That of a metric has none.
fn articulated_in<S: Scalar>(model: &Model) -> usize {
    match model.integrator {
        Integrator::Discrete => 0,
        Integrator::Euler | Integrator::ImplicitFast | Integrator::Implicit | Integrator::Rk4 => {
            articulated_bodies::<S>(model).len()
        }
    }
}

/// Returns the start of each consecutive part, and the end of the last.
fn starts(lengths: impl IntoIterator<Item = usize>) -> Vec<usize> {
    let mut starts = vec![0];
    let mut end = 0;
    for length in lengths {
        end += length;
        starts.push(end);
    }
    starts
}
