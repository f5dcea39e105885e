//! What lies in the memory of the device for each environment, a line a field. Places, sizes, the constants of the kernels, and
//! the names under which fields are read and written follow from these tables.

use crate::tables::{BLOCK_SIZE, CONTACT_SIZE, Capacity, has_sensor_history};
use clench_rigid::dynamics::plastic::has_yielding_tendons;
use clench_rigid::model::{Integrator, Model};

/// A field: so many numbers for each environment, from a place on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Field {
    /// Its name; in capitals, its place in the kernels.
    pub name: &'static str,
    /// What lies before it.
    pub place: usize,
    /// How many numbers.
    pub width: usize,
}

/// The fields of one buffer.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Fields {
    /// All of them, in order.
    pub list: Vec<Field>,
    /// Numbers of an environment.
    pub size: usize,
}

impl Fields {
    fn push(&mut self, name: &'static str, width: usize) {
        let place = self.size;
        self.list.push(Field { name, place, width });
        self.size += width;
    }

    /// The field of a name.
    pub(crate) fn find(&self, name: &str) -> Option<Field> {
        self.list.iter().copied().find(|field| field.name == name)
    }
}

/// Whether the integrator takes Coriolis forces implicitly.
fn takes_coriolis(m: &Model) -> bool {
    m.integrator == Integrator::Implicit
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
    /// What users set and read: the state, and its inputs. Environment next to environment.
    state_fields(m, c);
    qpos: m.nq;
    qvel: m.nv;
    act: m.na;
    /// Buffers of past controls.
    history: m.nhistory;
    /// Where springs that yield rest.
    plastic: m.nplastic;
    qacc_warmstart: m.nv;
    ctrl: m.nu();
    qfrc_applied: m.nv;
    /// The force first, then the torque, of each body.
    xfrc_applied: 6 * m.nbody();
    mocap_pos: 3 * m.nmocap;
    mocap_quat: 4 * m.nmocap;
    /// Zero where an equality is off.
    eq_active: m.equalities.len();
    /// When the first of the steps that are counted began, s.
    start_time: 1;
}

fields! {
    /// What follows from the state. Environment next to environment.
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
    /// Inertias of articulated bodies, where paths are long.
    articulated: 27 * c.articulated;
    cdof: 6 * m.nv;
    cdof_dot: 6 * m.nv;
    cvel: 6 * m.nbody();
    /// Accelerations of bodies that no joint's acceleration causes.
    cacc_bias: 6 * m.nbody();
    /// Those that joints cause.
    cacc_joints: 6 * m.nbody();
    cacc: 6 * m.nbody();
    cfrc_int: 6 * m.nbody();
    cfrc_ext: 6 * m.nbody();
    contact_force: 6 * m.nbody();
    sensordata: m.nsensordata();
    /// What sensors measure now, before any delay.
    undelayed: if has_sensor_history(m) { m.nsensordata() } else { 0 };
    /// Potential and kinetic energy.
    mechanical_energy: 2;
    /// Spatial forces of bodies, used up when they are projected.
    cfrc: 6 * m.nbody();
    /// How forces of the medium on ellipsoids change with velocities, column by column.
    fluid_rates: if m.bodies.iter().any(|b| b.fluid_ellipsoids) { 36 * m.nbody() } else { 0 };
    /// The mass matrix, in the pattern of the tree.
    qm: m.tree.nnz();
    /// Its LᵀDL, or that of an implicit step.
    qld: m.tree.nnz();
    qld_inverse: m.nv;
    /// The upper triangle where an implicit step's is not symmetric, and how forces and axes change with velocities.
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
    actuator_force: m.nout();
    /// With how much actuators pull at each tendon whose total is limited.
    ten_actuator_force: m.tendons.len();
    qfrc_actuator: m.nv;
    qfrc_smooth: m.nv;
    qacc_smooth: m.nv;
    /// What threads of the narrow phase have for themselves, one after the other.
    threads: c.threads * thread_fields(m, c).size;
    contacts: CONTACT_SIZE * c.contacts;
    /// The deepest contact of each pair whose distance is measured.
    measured: CONTACT_SIZE * c.measured;
    qacc: m.nv;
    qfrc_constraint: m.nv;
    /// Of the cost at `qacc`; and L⁻ᵀ times that, where somebody asks for the duality gap.
    gradient: m.nv;
    preconditioned: m.nv;
    /// How long after the start of the step the present stage is, s.
    offset: 1;
    /// By Runge–Kutta, which stage comes next.
    stage: 1;
    /// The velocity that positions advance by.
    rate: m.nv;
    mean_rate: m.nv;
    mean_qacc: m.nv;
    start_qpos: m.nq;
    start_qvel: m.nv;
    start_act: m.na;
    start_actuator_velocity: m.nout();
    /// Where tendons that yield were.
    start_ten_length: if has_yielding_tendons(m) { m.tendons.len() } else { 0 };
    start_ten_jacobian: if has_yielding_tendons(m) { m.tendon_dofs.len() } else { 0 };
    mean_act_dot: m.na;
    start_warmstart: m.nv;
}

