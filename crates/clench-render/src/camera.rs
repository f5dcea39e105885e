//! The cameras of images.

use clench::math::Real;
use clench::rigid::{Precision, Sim};

/// The half size of the visible part of a plane if there is nothing else, m.
const PLANE: f64 = 1.0;
/// The distance of a camera that shows all movable geoms, as a multiple of their size.
const DISTANCE: f64 = 1.75;

/// A camera independent of the model, which looks at a point from a distance and a direction: MuJoCo's free camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeCamera {
    /// The point at the centre of the image, m.
    pub lookat: [f64; 3],
    /// The distance from the point, m.
    pub distance: f64,
    /// The viewing direction about the vertical, degrees: 0 looks along x, 90 along y.
    pub azimuth: f64,
    /// The viewing direction above the horizon, degrees; negative looks down.
    pub elevation: f64,
    /// The vertical field of view, degrees.
    pub fovy: f64,
}

impl FreeCamera {
    /// Creates a camera that shows all movable geoms, or all geoms if none is movable.
    ///
    /// # Errors
    /// Returns an error if the state cannot be evaluated.
    pub fn of_all<T: Precision>(sim: &mut Sim<T>) -> Result<Self, clench::SimError> {
        let places = sim.output("geom_xpos")?;
        let (model, params) = (sim.model(), sim.params());
        let bounds = |moving: bool| {
            let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
            for (g, pose) in places.chunks_exact(3).enumerate() {
                let radius = params.geom_rbound[g].lane(0).to_f64();
                if moving && (model.geoms[g].body == 0 || radius <= 0.0) {
                    continue;
                }
                let radius = if radius > 0.0 { radius } else { PLANE };
                for k in 0..3 {
                    low[k] = low[k].min(pose[k].to_f64() - 0.7 * radius);
                    high[k] = high[k].max(pose[k].to_f64() + 0.7 * radius);
                }
            }
            (low[0] <= high[0]).then_some((low, high))
        };
        let (low, high) = (bounds(true).or_else(|| bounds(false))).unwrap_or(([-1.0; 3], [1.0; 3]));
        let middle = [0, 1, 2].map(|k| 0.5 * (low[k] + high[k]));
        let squares = (0..3).map(|k| (high[k] - low[k]).powi(2));
        let size = squares.sum::<f64>().sqrt().clamp(0.02, 1e6);
        Ok(FreeCamera {
            lookat: middle,
            distance: DISTANCE * size,
            azimuth: 131.0,
            elevation: -17.0,
            fovy: 42.0,
        })
    }

    /// Returns the present size of the movable geoms, m.
    pub(crate) fn extent<T: Precision>(sim: &mut Sim<T>) -> Result<f32, clench::SimError> {
        Ok((Self::of_all(sim)?.distance / DISTANCE) as f32)
    }
}

/// The selection of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// A camera of the model.
    Camera(usize),
    /// A free camera.
    Free(FreeCamera),
    /// A free camera that shows all movable geoms.
    All,
}

/// A camera with its pose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CameraPose {
    pub eye: [f32; 3],
    /// The unit vectors to the right, upwards and backwards.
    pub axes: [[f32; 3]; 3],
    pub lens: Lens,
    pub parallel: bool,
}

/// The part of the plane at distance 1 that an image shows; for an orthographic camera, in metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lens {
    /// Half the height.
    pub half: f32,
    /// Half the width; none if pixels are square.
    pub half_width: Option<f32>,
    /// The centre, to the right and upwards of the viewing direction.
    pub center: [f32; 2],
}

impl Lens {
    /// Creates a lens of square pixels whose image is centred on the viewing direction.
    pub(crate) fn central(half: f32) -> Self {
        Lens {
            half,
            half_width: None,
            center: [0.0; 2],
        }
    }

    /// Creates the lens of a sensor's size, focal lengths and principal point. As in MuJoCo, the whole sensor fills the
    /// image, whatever its aspect ratio.
    fn of_sensor(size: [f64; 2], [fx, fy, px, py]: [f64; 4]) -> Self {
        Lens {
            half: (0.5 * size[1] / fy) as f32,
            half_width: Some((0.5 * size[0] / fx) as f32),
            center: [(px / fx) as f32, (-py / fy) as f32],
        }
    }
}

