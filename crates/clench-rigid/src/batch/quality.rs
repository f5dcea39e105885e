//! Quality statistics of the steps of a run.
//!
//! Constraints are soft: their force and their impacts explain some violation r. With R the regularization of a row, f
//! its force, and k d the stiffness of its own solref and solimp (see `constraint::softness`):
//!
//! ```text
//! at rest        aref = −k d r = −R f:                      r = R f / (k d), times β under the integrator `discrete`
//! in an impact   critically damped, r″ = −k d r − b r′:     r ≤ v / (e √(k d)) at an approach of v
//! ```
//!
//! The stiffness is that of the model as written. If a time step is too long for it, the step uses a softer constraint
//! (`refsafe`), and the additional violation is not explained.

use clench_collide::ShapeKind;
use clench_dynamics::constraint::dynamic::softness;
use clench_dynamics::constraint::{BlockRecord, ConstraintSource, Softness};
use clench_dynamics::contact::Contact;
use clench_dynamics::model::{Model, Params};
use clench_dynamics::settings::StepSettings;
use clench_dynamics::workspace::Workspace;
use clench_math::{Mask, Real, Scalar, Vec3, kernel};
use clench_solver::Status;
use std::f64::consts::E;
use std::ops::AddAssign;

/// The maximum violation of an equality or a limit that is not suspicious, m or rad.
const SUSPICIOUS_VIOLATION: f64 = 0.1;
/// The impact speed whose violation is not suspicious, m/s or rad/s: a fall from 1.3 m.
const IMPACT_SPEED: f64 = 5.0;

/// Sums and extremes over steps (and forward passes) of environments, except those in which an environment failed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quality {
    /// The number of steps.
    pub steps: u64,
    /// The number of steps with active constraints.
    pub constrained: u64,
    /// The number of steps whose solve stopped at the iteration limit.
    pub unconverged: u64,
    /// The largest duality gap, a bound on a solution's cost above the minimum.
    pub gap_max: f64,
    /// The largest number of contacts.
    pub contacts_max: u64,
    /// The maximum penetration, m; 0 without penetration.
    pub penetration_max: f64,
    /// The number of steps in which some contact was too deep: deeper than softness explains, and deeper than half the
    /// thickness of one of its geoms, so that its centre or middle plane is past the other's surface. Planes and height
    /// fields have no thickness here: all below them is inside.
    pub deep: u64,
    /// The deepest of these contacts.
    pub deepest: Option<DeepContact>,
    /// The number of steps in which some equality or limit was violated by more than 0.1 (m or rad), and more than
    /// softness explains.
    pub violated: u64,
    /// The worst of these violations.
    pub worst_violation: Option<Violation>,
}

/// A contact that is too deep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeepContact {
    /// The geoms.
    pub geoms: [usize; 2],
    /// Penetration depth, m.
    pub depth: f64,
}

/// A violated equality or limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violation {
    /// The constraint.
    pub source: ConstraintSource,
    /// The violation, m or rad.
    pub size: f64,
}

/// The results of a step in a workspace, and the data to interpret them.
#[derive(Clone, Copy)]
pub(crate) struct StepResults<'a, T: Real> {
    pub model: &'a Model,
    pub params: &'a Params<T>,
    pub settings: &'a StepSettings,
    pub ws: &'a Workspace<T>,
}

impl Quality {
    /// Adds those of the first `len` lanes that are `good`. The other lanes have no environment.
    pub(crate) fn count<T: Real>(&mut self, results: StepResults<T>, len: usize, good: T::Mask) {
        let stats = results.ws.solver.stats();
        let figures = figures(results);
        let (deep, violated) = (figures.deep & good, figures.violated & good);
        for lane in (0..len).filter(|&lane| good.lane(lane)) {
            let status = stats.status(lane);
            let value = |x: T| x.lane(lane).to_f64();
            self.steps += 1;
            self.constrained += u64::from(status != Status::Unconstrained);
            self.unconverged += u64::from(status == Status::IterationLimit);
            self.gap_max = self.gap_max.max(value(stats.gap));
            self.contacts_max = self.contacts_max.max(value(figures.contacts) as u64);
            self.penetration_max = self.penetration_max.max(value(figures.depth));
            if deep.lane(lane)
                && let Some(contact) = deepest(results, lane)
            {
                self.deep += 1;
                self.deepest = worse(self.deepest, Some(contact));
            }
            if violated.lane(lane)
                && let Some(violation) = worst_violation(results, lane)
            {
                self.violated += 1;
                self.worst_violation = worse(self.worst_violation, Some(violation));
            }
        }
    }
}

