//! The problem: the data that stay constant during a solve.

use crate::block_index::BlockIndex;
use crate::costs;
use crate::costs::{Cost, MAX_DIM, Rows};
use crate::jacobian::StoredRows;
use crate::runs::runs;
use crate::transfer::Transfer;
use crate::tree::{Tree, TreeFactor, TreeMatrix};
use clench_math::{Mask, Real, kernel};
use std::ops::Range;
use std::sync::Arc;

/// The convex problem. Blocks keep the order in which they were pushed.
#[derive(Clone, Debug)]
pub struct Problem<T> {
    pub(crate) tree: Arc<Tree>,
    /// M.
    pub mass: TreeMatrix<T>,
    /// The factorization of M; see [`factor_mass`](Self::factor_mass).
    pub mass_factor: TreeFactor<T>,
    /// The factorization of the matrix that `noslip` uses in place of M if the metric has couplings: MuJoCo's sweeps
    /// use only their diagonal. Empty if the sweeps use M itself.
    pub noslip_factor: TreeFactor<T>,
    /// Unconstrained acceleration a_unc = M⁻¹ τ, length nv.
    pub qacc_smooth: Vec<T>,
    /// The acceleration −v / h that would end the motion within the step, length nv; empty if it is not known. With it
    /// a solve by CG that reaches its limit of iterations does not add energy.
    pub rest: Vec<T>,
    pub(crate) jacobian: StoredRows<T>,
    pub(crate) aref: Vec<T>,
    pub(crate) r: Vec<T>,
    pub(crate) d: Vec<T>,
    pub(crate) shape: Vec<T>,
    /// The length of the active set.
    pub(crate) nactive: usize,
    /// The number of blocks that are constraints. Later blocks are terms of the metric.
    pub(crate) nconstraint: Option<usize>,
    /// The first block that was pushed with an impossible size.
    pub(crate) malformed: Option<(usize, &'static str)>,
}

/// The part of a problem to copy.
pub(crate) struct Part<'a, T: Real> {
    /// The dofs of complete trees; a parent precedes its children.
    pub dofs: &'a [u32],
    /// Maps a dof to its index in `dofs`.
    pub local: &'a [u32],
    pub blocks: &'a [u32],
    /// The lanes in which each block of the whole acts, and the lanes that have this part. In all others its blocks are
    /// absent, with a zero Jacobian, so that the contents of those lanes have no effect.
    pub acting: &'a [T::Mask],
    pub lanes: T::Mask,
}

/// A new block to be filled in; every slice starts as zeros.
#[derive(Debug)]
pub struct BlockMut<'a, T> {
    /// J, dim × ndofs row-major.
    pub jacobian: &'a mut [T],
    /// The reference value of J a; per row.
    pub aref: &'a mut [T],
    /// The regularization R > 0; per row.
    pub r: &'a mut [T],
    /// D = 1 / R per row, or 0 in lanes that have no such constraint (J, aref and R stay finite there).
    pub d: &'a mut [T],
    /// Huber: η per row. Pyramid and Coulomb: row 0 unused, then μ_j. Elliptic: row 0 the regularized μ = μ₁ √(R₁/R₀),
    /// then μ_j.
    pub shape: &'a mut [T],
}

/// A block of the problem.
#[derive(Clone, Copy, Debug)]
pub struct Block<'a, T> {
    /// The shape of its cost.
    pub cost: Cost,
    /// The index of its first row in the problem.
    pub row: usize,
    /// The number of rows.
    pub dim: usize,
    /// The dofs on which it acts, ascending.
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
    /// Returns the range of its rows in the problem.
    pub fn rows(&self) -> Range<usize> {
        self.row..self.row + self.dim
    }
}

impl<T: Real> Problem<T> {
    /// Creates a problem without constraints and with zero mass. Fill `mass` and `qacc_smooth`, then call
    /// [`factor_mass`](Self::factor_mass).
    pub fn new(tree: Arc<Tree>) -> Self {
        Problem {
            mass: TreeMatrix::zeros(&tree),
            mass_factor: TreeFactor::zeros(&tree),
            noslip_factor: TreeFactor::default(),
            qacc_smooth: vec![T::ZERO; tree.nv()],
            rest: Vec::new(),
            tree,
            jacobian: StoredRows::default(),
            aref: Vec::new(),
            r: Vec::new(),
            d: Vec::new(),
            shape: Vec::new(),
            nactive: 0,
            nconstraint: None,
            malformed: None,
        }
    }

