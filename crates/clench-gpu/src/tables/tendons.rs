//! Tendons: their paths, the dofs that change their length, and the laws of their springs and dampers.

use super::{NONE, Tables, starts};
use clench_rigid::model::{Model, Wrap};

impl Tables {
    pub(super) fn tendons(&mut self, m: &Model) {
        let count = m.tendons.len();
        let rows = || 0..count;
        self.count("NTENDON", count);
        self.words(
            "TENDON_ROW",
            starts(rows().map(|t| m.tendon_dofs.dofs(t).len())),
        );
        let dofs = rows().flat_map(|t| m.tendon_dofs.dofs(t));
        self.words("TENDON_DOF", dofs.map(|&dof| dof as usize));
        self.fixed_tendons(m);
        self.spatial_tendons(m);
        self.tendon_laws(m);
    }

    /// Adds the terms of fixed tendons: a joint's position, the index of its derivative among those of all tendons, and
    /// its coefficient.
    fn fixed_tendons(&mut self, m: &Model) {
        let terms = |t: usize| {
            let tendon = &m.tendons[t];
            let coefs = &m.params.wrap_coef[tendon.coefs.clone()];
            let term = move |(wrap, &coef): (&Wrap, &f64)| {
                let &Wrap::Joint(j) = wrap else { return None };
                let joint = &m.joints[j];
                let column = (m.tendon_dofs.dofs(t)).binary_search(&(joint.dof as u32));
                let entry = m.tendon_dofs.range(t).start + column.ok()?;
                Some((joint.qpos, entry, coef))
            };
            Vec::from_iter(tendon.path.iter().zip(coefs).filter_map(term))
        };
        let all = Vec::from_iter((0..m.tendons.len()).map(terms));
        self.words("TENDON_TERM", starts(all.iter().map(Vec::len)));
        let each = || all.iter().flatten();
        self.words("TERM_QPOS", each().map(|term| term.0));
        self.words("TERM_ENTRY", each().map(|term| term.1));
        self.numbers("TERM_COEF", each().map(|term| term.2));
    }

    /// Adds the sections of spatial tendons: two sites, and the factor of the length between them.
    fn spatial_tendons(&mut self, m: &Model) {
        let sections = |t: usize| match m.tendons[t].is_spatial() {
            true => Vec::from_iter(m.tendons[t].sections()),
            false => Vec::new(),
        };
        let all = Vec::from_iter((0..m.tendons.len()).map(sections));
        self.words("TENDON_SECTION", starts(all.iter().map(Vec::len)));
        let each = || all.iter().flatten();
        self.words("SECTION_SITES", each().flat_map(|s| s.sites));
        let share = |divisor: Option<usize>| divisor.map_or(1.0, |i| 1.0 / m.params.wrap_coef[i]);
        self.numbers("SECTION_SHARE", each().map(|s| share(s.divisor)));
        let obstacle = each().flat_map(|s| match s.obstacle {
            Some((geom, side)) => [geom, side.unwrap_or(NONE as usize)],
            None => [NONE as usize; 2],
        });
        self.words("SECTION_OBSTACLE", obstacle);
        self.flag("ANY_OBSTACLE", each().any(|s| s.obstacle.is_some()));
    }

    /// Adds the inertia of each tendon, the dead band and the coefficients of its spring, and those of its damper with
    /// its actuators'; zero if the flags disable them.
    fn tendon_laws(&mut self, m: &Model) {
        let p = &m.params;
        let law = |on: bool, a: f64, [b, c]: [f64; 2]| if on { [a, b, c] } else { [0.0; 3] };
        let spring = |t: usize| {
            let [a, b, c] = law(
                m.flags.spring,
                p.tendon_stiffness[t],
                p.tendon_stiffnesspoly[t],
            );
            let [low, high] = p.tendon_lengthspring[t];
            [low, high, a, b, c]
        };
        let damper = |t: usize| {
            let mut sum = law(true, p.tendon_damping[t], p.tendon_dampingpoly[t]);
            for &u in &m.tendons[t].reflecting {
                let ratio = p.actuator_gear[u][0].powi(2);
                let [b, c] = p.actuator_dampingpoly[u];
                for (to, of) in sum.iter_mut().zip([p.actuator_damping[u], b, c]) {
                    *to += ratio * of;
                }
            }
            if m.flags.damper { sum } else { [0.0; 3] }
        };
        let armature = |t: usize| {
            let reflected = |&u: &usize| p.actuator_gear[u][0].powi(2) * p.actuator_armature[u];
            let reflecting = m.tendons[t].reflecting.iter();
            p.tendon_armature[t] + reflecting.map(reflected).sum::<f64>()
        };
        let armatures = Vec::from_iter((0..m.tendons.len()).map(armature));
        self.flag("HEAVY_TENDONS", armatures.iter().any(|&a| a != 0.0));
        self.numbers("TENDON_ARMATURE", armatures);
        self.numbers("TENDON_SPRING", (0..m.tendons.len()).flat_map(spring));
        self.numbers("TENDON_DAMPER", (0..m.tendons.len()).flat_map(damper));
    }
}
