//! The fields of each environment in the device's memory, one per line. Offsets, sizes, the constants of the kernels
//! and the names for reading and writing are derived from these tables.

use crate::solver_memory::TILE;
use crate::tables::{BLOCK_SIZE, CONTACT_SIZE, Capacity, has_sensor_history};
use clench_rigid::dynamics::plastic::has_yielding_tendons;
use clench_rigid::model::{Integrator, Model};
use clench_rigid::state::Size;
use clench_rigid::state::kind::{Kind, Reference};
use clench_solver::MAX_ELIMINATED;

/// A field: `width` numbers per environment, from an offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Field {
    /// The name; in capitals, its offset in the kernels.
    pub name: &'static str,
    /// The offset.
    pub offset: usize,
    /// The number of values.
    pub width: usize,
}

/// The fields of one buffer.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Fields {
    /// All fields, in order.
    pub list: Vec<Field>,
    /// The numbers per environment.
    pub size: usize,
}

impl Fields {
    fn push(&mut self, name: &'static str, width: usize) {
        let offset = self.size;
        self.list.push(Field {
            name,
            offset,
            width,
        });
        self.size += width;
    }

    /// Returns the field with the given name.
    pub(crate) fn find(&self, name: &str) -> Option<Field> {
        self.list.iter().copied().find(|field| field.name == name)
    }
}

/// Returns true if the integrator treats Coriolis forces implicitly.
fn takes_coriolis(m: &Model) -> bool {
    m.integrator == Integrator::Implicit
}

/// Returns the dofs and tendons whose dry friction may stick.
fn friction_count(m: &Model) -> usize {
    m.max_stick_pairs.map_or(0, |_| m.nv + m.tendons.len())
}

/// Returns the numbers of the stick references.
fn reference_numbers(m: &Model) -> usize {
    Reference::WIDTH * m.max_stick_pairs.unwrap_or(0)
}

/// Returns true if Runge–Kutta steps need the tendons at their start.
fn saves_tendons(m: &Model) -> bool {
    has_yielding_tendons(m) || m.max_stick_pairs.is_some()
}

/// Returns the numbers of the poses of sleeping trees, and of mocap bodies.
fn asleep_pose(m: &Model) -> usize {
    Size::AsleepPose.of(m)
}

