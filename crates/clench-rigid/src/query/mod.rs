//! Queries of a simulation, one file per subject. Results that depend on positions or velocities are computed on demand
//! if they are stale. No query changes a status, a statistic or a bit of a later step. The computations themselves are
//! in `dynamics`.

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

/// Returns an error if there is no such object.
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

/// Returns an error if there is no such body.
pub(crate) fn check_body(model: &Model, body: usize) -> Result<(), SimError> {
    check_object(model, FrameObject::Body(body))
}
