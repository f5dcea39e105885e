//! Fluid forces on geoms, each modelled as an ellipsoid with the same semi-axes.
//!
//! MuJoCo's second model ("ellipsoid model", *Computation*, fluid forces). In the frame of a geom with semi-axes r, v
//! is its velocity relative to the fluid, ω its angular velocity, ρ density, η viscosity, V volume, and ∘ the entrywise
//! product:
//!
//! ```text
//! added mass:   L = ρ m∘v, H = ρ I∘ω (m, I virtual mass and inertia)   f = L × ω        t = L × v + H × ω
//! Magnus lift:  f = C_M ρ V ω × v
//! Kutta lift:   f = C_K ρ A (cos α / |n|) (n × v) × v                   n = a∘v, a_i = (r_j r_k)²
//!                 A = π √(n·n / v·n)   cos α = v·n / (|v| |n|)          A the area that is seen along v
//! drag:         f = −(3π D η + ρ |v| (C_b A + C_s (A_max − A))) v       D = ⅔ (r_x + r_y + r_z)
//!               t = −(π D³ η + ρ |c∘ω|) ω                               c_i = C_a J_i + C_s (J_max − J_i)
//! ```
//!
//! A_max is the largest area, J_i = 8/15 π r_i max(r_j, r_k)⁴. C_b, C_s, C_a, C_K, C_M are the geom's `fluidcoef`:
//! blunt, slender and angular drag, and both lifts.

use crate::contact::exists;
use crate::dynamics::project::{force_at, local_velocity};
use crate::model::{Model, Params};
use crate::stages::{Positions, Velocities};
use clench_collide::{Shape, ShapeKind};
use clench_math::{Force, Motion, Real, Vec3};
use std::f64::consts::PI;

/// The minimum mass of a body that the fluid acts on, kg (MuJoCo's `mjMINVAL`).
const TINY: f64 = 1e-15;

/// Returns the semi-axes of the ellipsoid of a shape of size `size`.
#[inline(always)]
pub fn semi_axes<T: Real>(kind: ShapeKind, size: Vec3<T>) -> Vec3<T> {
    Shape::new(kind, size).half_lengths()
}

/// An ellipsoid in the fluid, at one velocity.
pub struct Ellipsoid<T> {
    geom: usize,
    /// The velocity relative to the fluid, in the geom's frame.
    velocity: Motion<T>,
    /// ρ times virtual mass and inertia.
    virtual_mass: Vec3<T>,
    virtual_inertia: Vec3<T>,
    /// ρ C_M V.
    magnus: T,
    /// ρ C_K.
    kutta: T,
    /// 3π D η, π D³ η.
    viscous: [T; 2],
    /// ρ C_s A_max, ρ (C_b − C_s).
    drag: [T; 2],
    /// ρ c.
    angular_drag: Vec3<T>,
    /// a.
    areas: Vec3<T>,
}

/// The projected area along the velocity and related terms, or their derivatives along a velocity change.
struct Flow<T> {
    /// |v|.
    speed: T,
    /// n.
    normal: Vec3<T>,
    /// A.
    area: T,
    /// A cos α / |n|.
    lift: T,
}