/// The statistics of a step, lane by lane.
struct StepFigures<T: Real> {
    /// The number of contacts.
    contacts: T,
    /// The maximum penetration, m.
    depth: T,
    /// True if some contact is deeper than half the thickness of a geom.
    deep: T::Mask,
    /// True if some equality or limit has a suspicious violation.
    violated: T::Mask,
}

#[kernel]
fn figures<T: Real>(results: StepResults<T>) -> StepFigures<T> {
    let mut figures = StepFigures {
        contacts: T::ZERO,
        depth: T::ZERO,
        deep: T::Mask::splat(false),
        violated: T::Mask::splat(false),
    };
    for contact in &results.ws.contacts {
        let depth = -contact.dist;
        let half = half_thickness(results, contact);
        figures.contacts += T::select(contact.active, T::ONE, T::ZERO);
        figures.depth = T::select(contact.active, depth, figures.depth).max(figures.depth);
        figures.deep |= contact.active & depth.gt(half);
    }
    for (_, record, pos) in equalities_and_limits(results.ws) {
        for &pos in pos {
            let size = violation(record, pos);
            figures.violated |= record.active & size.gt(T::new(SUSPICIOUS_VIOLATION));
        }
    }
    figures
}

/// Returns half the thickness of the thinner geom of a contact.
#[inline(always)]
fn half_thickness<T: Real>(results: StepResults<T>, contact: &Contact<T>) -> T {
    let half = |g: usize| {
        let Vec3 { x, y, z } = results.params.geom_size[g];
        match results.model.geoms[g].kind {
            ShapeKind::Plane | ShapeKind::HeightField => T::new(f64::INFINITY),
            ShapeKind::Sphere | ShapeKind::Capsule => x,
            ShapeKind::Cylinder => x.min(y),
            ShapeKind::Ellipsoid | ShapeKind::Box => x.min(y).min(z),
            // A flat mesh has no inside.
            ShapeKind::Mesh => {
                let half = x.min(y).min(z);
                T::select(half.gt(T::ZERO), half, T::new(f64::INFINITY))
            }
        }
    };
    half(contact.geoms[0]).min(half(contact.geoms[1]))
}

/// Returns the blocks of equalities and limits with their indices, their records and the positions of their rows.
#[inline(always)]
fn equalities_and_limits<T: Real>(
    ws: &Workspace<T>,
) -> impl Iterator<Item = (usize, &BlockRecord<T>, &[T])> {
    let blocks = ws.record.blocks.iter().enumerate();
    // Contacts are at the end.
    let others =
        blocks.take_while(|(_, record)| !matches!(record.source, ConstraintSource::Contact(_)));
    let chosen = others.filter(|(_, record)| {
        use ConstraintSource::{DofFriction, TendonFriction};
        !matches!(record.source, DofFriction(_) | TendonFriction(_))
    });
    chosen.map(|(i, record)| (i, record, &ws.record.pos[ws.problem.block(i).rows()]))
}

/// Returns the violation of a row of an equality or a limit at `pos`.
#[inline(always)]
fn violation<T: Real>(record: &BlockRecord<T>, pos: T) -> T {
    match record.source {
        ConstraintSource::Equality(_) | ConstraintSource::Dynamic { .. } => pos.abs(),
        ConstraintSource::DofFriction(_)
        | ConstraintSource::TendonFriction(_)
        | ConstraintSource::JointLimit(_)
        | ConstraintSource::TendonLimit(_)
        | ConstraintSource::Contact(_) => record.margin - pos,
    }
}

/// Returns the deepest contact of a lane among those that are too deep.
fn deepest<T: Real>(results: StepResults<T>, lane: usize) -> Option<DeepContact> {
    let number = |x: T| x.lane(lane).to_f64();
    let mut deepest = None;
    for contact in (results.ws.contacts.iter()).filter(|contact| contact.active.lane(lane)) {
        let depth = -number(contact.dist);
        if depth <= number(half_thickness(results, contact)) {
            continue;
        }
        let excess = number(contact.includemargin) + depth;
        let explained = contact.block.map_or(f64::INFINITY, |block| {
            explained(
                results,
                lane,
                block,
                0,
                excess,
                (contact.solref, contact.solimp),
            )
        });
        if excess > explained {
            let geoms = contact.geoms;
            deepest = worse(deepest, Some(DeepContact { geoms, depth }));
        }
    }
    deepest
}

