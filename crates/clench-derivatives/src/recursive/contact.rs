//! The derivatives of the forces of contacts at a constant acceleration.
//!
//! The rows of a contact move with the point p and the axes of its frame, which follow from the motion of both shapes.
//! In world axes about p, with W the wrench of the contact and s_i the axis of a dof that moves the second body, a dof
//! j changes the force along i by
//!
//! ```text
//! s_i · (dW − s_j ×* W)    if s_i turns with j        s_i · dW    otherwise
//! ```
//!
//! A dof that moves both bodies moves the contact with them, but for the tangents, which may follow the world's axes.

use super::row_forces::RowForces;
use super::slopes::Slopes;
use super::step::Step;
use clench_collide::{MovingPoint, Pose, moving_points};
use clench_dynamics::constraint::at_distance::MAX_DIM;
use clench_dynamics::contact::{Contact, shape};
use clench_dynamics::dynamics::chains::{BodyPoint, Chains, Side};
use clench_dynamics::dynamics::force_derivatives::ForceDerivatives;
use clench_dynamics::dynamics::inverse_derivatives::first_turning;
use clench_dynamics::model::Model;
use clench_math::{Force, Motion, Vec3};
use clench_solver::Block;

/// Scratch memory of these derivatives.
#[derive(Clone, Debug, Default)]
pub(super) struct Contacts {
    /// The accelerations J a of bodies (nbody), and of what carries each dof (nv).
    body: Vec<Motion<f64>>,
    carrier: Vec<Motion<f64>>,
    /// The velocities of what carries each dof (nv).
    carrier_velocity: Vec<Motion<f64>>,
    /// The geoms of the last contact, and the points between them.
    geoms: Option<[usize; 2]>,
    points: Vec<MovingPoint>,
    arms: Vec<Arm>,
}

/// The effect of a dof on a contact.
#[derive(Clone, Copy, Debug)]
struct Arm {
    dof: usize,
    side: Side,
    /// The motion of the second body relative to the first, about the point.
    motion: Motion<f64>,
    /// The sum of the motions of this and the later dofs of its side, times the factors of a product.
    motion_below: Motion<f64>,
    /// The change of the wrench on the second body about the fixed point by position, as such and with the axes of the
    /// dof.
    wrench: [Force<f64>; 2],
    /// Its change by velocity.
    by_velocity: Force<f64>,
}

impl Contacts {
    /// Computes J a of bodies, and of what carries each dof, and the velocities of what carries each dof.
    pub(super) fn find_accelerations(&mut self, step: &Step<'_>) {
        self.geoms = None;
        let (model, pos) = (step.model, &step.plain.position);
        let (qvel, qacc) = (&step.before.qvel, &step.plain.qacc);
        self.body.resize(model.nbody(), Motion::ZERO);
        self.carrier.resize(model.nv, Motion::ZERO);
        self.carrier_velocity.resize(model.nv, Motion::ZERO);
        for (b, body) in model.bodies.iter().enumerate().skip(1) {
            let mut acceleration = self.body[body.parent];
            let mut velocity = step.plain.velocity.cvel[body.parent];
            for i in body.dofs.clone() {
                let first = first_turning(model, i);
                match first < i {
                    true => {
                        self.carrier[i] = self.carrier[first];
                        self.carrier_velocity[i] = self.carrier_velocity[first];
                    }
                    false => {
                        self.carrier[i] = acceleration;
                        self.carrier_velocity[i] = velocity;
                    }
                }
                acceleration += pos.cdof[i] * qacc[i];
                velocity += pos.cdof[i] * qvel[i];
            }
            self.body[b] = acceleration;
        }
    }

    /// Subtracts the derivatives of the force of a contact from the gradient.
    pub(super) fn subtract(
        &mut self,
        step: &Step<'_>,
        block: &Block<'_, f64>,
        contact: &Contact<f64>,
        forces: (&[f64], &Slopes, &mut RowForces),
        gradient: &mut ForceDerivatives<'_, f64>,
    ) {
        let point = self.moving_point(step, contact);
        self.find_arms(step, block, (contact, &point), forces);
        let common = self.arms.len() - block.dofs.len();
        match gradient {
            ForceDerivatives::Product { factors, row } => {
                self.subtract_product(step.model, common, factors, row);
            }
            ForceDerivatives::Matrix { .. } | ForceDerivatives::List(_) => {
                self.subtract_entries(step.model, common, gradient);
            }
        }
    }