impl<T: Real> Ellipsoid<T> {
    /// Creates the ellipsoid of geom `geom` of body `b`.
    #[inline(always)]
    pub fn new(
        model: &Model,
        params: &Params<T>,
        pos: &Positions<T>,
        vel: &Velocities<T>,
        b: usize,
        geom: usize,
    ) -> Self {
        let arm = pos.geom_xpos[geom] - pos.subtree_com[model.bodies[b].root];
        let mut velocity = local_velocity(vel.cvel[b], arm, &pos.geom_xmat[geom]);
        velocity.linear -= pos.geom_xmat[geom].transpose_mul(params.wind);
        // The fluid does not act on a geom that the environment does not have.
        let heavy = params.body_mass[b].ge(T::new(TINY)) & exists(params, geom);
        let density = T::select(heavy, params.density.max(T::ZERO), T::ZERO);
        let viscosity = T::select(heavy, params.viscosity.max(T::ZERO), T::ZERO);
        let r = semi_axes(model.geoms[geom].kind, params.geom_size[geom]);
        let [blunt, slender, angular, kutta, magnus] = params.geom_fluidcoef[geom];
        let (largest, least) = (r.x.max(r.y).max(r.z), r.x.min(r.y).min(r.z));
        let middle = r.x + r.y + r.z - largest - least;
        let diameter = (r.x + r.y + r.z) * T::new(2.0 / 3.0);
        let swept =
            |axis: T, others: T| T::new(8.0 / 15.0 * PI) * axis * others.squared().squared();
        let moments = Vec3::new(
            swept(r.x, r.y.max(r.z)),
            swept(r.y, r.z.max(r.x)),
            swept(r.z, r.x.max(r.y)),
        );
        let maximum = swept(middle, largest);
        let resisted = |moment: T| (angular * moment + slender * (maximum - moment)) * density;
        let square = |x: T, y: T| (x * y).squared();
        Ellipsoid {
            geom,
            velocity,
            virtual_mass: Vec3::from_array(params.geom_virtualmass[geom]) * density,
            virtual_inertia: Vec3::from_array(params.geom_virtualinertia[geom]) * density,
            magnus: magnus * density * (T::new(4.0 / 3.0 * PI) * r.x * r.y * r.z),
            kutta: kutta * density,
            viscous: [
                viscosity * T::new(3.0 * PI) * diameter,
                viscosity * T::new(PI) * diameter * diameter * diameter,
            ],
            drag: [
                density * slender * (T::new(PI) * largest * middle),
                density * (blunt - slender),
            ],
            angular_drag: Vec3::new(
                resisted(moments.x),
                resisted(moments.y),
                resisted(moments.z),
            ),
            areas: Vec3::new(square(r.y, r.z), square(r.z, r.x), square(r.x, r.y)),
        }
    }

    /// Returns the force on the body, about the reference point of its tree.
    #[inline(always)]
    pub fn force(&self, model: &Model, pos: &Positions<T>) -> Force<T> {
        let Motion {
            angular: w,
            linear: v,
        } = self.velocity;
        let (momentum, spin) = (
            v.scale_by(self.virtual_mass),
            w.scale_by(self.virtual_inertia),
        );
        let flow = self.flow();
        let lift = flow.normal.cross(v).cross(v) * (self.kutta * flow.lift);
        let force =
            momentum.cross(w) + w.cross(v) * self.magnus + lift - v * self.linear_drag(&flow);
        let turning = self.viscous[1] + w.scale_by(self.angular_drag).norm();
        let torque = momentum.cross(v) + spin.cross(w) - w * turning;
        self.to_world(model, pos, torque, force)
    }

    /// Returns the change of [`force`](Self::force), or only of its drag, with a change `motion` of the body's
    /// velocity.
    #[inline(always)]
    pub fn derivative(
        &self,
        model: &Model,
        pos: &Positions<T>,
        forces: FluidForces,
        motion: Motion<T>,
    ) -> Force<T> {
        let Motion {
            angular: w,
            linear: v,
        } = self.velocity;
        let b = model.geoms[self.geom].body;
        let arm = pos.geom_xpos[self.geom] - pos.subtree_com[model.bodies[b].root];
        let Motion {
            angular: dw,
            linear: dv,
        } = local_velocity(motion, arm, &pos.geom_xmat[self.geom]);
        let flow = self.flow();
        let (change, dspeed) = self.flow_derivative(&flow, dv);
        let [widest, blunt] = self.drag;
        let ddrag = dspeed * (widest + blunt * flow.area) + flow.speed * blunt * change.area;
        let drag = -(v * ddrag) - dv * self.linear_drag(&flow);
        let resisted = w.scale_by(self.angular_drag);
        let size = resisted.norm();
        let slope = resisted.dot(dw.scale_by(self.angular_drag)) / positive(size);
        let turning = -(w * slope) - dw * (self.viscous[1] + size);
        if forces == FluidForces::Drag {
            return self.to_world(model, pos, turning, drag);
        }
        let (momentum, spin) = (
            v.scale_by(self.virtual_mass),
            w.scale_by(self.virtual_inertia),
        );
        let (dmomentum, dspin) = (
            dv.scale_by(self.virtual_mass),
            dw.scale_by(self.virtual_inertia),
        );
        let (normal, dnormal) = (flow.normal, change.normal);
        let turned = normal.cross(v);
        let dturned = dnormal.cross(v) + normal.cross(dv);
        let dlift =
            turned.cross(v) * change.lift + (dturned.cross(v) + turned.cross(dv)) * flow.lift;
        let force = dmomentum.cross(w)
            + momentum.cross(dw)
            + (dw.cross(v) + w.cross(dv)) * self.magnus
            + dlift * self.kutta
            + drag;
        let torque =
            dmomentum.cross(v) + momentum.cross(dv) + dspin.cross(w) + spin.cross(dw) + turning;
        self.to_world(model, pos, torque, force)
    }

