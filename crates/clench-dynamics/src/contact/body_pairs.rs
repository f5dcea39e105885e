//! Listed candidates grouped by body pair: pairs of geoms are skipped while boxes about the geoms of two bodies are
//! apart.

use super::Candidate;
use super::bounding_sphere::BoundingSphere;
use crate::model::Model;
use clench_collide::ShapeKind;
use clench_math::{Mask, Real, Scalar, Vec3, kernel};
use std::ops::Range;

/// The minimum number of candidates for which two bodies get boxes.
const WORTH_BOXES: usize = 4;
/// Boxes are enlarged by this many ε times the coordinates of their spheres, which exceeds their rounding error.
const ROUNDING: f64 = 8.0;

/// Consecutive candidates in the list.
#[derive(Clone, Debug)]
struct Run {
    candidates: Range<usize>,
    /// The boxes that must overlap for any of them to touch; `None` to check each candidate.
    boxes: Option<[usize; 2]>,
}

/// A box around the bounding spheres of some geoms of a body.
#[derive(Clone, Debug)]
struct BodyBox<T> {
    body: usize,
    geoms: Vec<usize>,
    low: Vec3<T>,
    high: Vec3<T>,
}

/// The candidates of a model whose list never changes.
#[derive(Clone, Debug)]
pub(super) struct BodyPairs<T> {
    /// The geoms of all candidates.
    geoms: Vec<usize>,
    runs: Vec<Run>,
    boxes: Vec<BodyBox<T>>,
}

impl<T: Real> BodyPairs<T> {
    /// Groups a list in canonical order, in which candidates of the same bodies are consecutive.
    #[cold] // Compiled for size.
    #[inline(never)]
    pub(super) fn new(model: &Model, candidates: &[Candidate]) -> Self {
        let mut geoms = Vec::from_iter(candidates.iter().flat_map(|c| c.geoms.map(|g| g as usize)));
        geoms.sort_unstable();
        geoms.dedup();
        let mut pairs = BodyPairs {
            geoms,
            runs: Vec::new(),
            boxes: Vec::new(),
        };
        let bodies = |c: &Candidate| {
            let boundless = c.pair.is_some() || c.kinds[0] == ShapeKind::Plane;
            let [a, b] = c.geoms.map(|g| model.geoms[g as usize].body);
            (boundless, a.min(b), a.max(b))
        };
        let mut end = 0;
        for run in candidates.chunk_by(|a, b| bodies(a) == bodies(b)) {
            let start = end;
            end += run.len();
            let (boundless, a, b) = bodies(&run[0]);
            let boxed = !boundless && run.len() >= WORTH_BOXES;
            let boxes = boxed.then(|| [a, b].map(|body| pairs.box_about(model, body)));
            match pairs.runs.last_mut() {
                Some(last) if last.boxes.is_none() && boxes.is_none() => last.candidates.end = end,
                _ => pairs.runs.push(Run {
                    candidates: start..end,
                    boxes,
                }),
            }
        }
        pairs
    }

    /// Returns the index of the box of a body's candidate geoms, created if absent.
    fn box_about(&mut self, model: &Model, body: usize) -> usize {
        let found = self.boxes.iter().position(|found| found.body == body);
        found.unwrap_or_else(|| {
            let of_body = |&&g: &&usize| model.geoms[g].body == body;
            self.boxes.push(BodyBox {
                body,
                geoms: self.geoms.iter().filter(of_body).copied().collect(),
                low: Vec3::ZERO,
                high: Vec3::ZERO,
            });
            self.boxes.len() - 1
        })
    }

    /// Returns the geoms of all candidates.
    pub(super) fn geoms(&self) -> impl Iterator<Item = usize> {
        self.geoms.iter().copied()
    }

    /// Returns the number of runs of candidates.
    pub(super) fn len(&self) -> usize {
        self.runs.len()
    }

    /// Fits the boxes to the spheres of their geoms.
    #[kernel]
    pub(super) fn update(&mut self, spheres: &[BoundingSphere<T>]) {
        let rounding = T::splat(T::Scalar::EPSILON) * T::new(ROUNDING);
        for bounds in &mut self.boxes {
            let infinity = T::splat(T::Scalar::INFINITY);
            let (mut low, mut high) = ([infinity; 3], [-infinity; 3]);
            for &geom in &bounds.geoms {
                let sphere = &spheres[geom];
                for (axis, center) in sphere.center.to_array().into_iter().enumerate() {
                    let reach = sphere.reach + center.abs() * rounding;
                    low[axis] = low[axis].min(center - reach);
                    high[axis] = high[axis].max(center + reach);
                }
            }
            (bounds.low, bounds.high) = (Vec3::from_array(low), Vec3::from_array(high));
        }
    }

    /// Returns the candidates of a run, if any of them may touch in any lane.
    #[inline(always)]
    pub(super) fn near(&self, run: usize) -> Option<Range<usize>> {
        let run = &self.runs[run];
        let may_touch = match run.boxes {
            None => true,
            Some([a, b]) => {
                let (a, b) = (&self.boxes[a], &self.boxes[b]);
                (at_most(a.low, b.high) & at_most(b.low, a.high)).any()
            }
        };
        may_touch.then(|| run.candidates.clone())
    }
}

/// Returns the lanes in which no coordinate of `low` exceeds that of `high`.
#[inline(always)]
fn at_most<T: Real>(low: Vec3<T>, high: Vec3<T>) -> T::Mask {
    low.x.le(high.x) & low.y.le(high.y) & low.z.le(high.z)
}
