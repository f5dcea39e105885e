//! Length ranges of actuators that the model does not specify. A force pulls each to its shortest and its longest
//! length, in a simulation without contacts, gravity, springs, dampers and dry friction whose velocities decay, as in
//! MuJoCo's `mj_setLengthRange` (modeling chapter, "Length range").

use super::element::Element;
use super::model_builder::ModelBuilder;
use super::physics::{LengthRangeMode, LengthRangeSpec};
use super::{ActuatorSpec, BuildError};
use clench_dynamics::budget::RAISE;
use clench_dynamics::dynamics::transmission;
use clench_dynamics::model::{
    Actuator, BiasKind, Flags, GainKind, Integrator, Model, Transmission,
};
use clench_dynamics::options::RigidOptions;
use clench_dynamics::{Fault, SimError, State, Step, StepContext, StepSettings, Workspace, check};

/// The minimum time constant of the decay of velocities, s.
const MIN_TIMECONST: f64 = 0.01;
/// The minimum of accelerations and forces that are divisors (MuJoCo's `mjMINVAL`).
const MIN_NORM: f64 = 1e-15;

/// Computes the length ranges that are needed and not specified.
///
/// # Errors
/// Returns an error if a simulation fails, a length does not converge or has no range, or the steps exceed the budget.
pub(super) fn find_all(builder: &ModelBuilder, model: &mut Model) -> Result<(), BuildError> {
    let settings = &builder.compiler.lengthrange;
    let mut wanted = Vec::new();
    for (u, actuator) in model.actuators.iter().enumerate() {
        let [low, high] = model.params.actuator_lengthrange[u];
        let given = settings.useexisting && low < high;
        if given || !is_of_mode(settings.mode, actuator) {
            continue;
        }
        match limit(model, actuator.transmission).filter(|_| settings.uselimit) {
            Some(range) => model.params.actuator_lengthrange[u] = range,
            None => wanted.push(u),
        }
    }
    match wanted.last() {
        Some(&last) => search_all(builder, &wanted, last, model),
        None => Ok(()),
    }
}

/// Searches the ranges of some actuators; `last` is the last of them. A separate function, because a simulation takes
/// 100 kB of stack, which models without such actuators do not need.
#[inline(never)]
fn search_all(
    builder: &ModelBuilder,
    wanted: &[usize],
    last: usize,
    model: &mut Model,
) -> Result<(), BuildError> {
    let settings = &builder.compiler.lengthrange;
    let mut search = Search::new(settings, model, &builder.actuators[last])?;
    search.require_budget(builder, wanted.len(), &builder.actuators[last])?;
    for &u in wanted {
        model.params.actuator_lengthrange[u] = search.range(u, &builder.actuators[u])?;
    }
    Ok(())
}

fn is_of_mode(mode: LengthRangeMode, actuator: &Actuator) -> bool {
    let muscle = actuator.gain == GainKind::Muscle || actuator.bias == BiasKind::Muscle;
    let user = actuator.gain == GainKind::User || actuator.bias == BiasKind::User;
    match mode {
        LengthRangeMode::None => false,
        LengthRangeMode::Muscle => muscle,
        LengthRangeMode::MuscleUser => muscle || user,
        LengthRangeMode::All => true,
    }
}

/// Returns the range of a limited joint or tendon.
fn limit(model: &Model, transmission: Transmission) -> Option<[f64; 2]> {
    match transmission {
        Transmission::Joint(j) | Transmission::JointInParent(j) => {
            (model.joints[j].limited).then(|| model.params.jnt_range[j])
        }
        Transmission::Tendon(t) => (model.tendons[t].limited).then(|| model.params.tendon_range[t]),
        Transmission::Site(_)
        | Transmission::SiteInFrame(_)
        | Transmission::SliderCrank(_)
        | Transmission::Body(_)
        | Transmission::Rotation(_)
        | Transmission::RotationInFrame(_) => None,
    }
}

/// A simulation that pulls on one actuator after the other.
struct Search<'a> {
    settings: &'a LengthRangeSpec,
    model: Model,
    options: StepSettings,
    /// The state at the start of every search.
    initial: State<f64>,
    state: State<f64>,
    ws: Workspace<f64>,
    step: Step<f64>,
    /// The force along dofs.
    force: Vec<f64>,
}

impl<'a> Search<'a> {
    fn new(
        settings: &'a LengthRangeSpec,
        model: &Model,
        spec: &ActuatorSpec,
    ) -> Result<Self, BuildError> {
        let mut model = model.clone();
        model.flags = Flags {
            frictionloss: false,
            contact: false,
            spring: false,
            damper: false,
            gravity: false,
            actuation: false,
            sensor: false,
            ..Flags::default()
        };
        // Flags of a file may have become options.
        model.options = RigidOptions {
            disable_constraint: None,
            enable_joint_limit: None,
            warmstart: None,
            islands: None,
            // A simulation that resets never terminates.
            autoreset: None,
            ..model.options
        };
        if model.integrator == Integrator::Rk4 {
            model.integrator = Integrator::Euler;
        }
        if settings.timestep > 0.0 {
            model.params.timestep = settings.timestep;
        }
        let options = StepSettings::supported::<f64>(&model, RigidOptions::new());
        let initial = State::new(&model);
        let step = Step::compiled();
        Ok(Search {
            settings,
            options: options.map_err(|error| failure(spec, &error))?,
            state: initial.clone(),
            initial,
            ws: (step.workspace)(&model),
            step,
            force: vec![0.0; model.nv],
            model,
        })
    }

