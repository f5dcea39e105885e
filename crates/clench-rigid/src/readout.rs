//! The results of a step in MuJoCo's terms: constraint rows with pyramid edges, contact forces, dense matrices. For
//! inspection, not for stepping: all functions allocate.

mod blocks;
mod light;
mod push;
mod tendon;

pub use light::light_poses;
pub use push::Push;
pub(crate) use push::pushes;
pub use tendon::TendonLine;
pub(crate) use tendon::tendon_lines;

use crate::output::of_contact;
use blocks::active_blocks;
use clench_dynamics::constraint::ConstraintSource;
use clench_dynamics::contact::Contact;
use clench_dynamics::workspace::Workspace;
use clench_math::{Mask, Real, Scalar};
use clench_solver::{Block, Cost, Partition};
use std::array::from_fn;

/// One constraint row as in MuJoCo's `efc` arrays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstraintRow {
    /// The source of the constraint.
    pub source: ConstraintSource,
    /// The shape of its cost.
    pub cost: Cost,
    /// The index of the row in its constraint; pyramid edges count one by one.
    pub row: usize,
    /// Position: violation of an equality, signed distance of a limit or contact, zero for friction.
    pub pos: f64,
    /// Distance below which it acts.
    pub margin: f64,
    /// Rate of change of the position.
    pub vel: f64,
    /// Reference acceleration.
    pub aref: f64,
    /// Weight D = 1 / R of its cost.
    pub d: f64,
    /// Impedance.
    pub impedance: f64,
    /// Dry friction, otherwise zero.
    pub frictionloss: f64,
    /// Force.
    pub force: f64,
}

/// Returns the constraint rows of lane `lane` in the last constraint stage.
pub fn constraint_rows<T: Real>(ws: &Workspace<T>, lane: usize) -> Vec<ConstraintRow> {
    let mut rows = Vec::new();
    for (index, block) in active_blocks(ws, lane) {
        let record = &ws.record.blocks[index];
        let number = |x: T| x.lane(lane).to_f64();
        let forces = match block.cost.has_edges() {
            true => ws.solver.edge_forces(&ws.problem, index),
            false => &ws.solver.force()[block.rows()],
        };
        let pos = |i: usize| ws.record.pos[block.row + i];
        for (row, edge) in edges(&block, lane).enumerate() {
            let combine = |values: &[T]| edge.combine(values, lane);
            rows.push(ConstraintRow {
                source: record.source,
                cost: block.cost,
                row,
                pos: number(pos(edge.base)),
                margin: if block.cost.is_cone() && edge.base > 0 {
                    0.0
                } else {
                    number(record.margin)
                },
                vel: combine(&ws.record.vel[block.rows()]),
                aref: combine(block.aref),
                d: number(block.d[edge.base]),
                impedance: number(record.impedance),
                frictionloss: match block.cost {
                    Cost::Huber => number(block.shape[row]),
                    Cost::Quadratic
                    | Cost::OneSided
                    | Cost::Pyramid
                    | Cost::Elliptic
                    | Cost::Coulomb => 0.0,
                },
                force: number(forces[row]),
            });
        }
    }
    rows
}

/// Returns the dense Jacobian of lane `lane` (rows as in [`constraint_rows`] × nv), row-major.
pub fn jacobian<T: Real>(ws: &Workspace<T>, lane: usize) -> Vec<f64> {
    let nv = ws.problem.nv();
    let mut dense = Vec::new();
    for (_, block) in active_blocks(ws, lane) {
        let n = block.dofs.len();
        for edge in edges(&block, lane) {
            let start = dense.len();
            dense.resize(start + nv, 0.0);
            let mut add = |row: usize, factor: f64| {
                for (&dof, j) in block.dofs.iter().zip(&block.jacobian[row * n..]) {
                    dense[start + dof as usize] += factor * j.lane(lane).to_f64();
                }
            };
            add(edge.base, 1.0);
            if let Some((row, factor)) = edge.added {
                add(row, factor);
            }
        }
    }
    dense
}

/// Returns the dense mass matrix of lane `lane` (nv × nv).
pub fn mass_matrix<T: Real>(ws: &Workspace<T>, lane: usize) -> Vec<f64> {
    let dense = ws.mass().to_dense(ws.problem.tree());
    dense.iter().map(|x| x.lane(lane).to_f64()).collect()
}

