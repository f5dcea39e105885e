//! The rays of a camera.

use crate::camera::CameraPose;
use clench::math::Vec3;
use std::ops::Range;

/// A camera whose pixels are rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eye {
    pub(super) position: Vec3<f64>,
    /// The unit vectors to the right, upwards and backwards.
    pub(super) axes: [Vec3<f64>; 3],
    /// Half the width and height of a pixel at distance 1 or, if the rays are parallel, in metres.
    pub(super) pixel: [f64; 2],
    /// The centre of the picture at distance 1, to the right and upwards of the viewing direction.
    pub(super) center: [f64; 2],
    pub(super) parallel: bool,
    /// The distances along the viewing direction between which a ray hits, m.
    pub(super) near: f64,
    pub(super) far: f64,
    /// The number of pixels in a row and in a column.
    pub(super) size: [usize; 2],
}

/// The part of a picture that a shape can cover.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Window {
    pub(super) rows: Range<usize>,
    pub(super) columns: Range<usize>,
}

impl Eye {
    /// Creates the rays of a camera between two distances. As in the pictures of a device, only the rays of
    /// an orthographic camera have an end.
    pub(super) fn new(camera: &CameraPose, size: [u32; 2], [near, far]: [f64; 2]) -> Self {
        let wide = |v: [f32; 3]| Vec3::from_array(v.map(f64::from));
        let lens = camera.lens;
        let [width, height] = size.map(f64::from);
        let high = f64::from(lens.half) / height;
        Eye {
            position: wide(camera.eye),
            axes: camera.axes.map(wide),
            pixel: [
                (lens.half_width).map_or(high, |half| f64::from(half) / width),
                high,
            ],
            center: lens.center.map(f64::from),
            parallel: camera.parallel,
            near,
            far: if camera.parallel { far } else { f64::INFINITY },
            size: size.map(|side| side as usize),
        }
    }

    /// Returns the whole picture.
    pub(super) fn whole(&self) -> Window {
        Window {
            rows: 0..self.size[1],
            columns: 0..self.size[0],
        }
    }

    /// Returns a part of the picture that contains a ball.
    pub(super) fn window(&self, center: Vec3<f64>, radius: f64) -> Window {
        let from = center - self.position;
        let [x, y, back] = self.axes.map(|axis| axis.dot(from));
        let ahead = -back;
        if ![x, y, ahead, radius].iter().all(|x| x.is_finite()) {
            return self.whole();
        }
        let radius = radius * 1.001 + 1e-6 * (x.abs() + y.abs() + ahead.abs());
        let [nearest, farthest] = [ahead - radius, ahead + radius];
        if farthest < self.near || nearest > self.far {
            return Window {
                rows: 0..0,
                columns: 0..0,
            };
        }
        if nearest <= 0.0 && !self.parallel {
            return self.whole();
        }
        // The bounds of the ball's box at distance 1.
        let scaled = |along: f64, divisor: f64| match self.parallel {
            true => along,
            false => along / divisor,
        };
        let bounds = |along: f64| {
            let (low, high) = (along - radius, along + radius);
            let low = scaled(low, if low < 0.0 { nearest } else { farthest });
            [
                low,
                scaled(high, if high > 0.0 { nearest } else { farthest }),
            ]
        };
        let [width, height] = self.size;
        let pixels = |[low, high]: [f64; 2], half: f64, most: usize| {
            let at = |x: f64| 0.5 * (most as f64 + x / half);
            let (first, end) = (at(low).floor().max(0.0), at(high).ceil().max(0.0));
            (first as usize).min(most)..(end as usize).min(most)
        };
        let [across, up] = self.center;
        let ([left, right], [low, high]) = (bounds(x), bounds(y));
        Window {
            rows: pixels([up - high, up - low], self.pixel[1], height),
            columns: pixels([left - across, right - across], self.pixel[0], width),
        }
    }
}
