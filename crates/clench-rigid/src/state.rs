//! What a user saves and restores.

use crate::model::{Keyframe, Model};
use clench_math::{Clock, Force, Mask, Quat, Real, Scalar, Vec3, broadcast};

/// The state of one environment (or of the lanes of a group): everything that the next step depends on.
#[derive(Clone, Debug)]
pub struct State<T: Real> {
    /// s, in double precision.
    pub time: T::Clock,
    /// Position coordinates (nq).
    pub qpos: Vec<T>,
    /// Velocities (nv).
    pub qvel: Vec<T>,
    /// Activations (na).
    pub act: Vec<T>,
    /// Controls (nu).
    pub ctrl: Vec<T>,
    /// Forces that the user applies along dofs (nv).
    pub qfrc_applied: Vec<T>,
    /// Forces that the user applies to bodies at their centres of mass, world axes (nbody).
    pub xfrc_applied: Vec<Force<T>>,
    /// Positions of mocap bodies (nmocap).
    pub mocap_pos: Vec<Vec3<T>>,
    /// Orientations of mocap bodies (nmocap).
    pub mocap_quat: Vec<Quat<T>>,
    /// Which equality constraints are on (neq).
    pub eq_active: Vec<T::Mask>,
    /// Acceleration of the previous step, where the solver starts (nv).
    pub qacc_warmstart: Vec<T>,
}

/// Bit by bit: a NaN equals itself, and 0 does not equal −0.
impl<T: Real> PartialEq for State<T> {
    fn eq(&self, other: &Self) -> bool {
        let numbers = |a: &[T], b: &[T]| {
            let bits = |values: &[T]| {
                Vec::from_iter(T::as_scalars(values).iter().map(|x| x.to_f64().to_bits()))
            };
            bits(a) == bits(b)
        };
        let times = |state: &Self| {
            Vec::from_iter((0..T::LANES).map(|lane| state.time.lane(lane).to_bits()))
        };
        let forces = |state: &Self| {
            let parts =
                |force: &Force<T>| [force.linear.to_array(), force.angular.to_array()].concat();
            Vec::from_iter(state.xfrc_applied.iter().flat_map(parts))
        };
        let points =
            |state: &Self| Vec::from_iter(state.mocap_pos.iter().flat_map(|p| p.to_array()));
        let turns =
            |state: &Self| Vec::from_iter(state.mocap_quat.iter().flat_map(|q| q.to_array()));
        times(self) == times(other)
            && numbers(&self.qpos, &other.qpos)
            && numbers(&self.qvel, &other.qvel)
            && numbers(&self.act, &other.act)
            && numbers(&self.ctrl, &other.ctrl)
            && numbers(&self.qfrc_applied, &other.qfrc_applied)
            && numbers(&forces(self), &forces(other))
            && numbers(&points(self), &points(other))
            && numbers(&turns(self), &turns(other))
            && self.eq_active == other.eq_active
            && numbers(&self.qacc_warmstart, &other.qacc_warmstart)
    }
}

impl<T: Real> Eq for State<T> {}

