//! The near pairs of a scene: a [`StaticTree`] of the static shapes, a [`Grid`] of clusters of the others.

use super::aabb::Aabb;
use super::grid::{Boxes, Grid};
use super::static_tree::StaticTree;
use super::{Bound, near};
use clench_math::{Mask, Real, kernel};
use std::ops::Range;

/// The mobility of a shape in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mobility {
    /// The shape makes no pairs, for example because it is only drawn.
    Excluded,
    /// The shape never moves, so the tree over such shapes is built once. It makes no pairs with static or placed
    /// shapes.
    Static,
    /// The shape moves only when its pose is set from outside. It makes no pairs with static or placed shapes.
    Placed,
    /// The shape moves, and may make a pair with any other that is not excluded.
    Moving,
}

/// Finds the near pairs of a scene. Its buffers grow to the requirements of the largest step.
#[derive(Clone, Debug, Default)]
pub struct BroadPhase {
    statics: Vec<u32>,
    tree: StaticTree,
    /// True if the tree is valid for the current static shapes.
    built: bool,
    /// The placed and moving shapes, ascending, their boxes, and true for placed ones.
    mobile: Vec<u32>,
    boxes: Vec<Aabb>,
    placed: Vec<bool>,
    clusters: Clusters,
    grid: Grid,
}

/// Groups of mobile shapes that stay near each other, such as those of a robot, with a common box in the grid. Each is
/// a range of indices of mobile shapes.
#[derive(Clone, Debug, Default)]
struct Clusters {
    members: Vec<Range<usize>>,
    boxes: Vec<Aabb>,
    /// True for the clusters that make no pairs among themselves in the current search.
    fixed: Vec<bool>,
}

/// The maximum size of a cluster; larger ones are split. Shapes in the same or neighbouring clusters are compared
/// pairwise.
const MAX_CLUSTER: usize = 32;

impl Clusters {
    /// Groups consecutive mobile shapes of the same cluster that are either all placed or all moving.
    fn new(mobile: &[u32], placed: &[bool], cluster: impl Fn(usize) -> usize) -> Self {
        let mut clusters = Clusters::default();
        for index in 0..mobile.len() {
            let key = |index: usize| (cluster(mobile[index] as usize), placed[index]);
            match clusters.members.last_mut() {
                Some(last) if last.len() < MAX_CLUSTER && key(last.start) == key(index) => {
                    last.end += 1;
                }
                _ => clusters.members.push(index..index + 1),
            }
        }
        clusters
    }

    /// Updates the boxes of the clusters, and finds those without a shape that is `awake`.
    fn update(&mut self, boxes: &[Aabb], awake: impl Fn(usize) -> bool) {
        let enclosing = |members: &Range<usize>| {
            let members = boxes[members.clone()].iter();
            members.fold(Aabb::EMPTY, |all, one| all.union(one))
        };
        self.boxes.clear();
        self.boxes.extend(self.members.iter().map(enclosing));
        self.fixed.clear();
        let members = self.members.iter().cloned();
        self.fixed
            .extend(members.map(|mut members| !members.any(&awake)));
    }

    /// Calls `check` once for every pair of mobile shapes whose boxes overlap, except for two in fixed clusters.
    fn pairs(&self, grid: &mut Grid, boxes: &[Aabb], check: &mut impl FnMut(usize, usize)) {
        for (members, &fixed) in self.members.iter().zip(&self.fixed) {
            if fixed {
                continue;
            }
            for a in members.clone() {
                let later = (a + 1..members.end).filter(|&b| boxes[a].overlaps(&boxes[b]));
                later.for_each(|b| check(a, b));
            }
        }
        let all = Boxes {
            all: &self.boxes,
            fixed: &self.fixed,
        };
        grid.pairs(all, &mut |one, other| {
            let (one, other) = (one as usize, other as usize);
            let bounds = &self.boxes[other];
            for a in self.members[one]
                .clone()
                .filter(|&a| boxes[a].overlaps(bounds))
            {
                let others = self.members[other].clone();
                let near = others.filter(|&b| boxes[a].overlaps(&boxes[b]));
                near.for_each(|b| check(a, b));
            }
        });
    }
}

impl BroadPhase {
    /// Creates a broad phase for shapes with the given mobility. Consecutive shapes with the same `cluster`, a number
    /// chosen by the caller, are assumed to stay near each other. This saves time and changes no pair.
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

    /// Returns the placed and moving shapes, ascending.
    pub fn mobile(&self) -> &[u32] {
        &self.mobile
    }

    /// Invalidates the tree of static shapes, which the next search rebuilds. Call it after static shapes have moved or
    /// changed margins.
    pub fn invalidate_statics(&mut self) {
        self.built = false;
    }

    /// Replaces `pairs` by those (i, j), i < j, ascending, that `allowed` admits and that are [`near`] in any
    /// environment with the margin `margins[i] + margins[j]`. Returns the environments that have more than `limit`
    /// pairs; some of their pairs are omitted. With `awake`, pairs of moving shapes that sleep, with each other or with
    /// static ones, may be omitted.
    #[kernel]
    pub fn pairs<T: Real>(
        &mut self,
        bounds: &[Bound<T>],
        margins: &[T],
        awake: Option<&dyn Fn(u32) -> bool>,
        mut allowed: impl FnMut(u32, u32) -> bool,
        limit: u64,
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
        let mut counter = Counter::<T>::new(limit);
        let mut check = |i: u32, j: u32| {
            let (i, j) = (i.min(j), i.max(j));
            let (a, b) = (i as usize, j as usize);
            let near = near(&bounds[a], &bounds[b], margins[a] + margins[b]);
            if near.any() && allowed(i, j) && counter.admits(near) {
                pairs.push((i, j));
            }
        };
        let (mobile, placed) = (&self.mobile, &self.placed);
        let moves = |index: usize| !placed[index] && awake.is_none_or(|awake| awake(mobile[index]));
        // Placed shapes make pairs with those that sleep.
        let searches = |index: usize| moves(index) || (awake.is_some() && placed[index]);
        self.clusters.update(&self.boxes, searches);
        (self.clusters).pairs(&mut self.grid, &self.boxes, &mut |i, j| {
            if !(placed[i] && placed[j]) {
                check(mobile[i], mobile[j]);
            }
        });
        for index in (0..mobile.len()).filter(|&index| moves(index)) {
            (self.tree).overlapping(&self.boxes[index], |shape| check(mobile[index], shape));
        }
        pairs.sort_unstable();
        counter.over
    }
}

/// Counts the near pairs of each environment.
struct Counter<T: Real> {
    limit: T,
    count: T,
    /// The environments beyond the maximum.
    over: T::Mask,
}

impl<T: Real> Counter<T> {
    fn new(limit: u64) -> Self {
        Counter {
            limit: T::new(limit as f64),
            count: T::ZERO,
            over: T::Mask::splat(false),
        }
    }

    /// Counts a near pair. Returns true if an environment still has capacity for it.
    #[inline(always)]
    fn admits(&mut self, near: T::Mask) -> bool {
        let found = near & !self.over;
        self.count += T::select(found, T::ONE, T::ZERO);
        self.over |= self.count.gt(self.limit);
        found.any()
    }
}
