//! Friction that sticks: the slots for stick references, and the dry friction that is displaced.

use super::Tables;
use clench_rigid::model::Model;
use clench_rigid::settings::StepSettings;
use clench_rigid::state::kind::{Kind, Reference};

impl Tables {
    pub(super) fn stiction(&mut self, m: &Model, s: &StepSettings) {
        self.fixed_flag("STICTION", s.stiction);
        self.constant("REFERENCE_SIZE", Reference::WIDTH);
        self.count("MAX_STICK_PAIRS", m.max_stick_pairs.unwrap_or(0));
        let dofs = m.dofs.iter().map(|dof| dof.frictionloss);
        let tendons = m.tendons.iter().map(|tendon| tendon.frictionloss);
        let brakes = dofs.chain(tendons).enumerate();
        let displaced = Vec::from_iter(brakes.filter(|&(_, brakes)| brakes).map(|(i, _)| i));
        self.count("NDISPLACED", displaced.len());
        // Dofs, then tendons.
        self.words("DISPLACED", displaced);
    }
}