    /// Returns the drag force over the velocity.
    #[inline(always)]
    fn linear_drag(&self, flow: &Flow<T>) -> T {
        let [widest, blunt] = self.drag;
        self.viscous[0] + flow.speed * (widest + blunt * flow.area)
    }

    #[inline(always)]
    fn flow(&self) -> Flow<T> {
        let v = self.velocity.linear;
        let normal = v.scale_by(self.areas);
        let (along, squared, speed) = (v.dot(normal), normal.norm_squared(), v.norm());
        let area = T::new(PI) * (squared / positive(along)).sqrt();
        Flow {
            speed,
            normal,
            area,
            lift: area * along / positive(speed * squared),
        }
    }

    /// Returns the changes of the flow and of the speed with a change `dv` of the velocity. Zero at rest, where all
    /// dependent terms vanish.
    #[inline(always)]
    fn flow_derivative(&self, flow: &Flow<T>, dv: Vec3<T>) -> (Flow<T>, T) {
        let v = self.velocity.linear;
        let normal = dv.scale_by(self.areas);
        let dspeed = v.dot(dv) / positive(flow.speed);
        // Logarithmic derivatives of v·n, n·n and |v|, the first two halved.
        let along = flow.normal.dot(dv) / positive(v.dot(flow.normal));
        let squared = flow.normal.dot(normal) / positive(flow.normal.norm_squared());
        let change = Flow {
            speed: dspeed,
            normal,
            area: flow.area * (squared - along),
            lift: flow.lift * (along - squared - dspeed / positive(flow.speed)),
        };
        (change, dspeed)
    }

    #[inline(always)]
    fn to_world(
        &self,
        model: &Model,
        pos: &Positions<T>,
        torque: Vec3<T>,
        force: Vec3<T>,
    ) -> Force<T> {
        let (g, axes) = (self.geom, &pos.geom_xmat[self.geom]);
        let (at, b) = (pos.geom_xpos[g], model.geoms[g].body);
        force_at(model, pos, b, at, *axes * force, *axes * torque)
    }
}

/// Returns a denominator: `x` if it is positive, else one.
#[inline(always)]
fn positive<T: Real>(x: T) -> T {
    T::select(x.gt(T::ZERO), x, T::ONE)
}

/// A selection of fluid forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FluidForces {
    /// All.
    All,
    /// Drag, without lift and added mass; the only force on inertia boxes.
    Drag,
}

/// Computes the derivatives of the fluid forces on the ellipsoids of body `b`: for each component of a motion about the
/// reference point of its tree, the change of the force about that point.
#[inline(always)]
pub fn ellipsoid_rates<T: Real>(
    model: &Model,
    params: &Params<T>,
    (pos, vel): (&Positions<T>, &Velocities<T>),
    b: usize,
    forces: FluidForces,
) -> [Force<T>; 6] {
    let mut rates = [Force::ZERO; 6];
    for geom in ellipsoids(model, b) {
        let ellipsoid = Ellipsoid::new(model, params, pos, vel, b, geom);
        for (c, rate) in rates.iter_mut().enumerate() {
            *rate += ellipsoid.derivative(model, pos, forces, Motion::component(c));
        }
    }
    rates
}

/// Returns the geoms of body `b` that the fluid acts on as ellipsoids. With any of them, the body's box is unused.
#[inline(always)]
pub fn ellipsoids(model: &Model, b: usize) -> impl Iterator<Item = usize> + '_ {
    let geoms = model.bodies[b].geoms.clone();
    geoms.filter(|&geom| model.geoms[geom].fluid_ellipsoid)
}