    /// Returns the sparsity of M.
    pub fn tree(&self) -> &Arc<Tree> {
        &self.tree
    }
    /// Returns the number of dofs.
    pub fn nv(&self) -> usize {
        self.tree.nv()
    }
    /// Returns the number of constraint rows.
    pub fn nrow(&self) -> usize {
        self.aref.len()
    }
    /// Returns the number of constraint blocks.
    pub fn nblock(&self) -> usize {
        self.jacobian.blocks.len()
    }

    /// Factors `mass` into `mass_factor`. Returns false in lanes in which it is not positive definite.
    pub fn factor_mass(&mut self) -> T::Mask {
        self.mass_factor.factor(&self.tree, &self.mass)
    }

    /// Removes all blocks and retains their memory.
    pub fn clear_constraints(&mut self) {
        self.jacobian.clear();
        self.aref.clear();
        self.r.clear();
        self.d.clear();
        self.shape.clear();
        self.nactive = 0;
        self.nconstraint = None;
        self.malformed = None;
    }

    /// Removes the derivatives of all blocks.
    pub fn remove_constraint_derivatives(&mut self) {
        for numbers in [
            &mut self.jacobian.values,
            &mut self.aref,
            &mut self.r,
            &mut self.d,
            &mut self.shape,
        ] {
            for x in numbers {
                *x = T::from_value(x.value());
            }
        }
    }

    /// Marks the blocks pushed from here on as terms ½ D (J a − aref)² of the metric: the matrix of the motion is M
    /// plus the sum of their D JᵀJ, and aref = J a_unc. `noslip` distinguishes them from constraints.
    pub fn begin_metric_terms(&mut self) {
        self.nconstraint = Some(self.nblock());
    }

    /// Returns the blocks that are constraints, and those that are terms of the metric.
    pub(crate) fn constraints_and_terms(&self) -> (&[BlockIndex], &[BlockIndex]) {
        let blocks = &self.jacobian.blocks;
        blocks.split_at(self.nconstraint.unwrap_or(blocks.len()))
    }

