//! What is fixed to the world: its poses follow from the parameters alone, and are computed once for them.

use crate::model::Model;
use std::ops::Range;
use std::slice::from_ref;

/// Whether a workspace holds the poses of what is fixed to the world.
#[derive(Clone, Debug)]
pub struct FixedPoses {
    /// They are those of the present parameters.
    known: bool,
    /// How often they were computed.
    version: u64,
    /// All bodies.
    bodies: Range<usize>,
    /// Ranges of the bodies whose poses a pass computes where they are known: all but those of trees on the world in which nothing
    /// moves. The world is among them.
    moving: Vec<Range<usize>>,
}

impl FixedPoses {
    /// Nothing is known.
    pub fn new(model: &Model) -> Self {
        let mut fixed = Vec::from_iter((0..model.nbody()).map(|body| model.is_fixed(body)));
        // A fixed body on the world with something that moves on it is a part of that tree.
        for (body, moves) in fixed.clone().iter().map(|fixed| !fixed).enumerate() {
            fixed[model.bodies[body].root] &= !moves;
        }
        let left_out = |body: usize| body != 0 && fixed[model.bodies[body].root];
        let mut moving: Vec<Range<usize>> = Vec::new();
        for body in (0..model.nbody()).filter(|&body| !left_out(body)) {
            match moving.last_mut() {
                Some(last) if last.end == body => last.end += 1,
                _ => moving.push(body..body + 1),
            }
        }
        FixedPoses {
            known: false,
            version: 0,
            bodies: 0..model.nbody(),
            moving,
        }
    }

    /// Has the next pass compute them, because parameters may have changed.
    pub fn forget(&mut self) {
        self.known = false;
    }

    /// Takes note of a pass that computed what was not known.
    pub fn note(&mut self) {
        if !self.known {
            (self.known, self.version) = (true, self.version + 1);
        }
    }

    /// Whether they are known.
    pub fn known(&self) -> bool {
        self.known
    }

    /// How often they were computed: while this stays the same, so do they.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// Ranges of the bodies whose poses a pass computes.
    pub fn parts(&self) -> &[Range<usize>] {
        match self.known {
            true => &self.moving,
            false => from_ref(&self.bodies),
        }
    }
}