    /// Subtracts the derivatives from the entries. The first `common` dofs move both bodies.
    fn subtract_entries(
        &self,
        model: &Model,
        common: usize,
        gradient: &mut ForceDerivatives<'_, f64>,
    ) {
        for by in &self.arms {
            let [fixed, turned] = by.wrench;
            let together = first_turning(model, by.dof);
            for of in &self.arms[common..] {
                let turns = by.side == Side::Both || by.side == of.side && together <= of.dof;
                let change = of.motion.dot(if turns { turned } else { fixed });
                gradient.add(of.dof, by.dof, -change);
                gradient.add(of.dof, model.nv + by.dof, -of.motion.dot(by.by_velocity));
            }
        }
    }

    /// Subtracts the product of the factors with the derivatives.
    fn subtract_product(
        &mut self,
        model: &Model,
        common: usize,
        factors: &[f64],
        product: &mut [f64],
    ) {
        let mut sums = [Motion::ZERO; 2];
        for arm in self.arms[common..].iter_mut().rev() {
            let sum = &mut sums[usize::from(arm.side == Side::Second)];
            *sum += arm.motion * factors[arm.dof];
            arm.motion_below = *sum;
        }
        let motion = sums[0] + sums[1];
        for (k, by) in self.arms.iter().enumerate() {
            let turning = match by.side {
                Side::Both => motion,
                Side::First | Side::Second => {
                    let first = k - (by.dof - first_turning(model, by.dof));
                    self.arms[first].motion_below
                }
            };
            let [fixed, turned] = by.wrench;
            product[by.dof] -= motion.dot(fixed) + turning.dot(turned - fixed);
            product[model.nv + by.dof] -= motion.dot(by.by_velocity);
        }
    }

    /// Returns the point of a contact with its derivatives.
    fn moving_point(&mut self, step: &Step<'_>, contact: &Contact<f64>) -> MovingPoint {
        if self.geoms != Some(contact.geoms) {
            self.geoms = Some(contact.geoms);
            let pos = &step.plain.position;
            let shapes = contact
                .geoms
                .map(|geom| shape(step.model, step.params, geom));
            let poses = contact.geoms.map(|geom| Pose {
                position: pos.geom_xpos[geom],
                rotation: pos.geom_xmat[geom],
            });
            moving_points(&shapes, &poses, contact.includemargin, &mut self.points);
        }
        let distance = |point: &&MovingPoint| {
            let apart = point.position - contact.pos;
            apart.dot(apart)
        };
        let nearest = self
            .points
            .iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.copied().unwrap_or_default()
    }

    /// Computes the effect of each dof of a contact.
    fn find_arms(
        &mut self,
        step: &Step<'_>,
        block: &Block<'_, f64>,
        (contact, point): (&Contact<f64>, &MovingPoint),
        (force, slopes, forces): (&[f64], &Slopes, &mut RowForces),
    ) {
        let (model, plain) = (step.model, step.plain);
        let bodies = contact.geoms.map(|geom| model.geoms[geom].body);
        let about = |body: usize| BodyPoint::new(model, &plain.position, body, contact.pos).offset;
        let offsets = bodies.map(about);
        let at = |motion: Motion<f64>, side: usize| {
            Motion::new(motion.angular, motion.velocity_at(offsets[side]))
        };
        let cvel = &plain.velocity.cvel;
        let [acceleration, velocity] =
            [&self.body, cvel].map(|motions| [0, 1].map(|side| at(motions[bodies[side]], side)));
        let centres = contact
            .geoms
            .map(|geom| plain.position.geom_xpos[geom] - contact.pos);
        let axes = contact.frame.rows;
        let wrench = wrench(&axes, force);
        self.arms.clear();
        let chains = Chains::new(model, bodies);
        let common = chains
            .iter()
            .take_while(|(_, side)| *side == Side::Both)
            .count();
        for (index, (dof, side)) in chains.iter().enumerate() {
            // The bodies of a dof that moves both have the same reference point.
            let (moves, own) = match side {
                Side::Both => ([1.0, 1.0], 1),
                Side::First => ([1.0, 0.0], 0),
                Side::Second => ([0.0, 1.0], 1),
            };
            let axis = at(plain.position.cdof[dof], own);
            let change = Change::new(point, axis, moves, centres);
            let motion = axis * (moves[1] - moves[0]);
            let field = |carrier: &[Motion<f64>], of: &[Motion<f64>; 2]| match side {
                Side::Both => axis.cross(of[1] - of[0]),
                Side::First | Side::Second => motion.cross(of[own] - at(carrier[dof], own)),
            };
            let mut residual = [0.0; MAX_DIM];
            let accelerated = field(&self.carrier, &acceleration);
            change.add_rates(
                &axes,
                (acceleration, accelerated),
                &[1.0; MAX_DIM],
                &mut residual,
            );
            let moved = field(&self.carrier_velocity, &velocity);
            change.add_rates(&axes, (velocity, moved), &slopes.damping, &mut residual);
            let mut rate = [0.0; MAX_DIM];
            if let Some(column) = index.checked_sub(common) {
                for (k, rate) in rate[..block.dim].iter_mut().enumerate() {
                    *rate = slopes.damping[k] * block.jacobian[k * block.dofs.len() + column];
                }
            }
            let by_position = slopes.force(block.dim, change.distance, &residual);
            let by_velocity = slopes.force(block.dim, 0.0, &rate);
            forces.add(block, dof, &by_position);
            forces.add(block, model.nv + dof, &by_velocity);
            let changed = change.wrench(force, wrench) + self::wrench(&axes, &by_position);
            self.arms.push(Arm {
                dof,
                side,
                motion,
                motion_below: Motion::ZERO,
                wrench: [changed, changed - axis.cross_force(wrench)],
                by_velocity: self::wrench(&axes, &by_velocity),
            });
        }
    }
}