    fn require_budget(
        &self,
        builder: &ModelBuilder,
        count: usize,
        spec: &ActuatorSpec,
    ) -> Result<(), BuildError> {
        let limit = builder.budget.steps;
        let steps = 2.0 * count as f64 * (self.settings.inttotal / self.model.params.timestep);
        match steps > limit as f64 {
            true => Err(spec.error(format!(
                "finding the length ranges of {count} actuators would take {steps:.0} steps, more than {limit}; give lengthrange, or {RAISE}"
            ))),
            false => Ok(()),
        }
    }

    /// Returns the shortest and the longest length of an actuator.
    fn range(&mut self, u: usize, spec: &ActuatorSpec) -> Result<[f64; 2], BuildError> {
        let shortest = self
            .converge(u, -1.0)
            .map_err(|e| failure(spec, &e.into()))?;
        let longest = self
            .converge(u, 1.0)
            .map_err(|e| failure(spec, &e.into()))?;
        let range = [shortest[0], longest[1]];
        let size = range[1] - range[0];
        let advice = "limit its joints, give lengthrange, or change <lengthrange> of the compiler";
        if size.is_nan() || size <= 0.0 {
            return Err(spec.error(format!(
                "the computed range of its length, {range:?}, is not increasing: {advice}"
            )));
        }
        for [low, high] in [shortest, longest] {
            if high - low > self.settings.tolrange * size {
                return Err(spec.error(format!(
                    "its length did not converge in the search for its range {range:?}: at the end it still varied from {low} to \
                     {high}: {advice}"
                )));
            }
        }
        Ok(range)
    }

    /// Returns the minimum and the maximum length at the end of a simulation from qpos0 that pulls in one direction.
    fn converge(&mut self, u: usize, direction: f64) -> Result<[f64; 2], Fault> {
        self.state.copy_from(&self.initial);
        let mut seen: Option<[f64; 2]> = None;
        while self.state.time < self.settings.inttotal {
            let length = self.pull(u, direction)?;
            if self.state.time > self.settings.inttotal - self.settings.interval {
                let [low, high] = seen.unwrap_or([length; 2]);
                seen = Some([low.min(length), high.max(length)]);
            }
        }
        Ok(seen.unwrap_or_default())
    }

    /// Takes a step and returns the length at its start.
    fn pull(&mut self, u: usize, direction: f64) -> Result<f64, Fault> {
        let settings = self.settings;
        let fading = (-self.model.params.timestep / settings.timeconst.max(MIN_TIMECONST)).exp();
        for velocity in &mut self.state.qvel {
            *velocity *= fading;
        }
        self.check()?;
        let (model, ws) = (&self.model, &mut self.ws);
        (self.step.position_stage)(model, &model.params, &self.state, ws);
        let output = model.actuators[u].outputs.start;
        let length = ws.position.actuator_length[output];
        let arms = || transmission::moment(model, &ws.position, output);
        self.force.fill(0.0);
        for (dof, arm) in arms() {
            self.force[dof] = arm;
        }
        (self.step.solve)(ws.mass_factor(), &model.tree, &mut self.force);
        let accel = direction * settings.accel / norm(&self.force).max(MIN_NORM);
        self.force.fill(0.0);
        for (dof, arm) in arms() {
            self.force[dof] = accel * arm;
        }
        let total = norm(&self.force);
        let excess = settings.maxforce > 0.0 && total > settings.maxforce;
        let share = if excess {
            settings.maxforce / total.max(MIN_NORM)
        } else {
            1.0
        };
        let applied = self.state.qfrc_applied.iter_mut();
        for (applied, force) in applied.zip(&self.force) {
            *applied = share * force;
        }
        self.advance()?;
        Ok(length)
    }

    /// Takes a step of the simulation.
    fn advance(&mut self) -> Result<(), Fault> {
        self.check()?;
        let (model, time) = (&self.model, self.state.time);
        let (state, ws) = (&mut self.state, &mut self.ws);
        let context = StepContext::without_sensors(model, &model.params, &self.options);
        (self.step.step)(context, state, ws);
        match check::good_results(state, ws) {
            true => Ok(()),
            false => Err(check::result_fault(model, time, state, ws, 0)),
        }
    }

    /// Checks that a step can start from the state.
    fn check(&self) -> Result<(), Fault> {
        match check::good_inputs(&self.state, true) {
            true => Ok(()),
            false => Err(check::input_fault(&self.model, &self.state, 0)),
        }
    }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn failure(spec: &ActuatorSpec, error: &SimError) -> BuildError {
    spec.error(format!("the search for its length range failed: {error}; give lengthrange, or change <lengthrange> of the compiler"))
}
