//! The use of meshes and height fields by geoms: their own frame and size, or a fitted primitive.

use super::element::Element;
use super::meshes::{bounding_box, reach};
use super::model_builder::ModelBuilder;
use super::processed_meshes::{find_or_process, keep};
use super::resolve::Names;
use super::uses::GeomUses;
use super::visuals::Palette;
use super::{BuildError, GeomSpec, SensorSubject, SiteSpec};
use clench_collide::{Shape, ShapeKind};
use clench_dynamics::model::{HeightField, Mesh, Model};
use clench_math::{Motion, Quat, Vec3};
use std::sync::Arc;

/// The processed meshes and height fields of a model.
pub(super) struct Assets<'a> {
    /// The geoms that collide and those that are discarded.
    pub(super) uses: GeomUses<'a>,
    names: Names<'a>,
    field_names: Names<'a>,
    /// The meshes. With `discardvisual`, an invalid one is an error only if a geom, site or sensor uses it.
    meshes: Vec<Result<Arc<Mesh>, BuildError>>,
    pub height_fields: Vec<Arc<HeightField>>,
    /// The appearance of elements.
    pub palette: Arc<Palette>,
    /// Fit primitives to bounding boxes instead of equivalent boxes.
    fitaabb: bool,
}

/// A geom in its body, with the data from its mesh or height field.
pub(super) struct PlacedGeom<'a> {
    pub spec: &'a GeomSpec,
    pub pos: Vec3<f64>,
    /// A unit quaternion.
    pub quat: Quat<f64>,
    pub size: Vec3<f64>,
    /// Velocity of the surface at its origin, along its axes: linear, angular.
    pub surfacevel: [f64; 6],
    /// Radius of its bounding sphere about its origin; 0 for a plane.
    pub(crate) rbound: f64,
    /// For mesh geoms.
    pub mesh: Option<(usize, &'a Mesh)>,
    /// For height fields.
    pub height_field: Option<usize>,
}

impl<'a> Assets<'a> {
    /// Processes the meshes and height fields of a description.
    ///
    /// # Errors
    /// Returns an error if a name is already used, or an asset is invalid.
    pub(super) fn new(builder: &'a ModelBuilder) -> Result<Self, BuildError> {
        let names = Names::new(&builder.meshes)?;
        let uses = GeomUses::of(builder);
        // Contacts and volumes of sites use hulls.
        let mut needs_hull = vec![false; builder.meshes.len()];
        for geom in builder.bodies.iter().flat_map(|body| &body.geoms) {
            let counts = geom.kind == ShapeKind::Mesh && uses.collides(geom);
            if counts && let Ok(mesh) = names.find(&geom.mesh, geom) {
                needs_hull[mesh] = true;
            }
        }
        for site in builder.bodies.iter().flat_map(|body| &body.sites) {
            if let Ok(mesh) = names.find(&site.mesh, site) {
                needs_hull[mesh] = true;
            }
        }
        let meshes = (builder.meshes.iter().zip(needs_hull))
            .map(
                |(spec, needs_hull)| match find_or_process(spec, needs_hull) {
                    Err(error) if !builder.compiler.discardvisual => Err(error),
                    mesh => Ok(mesh),
                },
            )
            .collect::<Result<_, _>>()?;
        let height_fields = (builder.height_fields.iter())
            .map(|spec| {
                let heights = spec.heights.clone();
                let shape =
                    clench_collide::HeightField::new(spec.rows, spec.columns, heights, spec.size);
                Ok(Arc::new(HeightField {
                    name: spec.name.clone(),
                    heights: spec.heights.clone(),
                    shape: shape.map_err(|error| spec.error(error.to_string()))?,
                }))
            })
            .collect::<Result<_, _>>()?;
        Ok(Assets {
            uses,
            names,
            field_names: Names::new(&builder.height_fields)?,
            meshes,
            height_fields,
            palette: Arc::new(Palette::new(builder)),
            fitaabb: builder.compiler.fitaabb,
        })
    }

