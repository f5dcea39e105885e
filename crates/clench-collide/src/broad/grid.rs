//! The near pairs of many shapes.
//!
//! Space is cut into cubes about as large as the larger of the shapes. Each shape is listed in every cube that its box reaches into, in a
//! hash table (Teschner et al. 2003), so that empty space costs nothing and a shape far away does no harm. Shapes in one cube are
//! compared; two that share several cubes are a pair in the one that holds the lower corner of what their boxes have in common. The few that
//! are much larger than the rest, planes among them, would be in too many cubes and are compared with all. So the work grows with the number
//! of shapes and of near pairs, not with the square.

use super::{Bound, allowance, near};
use clench_math::{Mask, Real, Scalar, kernel};

/// This part of the shapes is not larger than a cube.
const SMALL_SHARE: f64 = 0.9;
/// A shape of more cubes than this along an axis is compared with all others.
const MAX_CELLS: f64 = 4.0;
/// Cubes are numbered up to this along an axis; shapes beyond are compared with all others.
const MAX_CELL: f64 = 1e9;
/// Buckets of the hash table, for each shape.
const BUCKETS_PER_SHAPE: usize = 4;

/// Finds the near pairs of a scene. Its buffers grow to the largest scene seen.
#[derive(Clone, Debug, Default)]
pub struct Grid {
    /// What each shape covers in any environment, with its margin.
    boxes: Vec<Box3>,
    sides: Vec<f64>,
    /// Shapes that are compared with all others, ascending.
    wide: Vec<u32>,
    /// Whether a shape is one of them.
    is_wide: Vec<bool>,
    /// Whether a shape is fixed; none is where it is shorter.
    fixed: Vec<bool>,
    /// The shapes that are not, ascending.
    moving: Vec<u32>,
    /// Where the entries of a bucket begin, and those of the next.
    starts: Vec<u32>,
    entries: Vec<Entry>,
}

type Cube = [i32; 3];

/// A shape in a cube.
#[derive(Clone, Copy, Debug, Default)]
struct Entry {
    cube: Cube,
    shape: u32,
}

#[derive(Clone, Copy, Debug)]
struct Box3 {
    low: [f64; 3],
    high: [f64; 3],
}

impl Box3 {
    /// What a bound covers in any environment.
    fn new<T: Real>(bound: &Bound<T>, margin: T) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for lane in 0..T::LANES {
            let number = |x: T| x.lane(lane).to_f64();
            for axis in 0..3 {
                let (center, half) = (bound.center[axis], bound.half[axis]);
                let reach = number(half) + number(margin * allowance());
                low[axis] = low[axis].min(number(center) - reach);
                high[axis] = high[axis].max(number(center) + reach);
            }
        }
        Box3 { low, high }
    }

    fn side(&self) -> f64 {
        let side = |axis: usize| self.high[axis] - self.low[axis];
        side(0).max(side(1)).max(side(2))
    }

    fn overlaps(&self, other: &Box3) -> bool {
        (0..3).all(|axis| self.low[axis] <= other.high[axis] && other.low[axis] <= self.high[axis])
    }

    /// The cubes that hold the corners.
    fn cubes(&self, per_metre: f64) -> (Cube, Cube) {
        (cube(self.low, per_metre), cube(self.high, per_metre))
    }
}

/// The cube that a point is in.
fn cube(point: [f64; 3], per_metre: f64) -> Cube {
    point.map(|x| (x * per_metre).floor() as i32)
}

impl Grid {
    /// An empty grid.
    pub fn new() -> Self {
        Grid::default()
    }

    /// An empty grid for scenes of which these shapes are fixed: two of them are never a pair, so that however many may be in one
    /// place.
    pub fn with_fixed(fixed: Vec<bool>) -> Self {
        Grid {
            fixed,
            ..Grid::default()
        }
    }

    fn is_fixed(&self, shape: u32) -> bool {
        self.fixed.get(shape as usize).is_some_and(|&fixed| fixed)
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
        pairs.clear();
        self.boxes.clear();
        for (bound, &margin) in bounds.iter().zip(margins) {
            self.boxes.push(Box3::new(bound, margin));
        }
        let per_metre = self.part_by_size();
        self.list(per_metre);
        let most = T::new(most as f64);
        let (mut count, mut over) = (T::ZERO, T::Mask::splat(false));
        let mut check = |i: u32, j: u32| {
            let (i, j) = (i.min(j), i.max(j));
            let (a, b) = (i as usize, j as usize);
            let margin = margins[a] + margins[b];
            if !allowed(i, j) {
                return;
            }
            let found = near(&bounds[a], &bounds[b], margin) & !over;
            if found.any() {
                count += T::select(found, T::ONE, T::ZERO);
                over |= count.gt(most);
                pairs.push((i, j));
            }
        };
        self.in_cubes(per_metre, &mut check);
        self.with_wide(&mut check);
        pairs.sort_unstable();
        over
    }

