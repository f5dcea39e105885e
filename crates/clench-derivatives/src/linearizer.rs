//! The matrices of a linearized step.

use crate::direction::{self, Direction};
use crate::matrix::{InputGradient, Matrix, OutputTangent, RolloutGradient, split_index};
use crate::pass::{CreatePass, Pass};
use crate::reads::Reads;
use crate::request::Request;
use crate::seed::Seed;
use crate::source::Source;
use crate::stage::Stage;
use clench_dynamics::StepSettings;
use clench_dynamics::model::{Integrator, Model, ParamField, Params};
use clench_math::Instructions;
use clench_rigid::{Sim, SimError};
use clench_solver::ErrorBound;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// The linear model of a step about a state:
///
/// ```text
/// dx⁺ = A dx + B du + E dp
/// dy  = C dx + D du + F dp
/// ```
///
/// x holds the motion of the positions along the dofs (nv; rotations about the axes of the child, rad), the velocities
/// (nv), the activations (na), and on request the numbers of [`StateField::MEMORY`](crate::StateField::MEMORY). u holds
/// the controls (nu), p the chosen parameters and inputs. y holds the sensors (nsensordata), then the chosen outputs,
/// both of the state before the step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Linearization {
    /// ∂x⁺/∂x.
    pub a: Matrix,
    /// ∂x⁺/∂u.
    pub b: Matrix,
    /// ∂y/∂x.
    pub c: Matrix,
    /// ∂y/∂u.
    pub d: Matrix,
    /// ∂x⁺/∂p.
    pub e: Matrix,
    /// ∂y/∂p.
    pub f: Matrix,
    /// The distance of each constraint row, or edge of a pyramid, from a change of its piece, where its force has no
    /// derivative: see [`Problem::switching_distances`](clench_solver::Problem::switching_distances). The rows are
    /// those of the last solve of the step.
    pub switching: Vec<f64>,
    /// Bounds of the errors that the tolerance of the solver leaves in the acceleration `qacc` and in its derivatives
    /// by x, u and p; empty unless requested. They are infinite with RK4, noslip, sleep or Coulomb's law, whose
    /// accelerations are not the minimiser of one problem.
    pub errors: ErrorBound,
}

/// Returns the model for a step that skips no parameter to differentiate by because it is zero or trivial.
fn general(
    model: &Arc<Model>,
    params: &Params<f64>,
    parameters: &[(ParamField, usize)],
) -> Arc<Model> {
    let mut model = Arc::clone(model);
    for chosen in parameters.chunk_by(|(field, _), (next, _)| field == next) {
        let field = chosen[0].0;
        let mut row = params.read_lane(field, 0);
        for &(_, number) in chosen {
            row[number] = f64::NAN;
        }
        Model::clear_structural_guarantees(&mut model, field, &row);
    }
    model
}

/// Computes the derivatives of steps of a model, and reuses its memory.
pub struct Linearizer {
    pub(crate) pass: Box<dyn Pass>,
    /// The parameters of the last passes, and their version in the last simulation.
    params: Params<f64>,
    version: Option<u64>,
    /// The directions of the columns that are not zero, and their columns.
    pub(crate) directions: Vec<(Direction, usize)>,
    /// The directions of a pass.
    pub(crate) seeds: Vec<Seed>,
    /// All derivatives, one row for each number of x⁺ and y, one column for each direction.
    pub(crate) all: Vec<f64>,
    pub(crate) result: Linearization,
    pub(crate) along: OutputTangent,
    pub(crate) gradient: InputGradient,
    pub(crate) rollout: RolloutGradient,
    /// A and B of each step of a rollout.
    pub(crate) steps: Vec<[Matrix; 2]>,
}

impl fmt::Debug for Linearizer {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("Linearizer").finish_non_exhaustive()
    }
}

impl Linearizer {
    /// Creates memory for the derivatives of a simulation.
    ///
    /// # Errors
    /// Returns an error if the processor lacks the compiled instructions.
    pub fn new(model: &Model) -> Result<Self, SimError> {
        let pass = Instructions::with_derivatives(CreatePass { model });
        Ok(Linearizer {
            pass: pass.map_err(SimError::Instructions)?,
            params: model.params.clone(),
            version: None,
            directions: Vec::new(),
            seeds: Vec::new(),
            all: Vec::new(),
            result: Linearization::default(),
            along: OutputTangent::default(),
            gradient: InputGradient::default(),
            rollout: RolloutGradient::default(),
            steps: Vec::new(),
        })
    }