macro_rules! fields {
    ($(#[$doc:meta])* $maker:ident($m:ident, $c:ident); $($(#[$field_doc:meta])* $name:ident: $width:expr;)*) => {
        $(#[$doc])*
        pub(crate) fn $maker($m: &Model, $c: Capacity) -> Fields {
            let _ = ($m, $c);
            let mut fields = Fields::default();
            $(fields.push(stringify!($name), $width);)*
            fields
        }
    };
}

fields! {
    /// The fields that users set and read: the state and its inputs. Environments are interleaved.
    state_fields(m, c);
    qpos: m.nq;
    qvel: m.nv;
    act: m.na;
    /// Buffers of past controls.
    history: m.nhistory;
    /// The rest positions of springs that yield.
    plastic: m.nplastic;
    qacc_warmstart: m.nv;
    /// The stick references, and the displacements of dry friction that sticks.
    stick_references: reference_numbers(m);
    stick_friction: friction_count(m);
    ctrl: m.nu();
    qfrc_applied: m.nv;
    /// The force, then the torque, of each body.
    xfrc_applied: 6 * m.nbody();
    mocap_pos: 3 * m.nmocap;
    mocap_quat: 4 * m.nmocap;
    /// Zero if an equality is inactive.
    eq_active: m.equalities.len();
    /// The sleep counters of trees, and the poses of sleeping trees and of mocap bodies, if trees may sleep.
    tree_asleep: m.tree_asleep0.len();
    pose_asleep: asleep_pose(m);
    /// The start time of the first counted step, s.
    start_time: 1;
    /// The slots for constraints that are added at run time. They come last, so that they can be added.
    dynamic_kind: c.slots;
    dynamic_serial: c.slots;
    dynamic_body1: c.slots;
    dynamic_body2: c.slots;
    dynamic_anchor1: 3 * c.slots;
    dynamic_anchor2: 3 * c.slots;
    dynamic_quat: 4 * c.slots;
}

fields! {
    /// The quantities that depend on the state. Environments are interleaved.
    work_fields(m, c);
    xpos: 3 * m.nbody();
    xquat: 4 * m.nbody();
    xmat: 9 * m.nbody();
    xipos: 3 * m.nbody();
    ximat: 9 * m.nbody();
    xanchor: 3 * m.joints.len();
    xaxis: 3 * m.joints.len();
    geom_xpos: 3 * m.geoms.len();
    geom_xmat: 9 * m.geoms.len();
    site_xpos: 3 * m.sites.len();
    site_xmat: 9 * m.sites.len();
    cam_xpos: 3 * m.cameras.len();
    cam_xmat: 9 * m.cameras.len();
    subtree_com: 3 * m.nbody();
    cinert: 10 * m.nbody();
    crb: 10 * m.nbody();
    /// Articulated-body inertias, if paths are long.
    articulated: 27 * c.articulated;
    cdof: 6 * m.nv;
    cdof_dot: 6 * m.nv;
    cvel: 6 * m.nbody();
    /// The velocity-dependent part of the bodies' accelerations.
    cacc_bias: 6 * m.nbody();
    /// The part due to joint accelerations.
    cacc_joints: 6 * m.nbody();
    cacc: 6 * m.nbody();
    cfrc_int: 6 * m.nbody();
    cfrc_ext: 6 * m.nbody();
    contact_force: 6 * m.nbody();
    sensordata: m.nsensordata();
    /// The current measurements of sensors, before any delay.
    undelayed: if has_sensor_history(m) { m.nsensordata() } else { 0 };
    /// Potential and kinetic energy.
    mechanical_energy: 2;
    /// Spatial forces of bodies, consumed by their projection.
    cfrc: 6 * m.nbody();
    /// Velocity derivatives of fluid forces on ellipsoids, by column.
    fluid_rates: if m.bodies.iter().any(|b| b.fluid_ellipsoids) { 36 * m.nbody() } else { 0 };
    /// The mass matrix, in the pattern of the tree. With `discrete` the metric replaces it, and a copy remains.
    qm: m.tree.nnz();
    plain_mass: if c.in_metric { m.tree.nnz() } else { 0 };
    /// −h K v, the diagonal that the metric adds to M, and 1 for dofs on which a tendon or actuator term acts.
    shift: if c.in_metric { m.nv } else { 0 };
    added: if c.in_metric { m.nv } else { 0 };
    touched: if c.in_metric { m.nv } else { 0 };
    /// s of the terms of tendons and actuators, and their share of −h K v along them.
    along_scale: if c.in_metric { m.tendons.len() + m.nout() } else { 0 };
    along_shift: if c.in_metric { m.tendons.len() + m.nout() } else { 0 };
    /// M̂⁻¹Jᵀ of the couplings, the factor of I + J M̂⁻¹Jᵀ, and its product with J x.
    coupling_response: c.couplings * m.nv;
    coupling_gram: c.couplings * c.couplings;
    coupling_pull: c.couplings;
    /// The matrix of exact inverse inertias and no-slip sweeps in the metric, then its factor.
    backbone: if c.has_backbone { m.tree.nnz() } else { 0 };
    backbone_inverse: if c.has_backbone { m.nv } else { 0 };
    /// Its LᵀDL factor, or that of an implicit step.
    qld: m.tree.nnz();
    qld_inverse: m.nv;
    /// The upper triangle of a nonsymmetric implicit step, and velocity derivatives of forces and axes.
    qld_upper: if takes_coriolis(m) { m.tree.nnz() } else { 0 };
    coriolis_rates: if takes_coriolis(m) { 36 * m.nbody() } else { 0 };
    coriolis_drift: if takes_coriolis(m) { 6 * m.nv } else { 0 };
    qfrc_passive: m.nv;
    qfrc_bias: m.nv;
    ten_length: m.tendons.len();
    ten_velocity: m.tendons.len();
    ten_jacobian: m.tendon_dofs.len();
    qfrc_gravcomp: m.nv;
    actuator_moment: m.actuator_dofs.len();
    act_dot: m.na;
    actuator_length: m.nout();
    actuator_velocity: m.nout();
    /// Controls after their delays, clamped to their ranges.
    acting_ctrl: m.nu();
    actuator_force: m.nout();
    /// Limited forces of the currents of motors, without cogging and friction.
    current_force: m.nout();
    /// The total actuator force on each tendon with a force limit.
    ten_actuator_force: m.tendons.len();
    qfrc_actuator: m.nv;
    qfrc_smooth: m.nv;
    qacc_smooth: m.nv;
    /// The private memory of the threads of the narrow phase, one after another.
    threads: c.threads * thread_fields(m, c).size;
    contacts: CONTACT_SIZE * c.contacts;
    /// The deepest contact of each pair whose distance is measured.
    measured: CONTACT_SIZE * c.measured;
    qacc: m.nv;
    qfrc_constraint: m.nv;
    /// The gradient of the cost at `qacc`; and L⁻ᵀ times that, for the duality gap on request.
    gradient: m.nv;
    preconditioned: m.nv;
    /// The time from the start of the step to the current stage, s.
    offset: 1;
    /// The next stage of Runge–Kutta.
    stage: 1;
    /// The velocity by which positions advance.
    rate: m.nv;
    mean_rate: m.nv;
    mean_qacc: m.nv;
    start_qpos: m.nq;
    start_qvel: m.nv;
    start_act: m.na;
    start_actuator_velocity: m.nout();
    /// The lengths of tendons that yield or stick, at the start of the step.
    start_ten_length: if saves_tendons(m) { m.tendons.len() } else { 0 };
    start_ten_jacobian: if saves_tendons(m) { m.tendon_dofs.len() } else { 0 };
    mean_act_dot: m.na;
    start_warmstart: m.nv;
    start_stick_references: reference_numbers(m);
    start_stick_friction: friction_count(m);
    /// The slot of the stick reference of each contact's pair; beyond the last without one.
    stick_slot: m.max_stick_pairs.map_or(0, |_| c.contacts);
    /// The sleep counters during a step, and 1 for each tree that is awake, if trees may sleep.
    tree_counter: m.tree_asleep0.len();
    tree_awake: m.tree_asleep0.len();
    /// 1 for each tree that may wake, then for each tree whose island is not ready to sleep.
    tree_marked: m.tree_asleep0.len();
    /// The lowest tree of the island of each tree, and at that place the tree of it that was visited last.
    tree_leader: m.tree_asleep0.len();
    tree_visited: m.tree_asleep0.len();
    /// The poses of the last pass.
    pass_pose: asleep_pose(m);
}

fields! {
    /// The private memory of a thread of the narrow phase, in its part of the field `threads`.
    thread_fields(m, c);
    /// The polytope of overlapping shapes: vertices, faces, edges to visit, visible faces, horizon edges.
    polytope: 9 * c.polytope[0];
    polytope_face: 12 * c.polytope[1];
    polytope_stack: c.polytope[1] + 4;
    polytope_visible: c.polytope[1];
    polytope_horizon: 3 * c.polytope[1];
    /// Contacts on terrain during collection.
    terrain: c.terrain[0];
    terrain_face: c.terrain[1];
    terrain_patch: c.terrain[2];
    found_contacts: CONTACT_SIZE * (c.contacts + c.measured);
}

fields! {
    /// The convex problem of an environment, contiguous, because one workgroup solves it.
    row_fields(m, c);
    blocks: BLOCK_SIZE * c.blocks;
    /// The active set of each block.
    active_set: c.blocks;
    row_block: c.rows;
    position: c.rows;
    /// The velocity of moving surfaces, until the Jacobian is computed.
    velocity: c.rows;
    aref: c.rows;
    damping: c.rows;
    /// The stiffness k d, for steps that evaluate rows at their end and for friction that sticks.
    stiffness: if c.in_metric || m.max_stick_pairs.is_some() { c.rows } else { 0 };
    /// The pull of a row whose force would otherwise be zero, if any contact adheres.
    pull: if c.adheres { c.rows } else { 0 };
    r: c.rows;
    d: c.rows;
    shape: c.rows;
    /// The inverse inertia of an elliptic cone, at its first row.
    cone_inertia: c.rows;
    /// Coulomb's law, at the first row of a contact: λ, and of its last update the normal force, its difference from λ,
    /// and its change.
    lambda: if c.coulomb { c.rows } else { 0 };
    normal_force: if c.coulomb { c.rows } else { 0 };
    normal_residual: if c.coulomb { c.rows } else { 0 };
    normal_change: if c.coulomb { c.rows } else { 0 };
    /// The contacts whose sliding a Newton step predicts, the system of their normal forces, and those that jam.
    sliding_blocks: if c.coulomb { MAX_ELIMINATED } else { 0 };
    sliding_system: if c.coulomb { MAX_ELIMINATED * (MAX_ELIMINATED + 1) } else { 0 };
    sliding_jams: if c.coulomb { MAX_ELIMINATED } else { 0 };
    /// J a − aref; during assembly, the inverse inertia of each row.
    residual: c.rows;
    force: c.rows;
    /// J p, for the search direction p.
    ray: c.rows;
    jacobian: c.rows * m.nv;
    /// J in column-major order.
    columns: c.rows * m.nv;
    /// W J.
    weighed: c.rows * m.nv;
    /// The rows on pieces with curvature.
    stiff: c.rows;
    /// The mass matrix, dense or in the pattern of the tree.
    mass: c.mass;
    /// 1 for each tile of H with a dof that is awake, if trees may sleep.
    awake_tiles: if m.tree_asleep0.is_empty() { 0 } else { m.nv.div_ceil(TILE) };
    /// The factor of H, and vectors over the dofs, if workgroup memory is too small for them.
    tiles: c.tiles;
    vectors: c.vectors;
}

fields! {
    /// The report of an environment, in words. Environments are interleaved.
    report_fields(m, c);
    /// `RUNNING`, or the reason why it has stopped.
    status: 1;
    /// The fault of the current step.
    failure: 1;
    /// The field, the index and the bits of a number that diverged.
    fault_field: 1;
    fault_index: 1;
    fault_value: 1;
    /// Nonzero to reset the environment.
    restart: 1;
    /// Steps since the last reset.
    steps: 1;
    /// Automatic resets.
    resets: 1;
    /// Nonzero if the next step repeats one that failed, from the initial state.
    repeats: 1;
    /// Nonzero if all trees slept in the last pass.
    at_rest: 1;
    /// The number of near pairs, and their indices in canonical order; the contacts of a pair replace its index.
    nnear: 1;
    near_pairs: c.pairs;
    /// The positions of pairs in that list, grouped by method.
    near_by_method: c.pairs;
    /// The fault of each thread of the narrow phase.
    thread_fault: c.threads;
    ncon: 1;
    nblock: 1;
    nrow: 1;
    /// Iterations of the last solve, evaluations of its line searches, and the bits of its duality gap.
    niter: 1;
    ls_evaluations: 1;
    solve_gap: 1;
    /// The solve status, as the codes of `clench_solver::Status`.
    solve_status: 1;
}
