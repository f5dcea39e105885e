//! The common properties of all elements: a kind, a name, a source location, and checks of numbers.

use super::{
    ActuatorSpec, BodySpec, BuildError, CameraSpec, EqualitySpec, ExcludeSpec, GeomSpec,
    HeightFieldSpec, JointSpec, KeyframeSpec, LightSpec, MeshSpec, Origin, PairSpec, SensorSpec,
    SiteSpec, TendonSpec,
};
use clench_math::{Quat, Vec3};

/// An element of the author's description, as used in error messages.
pub(super) trait Element {
    /// The kind as named in messages.
    const KIND: &'static str;
    /// Returns its name, possibly empty.
    fn name(&self) -> &str;
    /// Returns its source location.
    fn origin(&self) -> Option<&Origin>;

    /// Creates an error about this element.
    fn error(&self, message: impl Into<String>) -> BuildError {
        let element = match self.name() {
            "" => format!("unnamed {}", Self::KIND),
            name => format!("{} \"{name}\"", Self::KIND),
        };
        BuildError {
            origin: self.origin().cloned(),
            ..BuildError::new(element, message)
        }
    }

    /// Returns an error for NaN and infinity.
    fn require_finite(&self, field: &str, values: &[f64]) -> Result<(), BuildError> {
        match values.iter().find(|v| !v.is_finite()) {
            Some(bad) => Err(self.error(format!("{field} must be finite, but has {bad}"))),
            None => Ok(()),
        }
    }

    /// Returns an error for NaN; a range may be infinite.
    fn require_numbers(&self, field: &str, range: &[f64]) -> Result<(), BuildError> {
        match range.iter().any(|v| v.is_nan()) {
            true => Err(self.error(format!("{field} contains NaN"))),
            false => Ok(()),
        }
    }

    /// Returns an error for negative numbers, NaN and infinity.
    fn require_not_negative(&self, field: &str, values: &[f64]) -> Result<(), BuildError> {
        self.require_finite(field, values)?;
        match values.iter().find(|&&v| v < 0.0) {
            Some(bad) => Err(self.error(format!("{field} cannot be negative, but is {bad}"))),
            None => Ok(()),
        }
    }
}

macro_rules! elements {
    ($($spec:ty => $kind:literal),* $(,)?) => {
        $(impl Element for $spec {
            const KIND: &'static str = $kind;
            fn name(&self) -> &str {
                &self.name
            }
            fn origin(&self) -> Option<&Origin> {
                self.origin.as_ref()
            }
        })*
    };
}

elements! {
    BodySpec => "body",
    JointSpec => "joint",
    GeomSpec => "geom",
    SiteSpec => "site",
    CameraSpec => "camera",
    LightSpec => "light",
    MeshSpec => "mesh",
    HeightFieldSpec => "height field",
    TendonSpec => "tendon",
    ActuatorSpec => "actuator",
    SensorSpec => "sensor",
    EqualitySpec => "equality constraint",
    PairSpec => "contact pair",
    ExcludeSpec => "contact exclude",
    KeyframeSpec => "keyframe",
}

/// Resolves whether a range limits: as the author specified, else if it is given and not empty (MuJoCo's `autolimits`).
///
/// # Errors
/// Returns an error if a range does not specify this and `autolimits` is off.
pub(super) fn resolve_limited(
    element: &impl Element,
    what: &str,
    said: Option<bool>,
    range: [f64; 2],
    autolimits: bool,
) -> Result<bool, BuildError> {
    element.require_numbers(&format!("{what}range"), &range)?;
    match said {
        Some(said) => Ok(said),
        None if range != [0.0; 2] && !autolimits => Err(element.error(format!(
            "has a {what}range, but does not say whether it is {what}limited, and autolimits is off"
        ))),
        None => Ok(range[0] < range[1]),
    }
}

/// Does the same as [`resolve_limited`], for a range that must be ascending if it limits.
///
/// # Errors
/// Also returns an error if a range limits without ascending.
pub(super) fn resolve_range(
    element: &impl Element,
    what: &str,
    said: Option<bool>,
    range: [f64; 2],
    autolimits: bool,
) -> Result<bool, BuildError> {
    let limited = resolve_limited(element, what, said, range, autolimits)?;
    if limited && range[0] >= range[1] {
        let [low, high] = range;
        return Err(element.error(format!(
            "{what}range must be increasing, but is {low} to {high}"
        )));
    }
    Ok(limited)
}

/// The minimum length of a quaternion (its square is MuJoCo's `mjEPS`).
pub(super) const MIN_QUAT_LENGTH: f64 = 1e-7;

/// Checks for a finite position and a valid orientation.
pub(super) fn check_pose(
    element: &impl Element,
    pos: Vec3<f64>,
    quat: Quat<f64>,
) -> Result<(), BuildError> {
    element.require_finite("pos", &pos.to_array())?;
    let quat = quat.to_array();
    element.require_finite("quat", &quat)?;
    match quat.iter().map(|q| q * q).sum::<f64>().sqrt() < MIN_QUAT_LENGTH {
        true => Err(element.error("quat is zero")),
        false => Ok(()),
    }
}