    /// Linearizes the next step of a simulation of the model, whose state does not change.
    ///
    /// # Errors
    /// Returns an error if [`Sim::step`] would return one.
    ///
    /// # Panics
    /// Panics if the simulation has another model, or if a parameter does not have a requested number.
    pub fn linearize(
        &mut self,
        sim: &Sim<f64>,
        request: &Request,
    ) -> Result<&Linearization, SimError> {
        let model = self.prepare(sim, &request.parameters)?;
        self.differentiate(source(&model, sim, request))?;
        Ok(&self.result)
    }

    /// Linearizes a step, after [`prepare`](Self::prepare).
    pub(crate) fn differentiate(&mut self, mut source: Source<'_>) -> Result<(), SimError> {
        let (model, request) = (source.model, source.request);
        self.all.clear();
        self.result.errors = ErrorBound::default();
        let sizes = [request.x_len(model), model.nu(), request.p_len()];
        let reads = match request.reads(model) {
            Some(reads) if self.recurse(source)? => Some(reads),
            Some(_) | None => None,
        };
        let recursed = reads.is_some();
        self.reset(sizes, request.y_len(model), recursed);
        direction::list(model, source.state, request, &mut self.directions);
        if let Some(reads) = reads {
            let [nx, nu, _] = sizes;
            if request.y_len(model) > 0 {
                self.read(source, reads, [nx, nu]);
            }
            self.directions.retain(|&(_, column)| column >= nx + nu);
        }
        let columns = self.directions.len();
        let mut end = 0;
        let mut reuses = false;
        let bounds = request.errors && minimises(source);
        while end < columns {
            let first = end;
            end += self.pass_len(source, first);
            self.seeds.clear();
            self.seeds.extend(Seed::units(&self.directions[first..end]));
            reuses = self.run_pass(&mut source, columns, first..end, reuses)?;
            if bounds {
                let errors = &mut self.result.errors;
                self.pass.bound_errors(source, end - first, errors);
            }
        }
        let Linearization {
            switching, errors, ..
        } = &mut self.result;
        self.pass.switching(switching);
        if request.errors && !bounds {
            errors.set_unknown(model.nv, columns, switching.len());
        }
        self.split(sizes);
        Ok(())
    }

    /// Prepares for the passes of a simulation. Returns the model for them.
    pub(crate) fn prepare(
        &mut self,
        sim: &Sim<f64>,
        parameters: &[(ParamField, usize)],
    ) -> Result<Arc<Model>, SimError> {
        sim.check_state()?;
        let version = Some(sim.params_version());
        if self.version != version && self.params != *sim.params() {
            self.params.clone_from(sim.params());
            self.pass.set_params(&self.params);
        }
        self.version = version;
        Ok(general(sim.model(), sim.params(), parameters))
    }

    /// Runs a pass along `seeds`, which fills some of the columns of all derivatives. `reuses` is true if it can reuse
    /// results of the last pass. Returns true if the next one can.
    pub(crate) fn run_pass(
        &mut self,
        source: &mut Source<'_>,
        columns: usize,
        filled: Range<usize>,
        reuses: bool,
    ) -> Result<bool, SimError> {
        let earliest = Seed::earliest(&self.seeds);
        source.first = filled.start == 0;
        source.start = match reuses {
            true => earliest,
            false => Stage::Positions,
        };
        let (first, all) = (filled.start, &mut self.all);
        self.pass
            .run(*source, filled.len(), &self.seeds, &mut |row, values| {
                let start = row * columns + first;
                if all.len() < (row + 1) * columns {
                    all.resize((row + 1) * columns, 0.0);
                }
                all[start..start + values.len()].copy_from_slice(values);
            })?;
        Ok(keeps_positions(*source) && (source.constant_factor || earliest > Stage::Positions))
    }

    /// Computes A and B by recursions. Returns false if the step needs passes.
    pub(crate) fn recurse(&mut self, source: Source<'_>) -> Result<bool, SimError> {
        let (nx, nu) = (2 * source.model.nv + source.model.na, source.model.nu());
        let Linearization { a, b, .. } = &mut self.result;
        for (matrix, columns) in [(&mut *a, nx), (&mut *b, nu)] {
            matrix.shape = [nx, columns];
            matrix.values.clear();
        }
        self.pass.recurse(source, &mut |row| {
            let (by_state, by_control) = row.split_at(nx);
            a.values.extend_from_slice(by_state);
            b.values.extend_from_slice(by_control);
        })
    }

