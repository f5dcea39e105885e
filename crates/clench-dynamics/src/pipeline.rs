//! The stages of a step. Each reads from the workspace the results of the stages before it.

use crate::constraint::{assemble, constraint_stage};
use crate::contact::detect;
use crate::context::StepContext;
use crate::dynamics::actuation::actuation;
use crate::dynamics::adhesion::adhesion;
use crate::dynamics::articulated::articulated_factor;
use crate::dynamics::bias::bias_forces;
use crate::dynamics::com::com_positions;
use crate::dynamics::discrete::{apply_metric, discrete};
use crate::dynamics::energy::{Energy, energy};
use crate::dynamics::euler::euler;
use crate::dynamics::implicit::{implicit, implicit_fast};
use crate::dynamics::inertia::composite_inertia;
use crate::dynamics::kinematics::{Computed, kinematics};
use crate::dynamics::passive::passive_forces;
use crate::dynamics::rk4::rk4;
use crate::dynamics::smooth::{smooth_acceleration, smooth_forces};
use crate::dynamics::tendon::tendons;
use crate::dynamics::tendon_armature::{add_tendon_bias, add_tendon_inertia};
use crate::dynamics::transmission::transmissions;
use crate::dynamics::velocity::velocities;
use crate::model::{Integrator, Model, Params};
use crate::part::Part;
use crate::profile::Stage;
use crate::sleep;
use crate::stages::Positions;
use crate::state::State;
use crate::stiction::drag;
use crate::workspace::{EnergyScratch, Workspace};
use clench_math::{Mask, Real};
use clench_solver::TreeMatrix;

/// Computes the quantities that depend on positions: poses, spatial inertias and dof axes, tendons and transmissions,
/// and the mass matrix with its factor.
pub fn position_stage<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    ws: &mut Workspace<T>,
) {
    ws.invalidate_poses();
    positions(model, params, state, ws);
}

/// Does the same, but reuses the workspace's poses of bodies that are fixed to the world, and of trees that sleep as in
/// the last pass, which [`Sleep::parts`](sleep::Sleep::parts) omits.
fn positions<T: Real>(model: &Model, params: &Params<T>, state: &State<T>, ws: &mut Workspace<T>) {
    let computed = Computed {
        parts: ws.sleep.parts(&ws.fixed),
        fixed: !ws.fixed.is_computed(),
    };
    let pos = &mut ws.position;
    poses(model, params, state, computed, pos);
    ws.fixed.mark_computed();
    ws.clock.lap(Stage::Kinematics as usize);
    let (mass, factor) = match ws.metric.acts() {
        true => (&mut ws.metric.mass, &mut ws.metric.mass_factor),
        false => (&mut ws.problem.mass, &mut ws.problem.mass_factor),
    };
    mass_matrix(model, params, ws.sleep.computed(), pos, mass);
    ws.clock.lap(Stage::Inertia as usize);
    ws.singular = !if T::IS_DUAL && ws.constant_factor {
        factor.factor_values(&model.tree, mass)
    } else if ws.articulated.is_empty() {
        ws.solver.factor(factor, ws.sleep.rows(model), mass)
    } else {
        articulated_factor(model, params, pos, |_| T::ZERO, &mut ws.articulated, factor)
    };
    ws.clock.lap(Stage::MassFactorization as usize);
}

/// Computes the poses of some bodies, and tendons and transmissions.
pub fn poses<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    computed: Computed,
    pos: &mut Positions<T>,
) {
    body_poses(model, params, state, computed, pos);
    tendons(model, params, &state.qpos, pos);
    transmissions(model, params, &state.qpos, pos);
}

/// Computes the poses of some bodies.
pub fn body_poses<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    computed: Computed,
    pos: &mut Positions<T>,
) {
    kinematics(model, params, state, computed, pos);
    com_positions(model, params, computed.parts, pos);
}

/// Computes the mass matrix of some parts at given poses, with the inertia of tendons. The parts include all dofs of
/// tendons.
fn mass_matrix<T: Real>(
    model: &Model,
    params: &Params<T>,
    parts: &[Part],
    pos: &mut Positions<T>,
    mass: &mut TreeMatrix<T>,
) {
    composite_inertia(model, params, parts, pos, mass);
    add_tendon_inertia(model, params, pos, mass);
}

