//! The constraint stage: every active constraint becomes a block of the convex problem, which is solved once.
//!
//! Each file derives one kind of constraint; `softness` converts solref and solimp into stiffness, damping and R;
//! `assembly` computes aref. Blocks are in MuJoCo's order: equalities, dry friction, limits, contacts. Constraints
//! added at run time follow the equalities.

mod active;
mod anchor_frames;
pub(crate) mod assembly;
pub mod at_distance;
mod connect;
mod contact;
mod context;
mod coordinate;
pub mod dynamic;
mod exact;
mod friction;
mod implicit;
mod joint_equality;
mod limit;
mod row;
pub mod softness;
mod weld;

pub use crate::record::{BlockRecord, ConstraintRecord, ConstraintSource};
pub use anchor_frames::AnchorFrames;
use context::ConstraintContext;
pub use joint_equality::{equality_rates, equality_slope};
pub use softness::{DEFAULT_SOLIMP, DEFAULT_SOLREF, Softness, impedance};
pub use weld::weld_torque;

use crate::contact::Contact;
use crate::context::StepContext;
use crate::dynamics::discrete::{append_couplings, couple_smooth, spin_freely, subtract_couplings};
use crate::model::{EqualityTarget, Params};
use crate::options::ContactModel;
use crate::profile::Stage;
use crate::settings::StepSettings;
use crate::state::State;
use crate::workspace::Workspace;
use anchor_frames::FrameConstraint;
use assembly::Assembly;
use clench_math::{Mask, Real, kernel};
use clench_solver::ConstraintSolver;
use coordinate::Coordinate;
use exact::ExactDiagonal;
use implicit::ImplicitRows;

/// Assembles the constraints of a configuration, solves the problem, and stores the acceleration in `ws.qacc` and the
/// constraint forces along dofs in `ws.qfrc_constraint`.
///
/// Reads poses, velocities and contacts of the workspace, and the problem's factored mass and unconstrained
/// acceleration.
pub fn constraint_stage<T: Real>(context: StepContext<T>, state: &State<T>, ws: &mut Workspace<T>) {
    let StepContext {
        model,
        params,
        settings,
        ..
    } = context;
    let in_metric = ws.metric.acts();
    if in_metric {
        couple_smooth(model, &settings.solver, ws);
    }
    if !(T::IS_DUAL && ws.reuse_constraints) {
        assemble(context, state, ws);
    }
    if in_metric {
        append_couplings(model, &settings.solver, ws);
    }
    ws.problem.rest.clear();
    let is_cg = settings.solver.constraint_solver == ConstraintSolver::Cg;
    if is_cg && settings.contact_model == ContactModel::Coulomb {
        let rest = state.qvel.iter().map(|&v| -v / params.timestep);
        ws.problem.rest.extend(rest);
    }
    ws.clock.lap(Stage::Assembly as usize);
    let warmstart = Some(&state.qacc_warmstart[..]);
    (ws.solver.solve(&ws.problem, &settings.solver, warmstart))
        .expect("the arrays of a state and a workspace have the model's lengths");
    ws.qacc.copy_from_slice(ws.solver.qacc());
    ws.qfrc_constraint
        .copy_from_slice(ws.solver.qfrc_constraint());
    if in_metric {
        let (problem, qfrc) = (&ws.problem, &mut ws.qfrc_constraint);
        subtract_couplings(problem, &ws.record, ws.solver.force(), qfrc);
        spin_freely(model, params, &state.qvel, ws);
    }
    ws.clock.lap(Stage::Solve as usize);
}

