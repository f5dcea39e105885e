//! Fluid forces on the box with the body's mass and inertia. The fluid acts on bodies with ellipsoid geoms only through
//! those, see [`ellipsoid`](crate::dynamics::ellipsoid).
//!
//! MuJoCo's default model ("inertia box", *Computation*, fluid forces): in the inertial frame of a body with box sides
//! s and mean side d, velocity v relative to the fluid and angular velocity ω,
//!
//! ```text
//! viscous:    f_i = −3π d η v_i               t_i = −π d³ η ω_i
//! quadratic:  f_i = −½ ρ s_j s_k |v_i| v_i    t_i = −ρ s_i (s_j⁴ + s_k⁴) |ω_i| ω_i / 64
//! ```

use crate::dynamics::ellipsoid::{Ellipsoid, ellipsoids};
use crate::dynamics::project::{force_at, local_velocity, project_forces};
use crate::model::{Model, Params};
use crate::part::Part;
use crate::stages::{Forces, Positions, Velocities};
use clench_math::{Force, Mask, Motion, Real, Vec3, kernel};
use std::f64::consts::PI;

/// The minimum mass (kg) of a body in a fluid, and the minimum (kg m²) for a box's squared sides (MuJoCo's `mjMINVAL`).
const TINY: f64 = 1e-15;

/// Returns true if any lane has a fluid.
#[inline(always)]
pub(crate) fn has_fluid<T: Real>(params: &Params<T>) -> bool {
    !(params.density.eq(T::ZERO) & params.viscosity.eq(T::ZERO)).all()
}

/// Returns true if there is a fluid and passive forces are enabled.
#[inline(always)]
pub(crate) fn fluid_acts<T: Real>(model: &Model, params: &Params<T>) -> bool {
    (model.flags.spring || model.flags.damper) && has_fluid(params)
}

/// Returns the symmetric and the skew part of a 6 × 6 matrix, input and output by columns.
#[inline(always)]
pub(crate) fn symmetric_and_skew<T: Real>(columns: [Force<T>; 6]) -> [[Force<T>; 6]; 2] {
    let mut parts = [[Force::ZERO; 6]; 2];
    let half = T::new(0.5);
    for c in 0..6 {
        let mut row = Force::ZERO;
        for (k, column) in columns.iter().enumerate() {
            let entry = Motion::component(c).dot(*column);
            if k < 3 {
                row.angular[k] = entry;
            } else {
                row.linear[k - 3] = entry;
            }
        }
        parts[0][c] = (columns[c] + row) * half;
        parts[1][c] = (columns[c] - row) * half;
    }
    parts
}

/// Computes `qfrc_fluid` of some parts (zero without a fluid).
#[kernel]
pub(crate) fn fluid_forces<T: Real>(
    model: &Model,
    params: &Params<T>,
    parts: &[Part],
    pos: &Positions<T>,
    vel: &Velocities<T>,
    force: &mut Forces<T>,
) {
    if !has_fluid(params) {
        return;
    }
    for b in parts.iter().flat_map(|part| part.bodies.clone()) {
        force.cfrc_body[b] = if model.bodies[b].fluid_ellipsoids {
            let mut sum = Force::ZERO;
            for geom in ellipsoids(model, b) {
                sum += Ellipsoid::new(model, params, pos, vel, b, geom).force(model, pos);
            }
            sum
        } else {
            Drag::new(model, params, pos, vel, b).force(model, pos)
        };
    }
    let Forces {
        cfrc_body,
        qfrc_fluid,
        ..
    } = force;
    project_forces(model, parts, pos, cfrc_body, qfrc_fluid);
}

/// The resistance of the fluid to one body, at one velocity.
pub(crate) struct Drag<T> {
    body: usize,
    /// The velocity relative to the fluid at the centre of mass, in the inertial frame.
    velocity: Motion<T>,
    /// The force per velocity of each component, N s/m.
    viscous: Motion<T>,
    /// The force per squared velocity.
    quadratic: Motion<T>,
}

