//! Colours and lights that may differ from one picture to the next.

use clench::Model;
use clench::math::Vec3;
use clench::rigid::model::{Appearance, Headlight, Light};

/// The colours and lights of the pictures of a simulation: those of its model until they are changed.
#[derive(Clone, Debug)]
pub struct Looks {
    /// The colour and opacity of each geom, each part from 0 to 1; a colour multiplies a texture.
    pub geom_rgba: Vec<[f32; 4]>,
    /// The colour and opacity of each site.
    pub site_rgba: Vec<[f32; 4]>,
    /// The lights.
    pub lights: Vec<Light>,
    /// The light at the camera.
    pub headlight: Headlight,
}

/// A field of [`Looks`] as numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LookField {
    /// Its name.
    pub name: &'static str,
    /// The numbers of an element.
    pub width: usize,
    of: Part,
}

/// The part of the looks that a field is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Geoms,
    Sites,
    Positions,
    Directions,
    Lights(Color),
    Headlight(Color),
}

/// A colour of a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Color {
    Ambient,
    Diffuse,
    Specular,
}

impl Color {
    /// Returns that of the three colours of a light.
    fn of<T>(self, [ambient, diffuse, specular]: [T; 3]) -> T {
        match self {
            Color::Ambient => ambient,
            Color::Diffuse => diffuse,
            Color::Specular => specular,
        }
    }
}

impl LookField {
    /// All fields.
    pub const ALL: [LookField; 10] = [
        Self::new("geom_rgba", 4, Part::Geoms),
        Self::new("site_rgba", 4, Part::Sites),
        Self::new("light_pos", 3, Part::Positions),
        Self::new("light_dir", 3, Part::Directions),
        Self::new("light_ambient", 3, Part::Lights(Color::Ambient)),
        Self::new("light_diffuse", 3, Part::Lights(Color::Diffuse)),
        Self::new("light_specular", 3, Part::Lights(Color::Specular)),
        Self::new("headlight_ambient", 3, Part::Headlight(Color::Ambient)),
        Self::new("headlight_diffuse", 3, Part::Headlight(Color::Diffuse)),
        Self::new("headlight_specular", 3, Part::Headlight(Color::Specular)),
    ];

    const fn new(name: &'static str, width: usize, of: Part) -> Self {
        LookField { name, width, of }
    }

    /// Returns true if it is about geoms.
    pub fn is_of_geoms(self) -> bool {
        self.of == Part::Geoms
    }

    /// Returns true if it is a direction, which has a length, and not a colour.
    pub fn is_direction(self) -> bool {
        self.of == Part::Directions
    }

    /// Returns the range of its numbers.
    pub fn range(self) -> [f64; 2] {
        match self.of {
            Part::Geoms | Part::Sites => [0.0, 1.0],
            Part::Positions | Part::Directions => [f64::MIN, f64::MAX],
            Part::Lights(_) | Part::Headlight(_) => [0.0, f64::MAX],
        }
    }

    /// Returns its shape in a model.
    pub fn shape(self, model: &Model) -> Vec<usize> {
        match self.of {
            Part::Geoms => vec![model.geoms.len(), self.width],
            Part::Sites => vec![model.sites.len(), self.width],
            Part::Positions | Part::Directions | Part::Lights(_) => {
                vec![model.visuals.lights.len(), self.width]
            }
            Part::Headlight(_) => vec![self.width],
        }
    }
}

impl Looks {
    /// Returns the looks of a model.
    pub fn of(model: &Model) -> Self {
        let visuals = &model.visuals;
        let colors = |all: &[Appearance]| all.iter().map(|&one| visuals.rgba(one)).collect();
        Looks {
            geom_rgba: colors(&visuals.geoms),
            site_rgba: colors(&visuals.sites),
            lights: visuals.lights.clone(),
            headlight: visuals.headlight,
        }
    }

    /// Returns the numbers of a field.
    pub fn values(&self, field: LookField) -> Vec<f64> {
        let colors = |all: &[[f32; 4]]| all.as_flattened().iter().map(|&x| f64::from(x)).collect();
        let lights = |number: &dyn Fn(&Light) -> [f64; 3]| {
            let all = self.lights.iter().flat_map(number);
            all.collect()
        };
        match field.of {
            Part::Geoms => colors(&self.geom_rgba),
            Part::Sites => colors(&self.site_rgba),
            Part::Positions => lights(&|light| light.pos.to_array()),
            Part::Directions => lights(&|light| light.dir.to_array()),
            Part::Lights(color) => lights(&|light| {
                let own = &light.properties;
                color.of([own.ambient, own.diffuse, own.specular])
            }),
            Part::Headlight(color) => {
                let own = &self.headlight;
                color.of([own.ambient, own.diffuse, own.specular]).to_vec()
            }
        }
    }

    /// Sets the numbers of a field; directions are normalized.
    pub fn set(&mut self, field: LookField, values: &[f64]) {
        let paint = |all: &mut [[f32; 4]]| {
            for (to, from) in all.iter_mut().zip(values.as_chunks::<4>().0) {
                *to = from.map(|x| x as f32);
            }
        };
        let rows = values.as_chunks::<3>().0;
        let lights = self.lights.iter_mut().zip(rows);
        match field.of {
            Part::Geoms => paint(&mut self.geom_rgba),
            Part::Sites => paint(&mut self.site_rgba),
            Part::Positions => lights.for_each(|(own, &row)| own.pos = Vec3::from_array(row)),
            Part::Directions => {
                lights.for_each(|(own, &row)| own.dir = Vec3::from_array(row).normalize().0);
            }
            Part::Lights(color) => lights.for_each(|(light, &row)| {
                let own = &mut light.properties;
                *color.of([&mut own.ambient, &mut own.diffuse, &mut own.specular]) = row;
            }),
            Part::Headlight(color) => {
                let own = &mut self.headlight;
                let to = color.of([&mut own.ambient, &mut own.diffuse, &mut own.specular]);
                rows.iter().for_each(|&row| *to = row);
            }
        }
    }
}
