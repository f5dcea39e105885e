//! The constants of the methods, by their names in the GPU kernels.

use crate::cg::{Cg, OVERLAP};
use crate::continuation::{FIRST, STAGE, STAGE_TOLERANCE, STIFF};
use crate::descent::{Direction, NEGLIGIBLE, NOTICEABLE};
use crate::line_search::{CURVATURE, DECREASE, RESOLUTION};
use crate::newton::Newton;

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
    ("CONTINUATION_STIFF", STIFF),
    ("CONTINUATION_FIRST", FIRST),
    ("CONTINUATION_STAGE", STAGE),
    ("CONTINUATION_SETTLED", STAGE_TOLERANCE),
];
