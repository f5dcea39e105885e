//! How well the steps of a run went: what it is judged by.
//!
//! A constraint is soft: some violation r of it is explained by what it carries and by what it stops. With R the
//! regularization of its row, f its force, and k d the stiffness of its own solref and solimp (see `constraint::softness`):
//!
//! ```text
//! at rest        aref = −k d r = −R f:                      r = R f / (k d), times β under the integrator `discrete`
//! in an impact   critically damped, r″ = −k d r − b r′:     r ≤ v / (e √(k d)) at an approach of v
//! ```
//!
//! The stiffness is that of the model as written. Where a time step is too long for it, a step is softer than that
//! (`refsafe`), and what comes of it is not what the model asks for.

use clench_collide::ShapeKind;
use clench_dynamics::constraint::dynamic::softness;
use clench_dynamics::constraint::{BlockRecord, ConstraintSource, Softness};
use clench_dynamics::contact::Contact;
use clench_dynamics::model::{Model, Params};
use clench_dynamics::settings::StepSettings;
use clench_dynamics::workspace::Workspace;
use clench_math::{Mask, Real, Scalar, Vec3, kernel};
use clench_solver::{Cost, Status};
use std::f64::consts::E;
use std::ops::AddAssign;

/// No violation of an equality or a limit is suspicious that is smaller, m or rad: a finger's breadth, some six degrees.
const SUSPICIOUS_VIOLATION: f64 = 0.1;
/// What an impact at this speed explains is not suspicious, m/s or rad/s: a fall from 1.3 m.
const IMPACT_SPEED: f64 = 5.0;

/// Sums and extremes over steps (and forward passes) of environments, but for those in which an environment failed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quality {
    /// Steps.
    pub steps: u64,
    /// Steps in which constraints acted.
    pub constrained: u64,
    /// Steps whose solve stopped at the iteration limit.
    pub unconverged: u64,
    /// Largest duality gap: how far a solution's cost may lie above the minimum.
    pub gap_max: f64,
    /// Most contacts.
    pub contacts_max: u64,
    /// Deepest penetration, m; 0 where nothing penetrates.
    pub penetration_max: f64,
    /// Steps in which some contact was too deep: deeper than half the thickness of one of its geoms, so that its centre or
    /// middle plane is past the other's surface, and deeper than softness explains. Planes and height fields have no thickness
    /// here: all below them is inside.
    pub deep: u64,
    /// The deepest of these contacts.
    pub deepest: Option<DeepContact>,
    /// Steps in which some equality or limit was violated by more than 0.1 (m or rad), and more than softness explains.
    pub violated: u64,
    /// The worst of these violations.
    pub worst_violation: Option<Violation>,
}

/// A contact that is too deep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeepContact {
    /// Between these geoms.
    pub geoms: [usize; 2],
    /// m.
    pub depth: f64,
}

/// An equality or a limit that is not kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violation {
    /// Which.
    pub source: ConstraintSource,
    /// m or rad.
    pub size: f64,
}

/// What a step left in a workspace, and what it is read with.
#[derive(Clone, Copy)]
pub(crate) struct StepResults<'a, T: Real> {
    pub model: &'a Model,
    pub params: &'a Params<T>,
    pub settings: &'a StepSettings,
    pub ws: &'a Workspace<T>,
}

impl Quality {
    /// Takes in the `good` ones of the first `len` lanes, in which environments are.
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

/// The figures of a step, lane by lane.
struct StepFigures<T: Real> {
    /// How many contacts there are.
    contacts: T,
    /// How deep the deepest is, m.
    depth: T,
    /// Where some contact is deeper than half the thickness of a geom.
    deep: T::Mask,
    /// Where some equality or limit is violated suspiciously.
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
    for (_, record, pos) in held(results.ws) {
        for &pos in pos {
            let size = violation(record, pos);
            figures.violated |= record.active & size.gt(T::new(SUSPICIOUS_VIOLATION));
        }
    }
    figures
}

/// Half the thickness of the thinner geom of a contact.
#[inline(always)]
fn half_thickness<T: Real>(results: StepResults<T>, contact: &Contact<T>) -> T {
    let half = |g: usize| {
        let Vec3 { x, y, z } = results.params.geom_size[g];
        match results.model.geoms[g].kind {
            ShapeKind::Plane | ShapeKind::HeightField => T::new(f64::INFINITY),
            ShapeKind::Sphere | ShapeKind::Capsule => x,
            ShapeKind::Cylinder => x.min(y),
            ShapeKind::Ellipsoid | ShapeKind::Box => x.min(y).min(z),
            // One that is flat has no inside.
            ShapeKind::Mesh => {
                let half = x.min(y).min(z);
                T::select(half.gt(T::ZERO), half, T::new(f64::INFINITY))
            }
        }
    };
    half(contact.geoms[0]).min(half(contact.geoms[1]))
}

/// The blocks of equalities and limits by their number, with what is known of each and the positions of its rows.
#[inline(always)]
fn held<T: Real>(ws: &Workspace<T>) -> impl Iterator<Item = (usize, &BlockRecord<T>, &[T])> {
    let blocks = ws.record.blocks.iter().enumerate();
    // Contacts come last.
    let others =
        blocks.take_while(|(_, record)| !matches!(record.source, ConstraintSource::Contact(_)));
    let held = others.filter(|(_, record)| {
        use ConstraintSource::{DofFriction, TendonFriction};
        !matches!(record.source, DofFriction(_) | TendonFriction(_))
    });
    held.map(|(i, record)| (i, record, &ws.record.pos[ws.problem.block(i).rows()]))
}

/// By how much a row of an equality or a limit at `pos` is violated.
#[inline(always)]
fn violation<T: Real>(record: &BlockRecord<T>, pos: T) -> T {
    match record.source {
        ConstraintSource::Equality(_) | ConstraintSource::Dynamic { .. } => pos.abs(),
        _ => record.margin - pos,
    }
}

/// The deepest contact of a lane among those that are too deep.
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

/// The worst violation of an equality or a limit in a lane, among those that softness does not explain.
fn worst_violation<T: Real>(results: StepResults<T>, lane: usize) -> Option<Violation> {
    let p = results.params;
    let mut worst = None;
    for (block, record, rows) in held(results.ws) {
        let source = record.source;
        let softness = match source {
            ConstraintSource::Equality(i) => (p.eq_solref[i], p.eq_solimp[i]),
            ConstraintSource::Dynamic { .. } => softness(),
            ConstraintSource::JointLimit(i) => (p.jnt_solref[i], p.jnt_solimp[i]),
            ConstraintSource::TendonLimit(i) => (p.tendon_solref_lim[i], p.tendon_solimp_lim[i]),
            _ => continue,
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

/// The violation of a row that softness explains, where it is `found` one: at rest under its force, and in an impact.
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
    // Each edge of a pyramid carries its share of the normal force.
    let shares = if block.cost == Cost::Pyramid {
        2 * (block.dim - 1)
    } else {
        1
    };
    let at_rest = beta * force / (shares as f64 * number(block.d[row])) / soft.stiffness;
    at_rest + IMPACT_SPEED / (E * soft.stiffness.sqrt())
}

/// β: what a step that takes rows at its end has divided R of a block's rows by.
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
        _ => soft,
    };
    1.0 + h * soft.damping + h * h * soft.stiffness
}

/// How bad something is.
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

/// The worse of two, if there are any; the first of equals.
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
