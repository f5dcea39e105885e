//! What the kernels of a batch were made of.

use crate::layout::Layout;
use crate::tables::Tables;
use clench_math::Scalar;
use clench_rigid::contact::Candidate;

/// What the kernels were made of, to which all environments must keep.
pub(crate) struct Base<S> {
    pub words: Vec<u32>,
    pub constants: String,
    pub layout: Layout,
    pub parameters: Vec<S>,
    pub candidates: Vec<Candidate>,
    /// Whether the kernels are such as serve any model.
    pub general_kernels: bool,
}

impl<S: Scalar> Base<S> {
    pub(crate) fn new(tables: &Tables, candidates: Vec<Candidate>) -> Self {
        Base {
            words: tables.words.clone(),
            constants: tables.constants.clone(),
            layout: tables.layout.clone(),
            parameters: tables.numbers_in(),
            candidates,
            general_kernels: tables.general_kernels,
        }
    }
}
