//! What cameras see: where a site is in the picture, and the line of sight of a pixel.
//!
//! In the camera's frame a pinhole with focal lengths f_x, f_y, measured in pixels, has the point (x, y, z) at f_x x / −z to the
//! right and f_y y / −z above the optical axis. With a field of view φ and a picture of h pixels, f = ½ h / tan(½ φ).

use super::reading::Reading;
use clench_collide::Ray;
use clench_dynamics::dynamics::camera::camera_pose;
use clench_math::{Real, Vec3, kernel};

/// A point nearer to the camera's plane than this (m, MuJoCo's `mjMINVAL`) is seen as if it were so far away.
const MIN_DEPTH: f64 = 1e-15;

impl<T: Real> Reading<'_, T> {
    /// Where a camera sees a site, pixels from the upper left corner. As in MuJoCo, lines of sight meet in the camera even if it is
    /// orthographic, and the principal point is the middle of the picture.
    #[kernel]
    pub(super) fn project(&self, site: usize, camera: usize, out: &mut [T]) {
        let (place, axes) = camera_pose(self.model, self.params, &self.ws.position, camera);
        let p = axes.transpose_mul(self.ws.position.site_xpos[site] - place);
        let near = p.z.abs().lt(T::new(MIN_DEPTH));
        let least = T::new(MIN_DEPTH);
        let signed = T::select(p.z.lt(T::ZERO), -least, least);
        let z = T::select(near, signed, p.z);
        let [fx, fy] = self.focal_lengths(camera);
        let [width, height] = self.model.cameras[camera].resolution;
        out[0] = T::new(0.5 * width as f64) - fx * p.x / z;
        out[1] = T::new(0.5 * height as f64) + fy * p.y / z;
    }

    /// Focal lengths in pixels.
    #[kernel]
    fn focal_lengths(&self, camera: usize) -> [T; 2] {
        let structure = &self.model.cameras[camera];
        let [width, height] = structure.resolution.map(|n| T::new(n as f64));
        if structure.intrinsic {
            let ([sx, sy], [fx, fy, ..]) = (
                self.params.cam_sensorsize[camera],
                self.params.cam_intrinsic[camera],
            );
            return [fx / sx * width, fy / sy * height];
        }
        let (sin, cos) = self.half_angle(camera);
        [height * T::new(0.5) * cos / sin; 2]
    }

    #[kernel]
    fn half_angle(&self, camera: usize) -> (T, T) {
        let half = self.params.cam_fovy[camera] * T::new(0.5_f64.to_radians());
        half.sin_cos()
    }

    /// The line of sight through the middle of each pixel, line by line from the upper left corner.
    pub(super) fn lines_of_sight(&self, camera: usize, mut show: impl FnMut(usize, &Ray<T>)) {
        let (place, axes) = camera_pose(self.model, self.params, &self.ws.position, camera);
        let structure = &self.model.cameras[camera];
        let [width, height] = structure.resolution;
        let focal = self.focal_lengths(camera);
        let center = self.optical_axis(camera);
        // The picture is as wide as high where lines of sight are parallel: so it is in MuJoCo.
        let extent = self.params.cam_fovy[camera];
        let pixel = [width, height].map(|n| extent / T::new(n as f64));
        let z = axes.column(2);
        for i in 0..width * height {
            let x = T::new((i % width) as f64 + 0.5) - center[0];
            let y = center[1] - T::new((i / width) as f64 + 0.5);
            let line = match structure.orthographic {
                true => Ray {
                    origin: place + axes * Vec3::new(x * pixel[0], y * pixel[1], T::ZERO),
                    direction: -z,
                },
                false => {
                    let local = Vec3::new(x / focal[0], y / focal[1], -T::ONE);
                    Ray {
                        origin: place,
                        direction: axes * local.normalize().0,
                    }
                }
            };
            show(i, &line);
        }
    }

    /// Where the optical axis meets the picture, pixels from its upper left corner. As in MuJoCo, the principal point of a pinhole
    /// is counted from that corner, else the axis is in the middle.
    fn optical_axis(&self, camera: usize) -> [T; 2] {
        let structure = &self.model.cameras[camera];
        let [width, height] = structure.resolution.map(|n| T::new(n as f64));
        if structure.intrinsic && !structure.orthographic {
            let ([sx, sy], [.., px, py]) = (
                self.params.cam_sensorsize[camera],
                self.params.cam_intrinsic[camera],
            );
            return [px / sx * width, py / sy * height];
        }
        [width * T::new(0.5), height * T::new(0.5)]
    }
}
