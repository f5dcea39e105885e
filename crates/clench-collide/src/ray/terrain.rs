//! Rays against height fields, cell by cell.
//!
//! Within a triangle the height of the ray over the surface is linear, so a ray that enters above and leaves below has
//! hit the surface in between. Neighbours agree about their common edge, so no ray slips through. A ray passes at most
//! as many cells as there are rows and columns.
//!
//! As in MuJoCo 4.0, the terrain and its base are two solids, one on the other: a ray that starts within one of them
//! also hits the plane between the two.

use super::chord::Chord;
use super::line::Line;
use crate::height_field::HeightField;
use clench_math::Vec3;

/// The relative height of the bounding box above the highest point.
const HEADROOM: f64 = 1e-9;

pub(crate) fn height_field(
    field: &HeightField,
    origin: Vec3<f64>,
    along: Vec3<f64>,
) -> Option<(f64, Vec3<f64>)> {
    let line = Line { origin, along };
    let [half_x, half_y, elevation, base] = field.size();
    let top = elevation * (1.0 + HEADROOM);
    let between = |low: f64, high: f64| {
        let sides = Chord::whole().slab(&line, 0, -half_x, half_x);
        sides
            .slab(&line, 1, -half_y, half_y)
            .slab(&line, 2, low, high)
    };
    let chord = between(-base, top);
    if !(chord.entry <= chord.exit && chord.exit >= 0.0) {
        return None;
    }
    let mut traversal = Traversal::new(field, &line, chord.entry.max(0.0));
    let above = traversal.height(traversal.now) >= 0.0;
    if !above && chord.entry >= 0.0 {
        // The ray enters through a side or the bottom.
        return Some((chord.entry, chord.entry_normal));
    }
    let in_terrain = !above && origin.z > 0.0;
    let chord = match (above, in_terrain) {
        (true, _) => chord,
        (false, true) => between(0.0, top),
        (false, false) => between(-base, 0.0),
    };
    for _ in 0..field.rows() + field.columns() {
        let end = traversal.next.0.min(traversal.next.1).min(chord.exit);
        if let Some(hit) = traversal.cross(end.max(traversal.now), above) {
            return Some(hit);
        }
        if end >= chord.exit {
            break;
        }
        traversal.advance();
    }
    let through_base = in_terrain && chord.exit_normal.z < 0.0;
    let normal = if through_base {
        -chord.exit_normal
    } else {
        chord.exit_normal
    };
    (!above).then_some((chord.exit, normal))
}

/// The traversal of cells along a ray.
struct Traversal<'a> {
    field: &'a HeightField,
    line: &'a Line<f64>,
    /// The lengths of a cell along x and y, m.
    step: [f64; 2],
    /// The column and row.
    cell: [usize; 2],
    /// The current distance along the line, and the distances of the cell's next borders across x and y.
    now: f64,
    next: (f64, f64),
}

impl<'a> Traversal<'a> {
    fn new(field: &'a HeightField, line: &'a Line<f64>, start: f64) -> Self {
        let [half_x, half_y, ..] = field.size();
        let count = [field.columns() - 1, field.rows() - 1];
        let step = [
            2.0 * half_x / count[0] as f64,
            2.0 * half_y / count[1] as f64,
        ];
        let p = line.at(start);
        let cell = |x: f64, half: f64, axis: usize| {
            let inside = ((x + half) / step[axis]).clamp(0.0, (count[axis] - 1) as f64);
            inside as usize
        };
        let mut traversal = Traversal {
            field,
            line,
            step,
            cell: [cell(p.x, half_x, 0), cell(p.y, half_y, 1)],
            now: start,
            next: (0.0, 0.0),
        };
        traversal.next = (traversal.border(0), traversal.border(1));
        traversal
    }

    /// Returns the distance of the cell's next border along an axis.
    fn border(&self, axis: usize) -> f64 {
        let (o, u) = (self.line.origin[axis], self.line.along[axis]);
        let half = self.field.size()[axis];
        let ahead = (self.cell[axis] + usize::from(u > 0.0)) as f64 * self.step[axis] - half;
        if u == 0.0 {
            f64::INFINITY
        } else {
            (ahead - o) / u
        }
    }

    /// Moves to the next cell, if there is one.
    fn advance(&mut self) {
        let axis = usize::from(self.next.1 < self.next.0);
        let count = [self.field.columns() - 1, self.field.rows() - 1][axis];
        let border = [self.next.0, self.next.1][axis];
        self.now = self.now.max(border);
        let forward = self.line.along[axis] > 0.0;
        let cell = self.cell[axis];
        let last = if forward {
            cell + 1 == count
        } else {
            cell == 0
        };
        let next = if last {
            f64::INFINITY
        } else {
            self.cell[axis] = if forward { cell + 1 } else { cell - 1 };
            self.border(axis)
        };
        *[&mut self.next.0, &mut self.next.1][axis] = next;
    }

    /// Returns the position in the cell, from 0 to 1.
    fn in_cell(&self, at: f64) -> [f64; 2] {
        let p = self.line.at(at);
        [0, 1].map(|axis| {
            let from = self.cell[axis] as f64 * self.step[axis] - self.field.size()[axis];
            (p[axis] - from) / self.step[axis]
        })
    }

    /// Returns the first corner's height and a triangle's slopes along x and y, in units of the cell.
    fn slopes(&self, right: bool) -> (f64, f64, f64) {
        let z = |r: usize, c: usize| self.field.point(self.cell[1] + r, self.cell[0] + c).z;
        let (first, last) = (z(0, 0), z(1, 1));
        if right {
            (first, z(0, 1) - first, last - z(0, 1))
        } else {
            (first, last - z(1, 0), z(1, 0) - first)
        }
    }

    /// Returns the height of the line over the right or left triangle of the cell.
    fn over(&self, at: f64, right: bool) -> f64 {
        let [x, y] = self.in_cell(at);
        let (z, along_x, along_y) = self.slopes(right);
        self.line.at(at).z - (z + along_x * x + along_y * y)
    }

    /// Returns the height of the line over the surface.
    fn height(&self, at: f64) -> f64 {
        let [x, y] = self.in_cell(at);
        self.over(at, x > y)
    }

    /// Returns the first crossing with the surface up to `end`, and its normal.
    fn cross(&self, end: f64, above: bool) -> Option<(f64, Vec3<f64>)> {
        let across = |at| {
            let [x, y] = self.in_cell(at);
            x - y
        };
        let (from, to) = (across(self.now), across(end));
        let diagonal = if (from < 0.0) != (to < 0.0) {
            self.now + (end - self.now) * (from / (from - to))
        } else {
            end
        };
        let right = if from == 0.0 { to > 0.0 } else { from > 0.0 };
        let parts = [(self.now, diagonal, right), (diagonal, end, to > 0.0)];
        parts.into_iter().find_map(|(start, end, right)| {
            let (before, after) = (self.over(start, right), self.over(end, right));
            let crosses = if above { after < 0.0 } else { after > 0.0 };
            if !(crosses && end >= start) {
                return None;
            }
            let share = (before / (before - after)).clamp(0.0, 1.0);
            let (_, along_x, along_y) = self.slopes(right);
            let normal = Vec3::new(-along_x / self.step[0], -along_y / self.step[1], 1.0);
            Some((start + (end - start) * share, normal.normalize().0))
        })
    }
}
