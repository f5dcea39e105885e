//! The states of all environments, a table a field.

use super::cells::Cells;
use super::precision::Lanewise;
use super::rows::try_reserve;
use super::{Precision, Rows};
use crate::check::check_length;
use crate::error::SimError;
use crate::model::Model;
use crate::model::flat::set_lane;
use crate::sim::no_such;
use crate::state::State;
use clench_math::{Clock, Mask, Real};

/// The states of the environments of a batch, field by field, a row an environment. To be read and written between steps;
/// what a step reads is checked first.
#[derive(Debug)]
pub struct StateRows<S> {
    /// s (n, 1), in double precision.
    pub time: Rows<f64>,
    /// Position coordinates (n, nq).
    pub qpos: Rows<S>,
    /// Velocities (n, nv).
    pub qvel: Rows<S>,
    /// Activations (n, na).
    pub act: Rows<S>,
    /// Controls (n, nu).
    pub ctrl: Rows<S>,
    /// Forces that the user applies along dofs (n, nv).
    pub qfrc_applied: Rows<S>,
    /// Forces and torques that the user applies to bodies at their centres of mass, world axes (n, 6 nbody): three numbers
    /// of force, three of torque, body after body.
    pub xfrc_applied: Rows<S>,
    /// Positions of mocap bodies (n, 3 nmocap).
    pub mocap_pos: Rows<S>,
    /// Orientations of mocap bodies (n, 4 nmocap).
    pub mocap_quat: Rows<S>,
    /// Which equality constraints are on (n, neq): all but 0 means on. Bytes, for those who write them by their address may leave
    /// others than those of false and true.
    pub eq_active: Rows<u8>,
    /// Acceleration of the previous step, where the solver starts (n, nv).
    pub qacc_warmstart: Rows<S>,
}

impl<S: Precision> StateRows<S> {
    /// Room for `count` states of a model, all zero: [`write`](Self::write) puts states in.
    ///
    /// # Errors
    /// More memory than there is.
    pub fn new(model: &Model, count: usize) -> Result<Self, SimError> {
        try_reserve(count, Self::row_bytes(model))?;
        let rows = |width| Rows::new(count, width, S::ZERO);
        Ok(StateRows {
            time: Rows::new(count, 1, 0.0)?,
            qpos: rows(model.nq)?,
            qvel: rows(model.nv)?,
            act: rows(model.na)?,
            ctrl: rows(model.nu())?,
            qfrc_applied: rows(model.nv)?,
            xfrc_applied: rows(6 * model.nbody())?,
            mocap_pos: rows(3 * model.nmocap)?,
            mocap_quat: rows(4 * model.nmocap)?,
            eq_active: Rows::new(count, model.equalities.len(), 0)?,
            qacc_warmstart: rows(model.nv)?,
        })
    }

    /// The tables of numbers in the batch's precision.
    fn numbers(&self) -> [&Rows<S>; 9] {
        [
            &self.qpos,
            &self.qvel,
            &self.act,
            &self.ctrl,
            &self.qfrc_applied,
            &self.xfrc_applied,
            &self.mocap_pos,
            &self.mocap_quat,
            &self.qacc_warmstart,
        ]
    }

    fn numbers_mut(&mut self) -> [&mut Rows<S>; 9] {
        [
            &mut self.qpos,
            &mut self.qvel,
            &mut self.act,
            &mut self.ctrl,
            &mut self.qfrc_applied,
            &mut self.xfrc_applied,
            &mut self.mocap_pos,
            &mut self.mocap_quat,
            &mut self.qacc_warmstart,
        ]
    }

    /// How many states there are.
    pub fn count(&self) -> usize {
        self.time.count()
    }

    /// Bytes that a state takes.
    pub(super) fn row_bytes(model: &Model) -> usize {
        let all: usize = model.state_lengths().iter().map(|(_, length)| length).sum();
        let switches = model.equalities.len();
        let times = 1;
        (all - switches - times) * size_of::<S>() + switches + times * size_of::<f64>()
    }

    /// How many rows each table has, and of how many numbers.
    fn shapes(&self) -> [(usize, usize); 11] {
        macro_rules! shapes {
            ($($field:ident)*) => { [$((self.$field.count(), self.$field.width())),*] };
        }
        shapes! {
            time qpos qvel act ctrl qfrc_applied xfrc_applied mocap_pos mocap_quat eq_active qacc_warmstart
        }
    }

