//! A simulation of one environment.

mod checks;
mod computed_state;
mod dynamic;
mod halves;
mod parameters;
mod provided_contacts;
mod pushes;
mod quality;
mod step_asleep;
mod threads;

pub use dynamic::DynamicConstraint;

use crate::output::{Output, Source};
use crate::validity::{Computed, Validity};
use crate::{Precision, readout};
use clench_dynamics::check::{self, check_values};
use clench_dynamics::contact::Contact;
use clench_dynamics::dynamics::energy::Energy;
use clench_dynamics::error::{SimError, no_such};
use clench_dynamics::inverse::Acceleration;
use clench_dynamics::model::{Model, Params};
use clench_dynamics::options::RigidOptions;
use clench_dynamics::profile::{Profile, Stage};
use clench_dynamics::settings::StepSettings;
use clench_dynamics::state::State;
use clench_dynamics::workspace::Workspace;
use clench_dynamics::{Step, StepContext};
use clench_math::{Mask, Real};
use clench_solver::LaneStats;
use computed_state::LaneCopy;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// A model and its state, with the results computed from them.
///
/// [`state`](Self::state) may be read and written between steps. Lengths and values are checked before they are used,
/// so invalid input is an error and never a panic. The results of a step or of [`forward`](Self::forward) are in
/// [`workspace`](Self::workspace), and in MuJoCo's terms in [`readout`](crate::readout).
#[derive(Debug)]
pub struct Sim<T: Precision = f64> {
    /// The state that the next step starts from.
    pub state: State<T>,
    model: Arc<Model>,
    params: Params<T::SingleEnv>,
    /// A number that no other parameters have. [`invalidate`](Self::invalidate) replaces it.
    params_version: u64,
    options: RigidOptions,
    settings: StepSettings,
    ws: Workspace<T::SingleEnv>,
    /// Memory for the state if it is computed in lanes.
    lane_copy: LaneCopy<T>,
    /// Memory for other values in that type.
    numbers: Vec<T::SingleEnv>,
    initial: State<T>,
    /// The part of the state that a step writes, as it was before the present step.
    last_good: State<T>,
    validity: Validity<T>,
    /// True if the workspace holds the first half of a step and nothing after it.
    halfway: bool,
    resets: u64,
    /// The serial number of the last constraint that was added at run time.
    pub(crate) last_serial: u32,
    /// The workspace of inverse dynamics, created on demand, so that [`workspace`](Self::workspace) does not change.
    inverse_ws: Option<Box<Workspace<T::SingleEnv>>>,
}

impl<T: Precision> Sim<T> {
    /// Creates a simulation in the model's initial state, with the model's options.
    ///
    /// # Errors
    /// Returns an error if an option is out of range, if a possible collision is not supported, or if the processor
    /// lacks the compiled instructions.
    pub fn new(model: Arc<Model>) -> Result<Self, SimError> {
        Sim::with_options(model, RigidOptions::new())
    }

    /// Creates a simulation with options that override those of the model.
    ///
    /// # Errors
    /// See [`new`](Self::new).
    pub fn with_options(model: Arc<Model>, options: RigidOptions) -> Result<Self, SimError> {
        if !T::SINGLE_ENV.available() {
            return Err(SimError::Instructions(T::SINGLE_ENV));
        }
        let settings = StepSettings::supported::<T>(&model, options)?;
        let model = settings.adapt(model);
        State::<T>::check_memory(&model, 3)?; // The state, the last good one and the initial one.
        let initial = State::new(&model);
        let mut ws = (Step::compiled().workspace)(&model);
        ws.sensors.wanted = true;
        Ok(Sim {
            state: initial.clone(),
            params: T::params(&model),
            params_version: next_params_version(),
            options,
            settings,
            ws,
            last_good: initial.clone(),
            validity: Validity::new(),
            halfway: false,
            resets: 0,
            last_serial: 0,
            inverse_ws: None,
            lane_copy: computed_state::lane_copy::<T>(&model),
            numbers: Vec::new(),
            initial,
            model,
        })
    }

