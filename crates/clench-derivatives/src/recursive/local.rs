//! Derivatives of the forces of joints and actuators, of activations and of the integration of positions.
//!
//! Each depends on the coordinates of one joint or actuator. So all joints change at once along one direction, which
//! stands for the k-th dof of each: a single pass in dual numbers serves them all.

use super::step::Step;
use crate::tangent;
use clench_dynamics::State;
use clench_dynamics::dynamics::integrate::integrate_positions;
use clench_dynamics::dynamics::inverse_derivatives::Columns;
use clench_dynamics::dynamics::local::{LocalStages, dof_damping_slope, is_sprung};
use clench_dynamics::model::{Integrator, Model, Params};
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

/// The derivatives of the motion of a dof by the k-th positions and new velocities of its joint.
#[derive(Clone, Copy, Debug, Default)]
struct Motion {
    by_position: [f64; 6],
    by_velocity: [f64; 6],
}

/// Memory of these derivatives, and those that are not forces.
#[derive(Debug)]
pub(super) struct Local {
    params: Params<Number>,
    before: State<Number>,
    stages: LocalStages<Number>,
    directions: Vec<(Kind, usize)>,
    /// The derivatives of the motion of each dof (nv).
    motion: Vec<Motion>,
    /// The derivatives of the new activations: an activation, a column and the derivative.
    activations: Vec<(usize, usize, f64)>,
    /// Minus the derivative of the force along each dof by its velocity, as an implicit step adds it to M (nv).
    pub slopes: Vec<f64>,
    /// The derivatives of these slopes times the acceleration of the step: the dof, a column and the derivative.
    pub slope_rates: Vec<(usize, usize, f64)>,
    /// Scratch: a row of the result.
    row: Vec<f64>,
}

impl Local {
    pub(super) fn new(model: &Model) -> Self {
        Local {
            params: model.params.broadcast(),
            before: State::new(model),
            stages: LocalStages::new(model),
            directions: Vec::new(),
            motion: vec![Motion::default(); model.nv],
            activations: Vec::new(),
            slopes: Vec::new(),
            slope_rates: Vec::new(),
            row: Vec::new(),
        }
    }

    pub(super) fn set_params(&mut self, params: &Params<f64>) {
        self.params = params.broadcast();
    }

    /// Subtracts the derivatives of the forces from `gradient`, and computes all others.
    pub(super) fn run(&mut self, step: &Step<'_>, gradient: &mut Columns<'_, f64>) {
        self.activations.clear();
        self.slopes.clear();
        self.slope_rates.clear();
        self.list_directions(step);
        let directions = std::mem::take(&mut self.directions);
        for part in directions.chunks(DIRECTIONS) {
            self.before.set_values(step.before);
            self.seed(step, part);
            self.slopes.clear();
            self.stages.run(step.model, &self.params, &self.before);
            self.subtract_passive(step, part, gradient);
            if step.model.flags.actuation {
                self.subtract_actuation(step, part, gradient);
            }
            self.stages
                .advance(step.model, &self.params, &mut self.before.act);
            self.read_activations(step, part);
        }
        self.directions = directions;
        self.slopes.resize(step.model.nv, 0.0);
        self.integrate(step);
    }