    /// Tables for `count` states of this model.
    ///
    /// # Errors
    /// The first of another shape.
    pub(super) fn check_shapes(&self, model: &Model, count: usize) -> Result<(), SimError> {
        let shapes = self.shapes().into_iter();
        for ((rows, width), (field, expected)) in shapes.zip(model.state_lengths()) {
            check_length(field, rows * width, count * expected)?;
            check_length(field, width, expected)?;
        }
        Ok(())
    }

    /// Tables that have row `env`, as long as the fields of this state.
    fn check_row(&self, env: usize, state: &State<S>) -> Result<(), SimError> {
        let shapes = self.shapes().into_iter();
        for ((rows, width), (field, length)) in shapes.zip(state.lengths()) {
            if env >= rows {
                return Err(no_such("environment", env, rows));
            }
            check_length(field, length, width)?;
        }
        Ok(())
    }

    /// Takes row `from` of another table as row `to`.
    pub(super) fn copy_row(&mut self, to: usize, other: &Self, from: usize) {
        for (rows, other) in self.numbers_mut().into_iter().zip(other.numbers()) {
            rows.row_mut(to).copy_from_slice(other.row(from));
        }
        self.time.row_mut(to).copy_from_slice(other.time.row(from));
        let switches = other.eq_active.row(from);
        self.eq_active.row_mut(to).copy_from_slice(switches);
    }

    /// Copies row `env` into a state of the same model. Numbers are read one by one: who writes them meanwhile, by their address,
    /// leaves some of the old and some of the new.
    ///
    /// # Errors
    /// A row that there is not; a state of other lengths, which is then as before.
    pub fn read(&mut self, env: usize, state: &mut State<S>) -> Result<(), SimError> {
        self.check_row(env, state)?;
        let (motion, inputs) = self.share();
        motion.read(env, 0, state);
        inputs.read(env, 0, state);
        inputs.read_applied_forces(env, 0, state);
        Ok(())
    }

    /// Copies a state of the same model into row `env`, number by number as [`read`](Self::read) does.
    ///
    /// # Errors
    /// A row that there is not; a state of other lengths. The row is then as before.
    pub fn write(&mut self, env: usize, state: &State<S>) -> Result<(), SimError> {
        self.check_row(env, state)?;
        let (motion, inputs) = self.share();
        motion.write(env, 0, state);
        inputs.write(env, state);
        Ok(())
    }

    /// Copies what a step only reads of a state, all but what it moves, into row `env`.
    pub(super) fn write_inputs(&mut self, env: usize, state: &State<S>) {
        self.share().1.write(env, state);
    }

    /// The tables as a step sees them.
    pub(super) fn share(&mut self) -> (MovingRows<'_, S>, Inputs<'_, S>) {
        let motion = MovingRows {
            time: Cells::new(&mut self.time),
            qpos: Cells::new(&mut self.qpos),
            qvel: Cells::new(&mut self.qvel),
            act: Cells::new(&mut self.act),
            qacc_warmstart: Cells::new(&mut self.qacc_warmstart),
        };
        let inputs = Inputs {
            ctrl: Cells::new(&mut self.ctrl),
            qfrc_applied: Cells::new(&mut self.qfrc_applied),
            xfrc_applied: Cells::new(&mut self.xfrc_applied),
            mocap_pos: Cells::new(&mut self.mocap_pos),
            mocap_quat: Cells::new(&mut self.mocap_quat),
            eq_active: Cells::new(&mut self.eq_active),
        };
        (motion, inputs)
    }
}

/// What a step reads and writes.
pub struct MovingRows<'a, S: Lanewise> {
    time: Cells<'a, f64>,
    qpos: Cells<'a, S>,
    qvel: Cells<'a, S>,
    act: Cells<'a, S>,
    qacc_warmstart: Cells<'a, S>,
}