    /// Advances the state by one time step.
    ///
    /// With the option `autoreset`, a step that fails is repeated from the initial state, including controls and
    /// applied forces, and is counted in [`resets`](Self::resets).
    ///
    /// # Errors
    /// Returns an error if the state has wrong lengths or values that are not finite, if the motion diverges (values
    /// that are not finite, or positions, velocities or accelerations beyond 1e10), or if the mass matrix is singular.
    /// The state is then as before the step.
    pub fn step(&mut self) -> Result<(), SimError> {
        self.with_autoreset(Self::try_step)
    }

    /// Runs a step or the first half of one. After a fault with the option `autoreset`, it is repeated from the initial
    /// state.
    fn with_autoreset(
        &mut self,
        pass: impl Fn(&mut Self) -> Result<(), SimError>,
    ) -> Result<(), SimError> {
        match pass(self) {
            Err(SimError::Fault(_)) if self.settings.autoreset => {
                let before = self.state.clone();
                self.reset();
                let again = pass(self);
                match again {
                    Ok(()) => self.resets += 1,
                    Err(_) => self.state.copy_from(&before),
                }
                again
            }
            done => done,
        }
    }

    fn try_step(&mut self) -> Result<(), SimError> {
        self.ws.clock.start();
        if self.step_asleep() {
            self.ws.clock.lap(Stage::Rows as usize);
            return Ok(());
        }
        self.check_state()?;
        self.last_good.copy_moving_from(&self.state);
        self.ws.clock.lap(Stage::Rows as usize);
        self.on_threads(Step::compiled().step);
        let result = self.check_result(self.last_good.time);
        self.record_validity(&result);
        if result.is_err() {
            self.state.copy_moving_from(&self.last_good);
        }
        self.ws.clock.lap(Stage::Rows as usize);
        result
    }

    /// Computes all results of the state without changing it.
    ///
    /// # Errors
    /// See [`step`](Self::step); nothing is reset.
    pub fn forward(&mut self) -> Result<(), SimError> {
        self.check_state()?;
        self.on_threads(|context, state, ws| (Step::compiled().forward)(context, state, ws));
        let result = self.check_result(self.state.time);
        self.record_validity(&result);
        result
    }

    /// Records that a step or forward pass computed all results, or that it failed and its results are invalid.
    fn record_validity(&mut self, result: &Result<(), SimError>) {
        self.halfway = false;
        match result {
            Ok(()) => self.validity.record(Computed::Everything, &self.state),
            Err(_) => self.validity.invalidate(),
        }
    }

    /// Computes the results of the state if they are stale: before the first step or [`forward`](Self::forward), and
    /// after positions, velocities, mocap poses or parameters were written or the simulation was reset. Otherwise it
    /// does nothing; after a step, the results are those of the state at its start, as in MuJoCo. New controls and
    /// applied forces take effect in the next step or forward pass.
    ///
    /// Queries such as [`ray`](Self::ray) and [`output`](Self::output) call it themselves. Call it before you read the
    /// [`workspace`](Self::workspace) or [`contacts`](Self::contacts).
    ///
    /// # Errors
    /// See [`step`](Self::step); nothing is reset.
    pub fn refresh(&mut self) -> Result<(), SimError> {
        self.require(Computed::Everything)
    }

    /// Computes the results of the present positions, even if those of the positions before the last step count as
    /// valid.
    pub(crate) fn refresh_positions(&mut self) -> Result<(), SimError> {
        self.validity.invalidate();
        self.require(Computed::Positions)
    }

    /// Marks all results as stale, because parameters changed.
    fn invalidate(&mut self) {
        self.halfway = false;
        self.params_version = next_params_version();
        self.validity.invalidate();
        self.ws.invalidate_poses();
    }

