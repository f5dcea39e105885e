//! The numbers of the methods for convex shapes, by the names that the GPU kernels have for them.

use super::{clipping, ellipse, epa, gjk, overlap, polytope, prism, refine, terrain};
use crate::distance::{MIN_SEARCH_SHARE, SEARCH_GROWTH};
use crate::protrusion;

/// Names and values of tolerances.
pub const CONVEX_CONSTANTS: &[(&str, f64)] = &[
    ("PATCH_SAME_POINT", overlap::SAME_POINT),
    ("PATCH_MISS", overlap::MAX_MISS),
    ("PATCH_EXTENSION", overlap::EXTENSION),
    ("PATCH_MAX_EXTENSION", overlap::MAX_EXTENSION),
    ("EPA_SLACK", epa::SLACK),
    ("EPA_NEAR", epa::NEAR),
    ("EPA_FAR", epa::FAR),
    ("CLIP_PARALLEL", clipping::PARALLEL),
    ("CLIP_BEYOND_END", clipping::BEYOND_END),
    ("POLYTOPE_SAME_VERTEX", polytope::SAME),
    ("GJK_MAX_DIFFERENCE", gjk::MAX_DIFFERENCE),
    ("REFINE_MAX_ROTATION", refine::MAX_ROTATION),
    ("PRISM_WALL_RISE", prism::RISE),
    ("MANIFOLD_SAME_POINT", terrain::SAME),
    ("TERRAIN_FACE_DEPTH_RATIO", terrain::FACE_DEPTH_RATIO),
    ("TERRAIN_FACE_NORMAL_RATIO", terrain::FACE_NORMAL_RATIO),
    ("TERRAIN_CLEAR", terrain::CLEAR),
    ("TERRAIN_LEAST_SEARCH", MIN_SEARCH_SHARE),
    ("TERRAIN_SEARCH_GROWTH", SEARCH_GROWTH),
    ("ASCENT_FIRST_STEP", protrusion::FIRST_STEP),
];

/// Names and values of limits.
pub const CONVEX_COUNTS: &[(&str, usize)] = &[
    ("GJK_ROUNDS", gjk::MAX_ITERATIONS),
    ("REFINE_STEPS", refine::MAX_STEPS),
    ("REFINE_HALVINGS", refine::MAX_HALVINGS),
    ("ELLIPSE_STEPS", ellipse::STEPS),
    ("TERRAIN_MAX_FEATURES", terrain::MAX_FEATURES),
];