/// How many numbers each field of a state has.
pub(crate) type Lengths = [(&'static str, usize); 11];

impl Model {
    /// How many numbers each field of a state has.
    pub(crate) fn state_lengths(&self) -> Lengths {
        [
            ("time", 1),
            ("qpos", self.nq),
            ("qvel", self.nv),
            ("act", self.na),
            ("ctrl", self.nu()),
            ("qfrc_applied", self.nv),
            ("xfrc_applied", 6 * self.nbody()),
            ("mocap_pos", 3 * self.nmocap),
            ("mocap_quat", 4 * self.nmocap),
            ("eq_active", self.equalities.len()),
            ("qacc_warmstart", self.nv),
        ]
    }
}

impl<T: Real> State<T> {
    /// The initial state of a model.
    pub fn new(model: &Model) -> Self {
        let cast = |v: &[f64]| v.iter().map(|&x| T::new(x)).collect::<Vec<_>>();
        let mocap_bodies = || (0..model.nbody()).filter(|&b| model.bodies[b].mocap.is_some());
        State {
            time: T::Clock::splat(0.0),
            qpos: cast(&model.params.qpos0),
            qvel: vec![T::ZERO; model.nv],
            act: vec![T::ZERO; model.na],
            ctrl: vec![T::ZERO; model.nu()],
            qfrc_applied: vec![T::ZERO; model.nv],
            xfrc_applied: vec![Force::ZERO; model.nbody()],
            mocap_pos: mocap_bodies()
                .map(|b| Vec3::from_f64(model.params.body_pos[b].to_array()))
                .collect(),
            mocap_quat: mocap_bodies()
                .map(|b| Quat::from_f64(model.params.body_quat[b].to_array()))
                .collect(),
            eq_active: (model.equalities.iter())
                .map(|e| T::Mask::splat(e.active0))
                .collect(),
            qacc_warmstart: vec![T::ZERO; model.nv],
        }
    }

    /// How many numbers each field has.
    pub(crate) fn lengths(&self) -> Lengths {
        [
            ("time", 1),
            ("qpos", self.qpos.len()),
            ("qvel", self.qvel.len()),
            ("act", self.act.len()),
            ("ctrl", self.ctrl.len()),
            ("qfrc_applied", self.qfrc_applied.len()),
            ("xfrc_applied", 6 * self.xfrc_applied.len()),
            ("mocap_pos", 3 * self.mocap_pos.len()),
            ("mocap_quat", 4 * self.mocap_quat.len()),
            ("eq_active", self.eq_active.len()),
            ("qacc_warmstart", self.qacc_warmstart.len()),
        ]
    }

    /// Lets time pass.
    #[inline(always)]
    pub(crate) fn pass(&mut self, time: T) {
        for lane in 0..T::LANES {
            let now = self.time.lane(lane);
            self.time.set_lane(lane, now + time.lane(lane).to_f64());
        }
    }

    /// The time in the precision of all other numbers.
    pub(crate) fn rounded_time(&self) -> T {
        let mut time = T::ZERO;
        for lane in 0..T::LANES {
            time.set_lane(lane, T::Scalar::new(self.time.lane(lane)));
        }
        time
    }

    /// Takes over another state of the same model, without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.time = other.time;
        self.qpos.clone_from(&other.qpos);
        self.qvel.clone_from(&other.qvel);
        self.act.clone_from(&other.act);
        self.ctrl.clone_from(&other.ctrl);
        self.qfrc_applied.clone_from(&other.qfrc_applied);
        self.xfrc_applied.clone_from(&other.xfrc_applied);
        self.mocap_pos.clone_from(&other.mocap_pos);
        self.mocap_quat.clone_from(&other.mocap_quat);
        self.eq_active.clone_from(&other.eq_active);
        self.qacc_warmstart.clone_from(&other.qacc_warmstart);
    }

    /// Takes over what a keyframe of the model holds, the same in every lane.
    pub fn set_keyframe(&mut self, key: &Keyframe) {
        self.time = T::Clock::splat(key.time);
        for (to, from) in [
            (&mut self.qpos, &key.qpos),
            (&mut self.qvel, &key.qvel),
            (&mut self.act, &key.act),
            (&mut self.ctrl, &key.ctrl),
        ] {
            broadcast(from, to);
        }
        for (to, p) in (self.mocap_pos.iter_mut()).zip(key.mocap_pos.chunks_exact(3)) {
            *to = Vec3::from_f64([p[0], p[1], p[2]]);
        }
        for (to, q) in (self.mocap_quat.iter_mut()).zip(key.mocap_quat.chunks_exact(4)) {
            *to = Quat::from_f64([q[0], q[1], q[2], q[3]]);
        }
    }
}
