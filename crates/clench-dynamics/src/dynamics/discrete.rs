//! Velocity stepping: the solver's result is the step (MuJoCo's `discrete`).
//!
//! The [`metric`](crate::dynamics::metric) replaces the mass matrix in the convex problem, and constraint rows are
//! evaluated at the end of the step (see `constraint::softness`). The minimising acceleration is the change of the
//! velocity over h, so only positions remain to be integrated. A free body that is its own tree, without constraints or
//! couplings of the metric, is solved once more with its gyroscopic forces.

use crate::context::StepContext;
use crate::dynamics::ellipsoid::FluidForces;
use crate::dynamics::gyroscopic::{gyroscopic_product, is_free_tree, solve_gyroscopic};
use crate::dynamics::integrate::{add_scaled, advance_semi_implicit};
use crate::dynamics::metric::{Metric, add_metric, each_arm};
use crate::model::{Model, Params};
use crate::record::ConstraintRecord;
use crate::stages::Positions;
use crate::state::State;
use crate::workspace::Workspace;
use clench_math::{Mask, Real, array, kernel};
use clench_solver::{ConstraintSolver, Cost, Problem, Settings};

/// The number of Newton steps for a quadratic cost: one reaches its minimum, more remove rounding errors.
const EXACT_STEPS: usize = 4;

/// Replaces the mass matrix with the metric of the state, after actuators have their forces.
#[kernel]
pub(crate) fn apply_metric<T: Real>(
    context: StepContext<T>,
    state: &State<T>,
    ws: &mut Workspace<T>,
) {
    let StepContext {
        model,
        params,
        settings,
        ..
    } = context;
    let stages = (&ws.position, &ws.velocity, &ws.force);
    let mass = &mut ws.problem.mass;
    add_metric(model, params, state, stages, &mut ws.metric, mass);
    ws.singular |= !ws
        .solver
        .factor(&mut ws.problem.mass_factor, &model.tree, &ws.problem.mass);
    if settings.flags.diagexact || settings.solver.noslip_iterations > 0 {
        ws.singular |= !ws.metric.factor_backbone(&model.tree, &ws.solver);
    }
}

/// Computes `qacc_smooth`, the acceleration without constraints, in a metric that couples branches. The problem
/// provides it without these couplings.
pub(crate) fn couple_smooth<T: Real>(model: &Model, settings: &Settings, ws: &mut Workspace<T>) {
    if !ws.metric.is_coupled() {
        return;
    }
    ws.problem.clear_constraints();
    let all = (&ws.metric, T::Mask::splat(true));
    push_couplings(model, all, &ws.position, &mut ws.problem, |_| T::ZERO);
    let exact = Settings {
        constraint_solver: ConstraintSolver::Newton,
        tolerance: 0.0,
        iterations: EXACT_STEPS,
        ls_iterations: EXACT_STEPS,
        noslip_iterations: 0,
        ..*settings
    };
    (ws.solver.solve(&ws.problem, &exact, None))
        .expect("the arrays of a workspace have the model's lengths");
    ws.problem.qacc_smooth.copy_from_slice(ws.solver.qacc());
}

/// Appends the couplings of the metric to the constraints of the problem, relative to the acceleration without
/// constraints, in lanes in which a constraint acts.
pub(crate) fn append_couplings<T: Real>(model: &Model, settings: &Settings, ws: &mut Workspace<T>) {
    ws.problem.noslip_factor.clear();
    if let (true, Some(factor)) = (settings.noslip_iterations > 0, ws.metric.backbone_factor()) {
        ws.problem.noslip_factor.copy_from(factor);
    }
    ws.problem.begin_metric_terms();
    if !ws.metric.is_coupled() {
        return;
    }
    let mut lanes = T::Mask::splat(false);
    for block in ws.problem.blocks() {
        lanes |= acting(block.d);
    }
    let smooth = std::mem::take(&mut ws.problem.qacc_smooth);
    push_couplings(
        model,
        (&ws.metric, lanes),
        &ws.position,
        &mut ws.problem,
        #[inline(always)]
        |dof| smooth[dof],
    );
    ws.problem.qacc_smooth = smooth;
}

/// Returns the lanes in which a block acts.
#[inline(always)]
fn acting<T: Real>(d: &[T]) -> T::Mask {
    let no = T::Mask::splat(false);
    d.iter().fold(no, |acts, d| acts | d.gt(T::ZERO))
}

