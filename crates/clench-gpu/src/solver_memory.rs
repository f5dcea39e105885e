//! The placement of the solver's memory: in workgroup memory, which is fast and small, or with the rows of the
//! environment.

use crate::error::GpuError;
use crate::tables::Capacity;
use clench_solver::ConstraintSolver;
use std::fmt::Write;

/// The rows and columns of a tile of H.
pub(crate) const TILE: usize = 16;
/// The vectors over the dofs, for Newton's method and conjugate gradients.
const NEWTON_VECTORS: usize = 7;
const CG_VECTORS: usize = 10;
/// The maximum number of dofs for Newton's method.
const MAX_NEWTON_DOFS: usize = 512;
/// The maximum number of dofs whose Hessian factor is in workgroup memory. A larger factor would leave a GPU memory for
/// few concurrent workgroups.
const MAX_SHARED_DOFS: usize = 96;
/// The numbers of the two tiles that are multiplied, of the diagonal, and of reductions and exchanges between threads.
const STAGING: usize = 2 * TILE * 20 + TILE + 4 * 8 + 64;

/// The placement of a solve's data whose size depends on the dofs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SolverMemory {
    newton: bool,
    /// The tiles of H in a row, and the maximum that the memory is for.
    ntile: usize,
    max_tiles: usize,
    share_tiles: bool,
    share_vectors: bool,
}

/// Checks the number of dofs for Newton's method.
///
/// # Errors
/// Returns an error if there are too many.
pub(crate) fn check_dofs(nv: usize, solver: ConstraintSolver) -> Result<(), GpuError> {
    if solver == ConstraintSolver::Newton && nv > MAX_NEWTON_DOFS {
        return Err(GpuError::TooManyDofs {
            max: MAX_NEWTON_DOFS,
            nv,
        });
    }
    Ok(())
}

impl SolverMemory {
    /// Chooses the placement for `nv` dofs and a solver if workgroup memory has `available` bytes. Kernels that serve
    /// any model use as much of it as those with the most dofs whose factor is shared.
    pub(crate) fn new<S>(
        nv: usize,
        solver: ConstraintSolver,
        available: usize,
        general_kernels: bool,
    ) -> Self {
        let newton = solver == ConstraintSolver::Newton;
        let ntile = nv.div_ceil(TILE);
        let available = available / size_of::<S>();
        let with = |max_tiles: usize| {
            let mut memory = SolverMemory {
                newton,
                ntile,
                max_tiles,
                share_tiles: TILE * max_tiles <= MAX_SHARED_DOFS,
                share_vectors: true,
            };
            memory.share_vectors = STAGING + memory.vectors() <= available;
            // One of the tiles that are multiplied occupies the memory of the last tile of the factor.
            let others = memory.tiles().saturating_sub(TILE * TILE);
            let both = STAGING + memory.vectors() + others;
            memory.share_tiles &= memory.share_vectors && both <= available;
            memory
        };
        if general_kernels {
            let larger = (ntile + 1..=MAX_SHARED_DOFS / TILE).rev();
            if let Some(shared) = larger.map(with).find(|memory| memory.share_tiles) {
                return shared;
            }
        }
        with(ntile)
    }

    /// Returns the numbers of the tiles of a lower triangle; zero for conjugate gradients.
    fn tiles(self) -> usize {
        let triangle = TILE * TILE * self.max_tiles * (self.max_tiles + 1) / 2;
        if self.newton { triangle } else { 0 }
    }

    fn vectors(self) -> usize {
        let count = if self.newton {
            NEWTON_VECTORS
        } else {
            CG_VECTORS
        };
        count * TILE * self.max_tiles
    }

    /// Returns true if M is also stored densely.
    fn dense_mass(self) -> bool {
        self.newton && TILE * self.max_tiles <= MAX_SHARED_DOFS
    }

    /// Reserves the memory with the rows for a mass matrix of `nnz` entries and `nv` dofs.
    pub(crate) fn reserve(self, capacity: &mut Capacity, nnz: usize, nv: usize) {
        capacity.mass = if self.dense_mass() { nv * nv } else { nnz };
        let outside = |shared: bool, size: usize| if shared { 0 } else { size };
        capacity.tiles = outside(self.share_tiles, self.tiles());
        capacity.vectors = outside(self.share_vectors, self.vectors());
    }

    /// Returns the tiles of H in a row.
    pub(crate) fn ntile(self) -> usize {
        self.ntile
    }

    /// Returns the constants for the kernels. An unused array has one element, the minimum.
    pub(crate) fn constants(self) -> String {
        let mut text = String::new();
        let inside = |shared: bool, size: usize| if shared { size.max(1) } else { 1 };
        let others = self.tiles().saturating_sub(TILE * TILE);
        let right = if self.share_tiles { others / 4 } else { 0 };
        for (name, value) in [
            ("TILE", TILE),
            ("WIDTH", TILE * self.max_tiles),
            ("RIGHT", right),
            ("SHARED_VECTORS", inside(self.share_vectors, self.vectors())),
        ] {
            let _ = writeln!(text, "const {name}: u32 = {value}u;");
        }
        for (name, value) in [
            ("NEWTON", self.newton),
            ("DENSE_MASS", self.dense_mass()),
            ("SHARE_TILES", self.share_tiles),
            ("SHARE_VECTORS", self.share_vectors),
            (
                "SHARE_ALL",
                self.share_vectors && (self.share_tiles || !self.newton),
            ),
        ] {
            let _ = writeln!(text, "const {name}: bool = {value};");
        }
        text
    }
}