/// The change of a contact with a dof.
struct Change {
    distance: f64,
    position: Vec3<f64>,
    axes: [Vec3<f64>; 3],
}

impl Change {
    /// Computes the change with a motion of the first and of the second shape, each times a factor. The shapes'
    /// positions are at `centres` from the point.
    fn new(
        point: &MovingPoint,
        motion: Motion<f64>,
        factors: [f64; 2],
        centres: [Vec3<f64>; 2],
    ) -> Self {
        let turn = motion.angular;
        let [first, second] = [0, 1].map(|k| motion.velocity_at(centres[k]) * factors[k]);
        let motions = [second - first, turn * factors[0], turn * factors[1]];
        let mut change = Change {
            distance: 0.0,
            position: first,
            axes: [Vec3::ZERO; 3],
        };
        for (k, x) in motions.into_iter().flat_map(Vec3::to_array).enumerate() {
            change.distance += point.distance_rates[k] * x;
            change.position += point.position_rates[k] * x;
            for (axis, &rate) in change.axes.iter_mut().zip(&point.frame_rates[k]) {
                *axis += rate * x;
            }
        }
        change
    }

    /// Adds the changes of the rows of the second body's motion minus the first's, times a factor for each row.
    /// `changed` is the change of this difference about the fixed point.
    fn add_rates(
        &self,
        axes: &[Vec3<f64>; 3],
        ([first, second], changed): ([Motion<f64>; 2], Motion<f64>),
        factors: &[f64; MAX_DIM],
        rates: &mut [f64; MAX_DIM],
    ) {
        let relative = second - first;
        let linear = changed.linear + relative.angular.cross(self.position);
        for k in 0..3 {
            let translation = self.axes[k].dot(relative.linear) + axes[k].dot(linear);
            let rotation = self.axes[k].dot(relative.angular) + axes[k].dot(changed.angular);
            rates[k] += factors[k] * translation;
            rates[k + 3] += factors[k + 3] * rotation;
        }
    }

    /// Returns the change of the wrench of constant forces about the fixed point.
    fn wrench(&self, force: &[f64], wrench: Force<f64>) -> Force<f64> {
        let turned = self::wrench(&self.axes, force);
        let moment = turned.angular + self.position.cross(wrench.linear);
        Force::new(moment, turned.linear)
    }
}

/// Returns the wrench of the forces along the rows of a contact on the second body.
fn wrench(axes: &[Vec3<f64>; 3], force: &[f64]) -> Force<f64> {
    let mut wrench = Force::ZERO;
    for (k, &f) in force.iter().enumerate() {
        match k < 3 {
            true => wrench.linear += axes[k] * f,
            false => wrench.angular += axes[k - 3] * f,
        }
    }
    wrench
}
