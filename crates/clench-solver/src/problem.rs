//! The problem: what stays constant during a solve.

use crate::costs::{self, MAX_DIM, Rows};
use crate::jacobian::{BlockIndex, StoredRows};
use crate::{Tree, TreeFactor, TreeMatrix};
use clench_math::{Mask, Real, Scalar};
use std::ops::Range;
use std::sync::Arc;

/// The shape of a constraint's cost s(y), y = J a − aref.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Cost {
    /// ½ D y² always: equalities.
    #[default]
    Quadratic,
    /// ½ D y² where y < 0: limits, frictionless contacts.
    OneSided,
    /// ½ D y² near zero, η |y| − ½ R η² beyond: dry friction of loss η.
    Huber,
    /// One-sided on each of the 2 (dim − 1) edges y₀ ± μ_j y_j: frictional contact, linearised.
    Pyramid,
    /// Distance to a circular cone after scaling: frictional contact, exact.
    Elliptic,
}

/// Why a problem is not one.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProblemError {
    /// Tree numbering.
    #[error("dof {dof} has parent {parent}, which does not come before it")]
    ParentAfterChild {
        /// The child.
        dof: usize,
        /// Its parent.
        parent: usize,
    },
    /// A slice of the wrong length.
    #[error("{what} has {found} entries where {expected} are needed")]
    WrongLength {
        /// Which array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it needs.
        expected: usize,
    },
    /// An infinite or undefined number.
    #[error("{what} is not finite at entry {index} (lane {lane})")]
    NotFinite {
        /// Which array.
        what: &'static str,
        /// Where in it.
        index: usize,
        /// Which lane.
        lane: usize,
    },
    /// The mass matrix cannot be factored.
    #[error("the mass matrix is not positive definite (lane {lane})")]
    MassNotPositiveDefinite {
        /// Which lane.
        lane: usize,
    },
    /// A block that makes no sense.
    #[error("constraint block {block}: {reason}")]
    Block {
        /// Which block.
        block: usize,
        /// What is wrong with it.
        reason: &'static str,
    },
}

/// The convex problem. Blocks stay in the order in which they were pushed.
#[derive(Clone, Debug)]
pub struct Problem<T> {
    tree: Arc<Tree>,
    /// M.
    pub mass: TreeMatrix<T>,
    /// The factorization of M; see [`factor_mass`](Self::factor_mass).
    pub mass_factor: TreeFactor<T>,
    /// Unconstrained acceleration a_unc = M⁻¹ τ, length nv.
    pub qacc_smooth: Vec<T>,
    pub(crate) jacobian: StoredRows<T>,
    pub(crate) aref: Vec<T>,
    pub(crate) r: Vec<T>,
    pub(crate) d: Vec<T>,
    pub(crate) shape: Vec<T>,
    /// Total number of pieces.
    pub(crate) npiece: usize,
    /// The first block that was pushed with an impossible size.
    malformed: Option<(usize, &'static str)>,
}

/// A new block to be filled in: every slice starts as zeros.
#[derive(Debug)]
pub struct BlockMut<'a, T> {
    /// J, dim × ndofs row-major.
    pub jacobian: &'a mut [T],
    /// What the constraint asks of J a; per row.
    pub aref: &'a mut [T],
    /// Regularization R > 0; per row.
    pub r: &'a mut [T],
    /// D = 1 / R per row, or 0 in lanes that have no such constraint (J, aref and R stay finite there).
    pub d: &'a mut [T],
    /// Huber: η per row. Pyramid: row 0 unused, then μ_j. Elliptic: row 0 the regularized μ = μ₁ √(R₁/R₀), then μ_j.
    pub shape: &'a mut [T],
}

/// A block as it lies in the problem.
#[derive(Clone, Copy, Debug)]
pub struct Block<'a, T> {
    /// Shape of its cost.
    pub cost: Cost,
    /// Its first row among all rows.
    pub row: usize,
    /// Number of rows.
    pub dim: usize,
    /// The dofs it acts on, ascending.
    pub dofs: &'a [u32],
    /// J, dim × ndofs row-major.
    pub jacobian: &'a [T],
    /// See [`BlockMut`].
    pub aref: &'a [T],
    /// See [`BlockMut`].
    pub r: &'a [T],
    /// See [`BlockMut`].
    pub d: &'a [T],
    /// See [`BlockMut`].
    pub shape: &'a [T],
}

