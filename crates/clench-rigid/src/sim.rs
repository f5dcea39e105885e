//! A simulation of one environment.

mod alone;
mod dynamic;
mod halves;
mod parameters;
mod pushes;
mod quality;
mod rest;
mod threads;

pub use dynamic::DynamicConstraint;

use crate::known::{Extent, Known};
use crate::output::{Output, Source};
use crate::{Precision, readout};
use alone::Room;
use clench_dynamics::check::{self, check_contact, check_values};
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
use clench_math::{Mask, Real, read_lane};
use clench_solver::LaneStats;
use std::sync::Arc;

/// A model in motion: a state, and what follows from it.
///
/// [`state`](Self::state) is open to be read and written between steps; lengths and numbers are checked before they are
/// used, so bad input is an error and never a panic. What a step or [`forward`](Self::forward) computed is read from
/// [`workspace`](Self::workspace), or in MuJoCo's terms from [`readout`](crate::readout).
#[derive(Debug)]
pub struct Sim<T: Precision = f64> {
    /// What the next step depends on.
    pub state: State<T>,
    model: Arc<Model>,
    params: Params<T::Alone>,
    options: RigidOptions,
    settings: StepSettings,
    ws: Workspace<T::Alone>,
    /// Room for the state where it is computed in lanes.
    room: Room<T>,
    /// Room for other numbers in that type.
    numbers: Vec<T::Alone>,
    initial: State<T>,
    /// What the present step writes of the state, as it was before.
    last_good: State<T>,
    known: Known<T>,
    /// Whether the workspace holds the first half of a step, and nothing after it.
    halfway: bool,
    resets: u64,
    /// The serial number of the constraint that was last added at run time.
    pub(crate) last_serial: u32,
    /// The workspace of inverse dynamics, made when they are first asked for: [`workspace`](Self::workspace) stays as it is.
    inverse_ws: Option<Box<Workspace<T::Alone>>>,
}

impl<T: Precision> Sim<T> {
    /// A simulation in the model's initial state, with the model's options.
    ///
    /// # Errors
    /// Options out of range; shapes that may meet and cannot be collided; single precision in a program compiled for another
    /// processor.
    pub fn new(model: Arc<Model>) -> Result<Self, SimError> {
        Sim::with_options(model, RigidOptions::new())
    }

