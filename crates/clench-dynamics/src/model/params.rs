//! The numbers of a model, one array per field, in any precision or width.

use super::flat::{Broadcast, Flat, FlatMut, Numbers};
use super::rule::Rule;
use clench_math::{Quat, Real, Scalar, Vec3};

macro_rules! params {
    // The rows of this file, and those of the table of element numbers.
    ([$($rows:tt)*] $($group:ident {$(
        $(#[$doc:meta])* $name:ident: $param:ident, $check:ident, $rule:ident, $dimension:ident;
    )*})*) => {
        params! { $($rows)* $($($(#[$doc])* $param: Vec<T>, $rule;)*)* }
    };
    ($($(#[$doc:meta])* $name:ident: $kind:ty, $rule:expr;)*) => {
        /// The numbers of a model, one array per field (the index is that of the element).
        ///
        /// Units are SI; `solref` and `solimp` as in MuJoCo.
        #[derive(Debug, Default, PartialEq)]
        pub struct Params<T> {
            $($(#[$doc])* pub $name: $kind,)*
            /// The model of each lane, an index in [`Model::geom_assets`](super::Model::geom_assets); empty if all
            /// lanes have one model.
            pub lane_models: Vec<u32>,
        }

        /// A field of [`Params`].
        #[allow(non_camel_case_types)] // Named as the fields are.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum ParamField {
            $($(#[$doc])* $name,)*
        }

        impl ParamField {
            /// Every field.
            pub const ALL: &[ParamField] = &[$(ParamField::$name),*];

            /// Returns the name of the field.
            pub fn name(self) -> &'static str {
                match self { $(ParamField::$name => stringify!($name),)* }
            }

            /// Returns the rule of its numbers.
            pub(super) fn rule(self) -> Rule {
                use Rule::*;
                match self { $(ParamField::$name => $rule,)* }
            }
        }

        impl<T: Clone> Clone for Params<T> {
            #[inline(never)]
            fn clone(&self) -> Self {
                Params {
                    $($name: copy(&self.$name),)*
                    lane_models: copy(&self.lane_models),
                }
            }
        }

        impl Params<f64> {
            /// Copies the numbers to every lane of `T`.
            #[inline(never)]
            pub fn broadcast<T: Real>(&self) -> Params<T> {
                Params {
                    $($name: self.$name.broadcast(),)*
                    lane_models: Vec::new(),
                }
            }
        }

        impl<T: Real> Params<T> {
            /// Returns the shape of a field: elements, numbers per element. Single fields and plain numbers omit that
            /// axis.
            pub(super) fn shape(&self, field: ParamField) -> Vec<usize> {
                match field { $(ParamField::$name => self.$name.shape(),)* }
            }

            pub(super) fn flat(&self, field: ParamField) -> Flat<'_, T> {
                match field { $(ParamField::$name => self.$name.flat(),)* }
            }

            fn flat_mut(&mut self, field: ParamField) -> FlatMut<'_, T> {
                match field { $(ParamField::$name => self.$name.flat_mut(),)* }
            }

            /// Changes the number of elements of a field. New numbers are zero.
            pub fn resize(&mut self, field: ParamField, elements: usize) {
                match field { $(ParamField::$name => Numbers::<T>::resize(&mut self.$name, elements),)* }
            }
        }
    };
}

#[inline(never)] // Every field calls it.
fn copy<A: Clone>(field: &A) -> A {
    field.clone()
}

impl<T: Real> Params<T> {
    /// Returns the number of numbers of a field.
    pub fn width(&self, field: ParamField) -> usize {
        self.flat(field).len()
    }
    /// Returns the numbers of a field in lane `lane`, element after element.
    pub fn read_lane(&self, field: ParamField, lane: usize) -> Vec<T::Scalar> {
        self.flat(field).read_lane(lane)
    }
    /// Returns a number of a field in lane `lane`, by its index among all of them.
    pub fn number(&self, field: ParamField, lane: usize, index: usize) -> T::Scalar {
        self.flat(field).number(index).lane(lane)
    }
    /// Appends an element to a field that has one number each.
    pub fn push(&mut self, field: ParamField, number: T::Scalar) {
        let elements = self.width(field);
        self.resize(field, elements + 1);
        for lane in 0..T::LANES {
            self.write_part(field, lane, elements, &[number]);
        }
    }
    /// Replaces the numbers of a field in lane `lane` by the same number of others.
    pub fn write_lane(&mut self, field: ParamField, lane: usize, row: &[T::Scalar]) {
        self.flat_mut(field).write_lane(lane, 0, row);
    }
    /// Replaces the numbers of a field in lane `lane` from number `start` on, which is the first of an element.
    pub fn write_part(&mut self, field: ParamField, lane: usize, start: usize, row: &[T::Scalar]) {
        self.flat_mut(field).write_lane(lane, start, row);
    }
    /// Replaces the numbers of a field by the same number of others, equal in every lane.
    pub fn write_lanes(&mut self, field: ParamField, row: &[T::Scalar]) {
        for lane in 0..T::LANES {
            self.write_lane(field, lane, row);
        }
    }
}

impl Params<f64> {
    /// Replaces the numbers of a field by those of a simulation of a model. A number that equals the model's in the
    /// precision of the simulation becomes the model's in double precision.
    pub fn write_of_simulation<S: Scalar>(
        &mut self,
        field: ParamField,
        row: &[S],
        model: &Params<f64>,
    ) {
        let of_model = model.read_lane(field, 0);
        let numbers = of_model
            .iter()
            .zip(row)
            .map(|(&of_model, &x)| match S::new(of_model) == x {
                true => of_model,
                false => x.to_f64(),
            });
        self.write_lane(field, 0, &Vec::from_iter(numbers));
    }
}

crate::element_numbers! { params
    /// Time step, s.
    timestep: T, Positive;
    /// Acceleration of gravity.
    gravity: Vec3<T>, Finite;
    /// Velocity of the medium.
    wind: Vec3<T>, Finite;
    /// The magnetic field, measured by magnetometers.
    magnetic: Vec3<T>, Finite;
    /// Density of the medium.
    density: T, NotNegative;
    /// Viscosity of the medium.
    viscosity: T, NotNegative;
    /// Speed below which trees fall asleep, m/s.
    sleep_tolerance: T, Finite;
    /// Margin of every contact, with `Model::override_contacts`.
    override_margin: T, Finite;
    /// Reference dynamics of every contact, likewise.
    override_solref: [T; 2], Finite;
    /// Impedance of every contact, likewise.
    override_solimp: [T; 5], Finite;
    /// Friction of every contact, likewise.
    override_friction: [T; 5], NotNegative;

    /// Initial position coordinates (nq).
    qpos0: Vec<T>, Finite;
    /// Position coordinates at which springs are at rest (nq).
    qpos_spring: Vec<T>, Finite;

    /// Position in the parent's frame.
    body_pos: Vec<Vec3<T>>, Finite;
    /// Orientation in the parent's frame.
    body_quat: Vec<Quat<T>>, Quaternion;
    /// Centre of mass in the body frame.
    body_ipos: Vec<Vec3<T>>, Finite;
    /// Orientation of the inertial frame in the body frame.
    body_iquat: Vec<Quat<T>>, Quaternion;
    /// Mass.
    body_mass: Vec<T>, AsModel;
    /// Mass of the body and its descendants.
    body_subtreemass: Vec<T>, Follows("body_mass");
    /// Principal moments.
    body_inertia: Vec<Vec3<T>>, AsModel;
    /// Fraction of the weight that is compensated.
    body_gravcomp: Vec<T>, Finite;
    /// Mean inverse inertia at qpos0: translation, rotation.
    body_invweight0: Vec<[T; 2]>, NotNegative;

    /// Anchor in the body frame.
    jnt_pos: Vec<Vec3<T>>, Finite;
    /// Unit axis in the body frame.
    jnt_axis: Vec<Vec3<T>>, Axis;
    /// Spring stiffness.
    jnt_stiffness: Vec<T>, Finite;
    /// Coefficients of the spring's quadratic and cubic force.
    jnt_stiffnesspoly: Vec<[T; 2]>, Finite;
    /// Allowed positions.
    jnt_range: Vec<[T; 2]>, Range;
    /// Limits of the total actuator force.
    jnt_actfrcrange: Vec<[T; 2]>, Range;
    /// Limit reference dynamics.
    jnt_solref: Vec<[T; 2]>, Finite;
    /// Limit impedance.
    jnt_solimp: Vec<[T; 5]>, Finite;

    /// Factor of a velocity before it is compared with `sleep_tolerance`: 1 for translations, the size of the body for
    /// rotations, m.
    dof_length: Vec<T>, NotNegative;
    /// Damping.
    dof_damping: Vec<T>, Finite;
    /// Coefficients of quadratic and cubic damping.
    dof_dampingpoly: Vec<[T; 2]>, Finite;
    /// Dry-friction reference dynamics.
    dof_solref: Vec<[T; 2]>, Finite;
    /// Dry-friction impedance.
    dof_solimp: Vec<[T; 5]>, Finite;
    /// Inverse inertia at qpos0 (averaged over the dofs of ball and free joints as MuJoCo does).
    dof_invweight0: Vec<T>, NotNegative;

    /// Position in the body frame.
    geom_pos: Vec<Vec3<T>>, Finite;
    /// Orientation in the body frame.
    geom_quat: Vec<Quat<T>>, Quaternion;
    /// Sizes.
    geom_size: Vec<Vec3<T>>, AsModel;
    /// Radius of the bounding sphere (infinite planes: 0). −∞ in environments without the geom, which touches nothing
    /// there.
    geom_rbound: Vec<T>, Follows("geom_size");
    /// Slide, spin and roll friction.
    geom_friction: Vec<[T; 3]>, NotNegative;
    /// Margin.
    geom_margin: Vec<T>, Finite;
    /// Gap.
    geom_gap: Vec<T>, Finite;
    /// Velocity of the surface in the geom's frame: linear, angular.
    geom_surfacevel: Vec<[T; 6]>, Finite;
    /// Adhesive force of contacts.
    geom_adhesion: Vec<T>, Finite;
    /// Coefficients of blunt, slender and angular drag and of Kutta and Magnus lift, of ellipsoids in a medium.
    geom_fluidcoef: Vec<[T; 5]>, Finite;
    /// Volume of the medium that moves with the geom along each axis.
    geom_virtualmass: Vec<[T; 3]>, Finite;
    /// Moment of inertia of the medium that rotates with the geom about each axis, at unit density.
    geom_virtualinertia: Vec<[T; 3]>, Finite;
    /// Weight in mixing.
    geom_solmix: Vec<T>, Finite;
    /// Reference dynamics.
    geom_solref: Vec<[T; 2]>, Finite;
    /// Impedance.
    geom_solimp: Vec<[T; 5]>, Finite;

    /// Size of the site's volume, as a geom's.
    site_size: Vec<Vec3<T>>, NotNegative;
    /// Position in the body frame.
    site_pos: Vec<Vec3<T>>, Finite;
    /// Orientation in the body frame.
    site_quat: Vec<Quat<T>>, Quaternion;

    /// Position in the body frame.
    cam_pos: Vec<Vec3<T>>, Finite;
    /// Orientation in the body frame.
    cam_quat: Vec<Quat<T>>, Quaternion;
    /// Offset of the camera from the body in the initial configuration, world axes.
    cam_pos0: Vec<Vec3<T>>, Finite;
    /// Offset of the camera from the centre of mass of the body's subtree, likewise.
    cam_poscom0: Vec<Vec3<T>>, Finite;
    /// Orientation in the initial configuration, row by row.
    cam_mat0: Vec<[T; 9]>, Finite;
    /// Vertical field of view, degrees; for an orthographic camera the height of the picture.
    cam_fovy: Vec<T>, Finite;
    /// Size of the sensor, width and height; both zero: the field of view is `cam_fovy`.
    cam_sensorsize: Vec<[T; 2]>, Finite;
    /// Focal length and principal point, two numbers each.
    cam_intrinsic: Vec<[T; 4]>, Finite;

    /// Coefficients of the elements of tendons, tendon after tendon: coefficients of joints, divisors of pulleys; 0 for
    /// sites and geoms.
    wrap_coef: Vec<T>, Finite;
    /// Spring stiffness.
    tendon_stiffness: Vec<T>, Finite;
    /// Coefficients of the spring's quadratic and cubic force.
    tendon_stiffnesspoly: Vec<[T; 2]>, Finite;
    /// Damping.
    tendon_damping: Vec<T>, Finite;
    /// Coefficients of quadratic and cubic damping.
    tendon_dampingpoly: Vec<[T; 2]>, Finite;
    /// Dead band of the spring.
    tendon_lengthspring: Vec<[T; 2]>, Range;
    /// Length at qpos0.
    tendon_length0: Vec<T>, Finite;
    /// Inverse inertia at qpos0.
    tendon_invweight0: Vec<T>, NotNegative;
    /// Allowed lengths.
    tendon_range: Vec<[T; 2]>, Range;
    /// Limits of the total actuator force.
    tendon_actfrcrange: Vec<[T; 2]>, Range;
    /// Limit reference dynamics.
    tendon_solref_lim: Vec<[T; 2]>, Finite;
    /// Limit impedance.
    tendon_solimp_lim: Vec<[T; 5]>, Finite;
    /// Dry-friction reference dynamics.
    tendon_solref_fri: Vec<[T; 2]>, Finite;
    /// Dry-friction impedance.
    tendon_solimp_fri: Vec<[T; 5]>, Finite;

    /// Scaling of the force onto the transmission's axes.
    actuator_gear: Vec<[T; 6]>, Finite;
    /// Length of the rod of a slider-crank.
    actuator_cranklength: Vec<T>, Finite;
    /// Parameters of the dynamics.
    actuator_dynprm: Vec<[T; 10]>, Finite;
    /// Parameters of the gain.
    actuator_gainprm: Vec<[T; 10]>, Finite;
    /// Parameters of the bias.
    actuator_biasprm: Vec<[T; 10]>, Finite;
    /// Allowed controls.
    actuator_ctrlrange: Vec<[T; 2]>, Range;
    /// Allowed forces.
    actuator_forcerange: Vec<[T; 2]>, Range;
    /// Allowed activations.
    actuator_actrange: Vec<[T; 2]>, Range;
    /// Delay of controls, s; only of actuators that store past ones.
    actuator_delay: Vec<T>, NotNegative;
    /// Damping added to the target, times the square of the gear.
    actuator_damping: Vec<T>, Finite;
    /// Coefficients of quadratic and cubic damping, likewise.
    actuator_dampingpoly: Vec<[T; 2]>, Finite;
    /// Inertia added to the target, likewise.
    actuator_armature: Vec<T>, NotNegative;
    /// Norm of the acceleration that a unit force causes at qpos0.
    actuator_acc0: Vec<T>, NotNegative;
    /// Range of the transmission's length; used by muscles.
    actuator_lengthrange: Vec<[T; 2]>, Finite;

    /// Delay of sensors, s; only those that store past values.
    sensor_delay: Vec<T>, NotNegative;
    /// Measurement interval of sensors, s; zero: every step. Only those that store past values.
    sensor_interval: Vec<T>, NotNegative;

    /// Anchor (connect) or weld point in the first body's frame.
    eq_anchor1: Vec<Vec3<T>>, Finite;
    /// Anchor (connect) or weld point in the second body's frame.
    eq_anchor2: Vec<Vec3<T>>, Finite;
    /// Weld: orientation of the first body's weld frame in the first body.
    eq_quat1: Vec<Quat<T>>, Quaternion;
    /// Weld: orientation of the second body's weld frame in the second body.
    eq_quat2: Vec<Quat<T>>, Quaternion;
    /// Weld: length that scales rotations.
    eq_torquescale: Vec<T>, NotNegative;
    /// Joint and tendon equality: coefficients, constant first.
    eq_polycoef: Vec<[T; 5]>, Finite;
    /// Reference dynamics.
    eq_solref: Vec<[T; 2]>, Finite;
    /// Impedance.
    eq_solimp: Vec<[T; 5]>, Finite;

    /// Friction of a pair: two slides, spin, two rolls.
    pair_friction: Vec<[T; 5]>, NotNegative;
    /// Reference dynamics.
    pair_solref: Vec<[T; 2]>, Finite;
    /// Reference dynamics of the friction dimensions; both zero: as `pair_solref`.
    pair_solreffriction: Vec<[T; 2]>, Finite;
    /// Impedance.
    pair_solimp: Vec<[T; 5]>, Finite;
    /// Margin.
    pair_margin: Vec<T>, Finite;
    /// Gap.
    pair_gap: Vec<T>, Finite;
    /// Adhesive force of contacts.
    pair_adhesion: Vec<T>, Finite;
}