    /// Lists the directions along which a force changes.
    fn list_directions(&mut self, step: &Step<'_>) {
        let (model, params) = (step.model, step.params);
        let joints = model.joints.iter().enumerate();
        let sprung = joints.filter(|&(j, _)| is_sprung(model, params, j));
        let dofs = sprung.map(|(_, joint)| joint.kind.nv()).max();
        // Actuators act on joints of one dof.
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

    /// Sets the derivatives of positions, velocities, activations and controls.
    fn seed(&mut self, step: &Step<'_>, part: &[(Kind, usize)]) {
        let (model, plain) = (step.model, step.plain);
        let LocalStages {
            position, velocity, ..
        } = &mut self.stages;
        for (to, from) in [
            (
                &mut position.actuator_length,
                &plain.position.actuator_length,
            ),
            (
                &mut position.actuator_moment,
                &plain.position.actuator_moment,
            ),
            (
                &mut velocity.actuator_velocity,
                &plain.velocity.actuator_velocity,
            ),
        ] {
            for (to, &from) in to.iter_mut().zip(from) {
                *to = Number::new(from);
            }
        }
        let state = &mut self.before;
        for (direction, &(kind, k)) in part.iter().enumerate() {
            seed_state(model, state, (kind, k), direction);
            let moved = match (kind, k) {
                (Kind::Position, 0) => &mut position.actuator_length,
                (Kind::Velocity, 0) => &mut velocity.actuator_velocity,
                (Kind::Position | Kind::Velocity | Kind::Activation | Kind::Control, _) => continue,
            };
            for (u, actuator) in model.actuators.iter().enumerate() {
                if let Some((_, arm)) = step.arm(u) {
                    moved[actuator.outputs.start].set_derivative(direction, arm);
                }
            }
        }
    }

    /// Subtracts the derivatives of passive forces, and reads those of dampers' slopes.
    fn subtract_passive(
        &mut self,
        step: &Step<'_>,
        part: &[(Kind, usize)],
        gradient: &mut Columns<'_, f64>,
    ) {
        let model = step.model;
        for (i, dof) in model.dofs.iter().enumerate() {
            let joint = &model.joints[dof.joint];
            let force = self.stages.force.qfrc_passive[i];
            let damping = match model.flags.damper {
                true => dof_damping_slope(model, &self.params, i, self.before.qvel[i]),
                false => Number::ZERO,
            };
            self.slopes.push(damping.value);
            for (direction, &(kind, k)) in part.iter().enumerate() {
                let column = match kind {
                    Kind::Position => joint.dof + k,
                    Kind::Velocity => model.nv + joint.dof + k,
                    Kind::Activation | Kind::Control => continue,
                };
                if k >= joint.kind.nv() {
                    continue;
                }
                gradient.add(i, column, -force.tangent[direction]);
                let rate = damping.tangent[direction] * step.plain.integration.qacc[i];
                if rate != 0.0 {
                    self.slope_rates.push((i, column, rate));
                }
            }
        }
    }

    /// Subtracts the derivatives of actuators' forces, and reads those of their slopes.
    fn subtract_actuation(
        &mut self,
        step: &Step<'_>,
        part: &[(Kind, usize)],
        gradient: &mut Columns<'_, f64>,
    ) {
        let model = step.model;
        for (u, actuator) in model.actuators.iter().enumerate() {
            let Some((dof, arm)) = step.arm(u) else {
                continue;
            };
            let slope = match model.integrator {
                Integrator::ImplicitFast => {
                    (self.stages).velocity_slope(model, &self.params, &self.before, u)
                }
                Integrator::Euler
                | Integrator::Implicit
                | Integrator::Rk4
                | Integrator::Discrete => Number::ZERO,
            };
            self.slopes[dof] -= arm * arm * slope.value;
            let passed = step.passed_share(model.dofs[dof].joint);
            let force = self.stages.force.actuator_force[actuator.outputs.start];
            for (direction, &local) in part.iter().enumerate() {
                let Some(column) = column(model, u, dof, local) else {
                    continue;
                };
                gradient.add(dof, column, -arm * passed * force.tangent[direction]);
                let slope = -arm * arm * slope.tangent[direction];
                if slope != 0.0 {
                    let rate = slope * step.plain.integration.qacc[dof];
                    self.slope_rates.push((dof, column, rate));
                }
            }
        }
    }

    fn read_activations(&mut self, step: &Step<'_>, part: &[(Kind, usize)]) {
        for (u, actuator) in step.model.actuators.iter().enumerate() {
            let Some((dof, _)) = step.arm(u) else {
                continue;
            };
            for a in actuator.acts.clone() {
                for (direction, &local) in part.iter().enumerate() {
                    if let Some(column) = column(step.model, u, dof, local) {
                        let rate = self.before.act[a].tangent[direction];
                        self.activations.push((a, column, rate));
                    }
                }
            }
        }
    }

    /// Differentiates the integration of positions by the positions before and the velocities after the step.
    fn integrate(&mut self, step: &Step<'_>) {
        let (model, h) = (step.model, step.params.timestep);
        for motion in &mut self.motion {
            motion.by_position[0] = 1.0;
            motion.by_velocity[0] = h;
        }
        // Only rotations are not linear.
        if model.joints.iter().all(|joint| joint.kind.nv() == 1) {
            return;
        }
        for kind in [Kind::Position, Kind::Velocity] {
            let State { qpos, qvel, .. } = &mut self.before;
            for (to, from) in [(qpos, &step.before.qpos), (qvel, &step.after.qvel)] {
                for (to, &from) in to.iter_mut().zip(from) {
                    *to = Number::new(from);
                }
            }
            for k in 0..6 {
                seed_state(model, &mut self.before, (kind, k), k);
            }
            let State { qpos, qvel, .. } = &mut self.before;
            integrate_positions(model, qpos, qvel, Number::new(h));
            let mut motion = self.motion.iter_mut();
            tangent::each_motion(model, qpos, |rates| {
                let Some(motion) = motion.next() else { return };
                let to = match kind {
                    Kind::Position => &mut motion.by_position,
                    Kind::Velocity | Kind::Activation | Kind::Control => &mut motion.by_velocity,
                };
                to.copy_from_slice(&rates[..6]);
            });
        }
    }
}

impl Local {
    /// Passes the derivatives of the new positions to `write`, dof after dof, from those of the new velocities.
    pub(super) fn write_positions<'a>(
        &mut self,
        model: &Model,
        velocities: impl Iterator<Item = &'a [f64]> + Clone,
        write: &mut dyn FnMut(&[f64]),
    ) {
        for joint in &model.joints {
            let dofs = joint.dof..joint.dof + joint.kind.nv();
            let velocities = velocities.clone().skip(joint.dof).take(dofs.len());
            for motion in &self.motion[dofs] {
                self.row.clear();
                for (velocity, slope) in velocities.clone().zip(motion.by_velocity) {
                    self.row.resize(velocity.len(), 0.0);
                    if slope != 0.0 {
                        let row = self.row.iter_mut().zip(velocity);
                        row.for_each(|(x, &velocity)| *x += slope * velocity);
                    }
                }
                let row = self.row[joint.dof..].iter_mut();
                let own = row.zip(&motion.by_position[..joint.kind.nv()]);
                own.for_each(|(x, &by_position)| *x += by_position);
                write(&self.row);
            }
        }
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
                tangent::move_along(model, joint.dof + k, (direction, 1.0), &mut state.qpos);
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

/// Returns the column of the k-th coordinate of some kind of actuator `u`, which acts on a dof.
fn column(model: &Model, u: usize, dof: usize, (kind, k): (Kind, usize)) -> Option<usize> {
    let (actuator, nv, na) = (&model.actuators[u], model.nv, model.na);
    match kind {
        Kind::Position => (k == 0).then_some(dof),
        Kind::Velocity => (k == 0).then_some(nv + dof),
        Kind::Activation => (k < actuator.acts.len()).then(|| 2 * nv + actuator.acts.start + k),
        Kind::Control => {
            let given = k < actuator.controls.len();
            given.then(|| 2 * nv + na + actuator.controls.start + k)
        }
    }
}
