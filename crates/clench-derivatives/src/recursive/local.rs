//! Derivatives of the forces of joints, tendons and actuators, and of activations.
//!
//! Each depends on the coordinates of one joint, tendon or actuator. So all change at once along one direction, which
//! stands for the k-th dof of each joint and the length of each actuator: a single pass serves them all.

use super::coordinate::{AlongForce, Coordinate};
use super::implicit::{Implicit, is_implicit};
use super::step::Step;
use super::tendons;
use crate::tangent;
use clench_dynamics::dynamics::force_derivatives::ForceDerivatives;
use clench_dynamics::dynamics::local::{LocalStages, dof_damping_slope, is_sprung};
use clench_dynamics::model::{Integrator, Model, Params};
use clench_dynamics::{State, Workspace};
use clench_math::{Dual, Real};

/// The number of directions of a pass: as many as fill a register. Most models need no more.
const DIRECTIONS: usize = 8;
type Number = Dual<f64, DIRECTIONS>;

/// The coordinates of which the k-th of every joint or actuator changes along a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Position,
    Velocity,
    Activation,
    Control,
}

/// Memory of these derivatives, and those that are not forces.
#[derive(Debug)]
pub(super) struct Local {
    params: Params<Number>,
    before: State<Number>,
    stages: LocalStages<Number>,
    directions: Vec<(Kind, usize)>,
    /// Minus the derivatives of the forces: a dof, a column and the number.
    forces: Vec<(usize, usize, f64)>,
    /// The derivatives of the new activations, or of their rates for Runge–Kutta: an activation, a column and the
    /// derivative.
    pub activations: Vec<(usize, usize, f64)>,
    /// The slopes of damping.
    pub implicit: Implicit,
    /// Scratch: a row of the result.
    row: Vec<f64>,
}

impl Local {
    pub(super) fn new(model: &Model) -> Self {
        let mut local = Local {
            params: model.params.broadcast(),
            before: State::new(model),
            stages: LocalStages::new(model),
            directions: Vec::new(),
            forces: Vec::new(),
            activations: Vec::new(),
            implicit: Implicit::default(),
            row: Vec::new(),
        };
        local.set_params(&model.params);
        local
    }

    pub(super) fn set_params(&mut self, params: &Params<f64>) {
        self.params = params.broadcast();
        // The module `weight` differentiates gravity compensation.
        self.params.body_gravcomp.fill(Number::ZERO);
    }

    /// Computes the derivatives.
    pub(super) fn run(&mut self, step: &Step<'_>) {
        let model = step.model;
        let mut forces = std::mem::take(&mut self.forces);
        forces.clear();
        let gradient = &mut ForceDerivatives::List(&mut forces);
        self.activations.clear();
        self.implicit.clear(model.nv);
        self.list_directions(step);
        let directions = std::mem::take(&mut self.directions);
        for (index, part) in directions.chunks(DIRECTIONS).enumerate() {
            self.before.set_values(step.before);
            self.seed(step, part);
            self.stages.run(model, &self.params, &self.before);
            // With gravity compensation.
            set_values(
                &mut self.stages.force.qfrc_actuator,
                &step.plain.force.qfrc_actuator,
            );
            self.subtract_passive(step, part, gradient);
            if is_implicit(step) {
                self.add_damping(step, part, index == 0);
            }
            if model.flags.actuation {
                self.subtract_actuation(step, part, gradient);
            }
            let numbers = match model.integrator {
                Integrator::Rk4 => &self.stages.force.act_dot,
                Integrator::Euler
                | Integrator::ImplicitFast
                | Integrator::Implicit
                | Integrator::Discrete => {
                    let act = &mut self.before.act;
                    self.stages.advance(model, &self.params, act);
                    act
                }
            };
            read_activations(step, part, numbers, &mut self.activations);
        }
        self.directions = directions;
        if !model.tendons.is_empty() {
            self.before.set_values(step.before);
            let numbers = (&self.params, &self.before);
            tendons::subtract(step, numbers, &mut self.implicit, gradient);
        }
        self.forces = forces;
    }

