//! The derivatives of the forces of connects and welds at a constant acceleration.
//!
//! Each row is the position r of a spring-damper: y = r̈ + b ṙ + k d r, with the force f = −D y along it. Both d and D
//! depend on the norm of r. The module `pair` gives the rows and their changes.
//!
//! With W the wrench on a body about its anchor and s_i the axis of a dof that moves it, a dof j changes the force
//! along i by
//!
//! ```text
//! s_i · (dW − s_j ×* W)    if s_i turns with j        s_i · dW    otherwise
//! ```

use super::pair::{Anchor, Pair, Rows};
use super::row_forces::RowForces;
use super::step::Step;
use clench_dynamics::constraint::AnchorFrames;
use clench_dynamics::constraint::at_distance::{MAX_DIM, equality_softness};
use clench_dynamics::dynamics::chains::{Chains, Side};
use clench_dynamics::dynamics::force_derivatives::ForceDerivatives;
use clench_dynamics::dynamics::inverse_derivatives::{InverseDerivatives, first_turning};
use clench_dynamics::model::{EqualityTarget, Model};
use clench_dynamics::record::ConstraintSource;
use clench_math::{Dual, Force, Motion, Real, Vec3};
use clench_solver::Block;

/// Scratch memory of these derivatives.
#[derive(Clone, Debug, Default)]
pub(super) struct Frames {
    arms: Vec<Arm>,
}

/// The effect of a dof on the wrenches on both bodies, each about its anchor.
#[derive(Clone, Copy, Debug)]
struct Arm {
    dof: usize,
    side: Side,
    /// The motion of each body; zero of a body that the dof does not move.
    motion: [Motion<f64>; 2],
    /// The change of each wrench with the position.
    wrench: [Force<f64>; 2],
    /// The change of each wrench with the velocity.
    by_velocity: [Force<f64>; 2],
}

