//! `<camera>`: a frame that follows bodies, and its optics. Used only by sensors.

use super::compiler::CompilerOptions;
use super::orientation::{Orientation, Pose};
use crate::document::Element;
use crate::error::LoadError;
use clench_builder::{CameraLens, CameraSpec, CameraTracking};
use clench_math::Vec3;
use std::sync::Arc;

/// A camera as written in an element or a default class.
#[derive(Clone, Debug)]
pub(crate) struct CameraDraft {
    mode: Mode,
    pos: [f64; 3],
    orientation: Orientation,
    orthographic: bool,
    fovy: f64,
    resolution: [i32; 2],
    sensorsize: [f64; 2],
    focal: Lengths,
    principal: Lengths,
    user: Arc<[f64]>,
}

/// The mode in which a camera or light follows bodies.
#[derive(Clone, Copy, Debug)]
pub(super) enum Mode {
    Fixed,
    Track,
    TrackCom,
    TargetBody,
    TargetBodyCom,
}

/// Two lengths on the sensor, in metres or in pixels; the latter take precedence if nonzero.
#[derive(Clone, Copy, Debug, Default)]
struct Lengths {
    metres: [f64; 2],
    pixels: [f64; 2],
}

impl Default for CameraDraft {
    fn default() -> Self {
        CameraDraft {
            mode: Mode::Fixed,
            pos: [0.0; 3],
            orientation: Orientation::default(),
            orthographic: false,
            fovy: 45.0,
            resolution: [1; 2],
            sensorsize: [0.0; 2],
            focal: Lengths::default(),
            principal: Lengths::default(),
            user: Arc::default(),
        }
    }
}

impl CameraDraft {
    /// Overwrites the values that the element has.
    pub(super) fn read(&mut self, element: &Element) -> Result<(), LoadError> {
        self.mode.read(element)?;
        element.set_numbers("pos", &mut self.pos)?;
        self.orientation.read(element)?;
        let projections = [("perspective", false), ("orthographic", true)];
        element.set_keyword("projection", &projections, &mut self.orthographic)?;
        element.at_most_one(&["fovy", "sensorsize"])?;
        element.set_number("fovy", &mut self.fovy)?;
        match element.integers("resolution")?[..] {
            [] => {}
            [width, height] => self.resolution = [width, height],
            _ => return Err(element.error("resolution needs 2 numbers: width and height")),
        }
        element.set_user(&mut self.user)?;
        for (name, lengths) in [
            ("sensorsize", &mut self.sensorsize),
            ("focal", &mut self.focal.metres),
            ("focalpixel", &mut self.focal.pixels),
            ("principal", &mut self.principal.metres),
            ("principalpixel", &mut self.principal.pixels),
        ] {
            if let Some(numbers) = element.singles(name)? {
                *lengths = numbers.map(f64::from);
            }
        }
        Ok(())
    }

    /// Returns the camera in its body, transformed by the enclosing frame.
    pub(super) fn finish(
        self,
        element: &Element,
        compiler: &CompilerOptions,
        frame: &Pose,
    ) -> Result<CameraSpec, LoadError> {
        let pose = frame.then(Pose {
            pos: Vec3::from_array(self.pos),
            quat: self.orientation.resolve(compiler, element)?,
            ..Pose::IDENTITY
        });
        Ok(CameraSpec {
            name: element.string("name"),
            pos: pose.pos,
            quat: pose.quat,
            tracking: tracking(self.mode, element),
            orthographic: self.orthographic,
            lens: self.lens(element)?,
            resolution: self.resolution.map(|n| usize::try_from(n).unwrap_or(0)),
            user: self.user,
            origin: Some(element.origin.clone()),
        })
    }

    fn lens(&self, element: &Element) -> Result<CameraLens, LoadError> {
        if self.sensorsize.iter().all(|&size| size > 0.0) {
            if self.resolution.iter().any(|&n| n <= 0) {
                return Err(element.incomplete("a sensorsize needs a positive resolution"));
            }
            let [focal, principal] = [self.focal, self.principal].map(|x| self.on_sensor(x));
            if focal.iter().chain(&principal).any(|x| x.is_infinite()) {
                let message = "a length of the lens is too large for single precision";
                return Err(element.error(message));
            }
            return Ok(CameraLens::Intrinsic {
                sensorsize: self.sensorsize,
                focal,
                principal,
            });
        }
        if self.focal.is_set() || self.principal.is_set() {
            let message = "a focal length or a principal point needs a sensorsize";
            return Err(element.incomplete(message));
        }
        Ok(CameraLens::FieldOfView(self.fovy))
    }

    fn on_sensor(&self, lengths: Lengths) -> [f64; 2] {
        if lengths.pixels == [0.0; 2] {
            return lengths.metres;
        }
        [0, 1].map(|i| {
            let pixel = self.sensorsize[i] / f64::from(self.resolution[i]);
            stored(lengths.pixels[i] * pixel)
        })
    }
}

impl Mode {
    /// Overwrites the values that the element has.
    pub(super) fn read(&mut self, element: &Element) -> Result<(), LoadError> {
        let modes = [
            ("fixed", Mode::Fixed),
            ("track", Mode::Track),
            ("trackcom", Mode::TrackCom),
            ("targetbody", Mode::TargetBody),
            ("targetbodycom", Mode::TargetBodyCom),
        ];
        element.set_keyword("mode", &modes, self)
    }
}

/// Returns the tracking mode of an element, with its target.
pub(super) fn tracking(mode: Mode, element: &Element) -> CameraTracking {
    let target = || element.string("target");
    match mode {
        Mode::Fixed => CameraTracking::Fixed,
        Mode::Track => CameraTracking::Track,
        Mode::TrackCom => CameraTracking::TrackCom(target()),
        Mode::TargetBody => CameraTracking::TargetBody(target()),
        Mode::TargetBodyCom => CameraTracking::TargetBodyCom(target()),
    }
}

impl Lengths {
    fn is_set(&self) -> bool {
        (self.metres, self.pixels) != ([0.0; 2], [0.0; 2])
    }
}

/// Rounds a lens length to single precision, as MuJoCo stores it.
fn stored(number: f64) -> f64 {
    f64::from(number as f32)
}
