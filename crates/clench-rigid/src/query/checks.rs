//! Checks of the arguments of queries.

use super::cast::RAY;
use clench_dynamics::check::{check_count, check_values};
use clench_dynamics::error::{SimError, no_such};
use clench_dynamics::inverse::Acceleration;
use clench_dynamics::model::{FrameObject, Integrator, Model};
use clench_math::Scalar;

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

/// Returns an error unless rays and frame are valid.
pub(crate) fn check_rays<S: Scalar>(
    model: &Model,
    frame: Option<FrameObject>,
    rays: &[S],
) -> Result<(), SimError> {
    frame.map_or(Ok(()), |frame| check_object(model, frame))?;
    check_count("rays", rays.len(), RAY)?;
    check_values("rays", rays, rays.len())
}

/// Returns an error unless positions, geom and frame are valid.
pub(crate) fn check_places<S: Scalar>(
    model: &Model,
    geom: usize,
    frame: Option<FrameObject>,
    places: &[S],
) -> Result<(), SimError> {
    if geom >= model.geoms.len() {
        return Err(no_such("geom", geom, model.geoms.len()));
    }
    if model.heights(geom).is_none() {
        return Err(SimError::NoHeightField { geom });
    }
    frame.map_or(Ok(()), |frame| check_object(model, frame))?;
    check_count("places", places.len(), 2)?;
    check_values("places", places, places.len())
}

/// Returns an error if inverse dynamics do not support this kind of acceleration.
pub(crate) fn check_acceleration(model: &Model, kind: Acceleration) -> Result<(), SimError> {
    let stages = model.integrator == Integrator::Rk4;
    match kind {
        Acceleration::Discrete if stages => Err(SimError::NoDiscreteInverse),
        Acceleration::Discrete | Acceleration::Continuous => Ok(()),
    }
}