    /// Subtracts the derivatives of the forces from the gradient.
    pub(super) fn subtract(&self, gradient: &mut ForceDerivatives<'_, f64>) {
        for &(dof, column, x) in &self.forces {
            gradient.add(dof, column, x);
        }
    }

    /// Lists the directions along which a force changes.
    fn list_directions(&mut self, step: &Step<'_>) {
        let (model, params) = (step.model, step.params);
        let joints = model.joints.iter().enumerate();
        let sprung = joints.filter(|&(j, _)| is_sprung(model, params, j));
        let dofs = sprung.map(|(_, joint)| joint.kind.nv()).max();
        // Actuators have one length.
        let dofs = dofs
            .unwrap_or(0)
            .max(usize::from(!model.actuators.is_empty()));
        let most = |count: &dyn Fn(usize) -> usize| (0..model.actuators.len()).map(count).max();
        let acts = most(&|u| model.actuators[u].acts.len()).unwrap_or(0);
        let controls = most(&|u| model.actuators[u].controls.len()).unwrap_or(0);
        self.directions.clear();
        for (kind, count) in [
            (Kind::Position, dofs),
            (Kind::Velocity, dofs),
            (Kind::Activation, acts),
            (Kind::Control, controls),
        ] {
            self.directions.extend((0..count).map(|k| (kind, k)));
        }
    }

    /// Sets the derivatives of positions, velocities, activations and controls, and of the lengths of actuators.
    fn seed(&mut self, step: &Step<'_>, part: &[(Kind, usize)]) {
        let (model, pos, vel) = (step.model, &step.plain.position, &step.plain.velocity);
        let LocalStages {
            position, velocity, ..
        } = &mut self.stages;
        set_values(&mut position.ten_length, &pos.ten_length);
        set_values(&mut position.ten_jacobian, &pos.ten_jacobian);
        set_values(&mut position.actuator_length, &pos.actuator_length);
        set_values(&mut position.actuator_moment, &pos.actuator_moment);
        set_values(&mut velocity.ten_velocity, &vel.ten_velocity);
        set_values(&mut velocity.actuator_velocity, &vel.actuator_velocity);
        for (direction, &(kind, k)) in part.iter().enumerate() {
            seed_state(model, &mut self.before, (kind, k), direction);
            let moved = match (kind, k) {
                (Kind::Position, 0) => &mut position.actuator_length,
                (Kind::Velocity, 0) => &mut velocity.actuator_velocity,
                (Kind::Position | Kind::Velocity | Kind::Activation | Kind::Control, _) => continue,
            };
            for number in moved {
                number.set_derivative(direction, 1.0);
            }
        }
    }

    /// Adds the derivatives of the slopes of damping and, if `values`, these slopes.
    fn add_damping(&mut self, step: &Step<'_>, part: &[(Kind, usize)], values: bool) {
        let model = step.model;
        if model.flags.damper {
            for i in 0..model.nv {
                let damping = dof_damping_slope(model, &self.params, i, self.before.qvel[i]);
                if values {
                    self.implicit.add(i, damping.value);
                }
                for (direction, &local) in part.iter().enumerate() {
                    if let Some(column) = motion_column(model, i, local) {
                        let rate = damping.tangent[direction];
                        self.implicit.add_rate(step, i, (column, rate));
                    }
                }
            }
        }
        for u in (0..model.actuators.len()).filter(|_| values) {
            let slope = self.actuator_slope(step, u).value;
            let along = Coordinate::of_actuator(step, u);
            self.implicit.add_along(step, along, -slope);
        }
    }