impl View {
    /// Returns the present pose of the camera.
    pub(crate) fn pose<T: Precision>(
        &self,
        sim: &mut Sim<T>,
    ) -> Result<CameraPose, crate::RenderError> {
        match *self {
            View::Camera(index) => {
                let count = sim.model().cameras.len();
                if index >= count {
                    return Err(crate::RenderError::NoCamera(index, count));
                }
                let eye = sim.output("cam_xpos")?;
                let rotation = sim.output("cam_xmat")?;
                let number = |x: T| x.to_f64() as f32;
                let rotation = rotation[9 * index..].iter().map(|&x| number(x));
                let rotation: Vec<f32> = rotation.take(9).collect();
                let camera = &sim.model().cameras[index];
                let (parallel, params) = (camera.orthographic, sim.params());
                let wide = |x: T::SingleEnv| x.lane(0).to_f64();
                let lens = match camera.intrinsic && !parallel {
                    true => Lens::of_sensor(
                        params.cam_sensorsize[index].map(wide),
                        params.cam_intrinsic[index].map(wide),
                    ),
                    false => Lens::central(half(wide(params.cam_fovy[index]), parallel)),
                };
                Ok(CameraPose {
                    eye: [0, 1, 2].map(|k| number(eye[3 * index + k])),
                    axes: [0, 1, 2].map(|k| [rotation[k], rotation[3 + k], rotation[6 + k]]),
                    lens,
                    parallel,
                })
            }
            View::Free(free) => Ok(free.pose()),
            View::All => Ok(FreeCamera::of_all(sim)?.pose()),
        }
    }
}

/// Returns half the height of an image.
fn half(fovy: f64, parallel: bool) -> f32 {
    match parallel {
        true => 0.5 * fovy as f32,
        false => (0.5 * fovy.to_radians()).tan() as f32,
    }
}

impl FreeCamera {
    fn pose(&self) -> CameraPose {
        let (azimuth, elevation) = (self.azimuth.to_radians(), self.elevation.to_radians());
        let ahead = [
            elevation.cos() * azimuth.cos(),
            elevation.cos() * azimuth.sin(),
            elevation.sin(),
        ];
        let right = [azimuth.sin(), -azimuth.cos(), 0.0];
        let up = [
            -elevation.sin() * azimuth.cos(),
            -elevation.sin() * azimuth.sin(),
            elevation.cos(),
        ];
        let narrow = |v: [f64; 3]| v.map(|x| x as f32);
        CameraPose {
            eye: narrow([0, 1, 2].map(|k| self.lookat[k] - self.distance * ahead[k])),
            axes: [narrow(right), narrow(up), narrow(ahead.map(|x| -x))],
            lens: Lens::central(half(self.fovy, false)),
            parallel: false,
        }
    }
}

impl CameraPose {
    /// Returns the distance of a point along the viewing direction, m.
    pub(crate) fn distance(&self, point: [f32; 3]) -> f32 {
        let along = |k: usize| self.axes[2][k] * (self.eye[k] - point[k]);
        (0..3).map(along).sum()
    }

    /// Returns the number of pixels of a metre at a distance in an image of a height; infinite behind the camera.
    pub(crate) fn pixels(&self, distance: f32, height: u32) -> f32 {
        let distance = if self.parallel { 1.0 } else { distance };
        match distance > 0.0 {
            true => height as f32 / (2.0 * self.lens.half * distance),
            false => f32::INFINITY,
        }
    }

    /// Returns the column-major matrix from the world to the image. Depth is 1 at the distance `near` and falls to 0 at
    /// infinity (for an orthographic camera at `far`), which distributes single precision evenly.
    pub(crate) fn matrix(&self, aspect: f32, near: f32, far: f32) -> [[f32; 4]; 4] {
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let rows: Vec<[f32; 4]> = (self.axes.iter())
            .map(|&axis| [axis[0], axis[1], axis[2], -dot(axis, self.eye)])
            .collect();
        let scaled = |row: [f32; 4], factor: f32| row.map(|x| x * factor);
        let back = rows[2];
        let (depth, w) = match self.parallel {
            // 1 at z = −near, 0 at z = −far.
            true => {
                let mut depth = scaled(back, 1.0 / (far - near));
                depth[3] += far / (far - near);
                (depth, [0.0, 0.0, 0.0, 1.0])
            }
            false => ([0.0, 0.0, 0.0, near], scaled(back, -1.0)),
        };
        let Lens {
            half,
            half_width,
            center,
        } = self.lens;
        // A point at the lens's centre times its distance is in the middle of the image.
        let centred = |k: usize| [0, 1, 2, 3].map(|i| rows[k][i] - center[k] * w[i]);
        let all = [
            scaled(centred(0), 1.0 / half_width.unwrap_or(half * aspect)),
            scaled(centred(1), 1.0 / half),
            depth,
            w,
        ];
        [0, 1, 2, 3].map(|column| [0, 1, 2, 3].map(|row| all[row][column]))
    }
}
