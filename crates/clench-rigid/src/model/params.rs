//! Every number of a model, one array a field, in any precision or width.

use clench_math::{Quat, Real, Vec3};

/// A number, vector or array that can be broadcast to another kind of number.
trait Broadcast<T> {
    type Output;
    fn broadcast(&self) -> Self::Output;
}
impl<T: Real> Broadcast<T> for f64 {
    type Output = T;
    fn broadcast(&self) -> T {
        T::new(*self)
    }
}
impl<T: Real> Broadcast<T> for Vec3<f64> {
    type Output = Vec3<T>;
    fn broadcast(&self) -> Vec3<T> {
        Vec3::from_f64(self.to_array())
    }
}
impl<T: Real> Broadcast<T> for Quat<f64> {
    type Output = Quat<T>;
    fn broadcast(&self) -> Quat<T> {
        Quat::from_f64(self.to_array())
    }
}
impl<T: Real, const N: usize> Broadcast<T> for [f64; N] {
    type Output = [T; N];
    fn broadcast(&self) -> [T; N] {
        self.map(T::new)
    }
}
impl<T, A: Broadcast<T>> Broadcast<T> for Vec<A> {
    type Output = Vec<A::Output>;
    fn broadcast(&self) -> Vec<A::Output> {
        self.iter().map(|a| a.broadcast()).collect()
    }
}

