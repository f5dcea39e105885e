//! What the kernels of a batch were made of.

use crate::tables::Tables;
use clench_rigid::contact::Candidate;

/// What the kernels were made of, to which all environments must keep.
pub(crate) struct Base {
    pub words: Vec<u32>,
    pub constants: String,
    pub parameters: Vec<f32>,
    pub candidates: Vec<Candidate>,
}

impl Base {
    pub(crate) fn new(tables: &Tables, candidates: Vec<Candidate>) -> Self {
        Base {
            words: tables.words.clone(),
            constants: tables.constants.clone(),
            parameters: tables.numbers.clone(),
            candidates,
        }
    }
}
