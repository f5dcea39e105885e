//! The state of contact detection between steps, and its budget.

use super::Candidate;
use super::awake_pairs::AwakePairs;
use super::body_pairs::BodyPairs;
use super::bounding_sphere::BoundingSphere;
use super::dynamic_broad_phase::DynamicBroadPhase;
use super::pair_clock::PairClock;
use super::pair_finder::PairFinder;
use super::select::listed_candidates;
use super::separating_axes::SeparatingAxes;
use crate::Budget;
use crate::budget::RAISE;
use crate::model::Model;
use crate::options::MaxContacts;
use clench_math::{Mask, Real};

/// The advice in errors about pairs that stick.
const RAISE_STICK_PAIRS: &str = "set the option max_stick_pairs";

/// A quantity of a step that can exceed the model's budget.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Excess {
    /// Pairs of geoms whose bounds overlap.
    Pairs = 1,
    /// Contacts.
    Contacts,
    /// Numbers in the Jacobian of the contacts.
    Jacobian,
    /// Numbers in the factor of an island's Hessian, or in the matrix of `noslip`.
    Factor,
    /// Pairs of geoms with a stick reference.
    StickPairs,
}

impl Excess {
    /// Returns the excess of a code; `Factor` for an unknown code.
    pub fn from_code(code: f64) -> Excess {
        let others = [
            Excess::Pairs,
            Excess::Contacts,
            Excess::Jacobian,
            Excess::StickPairs,
        ];
        let found = others.into_iter().find(|&one| f64::from(one as u8) == code);
        found.unwrap_or(Excess::Factor)
    }

    /// Returns a description of the quantity, its limit, and the way to raise it.
    pub fn describe(self, model: &Model) -> (&'static str, u64, &'static str) {
        let budget = &model.budget;
        let (what, limit) = match self {
            Excess::Pairs => ("pairs of geoms whose bounds overlap", budget.pairs()),
            Excess::Contacts => ("contacts", budget.contacts),
            Excess::Jacobian => ("numbers in the Jacobian of the contacts", budget.matrix),
            Excess::Factor => (
                "numbers in the factor of the Hessian of an island",
                budget.matrix,
            ),
            Excess::StickPairs => {
                let limit = model.max_stick_pairs.unwrap_or(0) as u64;
                return ("pairs of geoms that stick", limit, RAISE_STICK_PAIRS);
            }
        };
        (what, limit, RAISE)
    }
}

/// The state of detection between steps.
#[derive(Clone, Debug)]
pub struct Collision<T: Real> {
    /// True if the user provided the workspace's contacts: detection leaves them unchanged.
    pub contacts_provided: bool,
    /// The lanes in which the last step found more contacts than the options allow.
    pub overflow: T::Mask,
    /// The quantity of the last step that exceeds the model's budget, as the code of an [`Excess`], or 0. Lanes with an
    /// excess have no contacts.
    pub excess: T,
    /// The numbers of the environments in the lanes; empty if there is one environment. They change no result.
    pub environments: Vec<u32>,
    /// The pairs to check, in canonical order.
    pub(super) candidates: Vec<Candidate>,
    /// The same pairs by body, if they are listed once.
    pub(super) body_pairs: BodyPairs<T>,
    /// The listed candidates of which a tree is awake.
    pub(super) awake_pairs: AwakePairs,
    /// The candidates that may touch now.
    pub(super) near: Vec<u32>,
    /// Finds the candidates of a large model in each step; those of a small one never change.
    pub(super) broad_phase: Option<Box<DynamicBroadPhase<T>>>,
    pub(super) spheres: Vec<BoundingSphere<T>>,
    pub(super) axes: SeparatingAxes<T>,
    /// Times the narrow phase by kinds of pair.
    pub(crate) clock: PairClock,
    /// The checkers of the near pairs; several if threads share them.
    pub(super) finders: Vec<PairFinder<T>>,
    /// The number of contacts in each lane.
    pub(super) contact_count: T,
    /// The size of the contacts' Jacobian in each lane.
    pub(super) jacobian_size: T,
}

impl<T: Real> Collision<T> {
    /// Prepares detection for a model.
    #[cold] // Compiled for size.
    #[inline(never)]
    pub fn new(model: &Model) -> Self {
        let listed = listed_candidates(model);
        let broad_phase = listed
            .is_none()
            .then(|| Box::new(DynamicBroadPhase::new(model)));
        let candidates = listed.unwrap_or_default();
        Collision {
            contacts_provided: false,
            overflow: T::Mask::splat(false),
            excess: T::ZERO,
            environments: Vec::new(),
            body_pairs: BodyPairs::new(model, &candidates),
            awake_pairs: AwakePairs::new(model, &candidates),
            candidates,
            broad_phase,
            near: Vec::new(),
            spheres: Vec::new(),
            axes: SeparatingAxes::default(),
            clock: PairClock::default(),
            finders: Vec::new(),
            contact_count: T::ZERO,
            jacobian_size: T::ZERO,
        }
    }

    /// Counts a new contact, whose Jacobian has `numbers` entries, in its active lanes. Returns those within the
    /// limits.
    #[inline(always)]
    pub(super) fn count_within_limit(
        &mut self,
        active: T::Mask,
        limit: MaxContacts,
        numbers: usize,
        budget: &Budget,
    ) -> T::Mask {
        let full = match limit {
            MaxContacts::Limit(limit) => self.contact_count.ge(T::new(limit as f64)),
            MaxContacts::Auto => T::Mask::splat(false),
        };
        self.overflow |= active & full;
        let active = active & !full & self.excess.le(T::ZERO);
        self.contact_count += T::select(active, T::ONE, T::ZERO);
        self.jacobian_size += T::select(active, T::new(numbers as f64), T::ZERO);
        self.record_excess(
            self.contact_count.gt(T::new(budget.contacts as f64)),
            Excess::Contacts,
        );
        self.record_excess(
            self.jacobian_size.gt(T::new(budget.matrix as f64)),
            Excess::Jacobian,
        );
        active
    }

    /// Records the excess of some lanes.
    #[inline(always)]
    pub(crate) fn record_excess(&mut self, lanes: T::Mask, excess: Excess) {
        self.excess = T::select(lanes, T::new(f64::from(excess as u8)), self.excess);
    }
}