    /// Computes C and D after recursions.
    fn read(&mut self, mut source: Source<'_>, reads: Reads, [nx, nu]: [usize; 2]) {
        // Other directions change no number of y.
        let directions = self.directions[..nx + nu].iter().copied();
        let changes =
            |&(direction, _): &(Direction, usize)| direction.start() <= reads.last_start();
        let directions = Vec::from_iter(directions.filter(changes));
        let Linearization { c, d, .. } = &mut self.result;
        let mut columns = Vec::new();
        source.first = true;
        for part in directions.chunks(self.pass.directions()) {
            self.seeds.clear();
            self.seeds.extend(Seed::units(part));
            source.start = match source.first {
                true => Stage::Positions,
                false => Seed::earliest(&self.seeds),
            };
            columns.clear();
            columns.extend(part.iter().map(|&(_, column)| column));
            let directions = (&self.seeds[..], &columns[..]);
            self.pass
                .read(source, reads, directions, &mut |row, values| {
                    for (&column, &value) in columns.iter().zip(values) {
                        match column.checked_sub(nx) {
                            None => c.values[row * nx + column] = value,
                            Some(column) => d.values[row * nu + column] = value,
                        }
                    }
                });
            source.first = false;
        }
    }

    /// Sets the matrices to zero, but A and B if recursions found them.
    fn reset(&mut self, [nx, nu, np]: [usize; 3], ny: usize, recursed: bool) {
        let Linearization {
            a, b, c, d, e, f, ..
        } = &mut self.result;
        if !recursed {
            a.reset([nx, nx]);
            b.reset([nx, nu]);
        }
        c.reset([ny, nx]);
        d.reset([ny, nu]);
        e.reset([nx, np]);
        f.reset([ny, np]);
    }

    /// Returns the number of directions of the pass that starts with direction `first`. A pass contains no positions
    /// and other directions together if later passes can then reuse poses and contacts.
    fn pass_len(&self, source: Source<'_>, first: usize) -> usize {
        let max_len = self.pass.directions();
        let count = max_len.min(self.directions.len() - first);
        let directions = self.directions[first..].iter();
        let moving = directions.take_while(|(direction, _)| direction.is_position());
        let moving = moving.count();
        let others = self.directions.len() - first - moving;
        let pays = others > 2 * max_len && keeps_positions(source);
        match pays && moving > 0 {
            true => count.min(moving),
            false => count,
        }
    }

    /// Copies the derivatives, and the bounds of their errors, to the columns of the matrices.
    fn split(&mut self, [nx, nu, np]: [usize; 3]) {
        let Linearization {
            a,
            b,
            c,
            d,
            e,
            f,
            errors,
            ..
        } = &mut self.result;
        let rows = self.all.chunks_exact(self.directions.len().max(1));
        for (row, values) in rows.enumerate() {
            let (row, matrices) = match row.checked_sub(nx) {
                None => (row, [&mut *a, &mut *b, &mut *e]),
                Some(row) => (row, [&mut *c, &mut *d, &mut *f]),
            };
            for (&value, &(_, column)) in values.iter().zip(&self.directions) {
                let (part, column) = split_index(column, [nx, nu]);
                let width = matrices[part].shape[1];
                matrices[part].values[row * width + column] = value;
            }
        }
        let bounds = std::mem::take(&mut errors.directions);
        if !bounds.is_empty() {
            errors.directions.resize(nx + nu + np, 0.0);
        }
        for (bound, &(_, column)) in bounds.into_iter().zip(&self.directions) {
            errors.directions[column] = bound;
        }
    }
}

/// Returns the input of the first pass of a simulation.
pub(crate) fn source<'a>(model: &'a Model, sim: &'a Sim<f64>, request: &'a Request) -> Source<'a> {
    Source {
        model,
        settings: sim.settings(),
        params: sim.params(),
        state: &sim.state,
        request,
        first: true,
        start: Stage::Positions,
        constant_factor: has_constant_factor(model, sim.settings()),
    }
}

/// Returns true if nothing but the unconstrained acceleration depends on derivatives of the factor of the mass matrix.
fn has_constant_factor(model: &Model, settings: &StepSettings) -> bool {
    let others = settings.flags.diagexact || settings.solver.noslip_iterations > 0;
    !others && model.integrator != Integrator::Discrete
}

/// Returns true if the acceleration of a step is the minimiser of its last problem.
fn minimises(source: Source<'_>) -> bool {
    let StepSettings { flags, solver, .. } = source.settings;
    let changes = flags.sleep || solver.noslip_iterations > 0;
    !changes && source.model.integrator != Integrator::Rk4
}

/// Returns true if the workspace holds the positions and contacts of the start of a step after it.
fn keeps_positions(source: Source<'_>) -> bool {
    source.model.integrator != Integrator::Rk4 && !source.settings.flags.sleep
}
