//! The data from which the kernels of a batch were built.

use crate::kernel_options::KernelOptions;
use crate::layout::Layout;
use crate::tables::Tables;
use clench_math::Scalar;
use clench_rigid::contact::Candidate;

/// The data from which the kernels were built; all environments must match it.
pub(crate) struct Base<S> {
    pub words: Vec<u32>,
    pub constants: String,
    pub layout: Layout,
    pub parameters: Vec<S>,
    pub candidates: Vec<Candidate>,
    pub kernels: KernelOptions,
}

impl<S: Scalar> Base<S> {
    pub(crate) fn new(tables: &Tables, candidates: Vec<Candidate>, kernels: KernelOptions) -> Self {
        Base {
            words: tables.words.clone(),
            constants: tables.constants.clone(),
            layout: tables.layout.clone(),
            parameters: tables.numbers_in(),
            candidates,
            kernels,
        }
    }
}
