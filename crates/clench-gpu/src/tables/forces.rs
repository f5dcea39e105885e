//! Springs, dampers, gravity compensation and the medium, each reduced to its coefficients; and the settings of the
//! step.

use super::{NONE, TINY, Tables, starts};
use crate::codes::row;
use clench_rigid::dynamics::ellipsoid::{ellipsoids, semi_axes};
use clench_rigid::dynamics::plastic::has_yielding_tendons;
use clench_rigid::model::{Integrator, Model};
use clench_rigid::options::{ContactModel, FrictionCone};
use clench_rigid::settings::StepSettings;

use std::f64::consts::PI;

row! {
    /// The force coefficients of an ellipsoid in the medium, see `dynamics/ellipsoid.rs`.
    numbers EllipsoidNumbers, "ELLIPSOID" {
        /// The density times virtual mass and inertia.
        mass: 3,
        inertia: 3,
        magnus: 1,
        kutta: 1,
        /// The viscous drag of translation and of rotation.
        viscous: 1,
        viscous_angular: 1,
        slender: 1,
        /// The blunt coefficient less the slender one.
        blunt: 1,
        /// The angular drag about each axis.
        angular: 3,
        /// The squared products of the other two semi-axes.
        area: 3,
    }
}

impl Tables {
    pub(super) fn forces(&mut self, m: &Model) {
        let p = &m.params;
        let gravity = if m.flags.gravity {
            p.gravity.to_array()
        } else {
            [0.0; 3]
        };
        self.numbers("GRAVITY", gravity);
        let law = |j: usize| {
            let [b, c] = p.jnt_stiffnesspoly[j];
            [p.jnt_stiffness[j], b, c]
        };
        let pulls = |&j: &usize| m.flags.spring && law(j) != [0.0; 3];
        let springs = Vec::from_iter((0..m.joints.len()).filter(pulls));
        self.count("NSPRING", springs.len());
        self.words("SPRING_JNT", springs.iter().copied());
        self.numbers("SPRING_LAW", springs.iter().flat_map(|&j| law(j)));
        self.plastic(m);
        let dampers = Vec::from_iter((0..m.nv).map(|i| damper(m, i)));
        self.numbers("DOF_DAMPER", dampers.iter().copied().flatten());
        let damped = dampers
            .iter()
            .any(|&[a, b, c]| a > 0.0 || b != 0.0 || c != 0.0);
        let euler = m.integrator == Integrator::Euler && m.flags.eulerdamp;
        self.flag("IMPLICIT_DAMPING", damped && euler);
        self.numbers("DOF_ARMATURE", (0..m.nv).map(|i| armature(m, i)));
        self.gravity_compensation(m);
        self.medium(m);
    }

    /// Adds the springs that yield, the offsets of their rest positions, and their yield elongations.
    fn plastic(&mut self, m: &Model) {
        let p = &m.params;
        let offset = |start: Option<usize>| start.unwrap_or(NONE as usize);
        self.flag("ANY_PLASTIC", m.nplastic > 0 && m.flags.spring);
        self.flag("YIELDING_TENDONS", has_yielding_tendons(m));
        self.words("JNT_PLASTIC", m.joints.iter().map(|j| offset(j.plastic)));
        self.words(
            "TENDON_PLASTIC",
            m.tendons.iter().map(|t| offset(t.plastic)),
        );
        self.numbers("JNT_YIELD", p.jnt_springyield.iter().copied());
        self.numbers("TENDON_YIELD", p.tendon_springyield.iter().copied());
    }

    /// Adds the compensated mass of each body. As in MuJoCo, a negative share counts only if another is positive, and
    /// there are no passive forces if springs and dampers are both off.
    fn gravity_compensation(&mut self, m: &Model) {
        let p = &m.params;
        let lifted = m.flags.gravity && p.body_gravcomp.iter().any(|&share| share > 0.0);
        self.flag("HAS_GRAVCOMP", lifted && (m.flags.spring || m.flags.damper));
        let lift = p.body_mass.iter().zip(&p.body_gravcomp);
        self.numbers("BODY_LIFT", lift.map(|(mass, share)| mass * share));
    }

    /// Adds the drag coefficients of the box with a body's mass and inertia, see `dynamics/fluid.rs`.
    fn medium(&mut self, m: &Model) {
        let p = &m.params;
        let any = p.density != 0.0 || p.viscosity != 0.0;
        self.flag("HAS_FLUID", any && (m.flags.spring || m.flags.damper));
        self.numbers("WIND", p.wind.to_array());
        self.numbers("BODY_DRAG", (0..m.nbody()).flat_map(|b| drag(m, b)));
        let of_body = |b: usize| Vec::from_iter(ellipsoids(m, b));
        let all = Vec::from_iter((0..m.nbody()).map(of_body));
        self.flag(
            "ANY_FLUID_ELLIPSOID",
            all.iter().any(|geoms| !geoms.is_empty()),
        );
        self.words("BODY_ELLIPSOID", starts(all.iter().map(Vec::len)));
        let geoms = || all.iter().flatten().copied();
        self.words("ELLIPSOID_GEOM", geoms());
        self.row::<EllipsoidNumbers>();
        self.numbers(
            "ELLIPSOID_PRM",
            geoms().flat_map(|g| ellipsoid(m, g).numbers()),
        );
        self.words("BODY_WELD", m.bodies.iter().map(|b| b.weld));
    }