    /// A simulation with options that go before those of the model.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn with_options(model: Arc<Model>, options: RigidOptions) -> Result<Self, SimError> {
        if !T::ALONE.available() {
            return Err(SimError::Instructions(T::ALONE));
        }
        let settings = StepSettings::supported::<T>(&model, options)?;
        let initial = State::new(&model);
        Ok(Sim {
            state: initial.clone(),
            params: T::params(&model),
            options,
            settings,
            ws: {
                let mut ws = T::workspace(&model);
                ws.sensors.wanted = true;
                ws
            },
            last_good: initial.clone(),
            known: Known::new(),
            halfway: false,
            resets: 0,
            last_serial: 0,
            inverse_ws: None,
            room: alone::room::<T>(&model),
            numbers: Vec::new(),
            initial,
            model,
        })
    }

    /// Advances the state by one time step.
    ///
    /// With the option `autoreset` a step that cannot be done starts over from the initial state, controls and applied forces
    /// included, and counts in [`resets`](Self::resets).
    ///
    /// # Errors
    /// A state of wrong lengths or with numbers that are not finite; a motion that diverges (numbers that are not finite, or
    /// positions, velocities or accelerations beyond 1e10) or a mass matrix that is singular. The state is then as before
    /// the step.
    pub fn step(&mut self) -> Result<(), SimError> {
        self.with_autoreset(Self::try_step)
    }

    /// Does a step or forward pass. If it meets a fault and the option `autoreset` is on, it is done again from the initial state.
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
        if self.rest() {
            self.ws.clock.lap(Stage::Rows as usize);
            return Ok(());
        }
        self.check_present()?;
        self.last_good.copy_moving_from(&self.state);
        self.ws.clock.lap(Stage::Rows as usize);
        self.on_threads(T::step);
        let result = self.check_result(self.last_good.time);
        self.note(&result);
        if result.is_err() {
            self.state.copy_moving_from(&self.last_good);
        }
        self.ws.clock.lap(Stage::Rows as usize);
        result
    }

    /// Computes everything that follows from the state, and leaves the state alone, but for a reset as in
    /// [`step`](Self::step).
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn forward(&mut self) -> Result<(), SimError> {
        self.with_autoreset(Self::try_forward)
    }

    fn try_forward(&mut self) -> Result<(), SimError> {
        self.check_present()?;
        self.on_threads(|model, params, settings, state, ws| {
            T::forward(model, params, settings, state, ws);
        });
        let result = self.check_result(self.state.time);
        self.note(&result);
        result
    }

    /// Notes that a step or forward pass computed everything, or that it failed and what it computed means nothing.
    fn note(&mut self, result: &Result<(), SimError>) {
        self.halfway = false;
        match result {
            Ok(()) => self.known.note(Extent::Everything, &self.state),
            Err(_) => self.known.forget(),
        }
    }

    /// Computes what follows from the state where that is not known: before the first step or [`forward`](Self::forward), and
    /// after someone wrote positions, velocities, mocap poses or parameters, or reset the simulation. Nothing is done where it is
    /// known; after a step that is, as in MuJoCo, what follows from the state at its start. Controls and applied forces that were
    /// written count from the next step or forward pass on.
    ///
    /// Queries such as [`ray`](Self::ray) and [`output`](Self::output) do so themselves; call it before you look at the
    /// [`workspace`](Self::workspace) or [`contacts`](Self::contacts).
    ///
    /// # Errors
    /// As [`step`](Self::step); nothing is reset.
    pub fn refresh(&mut self) -> Result<(), SimError> {
        self.require(Extent::Everything)
    }

    /// Computes what follows from the present positions, also where what followed from those before the last step would do.
    pub(crate) fn refresh_positions(&mut self) -> Result<(), SimError> {
        self.known.forget();
        self.require(Extent::Positions)
    }

    /// Marks everything that was computed as stale, because parameters changed.
    fn forget(&mut self) {
        self.halfway = false;
        self.known.forget();
        self.ws.forget_poses();
    }

    /// Computes what the workspace must hold for the present state, unless it holds it already.
    pub(crate) fn require(&mut self, wanted: Extent) -> Result<(), SimError> {
        if wanted <= self.known.extent(&self.state) {
            return Ok(());
        }
        if wanted == Extent::Everything {
            return self.try_forward();
        }
        self.check_present()?;
        self.halfway = false;
        self.ws.clock.start();
        self.ws.forget_poses();
        let (model, params, ws) = (&self.model, &self.params, &mut self.ws);
        alone::read(&self.state, &mut self.room, |state| {
            T::position_stage(model, params, state, ws);
        });
        self.known.note(Extent::Positions, &self.state);
        Ok(())
    }

    pub(crate) fn check_present(&self) -> Result<(), SimError> {
        self.check_threads()?;
        check::check_lengths(&self.model, &self.state)?;
        if T::good_inputs(&self.state) {
            return Ok(());
        }
        Err(check::input_fault(&self.model, &self.state, 0).into())
    }

    /// Finds the fault in what a step from `time` computed, if there is one.
    fn check_result(&self, time: f64) -> Result<(), SimError> {
        if T::good_results(&self.state, &self.ws) {
            return Ok(());
        }
        Err(check::result_fault(&self.model, time, &self.state, &self.ws, 0).into())
    }

    /// As [`forward`](Self::forward), but with these contacts instead of detected ones. A contact takes part where it is
    /// `active` and `dist < includemargin`.
    ///
    /// # Errors
    /// As [`step`](Self::step), and contacts that make no sense.
    pub fn forward_with_contacts(&mut self, contacts: &[Contact<T>]) -> Result<(), SimError> {
        self.with_contacts(contacts, Self::forward)
    }

    /// As [`step`](Self::step), but with these contacts instead of detected ones, in every stage of the integrator.
    ///
    /// # Errors
    /// As [`forward_with_contacts`](Self::forward_with_contacts).
    pub fn step_with_contacts(&mut self, contacts: &[Contact<T>]) -> Result<(), SimError> {
        self.with_contacts(contacts, Self::step)
    }

    fn with_contacts(
        &mut self,
        contacts: &[Contact<T>],
        compute: impl FnOnce(&mut Self) -> Result<(), SimError>,
    ) -> Result<(), SimError> {
        for (index, contact) in contacts.iter().enumerate() {
            check_contact(&self.model, contact)
                .map_err(|reason| SimError::Contact { index, reason })?;
        }
        self.ws.contacts.clear();
        self.ws.contacts.extend(contacts.iter().map(Contact::splat));
        self.ws.collision.given = true;
        self.ws.collision.overflow = Mask::splat(false);
        let result = compute(self);
        self.ws.collision.given = false;
        result
    }

    /// Back to the model's initial state.
    pub fn reset(&mut self) {
        self.state.copy_from(&self.initial);
        self.known.forget();
    }

    /// To a keyframe of the model; what a keyframe does not hold is as in the initial state.
    ///
    /// # Errors
    /// A keyframe that the model does not have.
    pub fn reset_to_keyframe(&mut self, index: usize) -> Result<(), SimError> {
        let Some(key) = self.model.keyframes.get(index) else {
            return Err(no_such("keyframe", index, self.model.keyframes.len()));
        };
        self.state.copy_from(&self.initial);
        self.state.set_keyframe(key);
        self.known.forget();
        Ok(())
    }

    /// Sets the controls (nu).
    ///
    /// # Errors
    /// A wrong length or a number that is not finite; the controls are then as before.
    pub fn set_ctrl(&mut self, ctrl: &[T]) -> Result<(), SimError> {
        check_values("ctrl", ctrl, self.state.ctrl.len())?;
        self.state.ctrl.copy_from_slice(ctrl);
        Ok(())
    }

    /// Sets the positions (nq) and the velocities (nv).
    ///
    /// # Errors
    /// A wrong length or a number that is not finite; the state is then as before.
    pub fn set_configuration(&mut self, qpos: &[T], qvel: &[T]) -> Result<(), SimError> {
        check_values("qpos", qpos, self.model.nq)?;
        check_values("qvel", qvel, self.model.nv)?;
        self.state.qpos.copy_from_slice(qpos);
        self.state.qvel.copy_from_slice(qvel);
        Ok(())
    }

    /// Switches an equality constraint on or off.
    ///
    /// # Errors
    /// An equality that the model does not have.
    pub fn set_equality_active(&mut self, equality: usize, active: bool) -> Result<(), SimError> {
        let count = self.model.equalities.len();
        let Some(switch) = self.state.eq_active.get_mut(equality) else {
            return Err(no_such("equality", equality, count));
        };
        *switch = active;
        Ok(())
    }

    /// The model.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }
    /// The options that the user set.
    pub fn options(&self) -> RigidOptions {
        self.options
    }
    /// All options, decided.
    pub fn settings(&self) -> &StepSettings {
        &self.settings
    }
    /// What was computed last, by a step, forward pass or [`refresh`](Self::refresh). After a step, positions and contacts are
    /// those at its start. Numbers are in the type that the environment is computed in, of which lane 0 counts.
    pub fn workspace(&self) -> &Workspace<T::Alone> {
        &self.ws
    }
    /// The contacts that were found last, by a step, forward pass or [`refresh`](Self::refresh). [`contact_rows`](crate::readout::contact_rows) adds their forces and wrenches.
    pub fn contacts(&self) -> &[Contact<T::Alone>] {
        &self.ws.contacts
    }
    /// How the last solve went.
    pub fn stats(&self) -> LaneStats {
        self.ws.solver.stats().lane(0)
    }
    /// How many steps and forward passes started over from the initial state, with the option `autoreset`.
    pub fn resets(&self) -> u64 {
        self.resets
    }
    /// Whether the last step or forward found more contacts than the options allow, and left some out.
    pub fn contact_overflow(&self) -> bool {
        self.ws.collision.overflow.lane(0)
    }

    /// The mass matrix, dense (nv × nv), where bodies are as in [`refresh`](Self::refresh).
    ///
    /// # Errors
    /// As [`refresh`](Self::refresh).
    pub fn mass_matrix(&mut self) -> Result<Vec<f64>, SimError> {
        self.require(Extent::Positions)?;
        Ok(readout::mass_matrix(&self.ws, 0))
    }

    /// An output of the last step or forward, by its name in [`Output`]; one that is not known is computed, as
    /// [`refresh`](Self::refresh) says.
    ///
    /// # Errors
    /// A name that no output has; a state as [`step`](Self::step) refuses it.
    pub fn output(&mut self, name: &str) -> Result<Vec<T>, SimError> {
        let output = Output::find(name)?;
        if output == Output::energy {
            let energy = self.energy()?;
            return Ok(vec![energy.potential, energy.kinetic]);
        }
        self.check_present()?;
        self.require(output.extent())?;
        let mut values = Vec::new();
        self.read(|source| T::read(output, source, &mut values));
        Ok(values.iter().map(|value| value.lane(0)).collect())
    }

    /// Shows to `reader` what outputs are read from.
    pub(crate) fn read<R>(&mut self, reader: impl FnOnce(&mut Source<T::Alone>) -> R) -> R {
        let (model, params, ws) = (&self.model, &self.params, &mut self.ws);
        alone::read(&self.state, &mut self.room, |state| {
            reader(&mut Source {
                model,
                params,
                state,
                ws,
            })
        })
    }

    /// Lets `compute` change numbers in the type that the environment is computed in.
    pub(crate) fn change(
        &mut self,
        values: &mut [T],
        compute: impl FnOnce(&Self, &mut [T::Alone]),
    ) {
        let mut numbers = std::mem::take(&mut self.numbers);
        numbers.clear();
        numbers.extend(values.iter().copied().map(T::Alone::splat));
        compute(self, &mut numbers);
        read_lane(&numbers, 0, values);
        self.numbers = numbers;
    }

    /// Computes what the joints of bodies carry, once all is known that a forward pass computes.
    pub(crate) fn update_body_forces(&mut self) {
        self.read(T::body_forces);
    }

    /// Inverse dynamics of the present state, in a workspace of their own, so that what is known stays.
    pub(crate) fn invert(
        &mut self,
        qacc: &[T],
        given: Acceleration,
        qfrc_inverse: &mut [T],
    ) -> Result<(), SimError> {
        self.check_present()?;
        let (model, state) = (&self.model, &self.state);
        let ws = (self.inverse_ws).get_or_insert_with(|| Box::new(T::workspace(model)));
        let splat = |numbers: &[T]| numbers.iter().copied().map(T::Alone::splat).collect();
        let (qacc, mut forces): (Vec<_>, Vec<_>) = (splat(qacc), splat(qfrc_inverse));
        let given = (&qacc[..], given);
        let (params, settings) = (&self.params, &self.settings);
        alone::read(state, &mut self.room, |state| {
            T::inverse(model, params, settings, state, given, ws, &mut forces);
        });
        read_lane(&forces, 0, qfrc_inverse);
        match T::good_results(state, ws) {
            true => Ok(()),
            false => Err(check::result_fault(model, state.time, state, ws, 0).into()),
        }
    }

    /// Lets the clocks of a step's stages run, or not.
    pub fn run_clocks(&mut self, running: bool) {
        self.ws.run_clocks(running);
    }
    /// Where the time of steps went while the clocks ran.
    pub fn profile(&mut self) -> Profile {
        self.ws.profile()
    }

    /// The mechanical energy of the state, J. The [`workspace`](Self::workspace) is then as before.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn energy(&mut self) -> Result<Energy<T>, SimError> {
        self.check_present()?;
        let (model, params) = (&self.model, &self.params);
        let scratch = self.ws.energy_scratch(model);
        let energy = alone::read(&self.state, &mut self.room, |state| {
            T::state_energy(model, params, state, scratch)
        });
        Ok(Energy {
            potential: energy.potential.lane(0),
            kinetic: energy.kinetic.lane(0),
        })
    }
}