/// Returns the force of contact `contact` of lane `lane` in the contact frame: along normal and tangents (N), about
/// normal and tangents (N m). It acts on the second geom, its negative on the first. Zero without constraint.
pub fn contact_force<T: Real>(ws: &Workspace<T>, contact: usize, lane: usize) -> [f64; 6] {
    let found = ws.contacts.get(contact).and_then(|c| of_contact(ws, c));
    found.map_or([0.0; 6], |force| force.map(|f| f.lane(lane).to_f64()))
}

/// A contact in scalar values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactRow {
    /// The geoms; the normal points from the first to the second.
    pub geoms: [usize; 2],
    /// Dimensions: 1, 3, 4 or 6.
    pub dim: usize,
    /// Signed distance, negative in penetration, m.
    pub dist: f64,
    /// Midpoint between the surfaces, m.
    pub pos: [f64; 3],
    /// Rows: normal, first tangent, second tangent.
    pub frame: [[f64; 3]; 3],
    /// The constraint exists if `dist` is less, m; that of an adhesive contact also beyond.
    pub includemargin: f64,
    /// Adhesion force, N.
    pub adhesion: f64,
    /// Velocity of the second surface minus that of the first along the tangents, m/s, and about the normal, rad/s.
    pub surfacevel: [f64; 3],
    /// Two slides, spin, two rolls.
    pub friction: [f64; 5],
    /// The displacement since it stuck, with the option `stiction`: two slides along the tangents, m; spin and two
    /// rolls, rad.
    pub displacement: [f64; 5],
    /// See [`contact_force`].
    pub force: [f64; 6],
    /// The same force in world axes: force (N), torque about `pos` (N m).
    pub wrench: [f64; 6],
}

/// Returns the contacts of lane `lane` from the last collision stage.
pub fn contact_rows<T: Real>(ws: &Workspace<T>, lane: usize) -> Vec<ContactRow> {
    let found = (ws.contacts.iter().enumerate()).filter(|(_, c)| c.active.lane(lane));
    let number = |x: T| x.lane(lane).to_f64();
    let row = |(index, contact): (usize, &Contact<T>)| {
        let frame = contact.frame.rows.map(|axis| axis.to_array().map(number));
        let force = contact_force(ws, index, lane);
        let turned = |along: &[f64], axis: usize| (0..3).map(|i| frame[i][axis] * along[i]).sum();
        ContactRow {
            geoms: contact.geoms,
            dim: contact.dim,
            dist: number(contact.dist),
            pos: contact.pos.to_array().map(number),
            frame,
            includemargin: number(contact.includemargin),
            adhesion: number(contact.adhesion),
            surfacevel: contact.surfacevel.map(number),
            friction: contact.friction.map(number),
            displacement: ws.stiction.displacement(index).map(number),
            force,
            wrench: from_fn(|i| turned(&force[i / 3 * 3..], i % 3)),
        }
    };
    found.map(row).collect()
}

/// Returns the island of each tree in lane `lane` (ntree), identified by its lowest tree; `None` for a tree without
/// constraints.
pub fn islands<T: Real>(ws: &Workspace<T>, lane: usize) -> Vec<Option<usize>> {
    let mut partition = Partition::default();
    partition.find(&ws.problem);
    let mut of_tree = vec![None; ws.problem.tree().ntree()];
    for island in (partition.islands().iter()).filter(|island| island.lanes.lane(lane)) {
        let trees = partition.trees(island);
        let lowest = trees.iter().min().map(|&tree| tree as usize);
        for &tree in trees {
            of_tree[tree as usize] = lowest;
        }
    }
    of_tree
}

/// An output row: a row of the block, or an edge of a pyramid, y₀ ± μ_j y_j.
struct PyramidEdge {
    base: usize,
    added: Option<(usize, f64)>,
}

impl PyramidEdge {
    fn combine<T: Real>(&self, values: &[T], lane: usize) -> f64 {
        let number = |i: usize| values[i].lane(lane).to_f64();
        match self.added {
            None => number(self.base),
            Some((j, factor)) => number(self.base) + factor * number(j),
        }
    }
}

fn edges<T: Real>(block: &Block<'_, T>, lane: usize) -> impl Iterator<Item = PyramidEdge> {
    let pyramid = block.cost.has_edges();
    let count = if pyramid {
        2 * (block.dim - 1)
    } else {
        block.dim
    };
    let shape = block.shape;
    (0..count).map(move |row| {
        if !pyramid {
            let (base, added) = (row, None);
            return PyramidEdge { base, added };
        }
        let j = 1 + row / 2;
        let mu = shape[j].lane(lane).to_f64();
        let added = Some((j, if row % 2 == 0 { mu } else { -mu }));
        PyramidEdge { base: 0, added }
    })
}