impl<T> Block<'_, T> {
    /// Its rows among all rows of the problem.
    pub fn rows(&self) -> Range<usize> {
        self.row..self.row + self.dim
    }
}

impl<T: Real> Problem<T> {
    /// A problem without constraints, with zero mass: fill `mass` and `qacc_smooth`, then call
    /// [`factor_mass`](Self::factor_mass).
    pub fn new(tree: Arc<Tree>) -> Self {
        Problem {
            mass: TreeMatrix::zeros(&tree),
            mass_factor: TreeFactor::zeros(&tree),
            qacc_smooth: vec![T::ZERO; tree.nv()],
            tree,
            jacobian: StoredRows::default(),
            aref: Vec::new(),
            r: Vec::new(),
            d: Vec::new(),
            shape: Vec::new(),
            npiece: 0,
            malformed: None,
        }
    }

    /// The sparsity of M.
    pub fn tree(&self) -> &Arc<Tree> {
        &self.tree
    }
    /// Number of dofs.
    pub fn nv(&self) -> usize {
        self.tree.nv()
    }
    /// Number of constraint rows.
    pub fn nrow(&self) -> usize {
        self.aref.len()
    }
    /// Number of constraint blocks.
    pub fn nblock(&self) -> usize {
        self.jacobian.blocks.len()
    }

    /// Factors `mass` into `mass_factor`. False in lanes where it is not positive definite.
    pub fn factor_mass(&mut self) -> T::Mask {
        self.mass_factor.factor(&self.tree, &self.mass)
    }

    /// Removes all blocks and keeps their memory.
    pub fn clear_constraints(&mut self) {
        self.jacobian.clear();
        self.aref.clear();
        self.r.clear();
        self.d.clear();
        self.shape.clear();
        self.npiece = 0;
        self.malformed = None;
    }

