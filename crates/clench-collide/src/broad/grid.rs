//! Which of many boxes overlap.
//!
//! Space is cut into cubes about as large as the larger of the boxes. Each box is listed in every cube that it reaches into, in a hash
//! table (Teschner et al. 2003), so that empty space costs nothing and a box far away does no harm. Boxes in one cube are compared; two that
//! share several cubes are a pair in the one that holds the lower corner of what they have in common. The few that are much larger than the
//! rest would be in too many cubes and are compared with all. So the work grows with the number of boxes and of pairs, not with the square.

use super::aabb::Aabb;

/// This part of the shapes is not larger than a cube.
const SMALL_SHARE: f64 = 0.9;
/// A shape of more cubes than this along an axis is compared with all others.
const MAX_CELLS: f64 = 4.0;
/// Cubes are numbered up to this along an axis; shapes beyond are compared with all others.
const MAX_CELL: f64 = 1e9;
/// Buckets of the hash table, for each shape.
const BUCKETS_PER_SHAPE: usize = 4;

/// Finds pairs of boxes that overlap. Its buffers grow to the largest scene seen.
#[derive(Clone, Debug, Default)]
pub(super) struct Grid {
    sides: Vec<f64>,
    /// Boxes that are compared with all others, ascending.
    wide: Vec<u32>,
    /// Whether a box is one of them.
    is_wide: Vec<bool>,
    /// The cubes that hold the corners of each other box, those of fixed ones first.
    ranges: Vec<CubeRange>,
    /// Where the entries of a bucket begin, and those of the next.
    starts: Vec<u32>,
    entries: Vec<Entry>,
}

/// Boxes in a scene, of which those that are `fixed` make no pairs with each other, however many may be in one place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Boxes<'a> {
    pub all: &'a [Aabb],
    pub fixed: &'a [bool],
}

type Cube = [i32; 3];

/// A shape in a cube.
#[derive(Clone, Copy, Debug, Default)]
struct Entry {
    cube: Cube,
    shape: u32,
}

/// The cubes that a shape reaches into.
#[derive(Clone, Copy, Debug)]
struct CubeRange {
    low: Cube,
    high: Cube,
    shape: u32,
}

impl CubeRange {
    fn new(shape: usize, one: &Aabb, per_metre: f64) -> Self {
        CubeRange {
            low: cube(one.low, per_metre),
            high: cube(one.high, per_metre),
            shape: shape as u32,
        }
    }

    fn cubes(&self) -> impl Iterator<Item = Cube> {
        let CubeRange { low, high, .. } = *self;
        let [along_x, along_y, along_z] = [0, 1, 2].map(|axis| low[axis]..=high[axis]);
        along_x.flat_map(move |x| {
            let along_z = along_z.clone();
            (along_y.clone()).flat_map(move |y| along_z.clone().map(move |z| [x, y, z]))
        })
    }
}

/// The cube that a point is in.
fn cube(point: [f64; 3], per_metre: f64) -> Cube {
    point.map(|x| floor(x * per_metre))
}

/// The largest whole number up to x, which is within [`MAX_CELL`].
fn floor(x: f64) -> i32 {
    let whole = x as i32;
    whole - i32::from(f64::from(whole) > x)
}

impl Grid {
    /// Hands every pair of boxes that overlap to `check`, once.
    pub(super) fn pairs(&mut self, boxes: Boxes, check: &mut impl FnMut(u32, u32)) {
        let per_metre = self.part_by_size(boxes.all);
        self.list(boxes, per_metre);
        self.in_cubes(boxes, per_metre, check);
        self.with_wide(boxes, check);
    }

    /// Decides the size of the cubes and which shapes are compared with all others. Gives the cubes per metre.
    fn part_by_size(&mut self, boxes: &[Aabb]) -> f64 {
        self.sides.clear();
        let sides = boxes.iter().map(Aabb::side);
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
        for (index, one) in boxes.iter().enumerate() {
            let corners = one.low.iter().chain(&one.high);
            let fits = one.side() * per_metre <= MAX_CELLS
                && corners.map(|x| x.abs() * per_metre).all(|x| x <= MAX_CELL);
            self.is_wide.push(!fits);
            if !fits {
                self.wide.push(index as u32);
            }
        }
        per_metre
    }

    /// Lists the other shapes in their cubes, bucket after bucket, in each the fixed ones last.
    fn list(&mut self, Boxes { all, fixed }: Boxes, per_metre: f64) {
        let Grid {
            is_wide,
            ranges,
            starts,
            entries,
            ..
        } = self;
        let buckets = (BUCKETS_PER_SHAPE * all.len()).next_power_of_two();
        // Buckets are filled from their ends.
        ranges.clear();
        for is_fixed in [true, false] {
            let of_kind = |&index: &usize| fixed[index] == is_fixed && !is_wide[index];
            let shapes = (0..all.len()).filter(of_kind);
            ranges.extend(shapes.map(|index| CubeRange::new(index, &all[index], per_metre)));
        }
        starts.clear();
        starts.resize(buckets + 1, 0);
        for cube in ranges.iter().flat_map(CubeRange::cubes) {
            starts[bucket(cube, buckets)] += 1;
        }
        let mut end = 0;
        for start in starts.iter_mut() {
            end += *start;
            *start = end;
        }
        entries.clear();
        entries.resize(end as usize, Entry::default());
        // From the end of each bucket to its beginning, which is where `starts` then points.
        for range in ranges.iter() {
            for cube in range.cubes() {
                let (shape, start) = (range.shape, &mut starts[bucket(cube, buckets)]);
                *start -= 1;
                entries[*start as usize] = Entry { cube, shape };
            }
        }
    }

    /// Pairs that share a cube.
    fn in_cubes(
        &self,
        Boxes { all, fixed }: Boxes,
        per_metre: f64,
        check: &mut impl FnMut(u32, u32),
    ) {
        for range in self.starts.windows(2) {
            let entries = &self.entries[range[0] as usize..range[1] as usize];
            for (k, one) in entries.iter().enumerate() {
                if fixed[one.shape as usize] {
                    break;
                }
                let a = &all[one.shape as usize];
                for other in &entries[k + 1..] {
                    let b = &all[other.shape as usize];
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

    /// Pairs with a box that is compared with all others.
    fn with_wide(&self, Boxes { all, fixed }: Boxes, check: &mut impl FnMut(u32, u32)) {
        for &one in &self.wide {
            let is_fixed = |index: u32| fixed[index as usize];
            for other in 0..all.len() as u32 {
                // Of two wide boxes the second meets the first, but for a fixed one, which meets those that are not.
                let twice = self.is_wide[other as usize]
                    && (other <= one || is_fixed(one))
                    && !is_fixed(other);
                let both_fixed = is_fixed(one) && is_fixed(other);
                if !twice && !both_fixed && all[one as usize].overlaps(&all[other as usize]) {
                    check(one, other);
                }
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
