//! Questions to a simulation. What depends on positions, or on velocities, is computed when it is asked for and not known; no
//! query changes a status, a figure or a bit of a later step. A file a subject; what is here asks, and computes nothing that
//! has a place in `dynamics`.

mod cast;
mod frames;
mod geoms;
mod ik;
mod inertia;
mod inverse;
mod scan;

pub(crate) use cast::{HIT, RAY, cast, sample};
pub use frames::Anchor;
pub(crate) use inverse::check_acceleration;
pub(crate) use scan::{check_places, check_rays};

use clench_dynamics::error::{SimError, no_such};
use clench_dynamics::model::{FrameObject, Model};

/// An object that the model has.
pub(crate) fn check_object(model: &Model, object: FrameObject) -> Result<(), SimError> {
    let (kind, index, count) = match object {
        FrameObject::Inertial(body) | FrameObject::Body(body) => ("body", body, model.nbody()),
        FrameObject::Geom(geom) => ("geom", geom, model.geoms.len()),
        FrameObject::Site(site) => ("site", site, model.sites.len()),
        FrameObject::Camera(camera) => ("camera", camera, model.cameras.len()),
    };
    match index < count {
        true => Ok(()),
        false => Err(no_such(kind, index, count)),
    }
}

/// A body that the model has.
pub(crate) fn check_body(model: &Model, body: usize) -> Result<(), SimError> {
    check_object(model, FrameObject::Body(body))
}