macro_rules! params {
    ($($(#[$doc:meta])* $name:ident: $kind:ty,)*) => {
        /// Every number of a model, one array a field (the index is that of the element).
        ///
        /// Units are SI; `solref` and `solimp` as in MuJoCo.
        #[derive(Clone, Debug, Default)]
        pub struct Params<T> {
            $($(#[$doc])* pub $name: $kind,)*
        }
        impl Params<f64> {
            /// The same numbers in every lane of `T`.
            pub fn broadcast<T: Real>(&self) -> Params<T> {
                Params { $($name: self.$name.broadcast(),)* }
            }
        }
    };
}

params! {
    /// Seconds a step.
    timestep: T,
    /// Acceleration of gravity.
    gravity: Vec3<T>,
    /// Velocity of the medium.
    wind: Vec3<T>,
    /// Density of the medium.
    density: T,
    /// Viscosity of the medium.
    viscosity: T,
    /// Margin of every contact, with `Model::override_contacts`.
    override_margin: T,
    /// Reference dynamics of every contact, likewise.
    override_solref: [T; 2],
    /// Impedance of every contact, likewise.
    override_solimp: [T; 5],
    /// Friction of every contact, likewise.
    override_friction: [T; 5],

    /// Initial position coordinates (nq).
    qpos0: Vec<T>,
    /// Position coordinates at which springs rest (nq).
    qpos_spring: Vec<T>,

    /// Position in the parent's frame.
    body_pos: Vec<Vec3<T>>,
    /// Orientation in the parent's frame.
    body_quat: Vec<Quat<T>>,
    /// Centre of mass in the body frame.
    body_ipos: Vec<Vec3<T>>,
    /// Orientation of the inertial frame in the body frame.
    body_iquat: Vec<Quat<T>>,
    /// Mass.
    body_mass: Vec<T>,
    /// Mass of the body and all below it.
    body_subtreemass: Vec<T>,
    /// Principal moments.
    body_inertia: Vec<Vec3<T>>,
    /// Share of the weight that is lifted.
    body_gravcomp: Vec<T>,
    /// Mean inverse inertia at qpos0: translation, rotation.
    body_invweight0: Vec<[T; 2]>,

    /// Anchor in the body frame.
    jnt_pos: Vec<Vec3<T>>,
    /// Unit axis in the body frame.
    jnt_axis: Vec<Vec3<T>>,
    /// Spring stiffness.
    jnt_stiffness: Vec<T>,
    /// Allowed positions.
    jnt_range: Vec<[T; 2]>,
    /// Distance at which the limit appears.
    jnt_margin: Vec<T>,
    /// Limits of the total actuator force.
    jnt_actfrcrange: Vec<[T; 2]>,
    /// Limit reference dynamics.
    jnt_solref: Vec<[T; 2]>,
    /// Limit impedance.
    jnt_solimp: Vec<[T; 5]>,

    /// Added inertia.
    dof_armature: Vec<T>,
    /// Damping.
    dof_damping: Vec<T>,
    /// Dry friction.
    dof_frictionloss: Vec<T>,
    /// Dry-friction reference dynamics.
    dof_solref: Vec<[T; 2]>,
    /// Dry-friction impedance.
    dof_solimp: Vec<[T; 5]>,
    /// Inverse inertia at qpos0 (averaged over the dofs of ball and free joints as MuJoCo does).
    dof_invweight0: Vec<T>,

    /// Position in the body frame.
    geom_pos: Vec<Vec3<T>>,
    /// Orientation in the body frame.
    geom_quat: Vec<Quat<T>>,
    /// Sizes.
    geom_size: Vec<Vec3<T>>,
    /// Radius of the bounding sphere (infinite planes: 0).
    geom_rbound: Vec<T>,
    /// Slide, spin and roll friction.
    geom_friction: Vec<[T; 3]>,
    /// Margin.
    geom_margin: Vec<T>,
    /// Gap.
    geom_gap: Vec<T>,
    /// Weight in mixing.
    geom_solmix: Vec<T>,
    /// Reference dynamics.
    geom_solref: Vec<[T; 2]>,
    /// Impedance.
    geom_solimp: Vec<[T; 5]>,

    /// Position in the body frame.
    site_pos: Vec<Vec3<T>>,
    /// Orientation in the body frame.
    site_quat: Vec<Quat<T>>,

    /// Coefficients of fixed tendons, tendon after tendon.
    wrap_coef: Vec<T>,
    /// Spring stiffness.
    tendon_stiffness: Vec<T>,
    /// Damping.
    tendon_damping: Vec<T>,
    /// Dead band of the spring.
    tendon_lengthspring: Vec<[T; 2]>,
    /// Length at qpos0.
    tendon_length0: Vec<T>,
    /// Inverse inertia at qpos0.
    tendon_invweight0: Vec<T>,
    /// Allowed lengths.
    tendon_range: Vec<[T; 2]>,
    /// Distance at which the limit appears.
    tendon_margin: Vec<T>,
    /// Limits of the total actuator force.
    tendon_actfrcrange: Vec<[T; 2]>,
    /// Dry friction.
    tendon_frictionloss: Vec<T>,
    /// Limit reference dynamics.
    tendon_solref_lim: Vec<[T; 2]>,
    /// Limit impedance.
    tendon_solimp_lim: Vec<[T; 5]>,
    /// Dry-friction reference dynamics.
    tendon_solref_fri: Vec<[T; 2]>,
    /// Dry-friction impedance.
    tendon_solimp_fri: Vec<[T; 5]>,

    /// Scaling of the force onto the transmission's axes.
    actuator_gear: Vec<[T; 6]>,
    /// Parameters of the dynamics.
    actuator_dynprm: Vec<[T; 10]>,
    /// Parameters of the gain.
    actuator_gainprm: Vec<[T; 10]>,
    /// Parameters of the bias.
    actuator_biasprm: Vec<[T; 10]>,
    /// Allowed controls.
    actuator_ctrlrange: Vec<[T; 2]>,
    /// Allowed forces.
    actuator_forcerange: Vec<[T; 2]>,
    /// Allowed activations.
    actuator_actrange: Vec<[T; 2]>,

    /// Anchor (connect) or weld point in the first body's frame.
    eq_anchor1: Vec<Vec3<T>>,
    /// Anchor (connect) or weld point in the second body's frame.
    eq_anchor2: Vec<Vec3<T>>,
    /// Weld: orientation of the first body's weld frame in the first body.
    eq_quat1: Vec<Quat<T>>,
    /// Weld: orientation of the second body's weld frame in the second body.
    eq_quat2: Vec<Quat<T>>,
    /// Weld: length that scales rotations.
    eq_torquescale: Vec<T>,
    /// Joint and tendon equality: coefficients, constant first.
    eq_polycoef: Vec<[T; 5]>,
    /// Reference dynamics.
    eq_solref: Vec<[T; 2]>,
    /// Impedance.
    eq_solimp: Vec<[T; 5]>,

    /// Friction of a pair: two slides, spin, two rolls.
    pair_friction: Vec<[T; 5]>,
    /// Reference dynamics.
    pair_solref: Vec<[T; 2]>,
    /// Reference dynamics of the friction dimensions; both zero: as `pair_solref`.
    pair_solreffriction: Vec<[T; 2]>,
    /// Impedance.
    pair_solimp: Vec<[T; 5]>,
    /// Margin.
    pair_margin: Vec<T>,
    /// Gap.
    pair_gap: Vec<T>,
}