    /// Decides the size of the cubes and which shapes are compared with all others. Gives the cubes per metre.
    fn part_by_size(&mut self) -> f64 {
        self.sides.clear();
        let sides = self.boxes.iter().map(Box3::side);
        self.sides.extend(sides.filter(|side| side.is_finite()));
        let count = self.sides.len();
        let rank = ((count as f64 * SMALL_SHARE) as usize).min(count.saturating_sub(1));
        let per_metre = match count {
            0 => 1.0,
            _ => {
                1.0 / self
                    .sides
                    .select_nth_unstable_by(rank, f64::total_cmp)
                    .1
                    .max(1e-12)
            }
        };
        self.wide.clear();
        self.is_wide.clear();
        self.moving.clear();
        for (index, one) in self.boxes.iter().enumerate() {
            let corners = one.low.iter().chain(&one.high);
            let fits = one.side() * per_metre <= MAX_CELLS
                && corners.map(|x| x.abs() * per_metre).all(|x| x <= MAX_CELL);
            self.is_wide.push(!fits);
            let fixed = self.fixed.get(index).is_some_and(|&fixed| fixed);
            if !fixed {
                self.moving.push(index as u32);
            }
            if !fits {
                self.wide.push(index as u32);
            }
        }
        per_metre
    }

    /// Lists the other shapes in their cubes, bucket after bucket, in each the fixed ones last.
    fn list(&mut self, per_metre: f64) {
        let Grid {
            boxes,
            is_wide,
            fixed,
            starts,
            entries,
            ..
        } = self;
        let buckets = (BUCKETS_PER_SHAPE * boxes.len()).next_power_of_two();
        let each = |put: &mut dyn FnMut(usize, Entry)| {
            let is_fixed = |index: usize| fixed.get(index).is_some_and(|&fixed| fixed);
            // Buckets are filled from their ends.
            let fixed_first = (0..boxes.len()).filter(|&index| is_fixed(index));
            let moving = (0..boxes.len()).filter(|&index| !is_fixed(index));
            for index in fixed_first.chain(moving) {
                let one = &boxes[index];
                if is_wide[index] {
                    continue;
                }
                let (low, high) = one.cubes(per_metre);
                for x in low[0]..=high[0] {
                    for y in low[1]..=high[1] {
                        for z in low[2]..=high[2] {
                            let (cube, shape) = ([x, y, z], index as u32);
                            put(bucket(cube, buckets), Entry { cube, shape });
                        }
                    }
                }
            }
        };
        starts.clear();
        starts.resize(buckets + 1, 0);
        each(&mut |bucket, _| starts[bucket] += 1);
        let mut end = 0;
        for start in starts.iter_mut() {
            end += *start;
            *start = end;
        }
        entries.clear();
        entries.resize(end as usize, Entry::default());
        // From the end of each bucket to its beginning, which is where `starts` then points.
        each(&mut |bucket, entry| {
            starts[bucket] -= 1;
            entries[starts[bucket] as usize] = entry;
        });
    }

    /// Pairs that share a cube.
    fn in_cubes(&self, per_metre: f64, check: &mut impl FnMut(u32, u32)) {
        for range in self.starts.windows(2) {
            let entries = &self.entries[range[0] as usize..range[1] as usize];
            for (k, one) in entries.iter().enumerate() {
                if self.is_fixed(one.shape) {
                    break;
                }
                let a = &self.boxes[one.shape as usize];
                for other in &entries[k + 1..] {
                    let b = &self.boxes[other.shape as usize];
                    if one.cube != other.cube || !a.overlaps(b) {
                        continue;
                    }
                    let common = [0, 1, 2].map(|axis| a.low[axis].max(b.low[axis]));
                    if cube(common, per_metre) == one.cube {
                        check(one.shape, other.shape);
                    }
                }
            }
        }
    }

    /// Pairs with a shape that is compared with all others.
    fn with_wide(&self, check: &mut impl FnMut(u32, u32)) {
        for &one in &self.wide {
            let mut look = |other: u32| {
                // Of two wide shapes the second meets the first, but for a fixed one, which looks at moving ones alone.
                let twice = self.is_wide[other as usize]
                    && (other <= one || self.is_fixed(one))
                    && !self.is_fixed(other);
                let near = || self.boxes[one as usize].overlaps(&self.boxes[other as usize]);
                if !twice && near() {
                    check(one, other);
                }
            };
            match self.is_fixed(one) {
                true => self.moving.iter().copied().for_each(look),
                false => (0..self.boxes.len() as u32).for_each(&mut look),
            }
        }
    }
}

/// The bucket of a cube, of a power of two of them.
fn bucket([x, y, z]: Cube, buckets: usize) -> usize {
    let mixed = (x as u32).wrapping_mul(73_856_093)
        ^ (y as u32).wrapping_mul(19_349_663)
        ^ (z as u32).wrapping_mul(83_492_791);
    // The upper bits depend on all of each number's.
    let spread = mixed.wrapping_mul(0x9E37_79B9);
    (spread as usize ^ (spread >> 16) as usize) & (buckets - 1)
}
