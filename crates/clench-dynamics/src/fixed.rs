//! The poses of bodies that are fixed to the world. They follow from the parameters alone and are computed once.

use crate::model::Model;
use crate::part::Part;
use std::slice::from_ref;

/// The validity of a workspace's poses of bodies that are fixed to the world.
#[derive(Clone, Debug)]
pub struct FixedPoses {
    /// True if the poses are those of the present parameters.
    computed: bool,
    /// The number of times that they were computed.
    version: u64,
    /// The whole model.
    whole: Part,
    /// False for the bodies of trees on the world in which nothing moves.
    moves: Vec<bool>,
    /// The parts whose poses a pass computes when the fixed poses are valid: the bodies in `moves`.
    moving: Vec<Part>,
}

impl FixedPoses {
    /// Creates the record with no valid pose.
    pub fn new(model: &Model) -> Self {
        let mut fixed = Vec::from_iter((0..model.nbody()).map(|body| model.is_fixed(body)));
        // A fixed body on the world that carries a moving body is a part of that tree.
        for (body, moves) in fixed.clone().iter().map(|fixed| !fixed).enumerate() {
            fixed[model.bodies[body].root] &= !moves;
        }
        let moves = |body: usize| body == 0 || !fixed[model.bodies[body].root];
        let mut moving = Vec::new();
        Part::list(model, &moves, &mut moving);
        FixedPoses {
            computed: false,
            version: 0,
            whole: Part::whole(model),
            moves: Vec::from_iter((0..model.nbody()).map(moves)),
            moving,
        }
    }

    /// Invalidates the poses, because parameters may have changed.
    pub fn invalidate(&mut self) {
        self.computed = false;
    }

    /// Records that a pass computed the invalid poses.
    pub fn mark_computed(&mut self) {
        if !self.computed {
            (self.computed, self.version) = (true, self.version + 1);
        }
    }

    /// Returns true if the poses are valid.
    pub fn is_computed(&self) -> bool {
        self.computed
    }

    /// Returns the number of times that the poses were computed. They change only with it.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// Returns false for the bodies of trees on the world in which nothing moves.
    pub(crate) fn moves(&self) -> &[bool] {
        &self.moves
    }

    /// Returns the parts whose poses a pass computes.
    pub fn parts(&self) -> &[Part] {
        match self.computed {
            true => &self.moving,
            false => from_ref(&self.whole),
        }
    }
}