    /// Appends a block of `dim` rows (1 to 6) that acts on `dofs` (ascending) and returns it to be filled in.
    /// A block of impossible size is reported by the solve.
    pub fn push(&mut self, cost: Cost, dim: usize, dofs: &[u32]) -> BlockMut<'_, T> {
        if let (None, Err(reason)) = (self.malformed, check_size(cost, dim, dofs, self.nv())) {
            self.malformed = Some((self.nblock(), reason));
        }
        let row = self.nrow();
        let jacobian = self.jacobian.push(
            BlockIndex {
                cost,
                dim,
                ndof: dofs.len(),
                row,
                dof: self.jacobian.dofs.len(),
                value: self.jacobian.values.len(),
                piece: self.npiece,
            },
            dofs,
        );
        self.npiece += costs::pieces(cost, dim);
        for pool in [&mut self.aref, &mut self.r, &mut self.d, &mut self.shape] {
            pool.resize(row + dim, T::ZERO);
        }
        BlockMut {
            jacobian,
            aref: &mut self.aref[row..],
            r: &mut self.r[row..],
            d: &mut self.d[row..],
            shape: &mut self.shape[row..],
        }
    }

    /// The blocks in the order in which they were pushed.
    pub fn blocks(&self) -> impl ExactSizeIterator<Item = Block<'_, T>> {
        self.jacobian.blocks.iter().map(|b| self.view(b))
    }

    /// Block `i`.
    pub fn block(&self, i: usize) -> Block<'_, T> {
        self.view(&self.jacobian.blocks[i])
    }

    fn view(&self, b: &BlockIndex) -> Block<'_, T> {
        let rows = b.row..b.row + b.dim;
        Block {
            cost: b.cost,
            row: b.row,
            dim: b.dim,
            dofs: self.jacobian.dofs(b),
            jacobian: self.jacobian.values(b),
            aref: &self.aref[rows.clone()],
            r: &self.r[rows.clone()],
            d: &self.d[rows.clone()],
            shape: &self.shape[rows],
        }
    }

    /// The cost parameters of one block.
    #[inline(always)]
    pub(crate) fn rows(&self, b: &BlockIndex) -> Rows<'_, T> {
        let rows = b.rows();
        Rows {
            d: &self.d[rows.clone()],
            r: &self.r[rows.clone()],
            shape: &self.shape[rows],
            softer: T::ZERO,
        }
    }

    /// Becomes the part of `whole` that `dofs` and `blocks` name; `local` maps its dofs to their place in `dofs`.
    pub(crate) fn gather(
        &mut self,
        whole: &Problem<T>,
        dofs: &[u32],
        local: &[u32],
        blocks: &[u32],
    ) {
        let from = &*whole.tree;
        let parent = |i: usize| from.parent(dofs[i] as usize).map(|p| local[p] as usize);
        let same =
            self.nv() == dofs.len() && (0..dofs.len()).all(|i| self.tree.parent(i) == parent(i));
        if !same {
            // The tree of a gathered problem is nobody else's, but for the empty one it starts with.
            let ascending = Arc::make_mut(&mut self.tree).rebuild(dofs.len(), parent);
            debug_assert!(
                ascending.is_ok(),
                "a part of a tree is numbered like the tree"
            );
        }
        self.mass.values.clear();
        self.qacc_smooth.clear();
        for &dof in dofs {
            self.mass
                .values
                .extend_from_slice(whole.mass.row(from, dof as usize));
            self.qacc_smooth.push(whole.qacc_smooth[dof as usize]);
        }
        self.mass_factor.gather(from, &whole.mass_factor, dofs);
        self.clear_constraints();
        for &k in blocks {
            let b = &whole.jacobian.blocks[k as usize];
            let dofs = whole
                .jacobian
                .dofs(b)
                .iter()
                .map(|&dof| local[dof as usize]);
            self.jacobian.push_copy(
                b,
                self.aref.len(),
                self.npiece,
                dofs,
                whole.jacobian.values(b).iter().copied(),
            );
            self.npiece += b.pieces().len();
            self.aref.extend_from_slice(&whole.aref[b.rows()]);
            self.r.extend_from_slice(&whole.r[b.rows()]);
            self.d.extend_from_slice(&whole.d[b.rows()]);
            self.shape.extend_from_slice(&whole.shape[b.rows()]);
        }
    }

    /// Becomes lane `lane` of `whole`, with those of its blocks that `blocks` names.
    pub(crate) fn gather_lane<L: Real<Scalar = T>>(
        &mut self,
        whole: &Problem<L>,
        lane: usize,
        blocks: &[u32],
    ) {
        if !Arc::ptr_eq(&self.tree, &whole.tree) {
            self.tree = whole.tree.clone();
        }
        let copy = |to: &mut Vec<T>, from: &[L]| to.extend(from.iter().map(|x| x.lane(lane)));
        self.mass.values.clear();
        self.qacc_smooth.clear();
        copy(&mut self.mass.values, &whole.mass.values);
        copy(&mut self.qacc_smooth, &whole.qacc_smooth);
        self.mass_factor.gather_lane(&whole.mass_factor, lane);
        self.clear_constraints();
        for &k in blocks {
            let b = &whole.jacobian.blocks[k as usize];
            let values = whole.jacobian.values(b).iter().map(|x| x.lane(lane));
            let dofs = whole.jacobian.dofs(b).iter().copied();
            self.jacobian
                .push_copy(b, self.aref.len(), self.npiece, dofs, values);
            self.npiece += b.pieces().len();
            copy(&mut self.aref, &whole.aref[b.rows()]);
            copy(&mut self.r, &whole.r[b.rows()]);
            copy(&mut self.d, &whole.d[b.rows()]);
            copy(&mut self.shape, &whole.shape[b.rows()]);
        }
    }

    /// Checks the sizes that a solve indexes by.
    pub(crate) fn check_sizes(&self) -> Result<(), ProblemError> {
        check_length("qacc_smooth", self.qacc_smooth.len(), self.nv())?;
        check_length("mass", self.mass.values.len(), self.tree.nnz())?;
        match self.malformed {
            Some((block, reason)) => Err(ProblemError::Block { block, reason }),
            None => Ok(()),
        }
    }

    /// Checks everything that a solve relies on: lengths, finite numbers, a positive definite M, and for each block the
    /// range of its parameters. A solve itself does not check, so that a caller that builds blocks by rule pays nothing.
    ///
    /// # Errors
    /// The first thing found wrong.
    pub fn check(&self) -> Result<(), ProblemError> {
        self.check_sizes()?;
        for (what, values) in [
            ("qacc_smooth", &self.qacc_smooth),
            ("mass", &self.mass.values),
            ("jacobian", &self.jacobian.values),
            ("aref", &self.aref),
            ("r", &self.r),
            ("d", &self.d),
            ("shape", &self.shape),
        ] {
            check_finite(what, values)?;
        }
        let positive = TreeFactor::zeros(&self.tree).factor(&self.tree, &self.mass);
        if let Some(lane) = (0..T::LANES).find(|&lane| !positive.lane(lane)) {
            return Err(ProblemError::MassNotPositiveDefinite { lane });
        }
        for (block, view) in self.blocks().enumerate() {
            check_block(&view).map_err(|reason| ProblemError::Block { block, reason })?;
        }
        Ok(())
    }
}