fields! {
    /// What a thread of the narrow phase has for itself, in its part of the field `threads`.
    thread_fields(m, c);
    /// The polytope of overlapping shapes: vertices, faces, sides that are yet to be looked at, faces that are seen, sides of the horizon.
    polytope: 9 * c.polytope[0];
    polytope_face: 12 * c.polytope[1];
    polytope_stack: c.polytope[1] + 4;
    polytope_visible: c.polytope[1];
    polytope_horizon: 3 * c.polytope[1];
    /// Contacts on terrain while they are gathered.
    terrain: c.terrain[0];
    terrain_face: c.terrain[1];
    terrain_patch: c.terrain[2];
    found_contacts: CONTACT_SIZE * (c.contacts + c.measured);
}

fields! {
    /// The convex problem of an environment: its numbers side by side, as one workgroup solves it.
    row_fields(m, c);
    blocks: BLOCK_SIZE * c.blocks;
    /// The active set of each block.
    active_set: c.blocks;
    row_block: c.rows;
    position: c.rows;
    /// Until its Jacobian is known, what surfaces move by themselves.
    velocity: c.rows;
    aref: c.rows;
    damping: c.rows;
    /// The force with which a row pulls where it would otherwise give none, if any contact adheres.
    pull: if c.adheres { c.rows } else { 0 };
    r: c.rows;
    d: c.rows;
    shape: c.rows;
    /// J a − aref; while the rows are assembled, the inverse inertia of each.
    residual: c.rows;
    force: c.rows;
    /// J p, of the search direction.
    ray: c.rows;
    jacobian: c.rows * m.nv;
    /// J again, column by column.
    columns: c.rows * m.nv;
    /// W J.
    weighed: c.rows * m.nv;
    /// Which rows are on pieces with curvature.
    stiff: c.rows;
    /// The mass matrix, dense or in the pattern of the tree.
    mass: c.mass;
    /// The factor of H, and vectors over the dofs, where the workgroup has no room for them.
    tiles: c.tiles;
    vectors: c.vectors;
}

fields! {
    /// Words that report how an environment fares. Environment next to environment.
    report_fields(m, c);
    /// Whether it runs, or why not.
    status: 1;
    /// What went wrong in the present step.
    trouble: 1;
    /// Of a number that diverged: of which field, where in it, its bits.
    fault_field: 1;
    fault_index: 1;
    fault_value: 1;
    /// Whether to start over.
    restart: 1;
    /// Steps since the last reset.
    steps: 1;
    /// How many pairs are near, and which, in canonical order; then, in the place of each, its contacts.
    nnear: 1;
    near_pairs: c.pairs;
    /// Where in that list pairs are, method by method.
    near_by_method: c.pairs;
    /// What went wrong in each thread of the narrow phase.
    thread_fault: c.threads;
    ncon: 1;
    nblock: 1;
    nrow: 1;
    /// Iterations of the last solve, and the bits of the duality gap that they left.
    niter: 1;
    solve_gap: 1;
    /// How it ended, as the codes of `clench_solver::Status`.
    solve_status: 1;
}