/// Returns the worst violation of an equality or a limit in a lane, among those that softness does not explain.
fn worst_violation<T: Real>(results: StepResults<T>, lane: usize) -> Option<Violation> {
    let p = results.params;
    let mut worst = None;
    for (block, record, rows) in equalities_and_limits(results.ws) {
        let source = record.source;
        let softness = match source {
            ConstraintSource::Equality(i) => (p.eq_solref[i], p.eq_solimp[i]),
            ConstraintSource::Dynamic { .. } => softness(),
            ConstraintSource::JointLimit(i) => (p.jnt_solref[i], p.jnt_solimp[i]),
            ConstraintSource::TendonLimit(i) => (p.tendon_solref_lim[i], p.tendon_solimp_lim[i]),
            ConstraintSource::DofFriction(_)
            | ConstraintSource::TendonFriction(_)
            | ConstraintSource::Contact(_) => continue,
        };
        for (row, &pos) in rows.iter().enumerate().filter(|_| record.active.lane(lane)) {
            let size = violation(record, pos).lane(lane).to_f64();
            if size > SUSPICIOUS_VIOLATION
                && size > explained(results, lane, block, row, size, softness)
            {
                worst = worse(worst, Some(Violation { source, size }));
            }
        }
    }
    worst
}

/// Returns the violation of a row that softness explains, given a violation `found`: at rest under its force, and in an
/// impact.
fn explained<T: Real>(
    results: StepResults<T>,
    lane: usize,
    block: usize,
    row: usize,
    found: f64,
    (solref, solimp): ([T; 2], [T; 5]),
) -> f64 {
    let number = |x: T| x.lane(lane).to_f64();
    let min_timeconst = results.settings.constraint_timeconst;
    let (solref, solimp) = (solref.map(number), solimp.map(number));
    let soft = Softness::new(solref, solimp, found, min_timeconst);
    let beta = match results.ws.metric.acts() {
        true => implicit_factor(results, lane, block, soft, solref),
        false => 1.0,
    };
    let block = results.ws.problem.block(block);
    let force = number(results.ws.solver.force()[block.rows()][row]).abs();
    // Each edge of a pyramid carries an equal part of the normal force.
    let shares = if block.cost.has_edges() {
        2 * (block.dim - 1)
    } else {
        1
    };
    let at_rest = beta * force / (shares as f64 * number(block.d[row])) / soft.stiffness;
    at_rest + IMPACT_SPEED / (E * soft.stiffness.sqrt())
}

/// Returns β, by which a step that evaluates rows at its end divides their R.
fn implicit_factor<T: Real>(
    results: StepResults<T>,
    lane: usize,
    block: usize,
    soft: Softness<f64>,
    solref: [f64; 2],
) -> f64 {
    let h = results.params.timestep.lane(lane).to_f64();
    let soft = match results.ws.record.blocks[block].source {
        ConstraintSource::Equality(_) | ConstraintSource::Dynamic { .. } => soft,
        _ if results.settings.flags.refsafe => soft.resolved(solref, h),
        ConstraintSource::DofFriction(_)
        | ConstraintSource::TendonFriction(_)
        | ConstraintSource::JointLimit(_)
        | ConstraintSource::TendonLimit(_)
        | ConstraintSource::Contact(_) => soft,
    };
    1.0 + h * soft.damping + h * h * soft.stiffness
}

/// A measure of severity.
trait Bad: Copy {
    fn badness(&self) -> f64;
}

impl Bad for DeepContact {
    fn badness(&self) -> f64 {
        self.depth
    }
}

impl Bad for Violation {
    fn badness(&self) -> f64 {
        self.size
    }
}

/// Returns the worse of two, if there are any; the first of equal ones.
fn worse<B: Bad>(one: Option<B>, other: Option<B>) -> Option<B> {
    match (one, other) {
        (Some(one), Some(other)) if other.badness() > one.badness() => Some(other),
        (Some(one), _) => Some(one),
        (None, other) => other,
    }
}

impl AddAssign for Quality {
    fn add_assign(&mut self, other: Self) {
        self.steps += other.steps;
        self.constrained += other.constrained;
        self.unconverged += other.unconverged;
        self.gap_max = self.gap_max.max(other.gap_max);
        self.contacts_max = self.contacts_max.max(other.contacts_max);
        self.penetration_max = self.penetration_max.max(other.penetration_max);
        self.deep += other.deep;
        self.deepest = worse(self.deepest, other.deepest);
        self.violated += other.violated;
        self.worst_violation = worse(self.worst_violation, other.worst_violation);
    }
}