impl<T: Real> Drag<T> {
    /// Creates the resistance to body `b`.
    #[inline(always)]
    pub(crate) fn new(
        model: &Model,
        params: &Params<T>,
        pos: &Positions<T>,
        vel: &Velocities<T>,
        b: usize,
    ) -> Self {
        let mass = params.body_mass[b];
        let heavy = mass.ge(T::new(TINY));
        let safe_mass = T::select(heavy, mass, T::ONE);
        let i = params.body_inertia[b];
        let side = |opposite: T| (opposite.max(T::new(TINY)) / safe_mass * T::new(6.0)).sqrt();
        let s = Vec3::new(
            side(i.y + i.z - i.x),
            side(i.x + i.z - i.y),
            side(i.x + i.y - i.z),
        );
        let density = T::select(heavy, params.density.max(T::ZERO), T::ZERO);
        let viscosity = T::select(heavy, params.viscosity.max(T::ZERO), T::ZERO);
        let all = |x: T| Vec3::new(x, x, x);
        let diameter = (s.x + s.y + s.z) / T::new(3.0);
        let viscous = Motion::new(
            all(T::new(PI) * diameter * diameter * diameter * viscosity),
            all(T::new(3.0 * PI) * diameter * viscosity),
        );
        let fourth = |x: T| x.squared().squared();
        let (x4, y4, z4) = (fourth(s.x), fourth(s.y), fourth(s.z));
        let quadratic = Motion::new(
            s.scale_by(Vec3::new(y4 + z4, x4 + z4, x4 + y4)) * (density / T::new(64.0)),
            Vec3::new(s.y * s.z, s.x * s.z, s.x * s.y) * (density * T::new(0.5)),
        );
        let arm = pos.xipos[b] - pos.subtree_com[model.bodies[b].root];
        let mut velocity = local_velocity(vel.cvel[b], arm, &pos.ximat[b]);
        velocity.linear -= pos.ximat[b].transpose_mul(params.wind);
        Drag {
            body: b,
            velocity,
            viscous,
            quadratic,
        }
    }

    /// Returns the force on the body, about the reference point of its tree.
    #[inline(always)]
    pub(crate) fn force(&self, model: &Model, pos: &Positions<T>) -> Force<T> {
        self.to_world(
            model,
            pos,
            resistance(
                self.viscous.angular,
                self.quadratic.angular,
                self.velocity.angular,
            ),
            resistance(
                self.viscous.linear,
                self.quadratic.linear,
                self.velocity.linear,
            ),
        )
    }

    /// Returns the change of [`force`](Self::force) with a change `motion` of the body's velocity.
    #[inline(always)]
    pub(crate) fn derivative(
        &self,
        model: &Model,
        pos: &Positions<T>,
        motion: Motion<T>,
    ) -> Force<T> {
        let arm = pos.xipos[self.body] - pos.subtree_com[model.bodies[self.body].root];
        let local = local_velocity(motion, arm, &pos.ximat[self.body]);
        self.to_world(
            model,
            pos,
            resistance_derivative(
                self.viscous.angular,
                self.quadratic.angular,
                self.velocity.angular,
                local.angular,
            ),
            resistance_derivative(
                self.viscous.linear,
                self.quadratic.linear,
                self.velocity.linear,
                local.linear,
            ),
        )
    }

    #[inline(always)]
    fn to_world(
        &self,
        model: &Model,
        pos: &Positions<T>,
        torque: Vec3<T>,
        force: Vec3<T>,
    ) -> Force<T> {
        let (b, axes) = (self.body, &pos.ximat[self.body]);
        force_at(model, pos, b, pos.xipos[b], *axes * force, *axes * torque)
    }
}

/// Computes −(c₁ v + c₂ |v| v), axis by axis.
#[inline(always)]
fn resistance<T: Real>(c1: Vec3<T>, c2: Vec3<T>, v: Vec3<T>) -> Vec3<T> {
    let axis = |c1: T, c2: T, v: T| -(c1 * v + c2 * v.abs() * v);
    Vec3::new(
        axis(c1.x, c2.x, v.x),
        axis(c1.y, c2.y, v.y),
        axis(c1.z, c2.z, v.z),
    )
}

/// Computes the change of [`resistance`] with a change `dv` of the velocity.
#[inline(always)]
fn resistance_derivative<T: Real>(c1: Vec3<T>, c2: Vec3<T>, v: Vec3<T>, dv: Vec3<T>) -> Vec3<T> {
    let axis = |c1: T, c2: T, v: T| -(c1 + T::new(2.0) * c2 * v.abs());
    Vec3::new(
        axis(c1.x, c2.x, v.x) * dv.x,
        axis(c1.y, c2.y, v.y) * dv.y,
        axis(c1.z, c2.z, v.z) * dv.z,
    )
}
