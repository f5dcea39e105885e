//! What users draw into a scene themselves: spheres, lines, arrows and words, each for a while.

use std::iter;

/// The most marks at a time: what a loop draws and never takes away must not fill the memory.
pub const MAX_MARKS: usize = 10_000;
/// The most characters of a text.
pub const MAX_TEXT: usize = 200;

/// What a mark is, in world coordinates, m.
#[derive(Clone, Debug, PartialEq)]
pub enum MarkShape {
    /// A sphere.
    Sphere {
        /// Its centre.
        center: [f64; 3],
        /// Its radius.
        radius: f64,
    },
    /// A straight line.
    Line {
        /// One end.
        from: [f64; 3],
        /// The other.
        to: [f64; 3],
        /// Half its thickness.
        radius: f64,
    },
    /// An arrow.
    Arrow {
        /// Where it begins.
        from: [f64; 3],
        /// Its tip.
        to: [f64; 3],
        /// Half the thickness of its shaft.
        radius: f64,
    },
    /// Words that face the camera, in one size on the screen wherever they are.
    Text {
        /// Their middle.
        at: [f64; 3],
        /// What they say.
        text: String,
    },
}

/// A drawing of a user's.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// What it is.
    pub shape: MarkShape,
    /// Red, green, blue and opacity, each from 0 to 1.
    pub rgba: [f32; 4],
    /// For how long it is seen, s of simulated time; with 0 until what comes next has been shown.
    pub lifetime: f64,
}

/// The marks that are seen, each with the simulated time at which it was first shown.
#[derive(Clone, Debug, Default)]
pub struct Marks(Vec<(Mark, Option<f64>)>);

impl Marks {
    /// Draws one more.
    ///
    /// # Errors
    /// Numbers that are not finite, or a lifetime below 0; a text that is too long; too many marks.
    pub fn add(&mut self, mark: Mark) -> Result<(), String> {
        let (from, to, radius) = mark.place();
        let numbers = from.into_iter().chain(to).chain([radius]);
        if !numbers.clone().all(|x| (x as f32).is_finite()) || radius < 0.0 {
            return Err("a mark has coordinates or a radius that no picture shows".to_owned());
        }
        if mark.rgba.iter().any(|part| !(0.0..=1.0).contains(part)) {
            return Err("rgba has numbers that are not between 0 and 1".to_owned());
        }
        if mark.lifetime.is_nan() || mark.lifetime < 0.0 {
            return Err(format!("the lifetime {} is no time", mark.lifetime));
        }
        if mark.text().chars().count() > MAX_TEXT {
            return Err(format!("a text has more than {MAX_TEXT} characters"));
        }
        if self.0.len() >= MAX_MARKS {
            return Err(format!(
                "there are {MAX_MARKS} marks already: clear them, or give them a lifetime"
            ));
        }
        self.0.push((mark, None));
        Ok(())
    }

    /// Takes all away.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Those that are seen at a time, s: what is over by then goes away. A time before the one at which a mark was first shown is
    /// that of a simulation that was set back, and ends it too.
    pub fn at(&mut self, time: f64) -> impl Iterator<Item = &Mark> + Clone {
        self.0.retain_mut(|(mark, born)| {
            let begin = *born.get_or_insert(time);
            time == begin || (time > begin && time <= begin + mark.lifetime)
        });
        self.0.iter().map(|(mark, _)| mark)
    }

    /// Takes those away that are seen only once.
    pub fn shown(&mut self) {
        self.0.retain(|(mark, _)| mark.lifetime > 0.0);
    }
}

impl Mark {
    /// Both ends and the radius.
    fn place(&self) -> ([f64; 3], [f64; 3], f64) {
        match self.shape {
            MarkShape::Sphere { center, radius } => (center, center, radius),
            MarkShape::Line { from, to, radius } | MarkShape::Arrow { from, to, radius } => {
                (from, to, radius)
            }
            MarkShape::Text { at, .. } => (at, at, 0.0),
        }
    }

    /// What it says.
    pub(crate) fn text(&self) -> &str {
        match &self.shape {
            MarkShape::Text { text, .. } => text,
            _ => "",
        }
    }

    /// As a frame shows it, but for its text.
    pub(crate) fn row(&self) -> [f32; 12] {
        let kind = match self.shape {
            MarkShape::Sphere { .. } => 0.0,
            MarkShape::Line { .. } => 1.0,
            MarkShape::Arrow { .. } => 2.0,
            MarkShape::Text { .. } => 3.0,
        };
        let (from, to, radius) = self.place();
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
