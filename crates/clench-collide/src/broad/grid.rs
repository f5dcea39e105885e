//! Pairs of overlapping boxes among many.
//!
//! Space is divided into cubes about as large as the larger boxes. Each box is listed in every cube that it overlaps,
//! in a hash table (Teschner et al. 2003), so empty space and distant boxes cost nothing. Boxes in the same cube are
//! compared. Two that share several cubes are reported in the one with the lower corner of their intersection. The few
//! much larger boxes would be in too many cubes; they are compared with all, as are all moving boxes if there are few.
//! So the work grows with the number of boxes and pairs, not with the square.

use super::aabb::Aabb;

/// The fraction of the shapes that are not larger than a cube.
const SMALL_SHARE: f64 = 0.9;
/// The maximum size of a shape, in cubes; larger ones are compared with all others.
const MAX_CELLS: f64 = 4.0;
/// The maximum cube coordinate along an axis; shapes beyond are compared with all others.
const MAX_CELL: f64 = 1e9;
/// The number of moving boxes up to which each is compared with all others.
const FEW: usize = 16;
/// The number of hash table buckets per shape.
const BUCKETS_PER_SHAPE: usize = 4;

/// Finds pairs of overlapping boxes. Its buffers grow to the largest scene seen.
#[derive(Clone, Debug, Default)]
pub(super) struct Grid {
    sides: Vec<f64>,
    /// The boxes compared with all others, ascending.
    wide: Vec<u32>,
    /// True for these boxes.
    is_wide: Vec<bool>,
    /// The cube ranges of the other boxes, fixed ones first.
    ranges: Vec<CubeRange>,
    /// The start of each bucket's entries, then the end of the last.
    starts: Vec<u32>,
    entries: Vec<Entry>,
}

/// The boxes of a scene. Those that are `fixed` make no pairs with each other, even if many overlap.
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

/// The range of cubes that a shape overlaps.
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

/// Returns the cube that contains a point.
fn cube(point: [f64; 3], per_metre: f64) -> Cube {
    point.map(|x| floor(x * per_metre))
}

/// Returns the largest integer not above x, which is within [`MAX_CELL`].
fn floor(x: f64) -> i32 {
    let whole = x as i32;
    whole - i32::from(f64::from(whole) > x)
}

impl Grid {
    /// Calls `check` once for every pair of overlapping boxes.
    pub(super) fn pairs(&mut self, boxes: Boxes, check: &mut impl FnMut(u32, u32)) {
        let moving = (0..boxes.all.len()).filter(|&index| !boxes.fixed[index]);
        if moving.clone().nth(FEW).is_none() {
            return few(boxes, moving, check);
        }
        let per_metre = self.part_by_size(boxes.all);
        self.list(boxes, per_metre);
        self.in_cubes(boxes, per_metre, check);
        self.with_wide(boxes, check);
    }

    /// Chooses the cube size and the shapes compared with all others. Returns the cubes per metre.
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

    /// Lists the other shapes in their cubes, bucket by bucket, with fixed ones last in each.
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
        // Fill each bucket from its end to its start, which `starts` then holds.
        for range in ranges.iter() {
            for cube in range.cubes() {
                let (shape, start) = (range.shape, &mut starts[bucket(cube, buckets)]);
                *start -= 1;
                entries[*start as usize] = Entry { cube, shape };
            }
        }
    }

    /// Finds the pairs that share a cube.
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

    /// Finds the pairs with a box that is compared with all others.
    fn with_wide(&self, Boxes { all, fixed }: Boxes, check: &mut impl FnMut(u32, u32)) {
        for &one in &self.wide {
            let is_fixed = |index: u32| fixed[index as usize];
            for other in 0..all.len() as u32 {
                // The first of two wide boxes that move checks the pair; the moving one checks a pair with a fixed box.
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

/// Compares the moving boxes with all others.
fn few(
    Boxes { all, fixed }: Boxes,
    moving: impl Iterator<Item = usize>,
    check: &mut impl FnMut(u32, u32),
) {
    for one in moving {
        let others = (0..all.len()).filter(|&other| fixed[other] || other > one);
        for other in others.filter(|&other| all[one].overlaps(&all[other])) {
            check(one as u32, other as u32);
        }
    }
}

/// Returns the bucket of a cube; `buckets` is a power of two.
fn bucket([x, y, z]: Cube, buckets: usize) -> usize {
    let mixed = (x as u32).wrapping_mul(73_856_093)
        ^ (y as u32).wrapping_mul(19_349_663)
        ^ (z as u32).wrapping_mul(83_492_791);
    // The upper bits depend on all bits of each number.
    let spread = mixed.wrapping_mul(0x9E37_79B9);
    (spread as usize ^ (spread >> 16) as usize) & (buckets - 1)
}
