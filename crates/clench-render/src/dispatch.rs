//! The content of a dispatch: environments, and pictures of them.

use crate::camera::CameraPose;
use crate::canvas::Form;
use crate::items::{self, Item, Surface};
use crate::light::{FAR, Lamp, Lighting, REACH, Uniforms};
use crate::looks::Looks;
use crate::scene::Scene;
use crate::shapes::{COLOR_TOLERANCE, FACT_TOLERANCE, SHADOW_TOLERANCE, Sight};
use clench::collide::ShapeKind;
use clench::rigid::readout::light_poses;
use clench::rigid::{Precision, Sim};
use std::ops::Range;

/// The distance of the parameters of two pictures in their buffer, bytes: the largest alignment that devices require.
pub(crate) const STRIDE: usize = 512;
const _: () = assert!(size_of::<Uniforms>() <= STRIDE);

/// The parameters of a picture at their distance from the next.
#[repr(C)]
#[derive(Clone, Copy, zerocopy::IntoBytes, zerocopy::Immutable)]
pub(crate) struct Parameters {
    pub uniforms: Uniforms,
    padding: [u8; STRIDE - size_of::<Uniforms>()],
}

/// A draw call: the vertices of one shape for one or more items.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Drawn {
    pub vertices: Range<u32>,
    pub items: Range<u32>,
    pub surface: Surface,
    pub texture: Option<usize>,
    /// True if the back sides of triangles are hidden.
    pub culls: bool,
}

/// A picture.
pub(crate) struct Shot {
    /// The index of its environment in the dispatch.
    pub environment: usize,
    /// The place among all pictures of a call.
    pub slot: usize,
    pub opaque: Vec<Drawn>,
    pub transparent: Vec<Drawn>,
    /// The items whose distances and indices are drawn.
    pub facts: Vec<Drawn>,
}

/// The shadow map of an environment.
pub(crate) struct Shadow {
    /// A picture whose parameters have the view of the sun.
    pub shot: usize,
    /// `None` if no light casts shadows.
    pub casting: Option<Vec<Drawn>>,
}

/// The pictures of a dispatch.
#[derive(Default)]
pub(crate) struct Dispatch {
    pub items: Vec<Item>,
    pub lamps: Vec<Lamp>,
    pub parameters: Vec<Parameters>,
    pub shots: Vec<Shot>,
    pub shadows: Vec<Shadow>,
}

/// The present state of an environment, as pictures show it.
pub(crate) struct Snapshot {
    pub items: Vec<Item>,
    /// The items of tendon segments.
    strings: Range<usize>,
    lighting: Lighting,
    /// The visible geoms and sites.
    opaque: Vec<usize>,
    transparent: Vec<usize>,
}

impl Snapshot {
    /// Evaluates a simulation, with the looks of its model or with others.
    pub(crate) fn new<T: Precision>(
        scene: &Scene,
        sim: &mut Sim<T>,
        groups: &[usize],
        looks: Option<&Looks>,
    ) -> Result<Self, clench::SimError> {
        let mut items = scene.items.clone();
        let visuals = &scene.model.visuals;
        let (mut lights, mut headlight) = (&visuals.lights, &visuals.headlight);
        if let Some(looks) = looks {
            (lights, headlight) = (&looks.lights, &looks.headlight);
            let colors = looks.geom_rgba.iter().chain(&looks.site_rgba);
            for (item, &color) in items[..scene.groups.len()].iter_mut().zip(colors) {
                item.color = items::shown(&scene.model, color);
            }
        }
        for (item, pose) in items.iter_mut().zip(items::poses(sim)?) {
            item.pose = pose;
        }
        let stretches = items::stretches(sim, FAR * scene.extent);
        for (item, stretch) in items.iter_mut().zip(stretches) {
            item.stretch = stretch;
        }
        let marks = scene.groups.len();
        let seen = |&k: &usize| groups.contains(&scene.groups[k]) && items[k].color[3] > 0.0;
        let (opaque, transparent) = (0..marks)
            .filter(seen)
            .partition(|&k| items[k].color[3] >= 1.0);
        items.extend(items::of_tendons(sim)?);
        let centre = scene.centre(&items);
        let poses = light_poses(lights, sim.workspace());
        let reach = REACH * scene.extent;
        Ok(Snapshot {
            strings: scene.items.len()..items.len(),
            lighting: Lighting::new((lights, headlight), &poses, centre, reach),
            items,
            opaque,
            transparent,
        })
    }
}

