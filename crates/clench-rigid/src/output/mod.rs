//! Outputs of an environment: rows of numbers that are read by name.
//!
//! Names, order and frames are MuJoCo's if it has the same quantity.

pub(crate) mod forces;
pub(crate) mod source;
mod tendon_forces;

use clench_dynamics::readings::BodyForces;
pub(crate) use forces::{each_joint_of_bodies, of_contact};
#[doc(hidden)]
pub use source::Source;

use crate::sensor::bodies::update as update_body_forces;
use crate::validity::Computed;
use clench_dynamics::Step;
use clench_dynamics::dynamics::camera::camera_pose;
use clench_dynamics::dynamics::frames::Frames;
use clench_dynamics::dynamics::jacobian::point_jacobian;
use clench_dynamics::error::SimError;
use clench_dynamics::model::{FrameObject, Model, RowPattern};
use clench_dynamics::workspace::Workspace;
use clench_math::{Force, Inertia, Mat3, Motion, Quat, Real, Vec3};

macro_rules! outputs {
    ($m:ident, $s:ident, $out:ident; $($(#[$doc:meta])* $name:ident [$($size:expr),*] of $requires:ident => $read:expr;)*) => {
        /// A row of numbers that every environment has.
        #[allow(non_camel_case_types)] // Named as users name them.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Output {
            $($(#[$doc])* $name,)*
        }

        impl Output {
            /// Every output.
            pub const ALL: &[Output] = &[$(Output::$name),*];
            pub(crate) const COUNT: usize = Output::ALL.len();

            /// Returns the name of the output.
            pub fn name(self) -> &'static str {
                match self { $(Output::$name => stringify!($name),)* }
            }

            /// Returns its shape in one environment, such as (nbody, 3) for [`xpos`](Self::xpos); empty for a single
            /// number.
            pub fn shape(self, $m: &Model) -> Vec<usize> {
                match self { $(Output::$name => vec![$($size),*],)* }
            }

            /// Returns the results that it requires.
            pub(crate) fn requires(self) -> Computed {
                match self { $(Output::$name => Computed::$requires,)* }
            }

            /// Appends its numbers to `out`.
            #[doc(hidden)]
            pub fn read<T: Real>(self, $s: &mut Source<T>, $out: &mut Vec<T>) {
                match self { $(Output::$name => $read,)* }
            }
        }
    };
}

outputs! {
    m, s, out;
    /// Time of the state, s, rounded to the precision of the other outputs.
    time [] of Nothing => out.push(s.state.rounded_time());
    /// Position coordinates of the state (nq).
    qpos [m.nq] of Nothing => out.extend_from_slice(&s.state.qpos);
    /// Velocities of the state (nv).
    qvel [m.nv] of Nothing => out.extend_from_slice(&s.state.qvel);
    /// Activations of the state (na).
    act [m.na] of Nothing => out.extend_from_slice(&s.state.act);

    /// Accelerations (nv).
    qacc [m.nv] of Everything => out.extend_from_slice(&s.ws.qacc);
    /// Positions of bodies, m (nbody, 3).
    xpos [m.nbody(), 3] of Positions => vectors(&s.ws.position.xpos, out);
    /// Orientations of bodies (nbody, 4).
    xquat [m.nbody(), 4] of Positions => quats(&s.ws.position.xquat, out);
    /// Orientations of bodies as matrices, row by row (nbody, 9).
    xmat [m.nbody(), 9] of Positions => matrices(&s.ws.position.xmat, out);
    /// Centres of mass of bodies, m (nbody, 3).
    xipos [m.nbody(), 3] of Positions => vectors(&s.ws.position.xipos, out);
    /// Orientations of inertial frames, row by row (nbody, 9).
    ximat [m.nbody(), 9] of Positions => matrices(&s.ws.position.ximat, out);
    /// Joint anchors, m (njnt, 3).
    xanchor [m.joints.len(), 3] of Positions => vectors(&s.ws.position.xanchor, out);
    /// Joint axes (njnt, 3).
    xaxis [m.joints.len(), 3] of Positions => vectors(&s.ws.position.xaxis, out);
    /// Positions of geoms, m (ngeom, 3).
    geom_xpos [m.geoms.len(), 3] of Positions => vectors(&s.ws.position.geom_xpos, out);
    /// Orientations of geoms, row by row (ngeom, 9).
    geom_xmat [m.geoms.len(), 9] of Positions => matrices(&s.ws.position.geom_xmat, out);
    /// Positions of sites, m (nsite, 3).
    site_xpos [m.sites.len(), 3] of Positions => vectors(&s.ws.position.site_xpos, out);
    /// Orientations of sites, row by row (nsite, 9).
    site_xmat [m.sites.len(), 9] of Positions => matrices(&s.ws.position.site_xmat, out);
    /// Jacobians of the positions of sites, world axes (nsite, 3, nv).
    site_jacp [m.sites.len(), 3, m.nv] of Positions => site_jacobians(s, 0, out);
    /// Jacobians of the orientations of sites, world axes (nsite, 3, nv).
    site_jacr [m.sites.len(), 3, m.nv] of Positions => site_jacobians(s, 3, out);
    /// Positions of cameras, m (ncam, 3).
    cam_xpos [m.cameras.len(), 3] of Positions => cameras(s, |(place, _)| out.extend(place.to_array()));
    /// Orientations of cameras, row by row (ncam, 9).
    cam_xmat [m.cameras.len(), 9] of Positions => cameras(s, |(_, axes)| matrices(&[axes], out));
    /// Centre of mass of each body's subtree, m (nbody, 3).
    subtree_com [m.nbody(), 3] of Positions => vectors(&s.ws.position.subtree_com, out);
    /// Inertia of each body about the centre of mass of its tree: xx, yy, zz, xy, xz, yz, mass times offset, mass
    /// (nbody, 10).
    cinert [m.nbody(), 10] of Positions => inertias(&s.ws.position.cinert, out);
    /// Velocity of each body, angular, then linear at the centre of mass of its tree (nbody, 6).
    cvel [m.nbody(), 6] of Everything => motions(&s.ws.velocity.cvel, out);
    /// Motion of each dof at unit velocity, in the form of `cvel` (nv, 6).
    cdof [m.nv, 6] of Positions => motions(&s.ws.position.cdof, out);
    /// Lengths of tendons (ntendon).
    ten_length [m.tendons.len()] of Positions => out.extend_from_slice(&s.ws.position.ten_length);
    /// Moment arms of tendons, ∂length/∂q (ntendon, nv).
    ten_J [m.tendons.len(), m.nv] of Positions => dense(s.model, (&s.model.tendon_dofs, s.model.tendons.len()), &s.ws.position.ten_jacobian, out);
    /// Velocities of tendons (ntendon).
    ten_velocity [m.tendons.len()] of Everything => out.extend_from_slice(&s.ws.velocity.ten_velocity);
    /// Lengths of actuators, three for an orientation servo and one for any other (nout).
    actuator_length [m.nout()] of Positions => out.extend_from_slice(&s.ws.position.actuator_length);
    /// Moment arms of actuators, ∂length/∂q (nout, nv). Those of actuators that act on contacts follow from the
    /// contacts.
    actuator_moment [m.nout(), m.nv] of Everything => dense(s.model, (&s.model.actuator_dofs, s.model.nout()), &s.ws.position.actuator_moment, out);
    /// Velocities of actuators (nout).
    actuator_velocity [m.nout()] of Everything => out.extend_from_slice(&s.ws.velocity.actuator_velocity);
    /// Forces of actuators (nout).
    actuator_force [m.nout()] of Everything => out.extend_from_slice(&s.ws.force.actuator_force);
    /// Power input of actuators, W: the sum over those that drive, without those that brake.
    actuator_power [] of Everything => out.push(driving_power(s.ws));
    /// Forces of actuators along dofs (nv).
    qfrc_actuator [m.nv] of Everything => out.extend_from_slice(&s.ws.force.qfrc_actuator);
    /// Passive forces along dofs (nv).
    qfrc_passive [m.nv] of Everything => out.extend_from_slice(&s.ws.force.qfrc_passive);
    /// Coriolis, centrifugal and gravitational forces along dofs, on the left-hand side of the equation of motion (nv).
    qfrc_bias [m.nv] of Everything => out.extend_from_slice(&s.ws.force.qfrc_bias);
    /// All forces along dofs except constraint forces (nv).
    qfrc_smooth [m.nv] of Everything => out.extend_from_slice(&s.ws.force.qfrc_smooth);
    /// Constraint forces along dofs (nv).
    qfrc_constraint [m.nv] of Everything => out.extend_from_slice(&s.ws.qfrc_constraint);
    /// External forces on each body: applied forces, contacts, connects, welds and tendons. Torque, then force, about
    /// the centre of mass of its tree (nbody, 6).
    cfrc_ext [m.nbody(), 6] of Everything => forces::external_forces(s, out);
    /// Joint reactions on each body: the torque, then the force of its parent on it, about the centre of mass of its
    /// tree (nbody, 6).
    cfrc_int [m.nbody(), 6] of Everything => wrenches(&body_forces(s).cfrc_int, out);
    /// Acceleration of each body including gravity's upward reaction, angular, then linear at the centre of mass of its
    /// tree (nbody, 6).
    cacc [m.nbody(), 6] of Everything => motions(&body_forces(s).cacc, out);
    /// Force and torque of contacts on each body at its centre of mass, world axes (nbody, 6), in the form of
    /// `xfrc_applied`.
    contact_force [m.nbody(), 6] of Everything => forces::of_contacts(s, out);
    /// The number of contacts.
    contact_count [] of Everything => out.push(count_contacts(s.ws));
    /// The number of iterations of the constraint solver.
    solver_iterations [] of Everything => out.push(s.ws.solver.stats().iterations);
    /// Sensor readings (nsensordata).
    sensordata [m.nsensordata()] of Everything => out.extend_from_slice(&s.ws.sensors.data);
    /// Potential and kinetic energy of the state, J.
    energy [2] of Nothing => read_energy(s, out);
}

impl Output {
    /// Returns the number of values in one environment.
    pub fn width(self, model: &Model) -> usize {
        self.shape(model).iter().product()
    }

    /// Returns true if its numbers depend on positions alone.
    #[doc(hidden)]
    pub fn follows_from_positions(self) -> bool {
        self.requires() == Computed::Positions
    }

    /// Returns true for a part of the state.
    pub(crate) fn is_state(self) -> bool {
        matches!(
            self,
            Output::time | Output::qpos | Output::qvel | Output::act
        )
    }

    /// Returns the output of that name.
    ///
    /// # Errors
    /// Returns an error if the name is unknown.
    pub fn find(name: &str) -> Result<Self, SimError> {
        let all = Output::ALL.iter();
        let found = all.clone().find(|output| output.name() == name);
        found
            .copied()
            .ok_or_else(|| SimError::unknown("output", name, all.map(|output| output.name())))
    }
}

fn vectors<T: Real>(values: &[Vec3<T>], out: &mut Vec<T>) {
    out.extend(values.iter().flat_map(|v| v.to_array()));
}

fn cameras<T: Real>(s: &Source<T>, show: impl FnMut((Vec3<T>, Mat3<T>))) {
    let pose = |c: usize| camera_pose(s.model, s.params, &s.ws.position, c);
    (0..s.model.cameras.len()).map(pose).for_each(show);
}

fn quats<T: Real>(values: &[Quat<T>], out: &mut Vec<T>) {
    out.extend(values.iter().flat_map(|q| q.to_array()));
}

fn matrices<T: Real>(values: &[Mat3<T>], out: &mut Vec<T>) {
    values.iter().for_each(|m| vectors(&m.rows, out));
}

fn motions<T: Real>(values: &[Motion<T>], out: &mut Vec<T>) {
    out.extend(values.iter().flat_map(|v| v.to_array()));
}

fn wrenches<T: Real>(values: &[Force<T>], out: &mut Vec<T>) {
    out.extend(values.iter().flat_map(|f| f.to_array()));
}

fn body_forces<'a, T: Real>(s: &'a mut Source<T>) -> &'a BodyForces<T> {
    update_body_forces(s.model, s.params, s.state, s.ws);
    &s.ws.sensors.bodies
}