pub(crate) fn check_length(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), ProblemError> {
    if found == expected {
        Ok(())
    } else {
        Err(ProblemError::WrongLength {
            what,
            found,
            expected,
        })
    }
}

fn check_finite<T: Real>(what: &'static str, values: &[T]) -> Result<(), ProblemError> {
    for (index, value) in values.iter().enumerate() {
        let finite = value.is_finite();
        if let Some(lane) = (0..T::LANES).find(|&lane| !finite.lane(lane)) {
            return Err(ProblemError::NotFinite { what, index, lane });
        }
    }
    Ok(())
}

/// How far D may be from 1 / R, and the rows of an elliptic block from their common scale.
const CONSISTENT: f64 = 1e-4;

fn check_size(cost: Cost, dim: usize, dofs: &[u32], nv: usize) -> Result<(), &'static str> {
    let cone = matches!(cost, Cost::Pyramid | Cost::Elliptic);
    if !(1..=MAX_DIM).contains(&dim) {
        return Err("a block has 1 to 6 rows");
    }
    if cone && dim < 2 {
        return Err("a cone has 2 to 6 rows");
    }
    if dofs.windows(2).any(|w| w[0] >= w[1]) {
        return Err("its dofs do not ascend");
    }
    if dofs.last().is_some_and(|&dof| dof as usize >= nv) {
        return Err("it acts on a dof that the tree does not have");
    }
    Ok(())
}

fn check_block<T: Real>(block: &Block<T>) -> Result<(), &'static str> {
    for lane in 0..T::LANES {
        let at = |values: &[T], row: usize| values[row].lane(lane).to_f64();
        for row in 0..block.dim {
            let (r, d, shape) = (at(block.r, row), at(block.d, row), at(block.shape, row));
            if d < 0.0 {
                return Err("D is negative");
            }
            if d > 0.0 && (d * r - 1.0).abs() > CONSISTENT {
                return Err("D is not 1 / R");
            }
            if block.cost == Cost::Huber && shape < 0.0 {
                return Err("a friction loss is negative");
            }
        }
        if at(block.d, 0) == 0.0 {
            continue;
        }
        if matches!(block.cost, Cost::Pyramid | Cost::Elliptic)
            && (1..block.dim).any(|j| at(block.shape, j) <= 0.0)
        {
            return Err("a friction coefficient is not positive");
        }
        if block.cost == Cost::Pyramid && (1..block.dim).any(|j| at(block.d, j) != at(block.d, 0)) {
            return Err("the rows of a pyramid need the same D");
        }
        if block.cost == Cost::Elliptic {
            let mu = at(block.shape, 0);
            if mu <= 0.0 {
                return Err("the regularized friction coefficient is not positive");
            }
            let scale = at(block.d, 0) / (mu * mu);
            let consistent = |j| {
                (at(block.d, j) / (scale * at(block.shape, j).powi(2)) - 1.0).abs() < CONSISTENT
            };
            if !(1..block.dim).all(consistent) {
                return Err("the rows of an elliptic cone need D_j = D_0 (mu_j / mu)²");
            }
        }
    }
    Ok(())
}
