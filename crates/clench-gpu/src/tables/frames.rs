//! The kinds of objects whose frames sensors read.

use crate::codes::codes;

codes! {
    /// The kinds of object with a frame.
    enum Frame {
        None = "NO_FRAME",
        Inertial = "INERTIAL_FRAME",
        Body = "BODY_FRAME",
        Geom = "GEOM_FRAME",
        Site = "SITE_FRAME",
        Camera = "CAMERA_FRAME",
    }
}
