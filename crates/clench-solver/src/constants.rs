//! The constants of the methods, by their names in the GPU kernels.

use crate::cg::{Cg, OVERLAP};
use crate::continuation::{FIRST, STAGE, STAGE_TOLERANCE, STIFF};
use crate::descent::{Direction, NEGLIGIBLE, NOTICEABLE};
use crate::line_search::{CURVATURE, DECREASE, RESOLUTION};
use crate::newton::Newton;
use crate::normal_forces::{CYCLE, MAX_FULL, MAX_PREDICTIONS, MAX_ROUNDS, MIXING};
use crate::prediction::MIN_COSINE;

/// Names and values.
pub const METHOD_CONSTANTS: &[(&str, f64)] = &[
    ("LINE_SEARCH_RESOLUTION", RESOLUTION),
    ("LINE_SEARCH_CURVATURE", CURVATURE),
    ("LINE_SEARCH_DECREASE", DECREASE),
    ("NEWTON_PATIENCE", <Newton<f64> as Direction<f64>>::PATIENCE),
    ("CG_PATIENCE", <Cg<f64> as Direction<f64>>::PATIENCE),
    ("CG_OVERLAP", OVERLAP),
    ("NEGLIGIBLE_ROUNDINGS", NEGLIGIBLE),
    ("NOTICEABLE_FALL", NOTICEABLE),
    ("MAX_PREDICTIONS", MAX_PREDICTIONS),
    ("MAX_UPDATES", MAX_ROUNDS),
    ("FULL_PREDICTIONS", MAX_FULL),
    ("PREDICTION_CYCLE", CYCLE),
    ("MIN_COSINE", MIN_COSINE),
    ("MIXING_LEAST", MIXING.0),
    ("MIXING_MOST", MIXING.1),
    ("CONTINUATION_STIFF", STIFF),
    ("CONTINUATION_FIRST", FIRST),
    ("CONTINUATION_STAGE", STAGE),
    ("CONTINUATION_SETTLED", STAGE_TOLERANCE),
];