    /// Appends a block of `dim` rows (1 to 6) that acts on `dofs` (ascending) and returns it to be filled in. A solve
    /// reports an error for a block of impossible size.
    pub fn push(&mut self, cost: Cost, dim: usize, dofs: &[u32]) -> BlockMut<'_, T> {
        if let (None, Err(reason)) = (self.malformed, check_size(cost, dim, dofs, self.nv())) {
            self.malformed = Some((self.nblock(), reason));
        }
        let row = self.nrow();
        self.jacobian.push(
            BlockIndex {
                cost,
                dim,
                ndof: dofs.len(),
                row,
                dof: self.jacobian.dofs.len(),
                value: self.jacobian.values.len(),
                active_start: self.nactive,
            },
            dofs,
        );
        self.nactive += costs::active_len(cost, dim);
        // A constant number of stores first: a resize that grows by an unknown number calls the system's library.
        for pool in [&mut self.aref, &mut self.r, &mut self.d, &mut self.shape] {
            pool.extend_from_slice(&[T::ZERO; MAX_DIM]);
            pool.resize(row + dim, T::ZERO);
        }
        self.last_block_mut()
    }

    /// Returns the block that was pushed last.
    ///
    /// # Panics
    /// Panics if the problem has no blocks.
    pub fn last_block_mut(&mut self) -> BlockMut<'_, T> {
        let last = self.jacobian.blocks[self.jacobian.blocks.len() - 1];
        let rows = last.rows();
        BlockMut {
            jacobian: self.jacobian.values_mut(&last),
            aref: &mut self.aref[rows.clone()],
            r: &mut self.r[rows.clone()],
            d: &mut self.d[rows.clone()],
            shape: &mut self.shape[rows],
        }
    }

    /// Returns the blocks in the order in which they were pushed.
    pub fn blocks(&self) -> impl ExactSizeIterator<Item = Block<'_, T>> {
        self.jacobian.blocks.iter().map(|b| self.view(b))
    }

    /// Returns block `i`.
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

    /// Returns the cost parameters of one block.
    #[inline(always)]
    pub(crate) fn rows(&self, b: &BlockIndex) -> Rows<'_, T> {
        let rows = b.rows();
        Rows {
            d: &self.d[rows.clone()],
            r: &self.r[rows.clone()],
            shape: &self.shape[rows],
            softer: T::ZERO,
            lambda: T::ZERO,
        }
    }

    /// Returns true if another problem has the same tree, blocks and numbers.
    pub(crate) fn equals(&self, other: &Self) -> bool {
        let same =
            |a: &[T], b: &[T]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.eq(*b).all());
        self.tree.parents() == other.tree.parents()
            && self.nconstraint == other.nconstraint
            && self.jacobian.blocks == other.jacobian.blocks
            && self.jacobian.dofs == other.jacobian.dofs
            && same(&self.jacobian.values, &other.jacobian.values)
            && same(&self.mass.values, &other.mass.values)
            && same(&self.qacc_smooth, &other.qacc_smooth)
            && same(&self.rest, &other.rest)
            && same(&self.aref, &other.aref)
            && same(&self.r, &other.r)
            && same(&self.d, &other.d)
            && same(&self.shape, &other.shape)
    }

    /// Copies a part of `whole` into this problem.
    pub(crate) fn gather<L: Real>(
        &mut self,
        whole: &Problem<L>,
        part: &Part<L>,
        transfer: impl Transfer<L, T>,
    ) {
        let (dofs, local) = (part.dofs, part.local);
        let from = &*whole.tree;
        let parent = |i: usize| from.parent(dofs[i] as usize).map(|p| local[p] as usize);
        let same =
            self.nv() == dofs.len() && (0..dofs.len()).all(|i| self.tree.parent(i) == parent(i));
        if !same {
            // Only this problem owns the tree of a gathered problem, except the empty one it starts with.
            let ascending = Arc::make_mut(&mut self.tree).rebuild(dofs.len(), parent);
            debug_assert!(
                ascending.is_ok(),
                "a part of a tree is numbered like the tree"
            );
        }
        self.mass.values.clear();
        self.qacc_smooth.clear();
        self.rest.clear();
        for run in runs(dofs) {
            let rows = from.row_start(run.start)..from.row_start(run.end);
            for (to, from) in [
                (&mut self.mass.values, &whole.mass.values[rows]),
                (&mut self.qacc_smooth, &whole.qacc_smooth[run.clone()]),
                (&mut self.rest, whole.rest.get(run).unwrap_or_default()),
            ] {
                to.extend(from.iter().map(|&x| transfer.convert(x)));
            }
        }
        self.mass_factor
            .gather(from, &whole.mass_factor, dofs, transfer);
        if whole.noslip_factor.is_empty() {
            self.noslip_factor.clear();
        } else {
            self.noslip_factor
                .gather(from, &whole.noslip_factor, dofs, transfer);
        }
        self.gather_blocks(whole, part, transfer);
    }

    /// Copies the blocks of a part.
    #[kernel]
    fn gather_blocks<L: Real>(
        &mut self,
        whole: &Problem<L>,
        part: &Part<L>,
        transfer: impl Transfer<L, T>,
    ) {
        self.clear_constraints();
        self.nconstraint =
            (whole.nconstraint).map(|count| part.blocks.partition_point(|&k| (k as usize) < count));
        for &k in part.blocks {
            let b = &whole.jacobian.blocks[k as usize];
            let lanes = part.lanes & part.acting[k as usize];
            let dofs = whole.jacobian.dofs(b).iter();
            self.jacobian.push_copy(
                b,
                (self.aref.len(), self.nactive),
                dofs.map(|&dof| part.local[dof as usize]),
                whole.jacobian.values(b),
                #[inline(always)]
                |j| transfer.convert_in(lanes, j, L::ZERO),
            );
            self.nactive += b.active_range().len();
            for (to, from, absent) in [
                (&mut self.aref, &whole.aref, L::ZERO),
                (&mut self.r, &whole.r, L::ONE),
                (&mut self.d, &whole.d, L::ZERO),
                (&mut self.shape, &whole.shape, L::ONE),
            ] {
                to.extend(from[b.rows()].iter().map(
                    #[inline(always)]
                    |&x| transfer.convert_in(lanes, x, absent),
                ));
            }
        }
    }
}

/// Checks that a block over these dofs can be stored and indexed.
pub(crate) fn check_size(
    cost: Cost,
    dim: usize,
    dofs: &[u32],
    nv: usize,
) -> Result<(), &'static str> {
    if !(1..=MAX_DIM).contains(&dim) {
        return Err("a block has 1 to 6 rows");
    }
    if cost.is_cone() && dim < 2 {
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
