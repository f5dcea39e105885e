//! The data that a user saves and restores.

pub(crate) mod bounds;
pub mod kind;
pub(crate) mod slots;
mod table;

use crate::error::SimError;
use crate::model::{ControlInput, Joint, Keyframe, Model};
use clench_math::{Clock, Mask, Quat, Real, Scalar, Vec3, broadcast, kernel};
use kind::Kind;
use std::ops::Range;

/// The number of elements of a field. Each variant is named after the elements of the model that it counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "`symbol` says how many each means")]
pub enum Size {
    Positions,
    Dofs,
    Activations,
    Plastic,
    Actuators,
    History,
    Bodies,
    MocapBodies,
    Equalities,
    DynamicConstraints,
    Trees,
    AsleepPose,
    StickReferences,
    StickFriction,
}

impl Size {
    /// Returns its symbol in descriptions of shapes, in MuJoCo's names.
    pub fn symbol(self) -> &'static str {
        match self {
            Size::Positions => "nq",
            Size::Dofs => "nv",
            Size::Activations => "na",
            Size::Plastic => "nplastic",
            Size::Actuators => "nu",
            Size::History => "nhistory",
            Size::Bodies => "nbody",
            Size::MocapBodies => "nmocap",
            Size::Equalities => "neq",
            Size::DynamicConstraints => "max_dynamic_constraints",
            Size::Trees => "ntree where trees may sleep, else 0",
            Size::AsleepPose => "nq + 7 nmocap where trees may sleep, else 0",
            Size::StickReferences => "max_stick_pairs with the option stiction, else 0",
            Size::StickFriction => "nv + ntendon with the option stiction, else 0",
        }
    }

    /// Returns the number of elements in a model.
    #[inline(always)]
    pub fn of(self, model: &Model) -> usize {
        match self {
            Size::Positions => model.nq,
            Size::Dofs => model.nv,
            Size::Activations => model.na,
            Size::Plastic => model.nplastic,
            Size::Actuators => model.nu(),
            Size::History => model.nhistory,
            Size::Bodies => model.nbody(),
            Size::MocapBodies => model.nmocap,
            Size::Equalities => model.equalities.len(),
            Size::DynamicConstraints => model.max_dynamic_constraints,
            Size::Trees => model.tree_asleep0.len(),
            Size::AsleepPose if model.may_sleep() => model.nq + 7 * model.nmocap,
            Size::AsleepPose => 0,
            Size::StickReferences => model.max_stick_pairs.unwrap_or(0),
            Size::StickFriction => match model.max_stick_pairs {
                Some(_) => model.nv + model.tendons.len(),
                None => 0,
            },
        }
    }

    /// Returns the range of the elements of a joint, for fields that have elements of joints.
    pub fn of_joint(self, joint: &Joint) -> Option<Range<usize>> {
        match self {
            Size::Positions => Some(joint.qpos..joint.qpos + joint.kind.nq()),
            Size::Dofs => Some(joint.dof..joint.dof + joint.kind.nv()),
            Size::Activations
            | Size::Plastic
            | Size::Actuators
            | Size::History
            | Size::Bodies
            | Size::MocapBodies
            | Size::Equalities
            | Size::DynamicConstraints
            | Size::Trees
            | Size::AsleepPose
            | Size::StickReferences
            | Size::StickFriction => None,
        }
    }
}

/// A field of the state other than the time.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Its name.
    pub name: &'static str,
    /// The number of elements.
    pub size: Size,
    /// The number of numbers per element.
    width: usize,
}

impl Field {
    /// Returns the number of numbers of the field.
    pub fn numbers(self, model: &Model) -> usize {
        self.width.saturating_mul(self.size.of(model))
    }
}

/// Copies the elements of one environment to every lane.
#[kernel]
fn splat<T: Real, K: Kind>(from: &[K::Of<T::Scalar>], to: &mut [K::Of<T>]) {
    for (from, to) in from.iter().zip(to) {
        *to = K::splat::<T>(from);
    }
}

/// Converts the elements of one environment, for every lane.
fn set_values<S: Scalar, T: Real, K: Kind>(from: &[K::Of<S>], to: &mut [K::Of<T>]) {
    for (from, to) in from.iter().zip(to) {
        for lane in 0..T::LANES {
            let numbers = K::cells::<S>(from, 0).map(|cell| {
                let number = K::number::<S>(cell).to_f64();
                K::from_number::<T::Scalar>(T::Scalar::new(number))
            });
            K::set_cells::<T>(to, lane, numbers);
        }
    }
}