impl<S: Lanewise> MovingRows<'_, S> {
    /// Copies the row of an environment into lane `lane`.
    pub fn read<T: Real<Scalar = S>>(&self, env: usize, lane: usize, state: &mut State<T>) {
        state.time.set_lane(lane, self.time.get(env));
        self.qpos.read(env, lane, &mut state.qpos);
        self.qvel.read(env, lane, &mut state.qvel);
        self.act.read(env, lane, &mut state.act);
        self.qacc_warmstart
            .read(env, lane, &mut state.qacc_warmstart);
    }

    /// Copies lane `lane` into the row of an environment.
    pub fn write<T: Real<Scalar = S>>(&self, env: usize, lane: usize, state: &State<T>) {
        self.time.set(env, state.time.lane(lane));
        self.qpos.write(env, lane, &state.qpos);
        self.qvel.write(env, lane, &state.qvel);
        self.act.write(env, lane, &state.act);
        self.qacc_warmstart.write(env, lane, &state.qacc_warmstart);
    }

    /// Replaces the row of an environment by time, `nq` positions, `nv` velocities and activations. The solver starts anew.
    pub fn start(&self, env: usize, row: &[S], nq: usize, nv: usize) {
        let (time, row) = row.split_at(1);
        let (qpos, row) = row.split_at(nq);
        let (qvel, act) = row.split_at(nv);
        self.time.put(env, time.iter().map(|t| t.to_f64()));
        self.qpos.put(env, qpos.iter().copied());
        self.qvel.put(env, qvel.iter().copied());
        self.act.put(env, act.iter().copied());
        self.qacc_warmstart
            .put(env, std::iter::repeat_n(S::ZERO, nv));
    }
}

/// What a step only reads.
pub struct Inputs<'a, S: Lanewise> {
    ctrl: Cells<'a, S>,
    qfrc_applied: Cells<'a, S>,
    xfrc_applied: Cells<'a, S>,
    mocap_pos: Cells<'a, S>,
    mocap_quat: Cells<'a, S>,
    eq_active: Cells<'a, u8>,
}

impl<S: Lanewise> Inputs<'_, S> {
    /// Copies the row of an environment into lane `lane`, but for the forces on bodies.
    pub fn read<T: Real<Scalar = S>>(&self, env: usize, lane: usize, state: &mut State<T>) {
        self.ctrl.read(env, lane, &mut state.ctrl);
        self.qfrc_applied.read(env, lane, &mut state.qfrc_applied);
        for (pos, row) in state
            .mocap_pos
            .iter_mut()
            .zip(self.mocap_pos.parts::<3>(env))
        {
            set_lane([&mut pos.x, &mut pos.y, &mut pos.z], lane, &row);
        }
        for (quat, row) in state
            .mocap_quat
            .iter_mut()
            .zip(self.mocap_quat.parts::<4>(env))
        {
            let axes = [&mut quat.w, &mut quat.x, &mut quat.y, &mut quat.z];
            set_lane(axes, lane, &row);
        }
        for (switch, [on]) in state.eq_active.iter_mut().zip(self.eq_active.parts(env)) {
            switch.set_lane(lane, on != 0);
        }
    }

    /// Whether forces are applied to any body of an environment; those of −0 count, for outputs show them.
    pub fn has_applied_forces(&self, env: usize) -> bool {
        !self.xfrc_applied.is_blank(env)
    }

    /// Copies the forces on bodies of an environment into lane `lane`.
    pub fn read_applied_forces<T: Real<Scalar = S>>(
        &self,
        env: usize,
        lane: usize,
        state: &mut State<T>,
    ) {
        for (force, row) in state
            .xfrc_applied
            .iter_mut()
            .zip(self.xfrc_applied.parts::<6>(env))
        {
            let (linear, angular) = (&mut force.linear, &mut force.angular);
            let axes = [
                &mut linear.x,
                &mut linear.y,
                &mut linear.z,
                &mut angular.x,
                &mut angular.y,
                &mut angular.z,
            ];
            set_lane(axes, lane, &row);
        }
    }

    /// Copies a state into the row of an environment.
    pub fn write(&self, env: usize, state: &State<S>) {
        self.ctrl.put(env, state.ctrl.iter().copied());
        (self.qfrc_applied).put(env, state.qfrc_applied.iter().copied());
        let forces = state.xfrc_applied.iter();
        let forces =
            forces.flat_map(|f| f.linear.to_array().into_iter().chain(f.angular.to_array()));
        self.xfrc_applied.put(env, forces);
        (self.mocap_pos).put(env, state.mocap_pos.iter().flat_map(|p| p.to_array()));
        (self.mocap_quat).put(env, state.mocap_quat.iter().flat_map(|q| q.to_array()));
        (self.eq_active).put(env, state.eq_active.iter().map(|&on| u8::from(on)));
    }
}