fn inertias<T: Real>(values: &[Inertia<T>], out: &mut Vec<T>) {
    for inertia in values {
        out.extend_from_slice(&inertia.rotational);
        out.extend_from_slice(&inertia.moment.to_array());
        out.push(inertia.mass);
    }
}

/// Appends the rows of a sparse matrix, each over all dofs.
fn dense<T: Real>(
    model: &Model,
    (pattern, rows): (&RowPattern, usize),
    values: &[T],
    out: &mut Vec<T>,
) {
    let start = out.len();
    out.resize(start + rows * model.nv, T::ZERO);
    for row in 0..rows {
        for (dof, value) in pattern.row(values, row) {
            out[start + row * model.nv + dof] = value;
        }
    }
}

/// Appends three of the six rows of each site's Jacobian, starting with row `first`.
fn site_jacobians<T: Real>(s: &Source<T>, first: usize, out: &mut Vec<T>) {
    let (model, pos) = (s.model, &s.ws.position);
    let frames = Frames {
        model,
        params: s.params,
        pos,
    };
    for site in 0..model.sites.len() {
        let start = out.len();
        out.resize(start + 6 * model.nv, T::ZERO);
        let point = frames.point(FrameObject::Site(site));
        point_jacobian(model, pos, &point, &mut out[start..]);
        let rows = start + first * model.nv..start + (first + 3) * model.nv;
        out.copy_within(rows, start);
        out.truncate(start + 3 * model.nv);
    }
}

fn driving_power<T: Real>(ws: &Workspace<T>) -> T {
    let velocities = &ws.velocity.actuator_velocity;
    let powers = (ws.force.actuator_force.iter().zip(velocities)).map(|(&f, &v)| f * v);
    powers.fold(T::ZERO, |sum, power| sum + power.max(T::ZERO))
}

fn count_contacts<T: Real>(ws: &Workspace<T>) -> T {
    let one =
        |contact: &clench_dynamics::contact::Contact<T>| T::select(contact.active, T::ONE, T::ZERO);
    ws.contacts.iter().map(one).fold(T::ZERO, |a, b| a + b)
}

fn read_energy<T: Real>(s: &mut Source<T>, out: &mut Vec<T>) {
    let scratch = s.ws.energy_scratch(s.model);
    let energy = (Step::compiled().state_energy)(s.model, s.params, s.state, scratch);
    out.extend([energy.potential, energy.kinetic]);
}