    /// Returns the derivative of the force of an actuator by its velocity, as far as it acts at the end of the step.
    fn actuator_slope(&self, step: &Step<'_>, u: usize) -> Number {
        match step.model.integrator {
            Integrator::ImplicitFast if step.model.flags.actuation => {
                (self.stages).velocity_slope(step.model, &self.params, &self.before, u)
            }
            Integrator::Euler
            | Integrator::ImplicitFast
            | Integrator::Implicit
            | Integrator::Rk4
            | Integrator::Discrete => Number::ZERO,
        }
    }

    /// Subtracts the derivatives of passive forces of joints.
    fn subtract_passive(
        &self,
        step: &Step<'_>,
        part: &[(Kind, usize)],
        gradient: &mut ForceDerivatives<'_, f64>,
    ) {
        for (i, force) in self.stages.force.qfrc_passive.iter().enumerate() {
            for (direction, &local) in part.iter().enumerate() {
                if let Some(column) = motion_column(step.model, i, local) {
                    gradient.add(i, column, -force.tangent[direction]);
                }
            }
        }
    }

    /// Subtracts the derivatives of actuators' forces, and reads those of their slopes.
    fn subtract_actuation(
        &mut self,
        step: &Step<'_>,
        part: &[(Kind, usize)],
        gradient: &mut ForceDerivatives<'_, f64>,
    ) {
        let model = step.model;
        let passed = |dof: usize| step.passed_share(model.dofs[dof].joint);
        for (u, actuator) in model.actuators.iter().enumerate() {
            let force = self.stages.force.actuator_force[actuator.outputs.start];
            let slope = self.actuator_slope(step, u);
            let along = Coordinate::of_actuator(step, u);
            let mut of_motion = AlongForce::default();
            for (direction, &local) in part.iter().enumerate() {
                let (by, rate) = (force.tangent[direction], -slope.tangent[direction]);
                match local {
                    (Kind::Position, 0) => {
                        (of_motion.value, of_motion.by_length) = (force.value, by);
                        self.implicit.add_length_rate(step, along, rate);
                    }
                    (Kind::Velocity, 0) => {
                        of_motion.by_velocity = by;
                        self.implicit.add_velocity_rate(step, along, rate);
                    }
                    (Kind::Position | Kind::Velocity, _) => {}
                    (Kind::Activation | Kind::Control, _) => {
                        let Some(column) = column(model, u, local) else {
                            continue;
                        };
                        for (dof, arm) in along.iter() {
                            gradient.add(dof, column, -arm * passed(dof) * by);
                        }
                        self.implicit.add_rate_along(step, along, (column, rate));
                    }
                }
            }
            let moving = |dof: usize| of_motion.by_velocity * step.before.qvel[dof];
            along.subtract((model.nv, gradient), of_motion, moving, passed);
        }
    }

    /// Returns the derivatives of each new activation by itself before the step, and by the mean of its rates in all
    /// stages. `plain` contains the means.
    pub(super) fn advance_slopes(
        &mut self,
        model: &Model,
        before: &State<f64>,
        plain: &Workspace<f64>,
    ) -> Vec<[f64; 2]> {
        let rates = &mut self.stages.force.act_dot;
        set_values(rates, &plain.integration.mean.activation);
        set_values(&mut self.before.act, &before.act);
        for (act, rate) in self.before.act.iter_mut().zip(rates) {
            act.set_derivative(0, 1.0);
            rate.set_derivative(1, 1.0);
        }
        let act = &mut self.before.act;
        self.stages.advance(model, &self.params, act);
        let slopes = act.iter().map(|act| [0, 1].map(|k| act.tangent[k]));
        slopes.collect()
    }

    /// Passes the derivatives of the new activations to `write`.
    pub(super) fn write_activations(
        &mut self,
        model: &Model,
        columns: usize,
        write: &mut dyn FnMut(&[f64]),
    ) {
        for a in 0..model.na {
            self.row.clear();
            self.row.resize(columns, 0.0);
            for &(of, column, rate) in &self.activations {
                if of == a {
                    self.row[column] += rate;
                }
            }
            write(&self.row);
        }
    }
}