impl Dispatch {
    /// Adds an environment; its pictures follow.
    pub(crate) fn add_environment(&mut self, scene: &Scene, shown: &Snapshot, form: &Form) {
        self.items.extend(&shown.items);
        self.lamps.extend(&shown.lighting.lamps);
        let casting = (form.colors && shown.lighting.casts).then(|| {
            let sight = Sight {
                camera: &shown.lighting.sun,
                height: form.shadow(),
                tolerance: SHADOW_TOLERANCE,
            };
            // Planes are excluded: they shade nothing visible and would shade themselves. So are sites, which are
            // marks.
            let plane = ShapeKind::Plane;
            let casts = |&&k: &&usize| (scene.model.geoms.get(k)).is_some_and(|g| g.kind != plane);
            let each = shown.opaque.iter().filter(casts);
            let each = each.map(|&k| self.draw(scene, shown, k, &sight));
            each.chain(self.draw_strings(scene, shown, &sight))
                .collect()
        });
        self.shadows.push(Shadow {
            shot: self.shots.len(),
            casting,
        });
    }

    /// Adds a picture of the last environment.
    pub(crate) fn add(
        &mut self,
        scene: &Scene,
        shown: &Snapshot,
        camera: &CameraPose,
        form: &Form,
        slot: usize,
    ) {
        let transparent = scene.sorted(&shown.items, &shown.transparent, camera);
        let [width, height] = form.size;
        let mut shot = Shot {
            environment: self.shadows.len() - 1,
            slot,
            opaque: Vec::new(),
            transparent: Vec::new(),
            facts: Vec::new(),
        };
        let sight = |tolerance| Sight {
            camera,
            height,
            tolerance,
        };
        if form.colors {
            let sight = sight(COLOR_TOLERANCE);
            let draw = |&k: &usize| self.draw(scene, shown, k, &sight);
            shot.opaque.extend(shown.opaque.iter().map(draw));
            shot.opaque.extend(self.draw_strings(scene, shown, &sight));
            shot.transparent.extend(transparent.iter().map(draw));
        }
        if form.facts {
            let sight = sight(FACT_TOLERANCE);
            let all = shown.opaque.iter().chain(&transparent);
            let geoms = all.filter(|&&k| k < scene.model.geoms.len());
            (shot.facts).extend(geoms.map(|&k| self.draw(scene, shown, k, &sight)));
            shot.facts.extend(self.draw_strings(scene, shown, &sight));
        }
        let aspect = width as f32 / height as f32;
        let lighting = &shown.lighting;
        let begins = (form.shadow(), self.lamps.len() - lighting.lamps.len());
        self.parameters.push(Parameters {
            uniforms: Uniforms::new(camera, aspect, scene.extent, lighting, begins),
            padding: [0; _],
        });
        self.shots.push(shot);
    }

    /// Returns the draw call of an item of the last environment.
    fn draw(&self, scene: &Scene, shown: &Snapshot, k: usize, sight: &Sight) -> Drawn {
        let (vertices, culls) = scene.shapes.at(k, &shown.items[k], sight);
        Drawn {
            vertices,
            items: self.of_last(shown, k..k + 1),
            surface: scene.surface_of[k],
            texture: scene.texture_of[k],
            culls,
        }
    }

    fn draw_strings(&self, scene: &Scene, shown: &Snapshot, sight: &Sight) -> Option<Drawn> {
        let segments = &shown.items[shown.strings.clone()];
        let pixels = |item: &Item| {
            let [side, _, along, [x, y, z, _]] = item.pose;
            let length = |v: [f32; 4]| v.iter().map(|x| x * x).sum::<f32>().sqrt();
            let nearest = sight.camera.distance([x, y, z]) - length(along);
            length(side) * sight.camera.pixels(nearest, sight.height)
        };
        let max_width = segments.iter().map(pixels).fold(0.0, f32::max);
        (!segments.is_empty()).then(|| Drawn {
            vertices: scene.shapes.string(max_width, sight.tolerance),
            items: self.of_last(shown, shown.strings.clone()),
            surface: Surface::Plain,
            texture: None,
            culls: true,
        })
    }

    /// Converts indices of items of the last environment to indices of items of the dispatch.
    fn of_last(&self, shown: &Snapshot, items: Range<usize>) -> Range<u32> {
        let first = self.items.len() - shown.items.len();
        (first + items.start) as u32..(first + items.end) as u32
    }
}
