//! Camera sensors: the projection of a site into the image, and the line of sight of a pixel.
//!
//! A pinhole camera with focal lengths f_x, f_y, in pixels, projects the point (x, y, z) of its frame to f_x x / −z to
//! the right of and f_y y / −z above the optical axis. With a field of view φ and an image height of h pixels, f = ½ h
//! / tan(½ φ).

use super::read::Reading;
use clench_collide::Ray;
use clench_dynamics::dynamics::camera::camera_pose;
use clench_math::{Real, Vec3, kernel};

/// The minimum distance from the camera's plane, m (MuJoCo's `mjMINVAL`). Nearer points are moved to it.
const MIN_DEPTH: f64 = 1e-15;

impl<T: Real> Reading<'_, T> {
    /// Projects a site into the image of a camera, pixels from the upper left corner. As in MuJoCo, the projection is
    /// perspective even if the camera is orthographic, and the principal point is the centre of the image.
    #[kernel]
    pub(super) fn project(&self, site: usize, camera: usize, out: &mut [T]) {
        let (position, axes) = camera_pose(self.model, self.params, &self.ws.position, camera);
        let p = axes.transpose_mul(self.ws.position.site_xpos[site] - position);
        let near = p.z.abs().lt(T::new(MIN_DEPTH));
        let least = T::new(MIN_DEPTH);
        let signed = T::select(p.z.lt(T::ZERO), -least, least);
        let z = T::select(near, signed, p.z);
        let [fx, fy] = self.focal_lengths(camera);
        let [width, height] = self.model.cameras[camera].resolution;
        out[0] = T::new(0.5 * width as f64) - fx * p.x / z;
        out[1] = T::new(0.5 * height as f64) + fy * p.y / z;
    }

    /// Returns the focal lengths in pixels.
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

    /// Calls `show` with the line of sight through the centre of each pixel, row by row from the upper left corner.
    pub(super) fn lines_of_sight(&self, camera: usize, mut show: impl FnMut(usize, &Ray<T>)) {
        let (position, axes) = camera_pose(self.model, self.params, &self.ws.position, camera);
        let structure = &self.model.cameras[camera];
        let [width, height] = structure.resolution;
        let focal = self.focal_lengths(camera);
        let center = self.optical_axis(camera);
        // As in MuJoCo, the image of an orthographic camera is as wide as it is high.
        let size = self.params.cam_fovy[camera];
        let pixel = [width, height].map(|n| size / T::new(n as f64));
        let z = axes.column(2);
        for i in 0..width * height {
            let x = T::new((i % width) as f64 + 0.5) - center[0];
            let y = center[1] - T::new((i / width) as f64 + 0.5);
            let line = match structure.orthographic {
                true => Ray {
                    origin: position + axes * Vec3::new(x * pixel[0], y * pixel[1], T::ZERO),
                    direction: -z,
                },
                false => {
                    let local = Vec3::new(x / focal[0], y / focal[1], -T::ONE);
                    Ray {
                        origin: position,
                        direction: axes * local.normalize().0,
                    }
                }
            };
            show(i, &line);
        }
    }

    /// Returns the image point of the optical axis, pixels from the upper left corner. As in MuJoCo, the principal
    /// point of a pinhole camera is relative to that corner; otherwise the axis is central.
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