/// Computes the energy of a state, independently of the workspace and without changing it.
pub fn state_energy<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    scratch: &mut EnergyScratch<T>,
) -> Energy<T> {
    let EnergyScratch { position, mass } = scratch;
    let whole = [Part::whole(model)];
    poses(model, params, state, Computed::all(&whole), position);
    mass_matrix(model, params, &whole, position, mass);
    energy(model, params, position, mass, state)
}

/// Computes the quantities that also depend on velocities: velocities of bodies, tendons and actuators, passive and
/// bias forces.
pub fn velocity_stage<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    ws: &mut Workspace<T>,
) {
    let (pos, vel, force) = (&ws.position, &mut ws.velocity, &mut ws.force);
    let parts = ws.sleep.computed();
    velocities(model, parts, pos, &state.qvel, vel);
    let at = (pos, &*vel);
    passive_forces(model, params, parts, at, state, &ws.contacts, force);
    bias_forces(model, params, parts, pos, vel, &state.qvel, force);
    add_tendon_bias(model, params, pos, vel, &state.qvel, force);
    ws.clock.lap(Stage::Velocity as usize);
}

/// Computes actuator forces, the sum of all smooth forces, and the unconstrained acceleration.
pub(crate) fn force_stage<T: Real>(
    context: StepContext<T>,
    state: &State<T>,
    ws: &mut Workspace<T>,
) {
    let StepContext { model, params, .. } = context;
    let (pos, vel, force) = (&ws.position, &ws.velocity, &mut ws.force);
    actuation(model, params, state, pos, vel, ws.integration.offset, force);
    smooth_forces(model, ws.sleep.computed(), state, pos, force);
    if ws.metric.acts() {
        apply_metric(context, state, ws);
    }
    let parts = (ws.sleep.computed(), ws.sleep.rows(model));
    let forces = (&ws.force.qfrc_smooth[..], &ws.metric.shift[..]);
    smooth_acceleration(parts, forces, &mut ws.problem, ws.constant_factor);
    ws.clock.lap(Stage::Force as usize);
}

/// Computes everything that follows from the state: forward dynamics and sensors.
pub fn forward<T: Real>(context: StepContext<T>, state: &State<T>, ws: &mut Workspace<T>) {
    forward_dynamics(context, state, ws);
    (context.sensors)(context, state, ws);
    ws.clock.lap(Stage::Sensors as usize);
}

/// Computes forward dynamics, up to `ws.qacc` and the constraint forces.
fn forward_dynamics<T: Real>(context: StepContext<T>, state: &State<T>, ws: &mut Workspace<T>) {
    before_forces(context, state, ws);
    from_forces(context, state, ws);
}

/// Computes the first half of forward dynamics, before controls act: everything that depends only on positions and
/// velocities, contacts included. (MuJoCo's `mj_step1`.)
pub fn before_forces<T: Real>(context: StepContext<T>, state: &State<T>, ws: &mut Workspace<T>) {
    let StepContext {
        model,
        params,
        settings,
        ..
    } = context;
    ws.clock.start();
    if settings.flags.sleep {
        wake(context, state, ws);
    } else {
        positions(model, params, state, ws);
        detect(context, ws);
    }
    adhesion(model, &ws.contacts, &mut ws.position);
    velocity_stage(model, params, state, ws);
}

/// Computes positions and contacts of awake trees, and wakes trees as soon as the cause is computed.
fn wake<T: Real>(context: StepContext<T>, state: &State<T>, ws: &mut Workspace<T>) {
    let StepContext { model, params, .. } = context;
    sleep::wake_touched(model, state, ws);
    ws.sleep.find_parts(model, state, &ws.fixed);
    positions(model, params, state, ws);
    let mut woke = sleep::wake_pulled(context, ws);
    detect(context, ws);
    while sleep::wake_touching(model, ws) {
        woke = true;
        detect(context, ws);
    }
    woke |= sleep::wake_coupled(model, state, ws);
    ws.sleep.add_woken(model, state, &ws.fixed, woke);
}

/// Computes the second half of forward dynamics: forces, including those of controls, and constraints.
fn from_forces<T: Real>(context: StepContext<T>, state: &State<T>, ws: &mut Workspace<T>) {
    let StepContext {
        model, settings, ..
    } = context;
    force_stage(context, state, ws);
    constraint_stage(context, state, ws);
    if settings.flags.sleep {
        ws.sleep.clear_sleeping(model, &mut ws.qacc);
        if !ws.singular.any() {
            ws.sleep.record_pass(model, state);
        }
    }
}