    /// Computes the required results for the present state unless the workspace holds them.
    pub(crate) fn require(&mut self, wanted: Computed) -> Result<(), SimError> {
        if wanted <= self.validity.computed(&self.state) {
            return Ok(());
        }
        if wanted == Computed::Everything {
            return self.forward();
        }
        self.check_state()?;
        self.halfway = false;
        self.ws.clock.start();
        self.ws.invalidate_poses();
        let (model, params, ws) = (&self.model, &self.params, &mut self.ws);
        computed_state::read(&self.state, &mut self.lane_copy, |state| {
            (Step::compiled().position_stage)(model, params, state, ws);
        });
        self.validity.record(Computed::Positions, &self.state);
        Ok(())
    }

    /// Resets the state to the model's initial state.
    pub fn reset(&mut self) {
        self.state.copy_from(&self.initial);
        self.validity.invalidate();
    }

    /// Resets the state to a keyframe of the model. Other fields get their initial values.
    ///
    /// # Errors
    /// Returns an error if there is no such keyframe.
    pub fn reset_to_keyframe(&mut self, index: usize) -> Result<(), SimError> {
        let Some(key) = self.model.keyframes.get(index) else {
            return Err(no_such("keyframe", index, self.model.keyframes.len()));
        };
        self.state.copy_from(&self.initial);
        self.state.set_keyframe(&self.model, key);
        self.validity.invalidate();
        Ok(())
    }

    /// Sets the controls (nu).
    ///
    /// # Errors
    /// Returns an error if the length is wrong or a value is not finite; the controls are then unchanged.
    pub fn set_ctrl(&mut self, ctrl: &[T]) -> Result<(), SimError> {
        check_values("ctrl", ctrl, self.state.ctrl.len())?;
        self.state.ctrl.copy_from_slice(ctrl);
        Ok(())
    }

    /// Sets the positions (nq) and the velocities (nv).
    ///
    /// # Errors
    /// Returns an error if a length is wrong or a value is not finite; the state is then unchanged.
    pub fn set_configuration(&mut self, qpos: &[T], qvel: &[T]) -> Result<(), SimError> {
        check_values("qpos", qpos, self.model.nq)?;
        check_values("qvel", qvel, self.model.nv)?;
        self.state.qpos.copy_from_slice(qpos);
        self.state.qvel.copy_from_slice(qvel);
        Ok(())
    }

    /// Activates or deactivates an equality constraint.
    ///
    /// # Errors
    /// Returns an error if there is no such equality.
    pub fn set_equality_active(&mut self, equality: usize, active: bool) -> Result<(), SimError> {
        let count = self.model.equalities.len();
        let Some(switch) = self.state.eq_active.get_mut(equality) else {
            return Err(no_such("equality", equality, count));
        };
        *switch = active;
        Ok(())
    }

    /// Returns the model.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }
    /// Returns the user's options.
    pub fn options(&self) -> RigidOptions {
        self.options
    }
    /// Returns all resolved options.
    pub fn settings(&self) -> &StepSettings {
        &self.settings
    }
    /// Returns the results of the last step, forward pass or [`refresh`](Self::refresh). After a step, positions and
    /// contacts are those at its start. Values have the number type that the environment is computed in; read lane 0.
    pub fn workspace(&self) -> &Workspace<T::SingleEnv> {
        &self.ws
    }
    /// Returns the contacts of the last step, forward pass or [`refresh`](Self::refresh).
    /// [`contact_rows`](crate::readout::contact_rows) adds their forces and wrenches.
    pub fn contacts(&self) -> &[Contact<T::SingleEnv>] {
        &self.ws.contacts
    }
    /// Returns the statistics of the last solve.
    pub fn stats(&self) -> LaneStats {
        self.ws.solver.stats().lane(0)
    }
    /// Returns the number of steps repeated by the option `autoreset`.
    pub fn resets(&self) -> u64 {
        self.resets
    }
    /// Returns true if the last step or forward pass found more contacts than the options allow, and omitted some.
    pub fn contact_overflow(&self) -> bool {
        self.ws.collision.overflow.lane(0)
    }

