//! Marks that users draw into a scene: spheres, lines, arrows and texts, each with a lifetime.

use std::iter;

/// The maximum number of marks; it limits the memory of a loop that draws without clearing.
pub const MAX_MARKS: usize = 10_000;
/// The maximum number of characters of a text.
pub const MAX_TEXT: usize = 200;

/// The shape of a mark, in world coordinates, m.
#[derive(Clone, Debug, PartialEq)]
pub enum MarkShape {
    /// A sphere.
    Sphere {
        /// The centre.
        center: [f64; 3],
        /// The radius.
        radius: f64,
    },
    /// A straight line.
    Line {
        /// The first end.
        from: [f64; 3],
        /// The second end.
        to: [f64; 3],
        /// Half the thickness.
        radius: f64,
    },
    /// An arrow.
    Arrow {
        /// The tail.
        from: [f64; 3],
        /// The tip.
        to: [f64; 3],
        /// Half the thickness of the shaft.
        radius: f64,
    },
    /// A text that faces the camera, with a constant size on the screen.
    Text {
        /// The centre of the text.
        at: [f64; 3],
        /// The text.
        text: String,
    },
}

/// A mark that a user draws.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// The shape.
    pub shape: MarkShape,
    /// Red, green, blue and opacity, each from 0 to 1.
    pub rgba: [f32; 4],
    /// The lifetime, s of simulated time; with 0 the mark is shown once.
    pub lifetime: f64,
}

/// The visible marks, each with the simulated time at which it was first shown.
#[derive(Clone, Debug, Default)]
pub struct Marks(Vec<(Mark, Option<f64>)>);

impl Marks {
    /// Adds a mark.
    ///
    /// # Errors
    /// Returns an error if a number is not finite, a colour is not within 0 to 1, the lifetime is negative, the text is
    /// too long or there are too many marks.
    pub fn add(&mut self, mark: Mark) -> Result<(), String> {
        let (from, to, radius) = mark.ends_and_radius();
        let numbers = from.into_iter().chain(to).chain([radius]);
        if !numbers.clone().all(|x| (x as f32).is_finite()) || radius < 0.0 {
            return Err(
                "a mark has coordinates that are not finite, or an invalid radius".to_owned(),
            );
        }
        if mark.rgba.iter().any(|part| !(0.0..=1.0).contains(part)) {
            return Err("rgba has numbers that are not between 0 and 1".to_owned());
        }
        if mark.lifetime.is_nan() || mark.lifetime < 0.0 {
            return Err(format!(
                "the lifetime is {}, but must be zero or more seconds",
                mark.lifetime
            ));
        }
        if mark.text().chars().count() > MAX_TEXT {
            return Err(format!("a text has more than {MAX_TEXT} characters"));
        }
        if self.0.len() >= MAX_MARKS {
            return Err(format!(
                "there are already {MAX_MARKS} marks: clear them, or give them a lifetime"
            ));
        }
        self.0.push((mark, None));
        Ok(())
    }

    /// Removes all marks.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Returns the marks that are visible at a time, s, and removes expired ones. A time before a mark was first shown
    /// means that the simulation was reset, and removes the mark too.
    pub fn at(&mut self, time: f64) -> impl Iterator<Item = &Mark> + Clone {
        self.0.retain_mut(|(mark, born)| {
            let begin = *born.get_or_insert(time);
            time == begin || (time > begin && time <= begin + mark.lifetime)
        });
        self.0.iter().map(|(mark, _)| mark)
    }

    /// Removes the marks that are shown only once.
    pub fn shown(&mut self) {
        self.0.retain(|(mark, _)| mark.lifetime > 0.0);
    }
}

impl Mark {
    /// Returns both ends and the radius.
    fn ends_and_radius(&self) -> ([f64; 3], [f64; 3], f64) {
        match self.shape {
            MarkShape::Sphere { center, radius } => (center, center, radius),
            MarkShape::Line { from, to, radius } | MarkShape::Arrow { from, to, radius } => {
                (from, to, radius)
            }
            MarkShape::Text { at, .. } => (at, at, 0.0),
        }
    }

    /// Returns the text; empty for other shapes.
    pub(crate) fn text(&self) -> &str {
        match &self.shape {
            MarkShape::Text { text, .. } => text,
            _ => "",
        }
    }

    /// Returns the row of a frame, without the text.
    pub(crate) fn row(&self) -> [f32; 12] {
        let kind = match self.shape {
            MarkShape::Sphere { .. } => 0.0,
            MarkShape::Line { .. } => 1.0,
            MarkShape::Arrow { .. } => 2.0,
            MarkShape::Text { .. } => 3.0,
        };
        let (from, to, radius) = self.ends_and_radius();
        let mut row = [kind; 12];
        let numbers = from.into_iter().chain(to).chain([radius]);
        for (to, from) in iter::zip(&mut row[1..8], numbers) {
            *to = from as f32;
        }
        row[8..].copy_from_slice(&self.rgba);
        row
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sphere(lifetime: f64) -> Mark {
        Mark {
            shape: MarkShape::Sphere {
                center: [1.0, 2.0, 3.0],
                radius: 0.5,
            },
            rgba: [1.0, 0.0, 0.0, 1.0],
            lifetime,
        }
    }

    #[test]
    fn a_mark_is_seen_for_its_lifetime() {
        let mut marks = Marks::default();
        for lifetime in [0.0, 0.5, f64::INFINITY] {
            marks.add(sphere(lifetime)).unwrap();
        }
        assert_eq!(marks.at(1.0).count(), 3);
        assert_eq!(marks.at(1.0).count(), 3);
        marks.shown();
        assert_eq!(marks.at(1.5).count(), 2);
        assert_eq!(marks.at(1.6).count(), 1);
        // The simulation was reset.
        assert_eq!(marks.at(0.0).count(), 0);
    }

    #[test]
    fn marks_that_no_picture_shows_are_refused() {
        let mut marks = Marks::default();
        let mut far = sphere(0.0);
        far.shape = MarkShape::Arrow {
            from: [0.0; 3],
            to: [0.0, f64::NAN, 0.0],
            radius: 0.1,
        };
        let mut loud = sphere(0.0);
        loud.shape = MarkShape::Text {
            at: [0.0; 3],
            text: "x".repeat(MAX_TEXT + 1),
        };
        let mut bright = sphere(0.0);
        bright.rgba[1] = 2.0;
        for mark in [far, loud, bright, sphere(-1.0), sphere(f64::NAN)] {
            assert!(marks.add(mark.clone()).is_err(), "{mark:?}");
        }
        assert_eq!(marks.at(0.0).count(), 0);
        for _ in 0..MAX_MARKS {
            marks.add(sphere(0.0)).unwrap();
        }
        assert!(marks.add(sphere(0.0)).is_err());
    }
}