/// Replaces the problem's blocks with those of the configuration.
#[kernel]
pub fn assemble<T: Real>(context: StepContext<T>, state: &State<T>, ws: &mut Workspace<T>) {
    let StepContext {
        model,
        params,
        settings,
        ..
    } = context;
    ws.problem.clear_constraints();
    ws.record.clear();
    ws.stiction.clear();
    if !settings.flags.constraint {
        return;
    }
    // Rows are appended to the problem while the displacements and the factor of its mass are read.
    let mut stiction = std::mem::take(&mut ws.stiction);
    let sticks = settings.stiction && model.max_stick_pairs.is_some();
    if sticks {
        stiction.find(model, state, &ws.position, &ws.contacts);
    }
    let mut slopes = std::mem::take(&mut stiction.slopes);
    let context = ConstraintContext {
        model,
        params,
        settings,
        state,
        position: &ws.position,
        velocity: &ws.velocity,
        sleep: &ws.sleep,
        stiction: sticks.then_some(&stiction),
        min_timeconst: min_timeconst(params, settings, ws.metric.acts()),
        impratio: T::new(settings.impratio),
        metric: ws.metric.acts().then_some(&ws.metric),
    };
    let factor = std::mem::take(&mut ws.problem.mass_factor);
    let exact = settings.flags.diagexact.then(|| ExactDiagonal {
        tree: &model.tree,
        factor: ws.metric.backbone_factor().unwrap_or(&factor),
        impratio: context.impratio,
        scratch: &mut ws.integration.qacc,
    });
    let mut out = Assembly {
        problem: &mut ws.problem,
        record: &mut ws.record,
        qvel: &state.qvel,
        dof_invweight0: &params.dof_invweight0,
        exact,
        implicit: context.metric.map(|metric| ImplicitRows {
            tree: &model.tree,
            metric,
            timestep: params.timestep,
            impratio: context.impratio,
        }),
        slopes: sticks.then_some(&mut slopes),
    };
    if settings.flags.equality {
        push_equalities(&context, &mut out);
        dynamic::push_all(&context, &mut out);
    }
    if settings.flags.frictionloss {
        friction::push_all(&context, &mut out);
    }
    if settings.enable_joint_limit {
        limit::push_joints(&context, &mut out);
    }
    if settings.flags.limit {
        limit::push_tendons(&context, &mut out);
    }
    if settings.flags.contact {
        push_contacts(&context, &mut out, &mut ws.contacts);
    }
    ws.problem.mass_factor = factor;
    stiction.slopes = slopes;
    ws.stiction = stiction;
}

#[inline(always)]
fn min_timeconst<T: Real>(params: &Params<T>, settings: &StepSettings, in_metric: bool) -> T {
    let floor = T::new(settings.constraint_timeconst);
    // Steps that evaluate constraints at their end are always stable.
    if settings.flags.refsafe && !in_metric {
        floor.max(params.timestep * T::new(2.0))
    } else {
        floor
    }
}

#[kernel]
fn push_equalities<T: Real>(context: &ConstraintContext<T>, out: &mut Assembly<T>) {
    for (i, equality) in context.model.equalities.iter().enumerate() {
        if !context.active_equality(i).any() {
            continue;
        }
        match equality.target {
            EqualityTarget::Connect { body1, body2 } => {
                connect::push(
                    context,
                    out,
                    &FrameConstraint::by_equality(context, i, [body1, body2]),
                );
            }
            EqualityTarget::Weld { body1, body2 } => {
                weld::push(
                    context,
                    out,
                    &FrameConstraint::by_equality(context, i, [body1, body2]),
                );
            }
            EqualityTarget::Joint { joint1, joint2 } => {
                let leader = joint2.map(Coordinate::Joint);
                joint_equality::push(context, out, i, Coordinate::Joint(joint1), leader);
            }
            EqualityTarget::Tendon { tendon1, tendon2 } => {
                let leader = tendon2.map(Coordinate::Tendon);
                joint_equality::push(context, out, i, Coordinate::Tendon(tendon1), leader);
            }
        }
    }
}

fn push_contacts<T: Real>(
    context: &ConstraintContext<T>,
    out: &mut Assembly<T>,
    contacts: &mut [Contact<T>],
) {
    for (i, contact) in contacts.iter_mut().enumerate() {
        contact::push(context, out, i, contact);
    }
}