/// Advances the state by one time step. The next step's solver starts from this step's acceleration.
pub fn step<T: Real>(context: StepContext<T>, state: &mut State<T>, ws: &mut Workspace<T>) {
    let StepContext {
        model, settings, ..
    } = context;
    if step_asleep(context, state, ws) {
        return;
    }
    if settings.flags.sleep && sleep::is_idle(model, state, ws) {
        idle(context, state, ws);
        return;
    }
    before_forces(context, state, ws);
    step_from_forces(context, state, ws);
}

/// Does the step if everything sleeps as the last step left it, so that only time changes. Returns true if it did.
pub fn step_asleep<T: Real>(
    context: StepContext<T>,
    state: &mut State<T>,
    ws: &mut Workspace<T>,
) -> bool {
    let StepContext {
        model, settings, ..
    } = context;
    let unchanged = settings.flags.sleep && sleep::sleeps_unchanged(model, state, ws);
    if unchanged {
        advance_time(context, state, ws);
    }
    unchanged
}

/// Does a step that only advances time.
fn advance_time<T: Real>(context: StepContext<T>, state: &mut State<T>, ws: &mut Workspace<T>) {
    let StepContext { params, .. } = context;
    (context.sensors)(context, state, ws);
    state.pass(params.timestep);
}

/// Does a step in which nothing is awake.
fn idle<T: Real>(context: StepContext<T>, state: &mut State<T>, ws: &mut Workspace<T>) {
    let StepContext { model, .. } = context;
    if !ws.sleep.is_at_rest() {
        clear(context, state, ws);
    }
    advance_time(context, state, ws);
    sleep::restore_sleeping(model, state, ws);
    state.qacc_warmstart.fill(T::ZERO);
}

/// Clears contacts, constraints and failures in the workspace. Its poses and forces are not updated.
fn clear<T: Real>(context: StepContext<T>, state: &State<T>, ws: &mut Workspace<T>) {
    ws.sleep.invalidate();
    ws.contacts.clear();
    ws.collision.excess = T::ZERO;
    ws.collision.overflow = T::Mask::splat(false);
    ws.singular = T::Mask::splat(false);
    ws.problem.qacc_smooth.fill(T::ZERO);
    assemble(context, state, ws);
    (ws.solver.solve(&ws.problem, &context.settings.solver, None))
        .expect("a problem without constraints has the model's lengths");
    ws.qacc.fill(T::ZERO);
    ws.qfrc_constraint.fill(T::ZERO);
}

/// Does the remainder of a step after positions and contacts: reuses those of the last pass, which was for the same
/// positions. Trees must not sleep.
pub fn step_from_velocities<T: Real>(
    context: StepContext<T>,
    state: &mut State<T>,
    ws: &mut Workspace<T>,
) {
    let StepContext { model, params, .. } = context;
    velocity_stage(model, params, state, ws);
    step_from_forces(context, state, ws);
}

/// Does the remainder of a step after [`before_forces`], for the same positions and velocities. (MuJoCo's `mj_step2`.)
pub fn step_from_forces<T: Real>(
    context: StepContext<T>,
    state: &mut State<T>,
    ws: &mut Workspace<T>,
) {
    let StepContext {
        model,
        params,
        settings,
        ..
    } = context;
    from_forces(context, state, ws);
    (context.sensors)(context, state, ws);
    ws.clock.lap(Stage::Sensors as usize);
    if settings.stiction {
        drag(model, params, state, ws);
    }
    if settings.flags.sleep {
        sleep::fall_asleep(context, state, ws);
    }
    match model.integrator {
        Integrator::Euler => euler(model, params, state, ws),
        Integrator::ImplicitFast => implicit_fast(model, params, state, ws),
        Integrator::Implicit => implicit(model, params, state, ws),
        Integrator::Discrete => discrete(model, params, state, ws),
        Integrator::Rk4 => rk4(model, params, state, ws, |state, ws| {
            forward_dynamics(context, state, ws);
        }),
    }
    if settings.flags.sleep {
        sleep::restore_sleeping(model, state, ws);
    }
    state.qacc_warmstart.copy_from_slice(&ws.qacc);
    ws.clock.lap(Stage::Integration as usize);
}
