//! The plan of a batch: the tables of its model, the fields of its memory, and the text before its kernels.

use crate::base::Base;
use crate::fields::{self, Fields};
use crate::kernel_options::KernelOptions;
use crate::kernels::{Memory, Preface, preface};
use crate::precision::GpuReal;
use crate::solver_memory::SolverMemory;
use crate::tables::{Capacity, Tables, ray_count, taxel_count};
use clench_rigid::contact::Candidate;
use clench_rigid::model::Model;
use clench_rigid::settings::StepSettings;

/// The plan of a batch.
pub(crate) struct Plan<S> {
    pub base: Base<S>,
    pub tables: Tables,
    pub capacity: Capacity,
    pub state: Fields,
    pub work: Fields,
    pub rows: Fields,
    pub reports: Fields,
    pub preface: Preface,
}

impl<S: GpuReal> Plan<S> {
    /// Plans a batch whose geoms collide in the given pairs, on a device whose workgroups have `available` bytes.
    pub(crate) fn new(
        model: &Model,
        settings: &StepSettings,
        pairs: Vec<Candidate>,
        kernels: KernelOptions,
        available: usize,
    ) -> Self {
        let method = settings.solver.constraint_solver;
        let solver = SolverMemory::new::<S>(model.nv, method, available, kernels.general);
        let (mut tables, mut capacity) = Tables::new::<S>(model, settings, &pairs, kernels);
        solver.reserve(&mut capacity, model.tree.nnz(), model.nv);
        let base = Base::new(&tables, pairs, kernels);
        tables.shapes(model, &base.candidates);
        tables.ray_shapes(model);
        tables.solid_shapes(model);
        tables.skins(model);
        let state = fields::state_fields(model, capacity);
        let work = fields::work_fields(model, capacity);
        let thread = fields::thread_fields(model, capacity);
        let rows = fields::row_fields(model, capacity);
        let reports = fields::report_fields(model, capacity);
        tables.initial_state(model, &state);
        let memory = Memory {
            state: &state,
            work: &work,
            thread: &thread,
            threads: capacity.threads,
            rays: ray_count(model),
            taxels: taxel_count(model),
            rows: &rows,
            reports: &reports,
            solver,
        };
        let preface = preface(&tables, &memory);
        Plan {
            base,
            tables,
            capacity,
            state,
            work,
            rows,
            reports,
            preface,
        }
    }

    /// Returns the bytes of an environment's state, work, rows and reports.
    pub(crate) fn sizes(&self) -> [usize; 4] {
        let of_numbers = |fields: &Fields| size_of::<S>() * fields.size;
        let [state, work, rows] = [&self.state, &self.work, &self.rows].map(of_numbers);
        [state, work, rows, 4 * self.reports.size]
    }
}
