//! The tolerances of shapes and of the closed forms, by the names that the GPU kernels have for them.

use super::{box_box, cylinder, plane_mesh};
use crate::{hull, shape};

/// Names and values.
pub const SHAPE_CONSTANTS: &[(&str, f64)] = &[
    ("BOX_EDGE_BIAS", box_box::EDGE_BIAS),
    ("BOX_ALIAS_COSINE", box_box::ALIAS_COSINE),
    ("BOX_ALIAS_SHARE", box_box::ALIAS_SHARE),
    ("CAPSULE_LEVEL_SINE", cylinder::LEVEL_SINE),
    ("PLANE_SAME_POINT", plane_mesh::SAME),
    ("PLANE_MISS", plane_mesh::MISSED),
    ("FACE_COSINE", hull::FACE_COSINE),
    ("EDGE_SINE", shape::EDGE_SINE),
    ("CAP_TILT", shape::TILT),
    ("HULL_NOTICEABLE", shape::NOTICEABLE),
    ("HULL_LEVEL", shape::LEVEL),
    ("HULL_ASIDE_X", shape::ASIDE[0]),
    ("HULL_ASIDE_Y", shape::ASIDE[1]),
    ("HULL_ASIDE_Z", shape::ASIDE[2]),
    ("HULL_TIE", shape::TIE),
];