/// Copies the elements of the first lane.
fn first_lane<T: Real, K: Kind>(from: &[K::Of<T>], to: &mut [K::Of<T::Scalar>]) {
    for (from, to) in from.iter().zip(to) {
        K::set_cells::<T::Scalar>(to, 0, K::cells::<T>(from, 0));
    }
}

#[inline(never)] // Every field calls it.
fn copy<X: Copy>(from: &[X], to: &mut Vec<X>) {
    if to.len() == from.len() {
        // One copy of memory. A vector copies structs of generic numbers one by one.
        return to.copy_from_slice(from);
    }
    to.clear();
    to.extend_from_slice(from);
}

#[inline(never)] // Every field calls it.
fn zeros<T: Real, K: Kind>(count: usize) -> Vec<K::Of<T>> {
    vec![K::zero::<T>(); count]
}

macro_rules! declare_state {
    ($($group:ident { $(
        $(#[$doc:meta])* $name:ident $setter:ident: $kind:ident, $size:ident, $limit:ident;
    )* })*) => {
        /// The state of one environment (or of the lanes of a group): everything that the next step depends on.
        #[derive(Clone, Debug)]
        pub struct State<T: Real> {
            /// The time, s, in double precision.
            pub time: T::Clock,
            $($($(#[$doc])* pub $name: Vec<<kind::$kind as Kind>::Of<T>>,)*)*
        }

        /// The fields of a state, except the time.
        pub const FIELDS: &[Field] = &[$($(Field {
            name: stringify!($name),
            size: Size::$size,
            width: <kind::$kind as Kind>::WIDTH,
        }),*),*];

        /// Compares bit by bit: a NaN equals itself, and 0 does not equal −0.
        impl<T: Real> PartialEq for State<T> {
            fn eq(&self, other: &Self) -> bool {
                let same_time = |lane| {
                    self.time.lane(lane).to_bits() == other.time.lane(lane).to_bits()
                };
                (0..T::LANES).all(same_time) $($(&& {
                    let mut pairs = self.$name.iter().zip(&other.$name);
                    self.$name.len() == other.$name.len()
                        && pairs.all(|(a, b)| <kind::$kind as Kind>::same::<T>(a, b))
                })*)*
            }
        }

        impl<T: Real> State<T> {
            /// Creates a state with zero and false everywhere.
            fn zero(model: &Model) -> Self {
                State {
                    time: T::Clock::splat(0.0),
                    $($($name: zeros::<T, kind::$kind>(Size::$size.of(model)),)*)*
                }
            }

            /// Returns the number of numbers of each field, in the order of [`FIELDS`].
            pub fn lengths(&self) -> impl Iterator<Item = usize> {
                [$($(self.$name.len() * <kind::$kind as Kind>::WIDTH),*),*].into_iter()
            }

            /// Returns true if every field has the number of elements that the model needs.
            pub fn fits(&self, model: &Model) -> bool {
                $($(self.$name.len() == Size::$size.of(model))&&*)&&*
            }

            /// Copies another state of the same model, without allocating.
            pub fn copy_from(&mut self, other: &Self) {
                self.time = other.time;
                $($(copy(&other.$name, &mut self.$name);)*)*
            }

            /// Copies the numbers of a state of the same model to every lane, without derivatives.
            pub fn set_values<S: Scalar>(&mut self, other: &State<S>) {
                self.time = T::Clock::splat(other.time);
                $($(set_values::<S, T, kind::$kind>(&other.$name, &mut self.$name);)*)*
            }

            /// Copies the state of one environment, of the same model, to every lane.
            pub fn splat_from(&mut self, other: &State<T::Scalar>) {
                self.time = T::Clock::splat(other.time);
                $($(splat::<T, kind::$kind>(&other.$name, &mut self.$name);)*)*
            }
        }
    };
}
crate::state_fields!(declare_state);

macro_rules! declare_moving {
    (moving { $(
        $(#[$doc:meta])* $name:ident $setter:ident: $kind:ident, $size:ident, $limit:ident;
    )* } $($others:tt)*) => {
        impl<T: Real> State<T> {
            /// Copies the fields that a step writes from another state of the same model, without allocating.
            pub fn copy_moving_from(&mut self, other: &Self) {
                self.time = other.time;
                $(copy(&other.$name, &mut self.$name);)*
            }

            /// Writes the fields that a step changes from the first lane to the state of one environment of the same
            /// model.
            pub fn write_moving(&self, other: &mut State<T::Scalar>) {
                other.time = self.time.lane(0);
                $(first_lane::<T, kind::$kind>(&self.$name, &mut other.$name);)*
            }
        }
    };
}
crate::state_fields!(declare_moving);

impl<T: Real> Eq for State<T> {}

impl<T: Real> State<T> {
    /// Checks that there is memory for several states of a model. Options choose how many elements some fields have.
    ///
    /// # Errors
    /// Returns an error if there is not.
    pub fn check_memory(model: &Model, count: usize) -> Result<(), SimError> {
        let numbers = FIELDS.iter().map(|field| field.numbers(model));
        let bytes = numbers
            .fold(0, usize::saturating_add)
            .saturating_mul(size_of::<T>());
        let mut attempt = Vec::<u8>::new();
        let fits = attempt.try_reserve_exact(bytes.saturating_mul(count));
        // An allocation that nothing uses would be removed by the compiler.
        std::hint::black_box(&mut attempt);
        fits.map_err(|_| SimError::OutOfMemory { count, bytes })
    }

    /// Creates the initial state of a model.
    pub fn new(model: &Model) -> Self {
        let mut state = State::zero(model);
        broadcast(&model.params.qpos0, &mut state.qpos);
        write_initial_rest_positions(model, &mut state.plastic);
        for actuator in &model.actuators {
            if actuator.inputs.first() == Some(&ControlInput::Quaternion) {
                state.ctrl[actuator.controls.start] = T::ONE; // No rotation.
            }
        }
        let step = model.params.timestep;
        for history in model.histories() {
            history.begin(step, &mut state.history);
        }
        for (sensor, &period) in model.sensors.iter().zip(&model.params.sensor_interval) {
            if let Some(history) = sensor.history.as_ref().filter(|_| period > 0.0) {
                let phase = if sensor.phase == 0.0 {
                    -period
                } else {
                    sensor.phase
                };
                history.begin_periodic(step, [period, phase], &mut state.history);
            }
        }
        let mocap_bodies = (0..model.nbody()).filter(|&b| model.bodies[b].mocap.is_some());
        for (m, b) in mocap_bodies.enumerate() {
            state.mocap_pos[m] = Vec3::from_f64(model.params.body_pos[b].to_array());
            state.mocap_quat[m] = Quat::from_f64(model.params.body_quat[b].to_array());
        }
        for (active, equality) in state.eq_active.iter_mut().zip(&model.equalities) {
            *active = T::Mask::splat(equality.active0);
        }
        broadcast(&model.tree_asleep0, &mut state.tree_asleep);
        if model.may_sleep() {
            let (qpos, mocap) = state.pose_asleep.split_at_mut(model.nq);
            broadcast(&model.params.qpos0, qpos);
            for (m, pose) in mocap.chunks_exact_mut(7).enumerate() {
                let (pos, quat) = (state.mocap_pos[m], state.mocap_quat[m]);
                pos.write(pose);
                quat.write(&mut pose[3..]);
            }
        }
        state
    }

    /// Advances the time.
    #[inline(always)]
    pub fn pass(&mut self, time: T) {
        for lane in 0..T::LANES {
            let now = self.time.lane(lane);
            self.time.set_lane(lane, now + time.lane(lane).to_f64());
        }
    }

    /// Returns the time in the precision of all other numbers.
    pub fn rounded_time(&self) -> T {
        let mut time = T::ZERO;
        for lane in 0..T::LANES {
            time.set_lane(lane, T::Scalar::new(self.time.lane(lane)));
        }
        time
    }

    /// Copies a keyframe of the model to every lane of an initial state. As in MuJoCo, the stored past of controls and
    /// sensors is that before time zero, also at a keyframe of a later time.
    pub fn set_keyframe(&mut self, model: &Model, key: &Keyframe) {
        self.time = T::Clock::splat(key.time);
        for history in model.histories() {
            for time in &mut self.history[history.times()] {
                *time -= T::new(key.time.max(0.0));
            }
        }
        for (to, from) in [
            (&mut self.qpos, &key.qpos),
            (&mut self.qvel, &key.qvel),
            (&mut self.act, &key.act),
            (&mut self.plastic, &key.plastic),
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

/// Writes the initial rest positions of yielding springs (nplastic).
fn write_initial_rest_positions<T: Real>(model: &Model, plastic: &mut [T]) {
    for joint in &model.joints {
        if let Some(start) = joint.plastic {
            let count = joint.kind.nq();
            let rest = &model.params.qpos_spring[joint.qpos..][..count];
            broadcast(rest, &mut plastic[start..start + count]);
        }
    }
    // While a model is built, joints have their indices before tendons have lengths.
    for (tendon, &[low, high]) in model.tendons.iter().zip(&model.params.tendon_lengthspring) {
        if let Some(start) = tendon.plastic {
            (plastic[start], plastic[start + 1]) = (T::new(low), T::new(high));
        }
    }
}