/// Appends the rows ½ s (J a − J a_s)², in some lanes.
#[kernel]
fn push_couplings<T: Real>(
    model: &Model,
    (metric, lanes): (&Metric<T>, T::Mask),
    pos: &Positions<T>,
    problem: &mut Problem<T>,
    about: impl Fn(usize) -> T,
) {
    for (&along, &scale) in metric.couplings.iter().zip(&metric.scales) {
        let acts = lanes & scale.gt(T::ZERO);
        if !acts.any() {
            continue;
        }
        let block = problem.push(Cost::Quadratic, 1, along.dofs(model));
        let (mut column, mut sum) = (0, T::ZERO);
        each_arm(
            model,
            pos,
            along,
            #[inline(always)]
            |dof, arm| {
                block.jacobian[column] = arm;
                sum += arm * about(dof);
                column += 1;
            },
        );
        block.aref[0] = sum;
        block.d[0] = T::select(acts, scale, T::ZERO);
        block.r[0] = T::ONE / T::select(acts, scale, T::ONE);
    }
}

/// Subtracts the forces of the metric's couplings from `qfrc_constraint`, the sum of the forces of all rows.
#[kernel]
pub(crate) fn subtract_couplings<T: Real>(
    problem: &Problem<T>,
    record: &ConstraintRecord<T>,
    force: &[T],
    qfrc_constraint: &mut [T],
) {
    for block in problem.blocks().skip(record.blocks.len()) {
        for (&dof, &arm) in block.dofs.iter().zip(block.jacobian) {
            qfrc_constraint[dof as usize] -= arm * force[block.row];
        }
    }
}

/// Solves once more for untouched free bodies, with their gyroscopic forces.
#[kernel]
pub fn spin_freely<T: Real>(model: &Model, params: &Params<T>, qvel: &[T], ws: &mut Workspace<T>) {
    let Workspace {
        position: pos,
        velocity: vel,
        force,
        problem,
        metric,
        qacc,
        ..
    } = ws;
    mark_touched(model, problem, &mut metric.touched);
    let total = |i: usize| force.qfrc_smooth[i] + metric.shift[i];
    for (j, joint) in model.joints.iter().enumerate() {
        let free = is_free_tree(model, j);
        let untouched = !metric.touched[model.tree.tree_of(joint.dof)];
        if !free || !untouched.any() {
            continue;
        }
        let system = (&problem.mass, array(|r| total(joint.dof + r)));
        let stages = (pos as &_, vel as &_);
        let x = solve_gyroscopic(model, params, j, qvel, stages, FluidForces::Drag, system);
        for (qacc, x) in qacc[joint.dof..].iter_mut().zip(x) {
            *qacc = T::select(untouched, x, *qacc);
        }
    }
}

/// Adds the terms of the metric beyond the problem's mass matrix to inverse dynamics: its couplings, gyroscopic forces
/// of untouched free bodies, and h K v.
#[kernel]
pub(crate) fn add_metric_forces<T: Real>(
    model: &Model,
    params: &Params<T>,
    qvel: &[T],
    ws: &mut Workspace<T>,
    qfrc: &mut [T],
) {
    let Workspace {
        position: pos,
        velocity: vel,
        problem,
        metric,
        qacc,
        ..
    } = ws;
    add_scaled(qfrc, &metric.shift, -T::ONE);
    for (&along, &scale) in metric.couplings.iter().zip(&metric.scales) {
        let mut rate = T::ZERO;
        each_arm(model, pos, along, |dof, arm| rate += arm * qacc[dof]);
        each_arm(model, pos, along, |dof, arm| {
            qfrc[dof] += scale * rate * arm
        });
    }
    mark_touched(model, problem, &mut metric.touched);
    for (j, joint) in model.joints.iter().enumerate() {
        let untouched = !metric.touched[model.tree.tree_of(joint.dof)];
        if !is_free_tree(model, j) || !untouched.any() {
            continue;
        }
        let product =
            gyroscopic_product(model, params, j, qvel, (pos, vel), FluidForces::Drag, qacc);
        for (qfrc, x) in qfrc[joint.dof..].iter_mut().zip(product) {
            *qfrc += T::select(untouched, x, T::ZERO);
        }
    }
}

/// Records the trees on which constraints act.
#[inline(always)]
fn mark_touched<T: Real>(model: &Model, problem: &Problem<T>, touched: &mut [T::Mask]) {
    for block in problem.blocks() {
        let acts = acting(block.d);
        for &dof in block.dofs {
            touched[model.tree.tree_of(dof as usize)] |= acts;
        }
    }
}

/// Advances the state by a time step with the acceleration of `ws`.
#[kernel]
pub fn discrete<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &mut State<T>,
    ws: &mut Workspace<T>,
) {
    ws.integration.qacc.copy_from_slice(&ws.qacc);
    advance_semi_implicit(model, params, state, ws);
}
