//! Poses: the five representations of an orientation, and frames that transform their contents.

use super::compiler::CompilerOptions;
use super::linear_map::{Deformation, LinearMap};
use crate::document::Element;
use crate::error::LoadError;
use clench_math::{Mat3, Quat, Vec3};

/// Vectors shorter than this have no direction (MuJoCo's `mjEPS`).
pub(crate) const SMALL: f64 = 1e-14;

/// An orientation as written; angles in the file's unit.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Orientation {
    Quat([f64; 4]),
    /// Axis and angle.
    AxisAngle([f64; 4]),
    /// Three rotations in the order of `eulerseq`.
    Euler([f64; 3]),
    /// The x axis, and a y axis to be made perpendicular to it.
    XyAxes([f64; 6]),
    /// The minimal rotation that gives this z axis.
    ZAxis([f64; 3]),
}

impl Default for Orientation {
    fn default() -> Self {
        Orientation::Quat([1.0, 0.0, 0.0, 0.0])
    }
}

impl Orientation {
    /// Overwrites the orientation if the element gives one.
    pub(crate) fn read(&mut self, element: &Element) -> Result<(), LoadError> {
        element.at_most_one(&["quat", "axisangle", "euler", "xyaxes", "zaxis"])?;
        if let Some(quat) = element.numbers("quat")? {
            if quat == [0.0; 4] {
                return Err(element.error("quat cannot be zero"));
            }
            *self = Orientation::Quat(quat);
        }
        if let Some(values) = element.numbers("axisangle")? {
            *self = Orientation::AxisAngle(values);
        }
        if let Some(values) = element.numbers("euler")? {
            *self = Orientation::Euler(values);
        }
        if let Some(values) = element.numbers("xyaxes")? {
            *self = Orientation::XyAxes(values);
        }
        if let Some(values) = element.numbers("zaxis")? {
            *self = Orientation::ZAxis(values);
        }
        Ok(())
    }

    /// Returns the unit quaternion; errors about an axis without direction refer to `element`.
    pub(crate) fn resolve(
        &self,
        compiler: &CompilerOptions,
        element: &Element,
    ) -> Result<Quat<f64>, LoadError> {
        let direction = |v: [f64; 3], what: &str| {
            let (unit, length) = Vec3::from_array(v).normalize();
            if length < SMALL {
                return Err(element.error(format!("{what} is too short to have a direction")));
            }
            Ok(unit)
        };
        match *self {
            Orientation::Quat(quat) => Ok(Quat::from_f64(quat).normalize()),
            Orientation::AxisAngle([x, y, z, angle]) => {
                let axis = direction([x, y, z], "the axis of axisangle")?;
                Ok(Quat::from_axis_angle(axis, compiler.radians(angle)))
            }
            Orientation::Euler(angles) => Ok(compiler.euler(angles)),
            Orientation::XyAxes([x0, x1, x2, y0, y1, y2]) => {
                let x = direction([x0, x1, x2], "the x axis of xyaxes")?;
                let y = Vec3::new(y0, y1, y2);
                let y = direction((y - x * x.dot(y)).to_array(), "the y axis of xyaxes")?;
                Ok(Quat::from_matrix(&columns(x, y, x.cross(y))))
            }
            Orientation::ZAxis(z) => {
                let z = direction(z, "zaxis")?;
                Ok(Quat::from_two_vectors(Vec3::new(0.0, 0.0, 1.0), z))
            }
        }
    }
}

fn columns(x: Vec3<f64>, y: Vec3<f64>, z: Vec3<f64>) -> Mat3<f64> {
    Mat3 {
        rows: [
            Vec3::new(x.x, y.x, z.x),
            Vec3::new(x.y, y.y, z.y),
            Vec3::new(x.z, y.z, z.z),
        ],
    }
}

/// The pose of an object in its parent.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose {
    pub pos: Vec3<f64>,
    pub quat: Quat<f64>,
    /// The linear map of positions, applied first.
    pub linear_map: LinearMap,
}

impl Pose {
    pub(crate) const IDENTITY: Pose = Pose {
        pos: Vec3::ZERO,
        quat: Quat::IDENTITY,
        linear_map: LinearMap::NONE,
    };

    /// Reads the pose in `pos` and one of the orientation attributes.
    pub(crate) fn read(element: &Element, compiler: &CompilerOptions) -> Result<Pose, LoadError> {
        let mut orientation = Orientation::default();
        orientation.read(element)?;
        Ok(Pose {
            pos: Vec3::from_array(element.numbers("pos")?.unwrap_or_default()),
            quat: orientation.resolve(compiler, element)?,
            linear_map: LinearMap::NONE,
        })
    }

    /// Returns the pose in the frame's parent of an object whose pose in the frame is `inner`.
    pub(crate) fn then(&self, inner: Pose) -> Pose {
        Pose {
            pos: self.point(inner.pos),
            quat: (self.quat * inner.quat).normalize(),
            linear_map: self.linear_map.rotated(inner.quat).after(inner.linear_map),
        }
    }

    /// Like `then` for a shape, with its deformation.
    pub(crate) fn carry(&self, shape: Pose) -> (Pose, Deformation) {
        let pose = self.then(shape);
        let deformation = Deformation {
            linear_map: pose.linear_map,
            segment: false,
        };
        (pose, deformation)
    }

    /// Maps a point of the frame to its parent.
    pub(crate) fn point(&self, local: Vec3<f64>) -> Vec3<f64> {
        self.pos + self.quat.rotate(self.linear_map.apply(local))
    }
}

/// Returns the centre, orientation (z from the second point to the first, as in MuJoCo) and half length of a segment.
pub(crate) fn segment(
    [x0, y0, z0, x1, y1, z1]: [f64; 6],
    element: &Element,
) -> Result<(Pose, f64), LoadError> {
    let (from, to) = (Vec3::new(x0, y0, z0), Vec3::new(x1, y1, z1));
    let (axis, length) = (from - to).normalize();
    if length * 0.5 < SMALL {
        return Err(element.error("the points of fromto coincide"));
    }
    let pose = Pose {
        pos: (from + to) * 0.5,
        quat: Quat::from_two_vectors(Vec3::new(0.0, 0.0, 1.0), axis),
        linear_map: LinearMap::NONE,
    };
    Ok((pose, length * 0.5))
}