    /// Returns the dense mass matrix (nv × nv) at the poses of [`refresh`](Self::refresh).
    ///
    /// # Errors
    /// See [`refresh`](Self::refresh).
    pub fn mass_matrix(&mut self) -> Result<Vec<f64>, SimError> {
        self.require(Computed::Positions)?;
        Ok(readout::mass_matrix(&self.ws, 0))
    }

    /// Returns an output of the last step or forward pass, by its name in [`Output`]. See [`refresh`](Self::refresh)
    /// for stale outputs.
    ///
    /// # Errors
    /// Returns an error if the name is unknown, or if [`step`](Self::step) would refuse the state.
    pub fn output(&mut self, name: &str) -> Result<Vec<T>, SimError> {
        let output = Output::find(name)?;
        if output == Output::energy {
            let energy = self.energy()?;
            return Ok(vec![energy.potential, energy.kinetic]);
        }
        self.check_state()?;
        self.require(output.requires())?;
        let mut values = Vec::new();
        self.read(|source| T::read(output, source, &mut values));
        Ok(values.iter().map(|value| value.lane(0)).collect())
    }

    /// Calls `reader` with the data that outputs are read from.
    pub(crate) fn read<R>(&mut self, reader: impl FnOnce(&mut Source<T::SingleEnv>) -> R) -> R {
        let (model, params, ws) = (&self.model, &self.params, &mut self.ws);
        computed_state::read(&self.state, &mut self.lane_copy, |state| {
            reader(&mut Source {
                model,
                params,
                state,
                ws,
            })
        })
    }

    /// Returns scratch memory for answers of queries.
    pub(crate) fn numbers(&mut self) -> &mut Vec<T::SingleEnv> {
        &mut self.numbers
    }

    /// Computes the joint reactions on bodies from the results of a forward pass.
    pub(crate) fn update_body_forces(&mut self) {
        self.read(T::body_forces);
    }

    /// Computes inverse dynamics of the present state in a separate workspace, so that other results stay valid, and
    /// leaves the forces in [`numbers`](Self::numbers).
    pub(crate) fn invert(
        &mut self,
        qacc: &[T::SingleEnv],
        kind: Acceleration,
    ) -> Result<(), SimError> {
        self.check_state()?;
        let (model, state, forces) = (&self.model, &self.state, &mut self.numbers);
        forces.clear();
        forces.resize(qacc.len(), T::SingleEnv::ZERO);
        let (step, inverse_ws) = (Step::compiled(), &mut self.inverse_ws);
        let ws = inverse_ws.get_or_insert_with(|| Box::new((step.workspace)(model)));
        let context = StepContext::without_sensors(model, &self.params, &self.settings);
        computed_state::read(state, &mut self.lane_copy, |state| {
            (step.inverse)(context, state, (qacc, kind), ws, forces);
        });
        match T::good_results(state, ws) {
            true => Ok(()),
            false => Err(check::result_fault(model, state.time, state, ws, 0).into()),
        }
    }

    /// Starts or stops the clocks of a step's stages.
    pub fn run_clocks(&mut self, running: bool) {
        self.ws.run_clocks(running);
    }
    /// Returns the time of each stage while the clocks ran.
    pub fn profile(&mut self) -> Profile {
        self.ws.profile()
    }

    /// Returns the mechanical energy of the state, J. The [`workspace`](Self::workspace) does not change.
    ///
    /// # Errors
    /// See [`step`](Self::step).
    pub fn energy(&mut self) -> Result<Energy<T>, SimError> {
        self.check_state()?;
        let (model, params) = (&self.model, &self.params);
        let scratch = self.ws.energy_scratch(model);
        let energy = computed_state::read(&self.state, &mut self.lane_copy, |state| {
            (Step::compiled().state_energy)(model, params, state, scratch)
        });
        Ok(Energy {
            potential: energy.potential.lane(0),
            kinetic: energy.kinetic.lane(0),
        })
    }
}

/// Returns a number that no call returned before.
fn next_params_version() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Relaxed)
}