impl Frames {
    /// Subtracts the derivatives of the force of a connect or weld from the gradient. `y` and `force` are those of its
    /// rows.
    pub(super) fn subtract(
        &mut self,
        (step, inverse): (&Step<'_>, &InverseDerivatives<f64>),
        block: &Block<'_, f64>,
        source: ConstraintSource,
        (y, force, forces): (&[f64], &[f64], &mut RowForces),
        gradient: &mut ForceDerivatives<'_, f64>,
    ) {
        let Some((frames, weld)) = frames(step, source) else {
            return;
        };
        let pair = Pair::new(step, inverse, &frames, weld);
        let Some(spring) = Spring::new(step, source, &pair, (block.dim, y)) else {
            return;
        };
        forces.set_slopes(block, &spring.slopes());
        let force = parts(force);
        let wrench = pair.wrench(force);
        let bodies = [wrench, -wrench];
        self.arms.clear();
        for (dof, side) in Chains::new(step.model, frames.bodies).iter() {
            let moves = match side {
                Side::Both => [true, true],
                Side::First => [true, false],
                Side::Second => [false, true],
            };
            let [by_position, by_velocity] = [true, false].map(|by_position| {
                let change = |b: usize| match (moves[b], by_position) {
                    (false, true | false) => Anchor::default(),
                    (true, true) => pair.by_position(step, inverse, (dof, b)),
                    (true, false) => pair.by_velocity(step, inverse, (dof, b)),
                };
                let changes = [change(0), change(1)];
                let force_change = spring.force(&pair.change(&changes));
                let column = match by_position {
                    true => dof,
                    false => step.model.nv + dof,
                };
                forces.add(block, column, &force_change.map(Vec3::to_array).concat());
                let change = pair.wrench_change(force, force_change, &changes);
                [change, -change]
            });
            let motion = [0, 1].map(|b| match moves[b] {
                true => pair.about(step.plain.position.cdof[dof], b),
                false => Motion::ZERO,
            });
            // An anchor moves with its body.
            let carried = |b: usize| motion[b].linear.cross(bodies[b].linear);
            let wrench = [0, 1].map(|b| by_position[b] + Force::new(carried(b), Vec3::ZERO));
            self.arms.push(Arm {
                dof,
                side,
                motion,
                wrench,
                by_velocity,
            });
        }
        self.add_arms(step.model, bodies, gradient);
    }

    fn add_arms(
        &self,
        model: &Model,
        bodies: [Force<f64>; 2],
        gradient: &mut ForceDerivatives<'_, f64>,
    ) {
        for by in &self.arms {
            let turned = [0, 1].map(|b| by.wrench[b] - by.motion[b].cross_force(bodies[b]));
            for of in &self.arms {
                let precedes = by.dof <= of.dof || first_turning(model, by.dof) <= of.dof;
                let turns = precedes && (by.side == Side::Both || by.side == of.side);
                let wrench = if turns { turned } else { by.wrench };
                let along = |wrench: [Force<f64>; 2]| {
                    of.motion[0].dot(wrench[0]) + of.motion[1].dot(wrench[1])
                };
                gradient.add(of.dof, by.dof, -along(wrench));
                gradient.add(of.dof, model.nv + by.dof, -along(by.by_velocity));
            }
        }
    }
}

/// Returns the frames of a connect or weld, and true for a weld.
fn frames(step: &Step<'_>, source: ConstraintSource) -> Option<(AnchorFrames<f64>, bool)> {
    let (state, params) = (step.before, step.params);
    match source {
        ConstraintSource::Dynamic { slot, bodies, weld } => {
            Some((AnchorFrames::of_slot(state, slot, bodies), weld))
        }
        ConstraintSource::Equality(e) => {
            let of = |bodies: [usize; 2]| AnchorFrames::of_equality(params, e, bodies);
            match step.model.equalities[e].target {
                EqualityTarget::Connect { body1, body2 } => Some((of([body1, body2]), false)),
                EqualityTarget::Weld { body1, body2 } => Some((of([body1, body2]), true)),
                EqualityTarget::Joint { .. } | EqualityTarget::Tendon { .. } => None,
            }
        }
        ConstraintSource::DofFriction(_)
        | ConstraintSource::TendonFriction(_)
        | ConstraintSource::JointLimit(_)
        | ConstraintSource::TendonLimit(_)
        | ConstraintSource::Contact(_) => None,
    }
}

/// Returns the part of translation and of rotation of rows; the latter is zero for a connect.
fn parts(rows: &[f64]) -> [Vec3<f64>; 2] {
    let at = |k: usize| rows.get(k).copied().unwrap_or(0.0);
    [0, 3].map(|k| Vec3::new(at(k), at(k + 1), at(k + 2)))
}

/// The force of the rows as a function of their positions, velocities and accelerations, to first order.
struct Spring {
    /// r, over its norm.
    direction: [Vec3<f64>; 2],
    damping: f64,
    stiffness: f64,
    /// D of translations and rotations.
    d: [f64; 2],
    /// The derivative of the force by the norm of r.
    by_norm: [Vec3<f64>; 2],
}

impl Spring {
    /// Creates the spring of a constraint, whose rows have the residual `y`.
    fn new(
        step: &Step<'_>,
        source: ConstraintSource,
        pair: &Pair,
        (dim, y): (usize, &[f64]),
    ) -> Option<Self> {
        let r = pair.rows[0];
        let norm = (r[0].norm_squared() + r[1].norm_squared()).sqrt();
        let mut violation = Dual::<f64, 1>::new(norm);
        violation.tangent[0] = 1.0;
        let soft = equality_softness((step.params, step.settings), source, violation)?;
        let d = [0, 1].map(|part| {
            let weights = pair.bodies.map(|b| step.params.body_invweight0[b][part]);
            let a0 = Dual::<f64, 1>::new(weights[0] + weights[1]);
            match 3 * part < dim {
                true => Dual::ONE / soft.regularization(a0),
                false => Dual::ZERO,
            }
        });
        let (stiffness, y) = (soft.stiffness, parts(y));
        let by_norm = |part: usize| {
            let (d, spring) = (d[part], r[part] * stiffness.tangent[0]);
            y[part] * -d.tangent[0] - spring * d.value
        };
        let inverse = if norm > 0.0 { 1.0 / norm } else { 0.0 };
        Some(Spring {
            direction: r.map(|r| r * inverse),
            damping: soft.damping.value,
            stiffness: stiffness.value,
            d: d.map(|d| d.value),
            by_norm: [by_norm(0), by_norm(1)],
        })
    }

    /// Returns the derivatives of the force of each row by the accelerations of the rows.
    fn slopes(&self) -> [[f64; MAX_DIM]; MAX_DIM] {
        let mut slopes = [[0.0; MAX_DIM]; MAX_DIM];
        for (k, row) in slopes.iter_mut().enumerate() {
            row[k] = -self.d[k / 3];
        }
        slopes
    }

    /// Returns the change of the force with those of the rows.
    fn force(&self, [r, velocity, acceleration]: &Rows) -> [Vec3<f64>; 2] {
        let norm = self.direction[0].dot(r[0]) + self.direction[1].dot(r[1]);
        [0, 1].map(|part| {
            let spring = r[part] * self.stiffness + velocity[part] * self.damping;
            self.by_norm[part] * norm - (acceleration[part] + spring) * self.d[part]
        })
    }
}