    pub(super) fn settings(&mut self, m: &Model, s: &StepSettings) {
        let h = m.params.timestep;
        let floor = s.constraint_timeconst;
        // Steps that evaluate constraints at their end are always stable.
        let least = if s.flags.refsafe && m.integrator != Integrator::Discrete {
            floor.max(2.0 * h)
        } else {
            floor
        };
        self.real("TIMESTEP", h);
        self.real("MIN_TIMECONST", least);
        self.real("IMPRATIO", s.impratio);
        let coulomb = s.contact_model == ContactModel::Coulomb;
        let elliptic = s.friction_cone == FrictionCone::Elliptic;
        self.flag("ELLIPTIC_CONES", elliptic && !coulomb);
        self.fixed_flag("COULOMB_CONTACTS", coulomb);
        self.fixed_flag("AUTORESET", s.autoreset);
        self.flag("EXACT_DIAGONAL", s.flags.diagexact);
        self.flag("WARMSTART", s.solver.warmstart);
        self.count("ITERATIONS", s.solver.iterations);
        self.count("LS_ITERATIONS", s.solver.ls_iterations);
        self.real("TOLERANCE", s.solver.tolerance);
        self.real("LS_TOLERANCE", s.solver.ls_tolerance);
        self.flag("NOSLIP", s.solver.noslip_iterations > 0);
        self.count("NOSLIP_ITERATIONS", s.solver.noslip_iterations);
        self.real("NOSLIP_TOLERANCE", s.solver.noslip_tolerance);
    }
}

/// Returns the damper of dof `i` including its joint's actuators; zero if dampers are off.
fn damper(m: &Model, i: usize) -> [f64; 3] {
    let p = &m.params;
    if !m.flags.damper {
        return [0.0; 3];
    }
    let [b, c] = p.dof_dampingpoly[i];
    let mut law = [p.dof_damping[i], b, c];
    for &u in &m.joints[m.dofs[i].joint].reflecting {
        let ratio = p.actuator_gear[u][0].powi(2);
        let [b, c] = p.actuator_dampingpoly[u];
        for (to, from) in law.iter_mut().zip([p.actuator_damping[u], b, c]) {
            *to += ratio * from;
        }
    }
    law
}

/// Returns the armature of dof `i`: its own and that of its joint's actuators.
fn armature(m: &Model, i: usize) -> f64 {
    let p = &m.params;
    let actuators = &m.joints[m.dofs[i].joint].reflecting;
    let reflected = |&u: &usize| p.actuator_gear[u][0].powi(2) * p.actuator_armature[u];
    p.dof_armature[i] + actuators.iter().map(reflected).sum::<f64>()
}

/// Returns the viscous, then the quadratic coefficients of body `b`, rotations before translations.
fn drag(m: &Model, b: usize) -> [f64; 12] {
    let p = &m.params;
    let mass = p.body_mass[b];
    if mass < TINY {
        return [0.0; 12];
    }
    let i = p.body_inertia[b];
    let side = |opposite: f64| (opposite.max(TINY) / mass * 6.0).sqrt();
    let (x, y, z) = (
        side(i.y + i.z - i.x),
        side(i.x + i.z - i.y),
        side(i.x + i.y - i.z),
    );
    let d = (x + y + z) / 3.0;
    let (density, viscosity) = (p.density.max(0.0), p.viscosity.max(0.0));
    let (turning, moving) = (PI * d.powi(3) * viscosity, 3.0 * PI * d * viscosity);
    let turn = |s: f64, a: f64, b: f64| s * (a.powi(4) + b.powi(4)) * density / 64.0;
    let face = |a: f64, b: f64| a * b * density / 2.0;
    let viscous = [turning, turning, turning, moving, moving, moving];
    let quadratic = [
        turn(x, y, z),
        turn(y, x, z),
        turn(z, x, y),
        face(y, z),
        face(x, z),
        face(x, y),
    ];
    let mut all = [0.0; 12];
    all[..6].copy_from_slice(&viscous);
    all[6..].copy_from_slice(&quadratic);
    all
}

/// Returns the force coefficients of geom `g`.
fn ellipsoid(m: &Model, g: usize) -> EllipsoidNumbers {
    let p = &m.params;
    let heavy = p.body_mass[m.geoms[g].body] >= TINY;
    let acting = |x: f64| if heavy { x.max(0.0) } else { 0.0 };
    let (density, viscosity) = (acting(p.density), acting(p.viscosity));
    let r = semi_axes(m.geoms[g].kind, p.geom_size[g]).to_array();
    let [blunt, slender, angular, kutta, magnus] = p.geom_fluidcoef[g];
    let mut sorted = r;
    sorted.sort_by(f64::total_cmp);
    let [_, middle, largest] = sorted;
    let diameter = r.iter().sum::<f64>() * (2.0 / 3.0);
    let swept = |axis: f64, others: f64| 8.0 / 15.0 * PI * axis * others.powi(4);
    let others = |i: usize| [r[(i + 1) % 3], r[(i + 2) % 3]];
    let max_moment = swept(middle, largest);
    let angular_drag = |i: usize| {
        let [a, b] = others(i);
        let moment = swept(r[i], a.max(b));
        density * (angular * moment + slender * (max_moment - moment))
    };
    let area = |i: usize| {
        let [a, b] = others(i);
        (a * b).powi(2)
    };
    let axes = [0, 1, 2];
    EllipsoidNumbers {
        mass: axes.map(|i| density * p.geom_virtualmass[g][i]),
        inertia: axes.map(|i| density * p.geom_virtualinertia[g][i]),
        magnus: [density * magnus * (4.0 / 3.0 * PI * r.iter().product::<f64>())],
        kutta: [density * kutta],
        viscous: [viscosity * 3.0 * PI * diameter],
        viscous_angular: [viscosity * PI * diameter.powi(3)],
        slender: [density * slender * PI * largest * middle],
        blunt: [density * (blunt - slender)],
        angular: axes.map(angular_drag),
        area: axes.map(area),
    }
}
