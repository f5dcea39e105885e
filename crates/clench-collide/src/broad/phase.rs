//! The near pairs of a scene: a [`StaticTree`] of what stands still, a [`Grid`] of the rest.

use super::aabb::Aabb;
use super::grid::{Boxes, Grid};
use super::static_tree::StaticTree;
use super::{Bound, near};
use clench_math::{Mask, Real, kernel};

/// What a shape does in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mobility {
    /// It makes no pair with anything, as a shape that is only drawn.
    Excluded,
    /// It never moves, so the tree over such shapes is built once. It makes no pair with another static shape, nor with a placed one.
    Static,
    /// It moves only when its pose is set from outside. It makes no pair with another placed shape, nor with a static one.
    Placed,
    /// It moves, and may make a pair with any other that is not excluded.
    Moving,
}

/// Finds the near pairs of a scene. Its buffers grow to what the largest step needed.
#[derive(Clone, Debug, Default)]
pub struct BroadPhase {
    statics: Vec<u32>,
    tree: StaticTree,
    /// Whether the tree is built over the static shapes where they are.
    built: bool,
    /// The shapes that are placed or move, ascending, with their boxes, and whether they are placed.
    mobile: Vec<u32>,
    boxes: Vec<Aabb>,
    placed: Vec<bool>,
    grid: Grid,
}

impl BroadPhase {
    /// For scenes whose shapes have this mobility, in their order.
    pub fn new(mobility: &[Mobility]) -> Self {
        let of = |wanted: fn(Mobility) -> bool| {
            let shapes = mobility.iter().enumerate();
            let wanted = shapes.filter(|&(_, &mobility)| wanted(mobility));
            Vec::from_iter(wanted.map(|(shape, _)| shape as u32))
        };
        let mobile = of(|mobility| matches!(mobility, Mobility::Placed | Mobility::Moving));
        let is_placed = |&shape: &u32| mobility[shape as usize] == Mobility::Placed;
        BroadPhase {
            statics: of(|mobility| mobility == Mobility::Static),
            placed: mobile.iter().map(is_placed).collect(),
            mobile,
            ..BroadPhase::default()
        }
    }

    /// The shapes that are placed or move, ascending.
    pub fn mobile(&self) -> &[u32] {
        &self.mobile
    }

    /// To be called when static shapes have moved after all, or have other margins: the next search builds their tree anew.
    pub fn forget_statics(&mut self) {
        self.built = false;
    }

    /// Replaces `pairs` by those (i, j), i < j, ascending, that `allowed` admits and that are [`near`] in any
    /// environment with the margin `margins[i] + margins[j]`. Returns the environments that have more than `most`: of theirs some are
    /// left out.
    #[kernel]
    pub fn pairs<T: Real>(
        &mut self,
        bounds: &[Bound<T>],
        margins: &[T],
        mut allowed: impl FnMut(u32, u32) -> bool,
        most: u64,
        pairs: &mut Vec<(u32, u32)>,
    ) -> T::Mask {
        let aabb = |shape: u32| Aabb::new(&bounds[shape as usize], margins[shape as usize]);
        if !self.built {
            let statics = self.statics.iter();
            (self.tree).build(statics.map(|&shape| (shape, aabb(shape))));
            self.built = true;
        }
        self.boxes.clear();
        for &shape in &self.mobile {
            self.boxes.push(aabb(shape));
        }
        pairs.clear();
        let mut counter = Counter::<T>::new(most);
        let mut check = |i: u32, j: u32| {
            let (i, j) = (i.min(j), i.max(j));
            let (a, b) = (i as usize, j as usize);
            let near = near(&bounds[a], &bounds[b], margins[a] + margins[b]);
            if near.any() && allowed(i, j) && counter.admits(near) {
                pairs.push((i, j));
            }
        };
        let (mobile, placed) = (&self.mobile, &self.placed);
        let boxes = Boxes {
            all: &self.boxes,
            fixed: placed,
        };
        (self.grid).pairs(boxes, &mut |i, j| {
            check(mobile[i as usize], mobile[j as usize])
        });
        let moving = (0..mobile.len()).filter(|&index| !placed[index]);
        for index in moving {
            (self.tree).overlapping(&self.boxes[index], |shape| check(mobile[index], shape));
        }
        pairs.sort_unstable();
        counter.over
    }
}

/// Counts the near pairs of each environment.
struct Counter<T: Real> {
    most: T,
    count: T,
    /// The environments that have more than the most.
    over: T::Mask,
}

impl<T: Real> Counter<T> {
    fn new(most: u64) -> Self {
        Counter {
            most: T::new(most as f64),
            count: T::ZERO,
            over: T::Mask::splat(false),
        }
    }

    /// Whether an environment in which two shapes are near may have another pair.
    #[inline(always)]
    fn admits(&mut self, near: T::Mask) -> bool {
        let found = near & !self.over;
        self.count += T::select(found, T::ONE, T::ZERO);
        self.over |= self.count.gt(self.most);
        found.any()
    }
}