    /// Moves the assets to a model that has all its geoms. With `discardvisual`, unused meshes are omitted.
    ///
    /// # Errors
    /// Returns an error if a mesh that is used is invalid.
    pub(super) fn move_into(
        self,
        builder: &ModelBuilder,
        model: &mut Model,
    ) -> Result<(), BuildError> {
        let mut used = vec![!builder.compiler.discardvisual; self.meshes.len()];
        for geom in builder.bodies.iter().flat_map(|body| &body.geoms) {
            // A primitive that was fitted to a mesh also retains it, as in MuJoCo.
            if !self.uses.is_discarded(geom)
                && let Ok(mesh) = self.names.find(&geom.mesh, geom)
            {
                used[mesh] = true;
            }
        }
        for site in builder.bodies.iter().flat_map(|body| &body.sites) {
            if let Ok(mesh) = self.names.find(&site.mesh, site) {
                used[mesh] = true;
            }
        }
        for sensor in &builder.sensors {
            if let SensorSubject::Taxels { mesh, .. } = &sensor.subject
                && let Ok(mesh) = self.names.find(mesh, sensor)
            {
                used[mesh] = true;
            }
        }
        let mut number = vec![0; used.len()];
        for (index, mesh) in self.meshes.into_iter().enumerate() {
            number[index] = model.meshes.len();
            if used[index] {
                model.meshes.push(mesh?);
            }
        }
        keep(&model.meshes);
        let geoms = model.geoms.iter_mut().map(|geom| &mut geom.mesh);
        let sites = model.sites.iter_mut().map(|site| &mut site.mesh);
        for mesh in geoms.chain(sites).flatten() {
            *mesh = number[*mesh];
        }
        model.height_fields = self.height_fields;
        Ok(())
    }

    /// Returns a mesh that an element uses, and its index.
    ///
    /// # Errors
    /// Returns an error if the mesh is unknown or invalid.
    fn mesh(&self, name: &str, user: &impl Element) -> Result<(usize, &Mesh), BuildError> {
        let index = self.names.find(name, user)?;
        let mesh = self.meshes[index].as_ref();
        Ok((index, mesh.map_err(Clone::clone)?))
    }

    /// Checks a geom that is omitted from the model. Its mesh may be invalid.
    ///
    /// # Errors
    /// Returns the other errors of [`place`](Self::place).
    pub(super) fn check_discarded(&self, spec: &GeomSpec) -> Result<(), BuildError> {
        match self.names.find(&spec.mesh, spec) {
            Ok(mesh) if self.meshes[mesh].is_err() => Ok(()),
            Ok(_) | Err(_) => self.place(spec).map(drop),
        }
    }

    /// Returns the mesh whose hull is a site's volume.
    ///
    /// # Errors
    /// Returns an error if the mesh is unknown, missing, or named by a site that is not a mesh.
    pub(super) fn mesh_of_site(
        &self,
        spec: &SiteSpec,
    ) -> Result<Option<(usize, &Mesh)>, BuildError> {
        match (spec.kind == ShapeKind::Mesh, spec.mesh.is_empty()) {
            (false, true) => Ok(None),
            (false, false) => Err(spec.error("only a site of type mesh can refer to a mesh")),
            (true, true) => Err(spec.error("a site of type mesh must refer to a mesh")),
            (true, false) => self.mesh(&spec.mesh, spec).map(Some),
        }
    }

    /// Returns a geom with the data from its mesh or height field.
    ///
    /// # Errors
    /// Returns an error if a name is unknown, a reference does not match the shape, or a size is not positive.
    pub(super) fn place(&'a self, spec: &'a GeomSpec) -> Result<PlacedGeom<'a>, BuildError> {
        if !spec.hfield.is_empty() && spec.kind != ShapeKind::HeightField {
            return Err(spec.error("only a geom of type hfield can refer to a height field"));
        }
        let mut placed = PlacedGeom {
            spec,
            pos: spec.pos,
            quat: spec.quat.normalize(),
            size: spec.size,
            surfacevel: spec.surfacevel,
            rbound: 0.0,
            mesh: None,
            height_field: None,
        };
        if spec.kind == ShapeKind::HeightField {
            let field = self.field_names.find(&spec.hfield, spec)?;
            placed.use_height_field(field, &self.height_fields[field].shape);
        } else if spec.kind == ShapeKind::Mesh || !spec.mesh.is_empty() {
            let (index, mesh) = self.mesh(&spec.mesh, spec)?;
            placed.use_mesh(index, mesh, self.fitaabb)?;
        }
        check_size(spec, placed.size)?;
        if !matches!(spec.kind, ShapeKind::Plane | ShapeKind::HeightField) {
            placed.rbound = Shape::new(spec.kind, placed.size).bounding_radius();
        }
        spec.require_finite("bounding radius", &[placed.rbound])?;
        Ok(placed)
    }
}

impl<'a> PlacedGeom<'a> {
    fn use_height_field(&mut self, index: usize, field: &clench_collide::HeightField) {
        let [x, y, elevation, base] = field.size();
        self.size = Vec3::new(x, y, 0.25 * elevation + 0.5 * base);
        self.rbound = field.radius();
        self.height_field = Some(index);
    }

