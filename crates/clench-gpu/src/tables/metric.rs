//! The metric of the integrator `discrete`: the tendons and actuator lengths that couple dofs of different branches.

use super::{Capacity, NONE, Tables};
use clench_rigid::dynamics::metric::{Along, couplings, terms};
use clench_rigid::model::{Integrator, Model};
use clench_rigid::settings::StepSettings;

impl Tables {
    pub(super) fn metric(&mut self, m: &Model, s: &StepSettings, capacity: &mut Capacity) {
        let acts = m.integrator == Integrator::Discrete;
        capacity.in_metric = acts;
        self.fixed_flag("IN_METRIC", acts);
        self.fixed_flag("LIMITED_STIFFNESS", acts && s.flags.refsafe);
        let alone = m.bodies.iter().map(|b| usize::from(b.diagonal_inertia));
        self.words("BODY_ALONE", alone);
        // Tendons, then the lengths of actuators.
        let index = |along: Along| match along {
            Along::Tendon(t) => t,
            Along::Output(output) => m.tendons.len() + output,
        };
        let coupled = Vec::from_iter(couplings(m).filter(|_| acts).map(index));
        let count = m.tendons.len() + m.nout();
        let of_each = |along: usize| coupled.binary_search(&along).unwrap_or(NONE as usize);
        self.count("NCOUPLING", coupled.len());
        self.words("ALONG_COUPLING", (0..count).map(of_each));
        self.words("COUPLING_ALONG", coupled.iter().copied());
        capacity.couplings = coupled.len();
        capacity.blocks += coupled.len();
        capacity.rows += coupled.len();
        let exact = s.flags.diagexact || s.solver.noslip_iterations > 0;
        let spans = terms(m).any(|along| along.dofs(m).len() > 1);
        capacity.has_backbone = acts && exact && spans;
        self.fixed_flag("HAS_BACKBONE", capacity.has_backbone);
    }
}
