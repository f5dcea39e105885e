//! Where the solver's memory lies: in that of the workgroup, which is near and small, or with the rows of the environment.

use crate::error::GpuError;
use crate::tables::Capacity;
use clench_solver::ConstraintSolver;
use std::fmt::Write;

/// Rows and columns of a tile of H.
const TILE: usize = 16;
/// Vectors over the dofs, of Newton's method and of conjugate gradients.
const NEWTON_VECTORS: usize = 7;
const CG_VECTORS: usize = 10;
/// Newton's method factors Hessians of so many dofs at most.
const MAX_NEWTON_DOFS: usize = 512;
/// The factor of a Hessian of more dofs would leave so little of a card's memory to other workgroups that few could run side by side.
const MAX_SHARED_DOFS: usize = 96;
/// Numbers of the two tiles that are multiplied, of the diagonal, and of what threads add up and hand to each other.
const STAGING: usize = 2 * TILE * 20 + TILE + 4 * 8 + 64;

/// Where a solve keeps what is of the size of the dofs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SolverMemory {
    newton: bool,
    /// Tiles of H in a row, and how many there is room for.
    ntile: usize,
    most: usize,
    share_tiles: bool,
    share_vectors: bool,
}

/// Refuses more dofs than Newton's method is for.
///
/// # Errors
/// That.
pub(crate) fn check_dofs(nv: usize, solver: ConstraintSolver) -> Result<(), GpuError> {
    if solver == ConstraintSolver::Newton && nv > MAX_NEWTON_DOFS {
        return Err(GpuError::TooManyDofs {
            most: MAX_NEWTON_DOFS,
            nv,
        });
    }
    Ok(())
}

impl SolverMemory {
    /// For `nv` dofs, by Newton's method or by conjugate gradients, where a workgroup shares `room` bytes. Kernels that serve any model have
    /// as much of that as those of the most dofs whose factor is shared.
    pub(crate) fn new<S>(
        nv: usize,
        solver: ConstraintSolver,
        room: usize,
        general_kernels: bool,
    ) -> Self {
        let newton = solver == ConstraintSolver::Newton;
        let ntile = nv.div_ceil(TILE);
        let room = room / size_of::<S>();
        let with = |most: usize| {
            let mut memory = SolverMemory {
                newton,
                ntile,
                most,
                share_tiles: TILE * most <= MAX_SHARED_DOFS,
                share_vectors: true,
            };
            memory.share_vectors = STAGING + memory.vectors() <= room;
            // One of the tiles that are multiplied is where the last one of the factor will be.
            let others = memory.tiles().saturating_sub(TILE * TILE);
            let both = STAGING + memory.vectors() + others;
            memory.share_tiles &= memory.share_vectors && both <= room;
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

    /// Numbers of the tiles of a lower triangle; conjugate gradients need none.
    fn tiles(self) -> usize {
        let triangle = TILE * TILE * self.most * (self.most + 1) / 2;
        if self.newton { triangle } else { 0 }
    }

    fn vectors(self) -> usize {
        let count = if self.newton {
            NEWTON_VECTORS
        } else {
            CG_VECTORS
        };
        count * TILE * self.most
    }

    /// Whether M is dense as well.
    fn dense_mass(self) -> bool {
        self.newton && TILE * self.most <= MAX_SHARED_DOFS
    }

    /// Sets aside what lies with the rows, for a mass matrix of `nnz` entries and `nv` dofs.
    pub(crate) fn reserve(self, capacity: &mut Capacity, nnz: usize, nv: usize) {
        capacity.mass = if self.dense_mass() { nv * nv } else { nnz };
        let outside = |shared: bool, size: usize| if shared { 0 } else { size };
        capacity.tiles = outside(self.share_tiles, self.tiles());
        capacity.vectors = outside(self.share_vectors, self.vectors());
    }

    /// Tiles of H in a row.
    pub(crate) fn ntile(self) -> usize {
        self.ntile
    }

    /// The constants that tell the kernels. An array that is not used has one element, since it must have some.
    pub(crate) fn constants(self) -> String {
        let mut text = String::new();
        let inside = |shared: bool, size: usize| if shared { size.max(1) } else { 1 };
        let others = self.tiles().saturating_sub(TILE * TILE);
        let right = if self.share_tiles { others / 4 } else { 0 };
        for (name, value) in [
            ("WIDTH", TILE * self.most),
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