    /// Uses the mesh itself, or the primitive that fits it, in the mesh's frame.
    fn use_mesh(&mut self, index: usize, mesh: &'a Mesh, fitaabb: bool) -> Result<(), BuildError> {
        let mut center = Vec3::ZERO;
        if self.spec.kind == ShapeKind::Mesh {
            if self.spec.shellinertia {
                return Err(self.spec.error(
                    "shellinertia is not for meshes: set inertia=\"shell\" of the mesh asset",
                ));
            }
            self.size = reach(mesh);
            self.mesh = Some((index, mesh));
        } else if fitaabb {
            let [low, high] = bounding_box(mesh);
            center = (low + high) * 0.5;
            self.size = enclosing_size(self.spec, high - center)? * self.spec.fitscale;
        } else {
            self.size = equivalent_size(self.spec, mesh.half_box)? * self.spec.fitscale;
        }
        let quat = mesh.quat;
        let pos = mesh.pos + quat.rotate(center);
        self.surfacevel = surfacevel_in_frame(&self.surfacevel, pos, quat);
        self.pos += self.quat.rotate(pos);
        self.quat = (self.quat * quat).normalize();
        Ok(())
    }
}

/// Transforms a geom's `surfacevel` (linear, angular) to another frame, which is at `offset` in the geom's and rotated
/// by `rotation`.
pub fn surfacevel_in_frame(
    surfacevel: &[f64; 6],
    offset: Vec3<f64>,
    rotation: Quat<f64>,
) -> [f64; 6] {
    let [linear, angular] = [&surfacevel[..3], &surfacevel[3..]].map(Vec3::from_slice);
    let [a, b, c, x, y, z] = (Motion::new(angular, linear).in_frame(offset, rotation)).to_array();
    [x, y, z, a, b, c]
}

/// Returns the size of a primitive equivalent to a box with these half sizes.
fn equivalent_size(spec: &GeomSpec, half: Vec3<f64>) -> Result<Vec3<f64>, BuildError> {
    let radius = 0.5 * (half.x + half.y);
    let size = match spec.kind {
        ShapeKind::Sphere => [(half.x + half.y + half.z) / 3.0, 0.0, 0.0],
        ShapeKind::Capsule => [radius, (half.z - 0.5 * radius).max(0.0), 0.0],
        ShapeKind::Cylinder => [radius, half.z, 0.0],
        ShapeKind::Ellipsoid | ShapeKind::Box => half.to_array(),
        ShapeKind::Plane | ShapeKind::HeightField | ShapeKind::Mesh => {
            return Err(spec.error("this shape cannot be fitted to a mesh"));
        }
    };
    Ok(Vec3::from_array(size))
}

/// Returns the size of the smallest primitive whose bounding box contains one with these half sizes.
fn enclosing_size(spec: &GeomSpec, half: Vec3<f64>) -> Result<Vec3<f64>, BuildError> {
    let radius = half.x.max(half.y);
    let size = match spec.kind {
        ShapeKind::Sphere => [radius.max(half.z), 0.0, 0.0],
        ShapeKind::Capsule => [radius, half.z - radius, 0.0],
        ShapeKind::Cylinder => [radius, half.z, 0.0],
        ShapeKind::Ellipsoid | ShapeKind::Box => half.to_array(),
        ShapeKind::Plane | ShapeKind::HeightField | ShapeKind::Mesh => {
            return Err(spec.error("this shape cannot be fitted to a mesh"));
        }
    };
    Ok(Vec3::from_array(size))
}

fn check_size(spec: &GeomSpec, size: Vec3<f64>) -> Result<(), BuildError> {
    // MuJoCo requires a plane's third number, the spacing of its grid, though it is unused.
    let used = match spec.kind {
        ShapeKind::Plane => 2..3,
        ShapeKind::Sphere => 0..1,
        ShapeKind::Capsule | ShapeKind::Cylinder => 0..2,
        ShapeKind::Ellipsoid | ShapeKind::Box => 0..3,
        // Positive by construction.
        ShapeKind::HeightField | ShapeKind::Mesh => 0..0,
    };
    for i in used {
        if size[i].is_nan() || size[i] <= 0.0 {
            return Err(spec.error(format!(
                "size[{i}] of a {} must be positive, but is {}",
                shape_name(spec.kind),
                size[i]
            )));
        }
    }
    Ok(())
}

fn shape_name(kind: ShapeKind) -> &'static str {
    match kind {
        ShapeKind::Plane => "plane",
        ShapeKind::HeightField => "height field",
        ShapeKind::Sphere => "sphere",
        ShapeKind::Capsule => "capsule",
        ShapeKind::Ellipsoid => "ellipsoid",
        ShapeKind::Cylinder => "cylinder",
        ShapeKind::Box => "box",
        ShapeKind::Mesh => "mesh",
    }
}