/// Reads the derivatives of activations, or of their rates, along the directions of a pass: appends the activation, the
/// column and the derivative.
fn read_activations(
    step: &Step<'_>,
    part: &[(Kind, usize)],
    numbers: &[Number],
    to: &mut Vec<(usize, usize, f64)>,
) {
    let (model, nv) = (step.model, step.model.nv);
    for (u, actuator) in model.actuators.iter().enumerate() {
        let along = Coordinate::of_actuator(step, u);
        for a in actuator.acts.clone() {
            for (direction, &local) in part.iter().enumerate() {
                let rate = numbers[a].tangent[direction];
                let mut push = |column: usize, rate: f64| to.push((a, column, rate));
                match local {
                    (Kind::Position, 0) => {
                        along.lengths().for_each(|(dof, by)| push(dof, rate * by));
                    }
                    (Kind::Velocity, 0) => {
                        let changes = along.velocity_changes(&step.before.qvel);
                        changes.for_each(|(dof, by)| push(dof, rate * by));
                        along
                            .iter()
                            .for_each(|(dof, arm)| push(nv + dof, rate * arm));
                    }
                    (Kind::Position | Kind::Velocity, _) => {}
                    (Kind::Activation | Kind::Control, _) => {
                        if let Some(column) = column(model, u, local) {
                            push(column, rate);
                        }
                    }
                }
            }
        }
    }
}

/// Sets the derivative of the k-th coordinate of some kind of every joint or actuator.
fn seed_state(
    model: &Model,
    state: &mut State<Number>,
    (kind, k): (Kind, usize),
    direction: usize,
) {
    let joints = model.joints.iter().filter(|joint| k < joint.kind.nv());
    match kind {
        Kind::Position => {
            for joint in joints {
                tangent::move_joint(joint, k, (direction, 1.0), &mut state.qpos);
            }
        }
        Kind::Velocity => {
            for joint in joints {
                state.qvel[joint.dof + k].set_derivative(direction, 1.0);
            }
        }
        Kind::Activation => {
            for actuator in model
                .actuators
                .iter()
                .filter(|actuator| k < actuator.acts.len())
            {
                state.act[actuator.acts.start + k].set_derivative(direction, 1.0);
            }
        }
        Kind::Control => {
            for actuator in &model.actuators {
                if k < actuator.controls.len() {
                    state.ctrl[actuator.controls.start + k].set_derivative(direction, 1.0);
                }
            }
        }
    }
}

/// Returns the column of the k-th position or velocity of the joint of dof `i`.
fn motion_column(model: &Model, i: usize, (kind, k): (Kind, usize)) -> Option<usize> {
    let joint = &model.joints[model.dofs[i].joint];
    let column = match kind {
        Kind::Position => joint.dof + k,
        Kind::Velocity => model.nv + joint.dof + k,
        Kind::Activation | Kind::Control => return None,
    };
    (k < joint.kind.nv()).then_some(column)
}

/// Returns the column of the k-th activation or control of actuator `u`.
fn column(model: &Model, u: usize, (kind, k): (Kind, usize)) -> Option<usize> {
    let (actuator, nv, na) = (&model.actuators[u], model.nv, model.na);
    match kind {
        Kind::Position | Kind::Velocity => None,
        Kind::Activation => (k < actuator.acts.len()).then(|| 2 * nv + actuator.acts.start + k),
        Kind::Control => {
            let given = k < actuator.controls.len();
            given.then(|| 2 * nv + na + actuator.controls.start + k)
        }
    }
}

/// Sets numbers to values without derivatives.
fn set_values(numbers: &mut [Number], values: &[f64]) {
    for (number, &value) in numbers.iter_mut().zip(values) {
        *number = Number::new(value);
    }
}
