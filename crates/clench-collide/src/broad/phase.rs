//! The near pairs of a scene: a [`StaticTree`] of what stands still, a [`Grid`] of clusters of the rest.

use super::aabb::Aabb;
use super::grid::{Boxes, Grid};
use super::static_tree::StaticTree;
use super::{Bound, near};
use clench_math::{Mask, Real, kernel};
use std::ops::Range;

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
    clusters: Clusters,
    grid: Grid,
}

/// Mobile shapes that are near each other whatever moves, as those of a robot: the grid holds a box about all of them. Each is a range of
/// their places among the mobile ones.
#[derive(Clone, Debug, Default)]
struct Clusters {
    members: Vec<Range<usize>>,
    boxes: Vec<Aabb>,
    placed: Vec<bool>,
}

/// Larger clusters are parted: what is in the same or in neighbouring ones is compared each with each.
const MAX_CLUSTER: usize = 32;

impl Clusters {
    /// Mobile shapes that follow each other, of one cluster and all placed or all moving.
    fn new(mobile: &[u32], placed: &[bool], cluster: impl Fn(usize) -> usize) -> Self {
        let mut clusters = Clusters::default();
        for index in 0..mobile.len() {
            let key = |index: usize| (cluster(mobile[index] as usize), placed[index]);
            match clusters.members.last_mut() {
                Some(last) if last.len() < MAX_CLUSTER && key(last.start) == key(index) => {
                    last.end += 1;
                }
                _ => {
                    clusters.members.push(index..index + 1);
                    clusters.placed.push(placed[index]);
                }
            }
        }
        clusters
    }

    /// Takes over where the shapes are.
    fn update(&mut self, boxes: &[Aabb]) {
        let around = |members: &Range<usize>| {
            let members = boxes[members.clone()].iter();
            members.fold(Aabb::EMPTY, |all, one| all.union(one))
        };
        self.boxes.clear();
        self.boxes.extend(self.members.iter().map(around));
    }

    /// Hands every pair of mobile shapes whose boxes overlap to `check`, once, but for two that are placed.
    fn pairs(&self, grid: &mut Grid, boxes: &[Aabb], check: &mut impl FnMut(usize, usize)) {
        for (members, &placed) in self.members.iter().zip(&self.placed) {
            if placed {
                continue;
            }
            for a in members.clone() {
                let later = (a + 1..members.end).filter(|&b| boxes[a].overlaps(&boxes[b]));
                later.for_each(|b| check(a, b));
            }
        }
        let all = Boxes {
            all: &self.boxes,
            fixed: &self.placed,
        };
        grid.pairs(all, &mut |one, other| {
            let (one, other) = (one as usize, other as usize);
            let around = &self.boxes[other];
            for a in self.members[one]
                .clone()
                .filter(|&a| boxes[a].overlaps(around))
            {
                let others = self.members[other].clone();
                let near = others.filter(|&b| boxes[a].overlaps(&boxes[b]));
                near.for_each(|b| check(a, b));
            }
        });
    }
}

impl BroadPhase {
    /// For scenes whose shapes have this mobility, in their order. Shapes that follow each other and are of the same `cluster`, a number
    /// of the caller's, are supposed to stay near each other, which saves time and changes no pair.
    pub fn new(mobility: &[Mobility], cluster: impl Fn(usize) -> usize) -> Self {
        let of = |wanted: fn(Mobility) -> bool| {
            let shapes = mobility.iter().enumerate();
            let wanted = shapes.filter(|&(_, &mobility)| wanted(mobility));
            Vec::from_iter(wanted.map(|(shape, _)| shape as u32))
        };
        let mobile = of(|mobility| matches!(mobility, Mobility::Placed | Mobility::Moving));
        let is_placed = |&shape: &u32| mobility[shape as usize] == Mobility::Placed;
        let placed = Vec::from_iter(mobile.iter().map(is_placed));
        BroadPhase {
            statics: of(|mobility| mobility == Mobility::Static),
            clusters: Clusters::new(&mobile, &placed, cluster),
            placed,
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
        self.clusters.update(&self.boxes);
        (self.clusters).pairs(&mut self.grid, &self.boxes, &mut |i, j| {
            check(mobile[i], mobile[j]);
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
