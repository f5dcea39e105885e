//! Meshes: an author's mesh becomes one about its centre of mass, along its principal axes, with its hull, by the
//! rules of MuJoCo's compiler.

use super::element::Element;
use super::solid::Solid;
use super::{BuildError, MeshInertia, MeshSpec};
use clench_collide::{Hull, HullSurface, convex_hull};
use clench_dynamics::model::Mesh;
use clench_math::{Mat3, Quat, Vec3, rough_principal_axes};

/// Volumes (m³) and areas (m²) below this count as zero (MuJoCo's `mjMINVAL`).
const NEGLIGIBLE: f64 = 1e-15;
/// Triangles of less area (m²) have no orientation (the root of `mjMINVAL`).
const NO_ORIENTATION: f64 = 3.162_277_660_168_379e-8;
/// The relative precision of the inertia of vertices with 24 bits per coordinate, as a fraction of its largest entry
/// (MuJoCo's measure).
const UNCERTAINTY: f64 = 1e-7;
/// The amount by which a principal moment may exceed the sum of the others, as a fraction of it and in m⁵.
const IMPLAUSIBLE: (f64, f64) = (1e-6, 1e-9);

/// Returns the bounding box of a mesh in its frame, m: its lowest and its highest corner.
pub(super) fn bounding_box(mesh: &Mesh) -> [Vec3<f64>; 2] {
    [f64::min as fn(f64, f64) -> f64, f64::max].map(|pick| {
        let all = mesh.vertices.iter().copied();
        all.reduce(|a, b| Vec3::new(pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z)))
            .unwrap_or(Vec3::ZERO)
    })
}

/// Returns the maximum distance of a mesh from its origin along each axis, m.
pub(super) fn reach(mesh: &Mesh) -> Vec3<f64> {
    let [low, high] = bounding_box(mesh).map(Vec3::to_array);
    Vec3::from_array(std::array::from_fn(|i| low[i].abs().max(high[i].abs())))
}

/// Processes a mesh for use in a model. `keeps_hull` requests its convex hull.
///
/// # Errors
/// Returns an error if there are too few vertices, an index is out of range, a number is not finite, the volume is
/// zero, or the triangles are not consistently oriented.
pub(super) fn process(spec: &MeshSpec, keeps_hull: bool) -> Result<Mesh, BuildError> {
    check(spec)?;
    let needs_hull = keeps_hull || spec.faces.is_empty() || spec.inertia == MeshInertia::Convex;
    let surface = match needs_hull {
        true => {
            let found = convex_hull(&spec.vertices, spec.max_hull_vertices);
            Some(found.map_err(|error| spec.error(error.to_string()))?)
        }
        false => None,
    };
    let vertices = in_own_frame(spec);
    let faces = faces(spec, surface.as_ref());
    let hull_faces = surface
        .as_ref()
        .map(|surface| oriented(spec, surface.triangles()));
    let weighed = match &hull_faces {
        Some(hull) if spec.inertia == MeshInertia::Convex => hull,
        _ => &faces,
    };
    let mass = weigh(spec, &vertices, &faces, weighed)?;
    let turn = mass.quat.conjugate();
    let vertices: Vec<Vec3<f64>> = (vertices.iter())
        .map(|&v| turn.rotate(v - mass.pos))
        .collect();
    let tangents = (spec.tangents.iter())
        .map(|pair| tangents_in_own_frame(spec, pair).map(|tangent| turn.rotate(tangent)))
        .collect();
    Ok(Mesh {
        name: spec.name.clone(),
        pos: mass.pos,
        quat: mass.quat,
        measure: mass.measure,
        half_box: mass.half_box,
        hull: surface
            .filter(|_| keeps_hull)
            .map(|s| Hull::new(&s, &vertices)),
        texcoords: spec.texcoords.clone(),
        face_texcoords: face_texcoords(spec, &faces),
        tangents,
        spec: spec.clone(),
        on_demand: Default::default(),
        vertices,
        faces,
    })
}

fn check(spec: &MeshSpec) -> Result<(), BuildError> {
    if let Some(reason) = &spec.unreadable {
        return Err(spec.error(reason));
    }
    if spec.vertices.len() < 4 {
        let count = spec.vertices.len();
        return Err(spec.error(format!("at least four vertices are needed, not {count}")));
    }
    let finite = |v: &Vec3<f64>| v.to_array().iter().all(|x| x.is_finite());
    if let Some(bad) = spec.vertices.iter().position(|v| !finite(v)) {
        return Err(spec.error(format!("a coordinate of vertex {bad} is not finite")));
    }
    let missing = |&c: &u32| c as usize >= spec.vertices.len();
    for (number, face) in spec.faces.iter().enumerate() {
        if let Some(vertex) = face.iter().copied().find(missing) {
            let message = format!("face {number} refers to vertex {vertex}, which does not exist");
            return Err(spec.error(message));
        }
    }
    check_texcoords(spec)?;
    if !spec.tangents.is_empty() && spec.tangents.len() != spec.vertices.len() {
        let counts = (spec.tangents.len(), spec.vertices.len());
        return Err(spec.error(format!(
            "has {} tangents for {} vertices",
            counts.0, counts.1
        )));
    }
    if !spec.tangents.iter().flatten().all(finite) {
        return Err(spec.error("a tangent is not finite"));
    }
    spec.require_finite("refpos", &spec.refpos.to_array())?;
    spec.require_finite("refquat", &spec.refquat.to_array())?;
    spec.require_finite("scale", &spec.scale.to_array())?;
    match spec.inertia {
        MeshInertia::Exact => check_orientation(spec),
        MeshInertia::Convex | MeshInertia::Legacy | MeshInertia::Shell => Ok(()),
    }
}

fn check_texcoords(spec: &MeshSpec) -> Result<(), BuildError> {
    let (places, corners) = (spec.texcoords.len(), spec.face_texcoords.len());
    if corners == 0 && places > 0 && places != spec.vertices.len() {
        let count = spec.vertices.len();
        return Err(spec.error(format!(
            "{places} texture coordinates do not match {count} vertices"
        )));
    }
    if corners > 0 && corners != spec.faces.len() {
        let count = spec.faces.len();
        return Err(spec.error(format!(
            "texture coordinates of {corners} triangles do not match {count} triangles"
        )));
    }
    let missing = |&c: &u32| c as usize >= places;
    if let Some(place) = spec
        .face_texcoords
        .as_flattened()
        .iter()
        .copied()
        .find(missing)
    {
        return Err(spec.error(format!("there is no texture coordinate {place}")));
    }
    match spec.texcoords.as_flattened().iter().all(|x| x.is_finite()) {
        true => Ok(()),
        false => Err(spec.error("a texture coordinate is not finite")),
    }
}

/// Checks the orientation: in a closed surface with consistent triangles, no two traverse an edge in the same
/// direction.
fn check_orientation(spec: &MeshSpec) -> Result<(), BuildError> {
    let mut halves = Vec::with_capacity(3 * spec.faces.len());
    for &[a, b, c] in &spec.faces {
        let [p, q, r] = [a, b, c].map(|i| spec.vertices[i as usize]);
        if (q - p).cross(r - p).norm() * 0.5 > NO_ORIENTATION {
            halves.extend([(a, b), (b, c), (c, a)]);
        }
    }
    halves.sort_unstable();
    match halves.windows(2).find(|pair| pair[0] == pair[1]) {
        None => Ok(()),
        Some(pair) => Err(spec.error(format!(
            "its faces are not oriented consistently: see those with the vertices {} and {} (inertia \"convex\" and \"legacy\" do \
             not require it)",
            pair[0].0, pair[0].1
        ))),
    }
}

/// Returns the vertices after reference position, orientation and scale.
fn in_own_frame(spec: &MeshSpec) -> Vec<Vec3<f64>> {
    let back = spec.refquat.normalize().conjugate();
    (spec.vertices.iter())
        .map(|&v| back.rotate(v - spec.refpos).scale_by(spec.scale))
        .collect()
}

/// Returns the tangents after reference orientation and scale. MuJoCo divides them by the scale, as normals, in single
/// precision, which is visible in speeds along them.
fn tangents_in_own_frame(spec: &MeshSpec, tangents: &[Vec3<f64>; 2]) -> [Vec3<f64>; 2] {
    let back = spec.refquat.normalize().conjugate();
    let scale = spec.scale.to_array();
    tangents.map(|tangent| {
        let turned = back.rotate(tangent).to_array().map(|x| x as f32);
        let [x, y, z] = std::array::from_fn(|i| (f64::from(turned[i]) / scale[i]) as f32);
        let squared = x * x + y * y + z * z;
        let unit = match f64::from(squared) > NEGLIGIBLE {
            true => [x, y, z].map(|x| x * (1.0 / squared.sqrt())),
            false => [0.0, 0.0, 1.0],
        };
        Vec3::from_array(unit.map(f64::from))
    })
}

fn faces(spec: &MeshSpec, surface: Option<&HullSurface>) -> Vec<[u32; 3]> {
    match surface {
        Some(surface) if spec.faces.is_empty() => oriented(spec, surface.triangles()),
        _ => oriented(spec, &spec.faces),
    }
}

/// Returns the texture coordinates of the corners of each triangle.
fn face_texcoords(spec: &MeshSpec, faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    match (spec.texcoords.is_empty(), spec.face_texcoords.is_empty()) {
        (true, _) => Vec::new(),
        (_, true) => faces.to_vec(),
        _ => oriented(spec, &spec.face_texcoords),
    }
}

/// Returns the triangles with an orientation that a mirroring scale does not invert.
fn oriented(spec: &MeshSpec, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mirrors = spec.scale.x * spec.scale.y * spec.scale.z < 0.0;
    let turn = |&[a, b, c]: &[u32; 3]| if mirrors { [a, c, b] } else { [a, b, c] };
    triangles.iter().map(turn).collect()
}

/// The mass frame of a mesh, and its equivalent box.
struct MassFrame {
    pos: Vec3<f64>,
    quat: Quat<f64>,
    measure: f64,
    half_box: Vec3<f64>,
}

fn weigh(
    spec: &MeshSpec,
    vertices: &[Vec3<f64>],
    faces: &[[u32; 3]],
    weighed: &[[u32; 3]],
) -> Result<MassFrame, BuildError> {
    let solid = |triangles| Solid {
        vertices,
        triangles,
        spread: spec.inertia,
    };
    let (apex, area) = solid(faces).surface();
    if area.is_nan() || area < NEGLIGIBLE {
        return Err(spec.error("its surface is too small"));
    }
    let (pos, measure) = solid(weighed).center(apex);
    if measure.is_nan() || measure < NEGLIGIBLE {
        return Err(spec.error(match measure < 0.0 {
            true => "its volume is negative: its triangles face inwards",
            false => "its volume is too small (inertia \"shell\" needs none)",
        }));
    }
    let (inertia, measure) = solid(weighed).inertia(pos);
    let (moments, quat) = rough_principal_axes(&inertia, UNCERTAINTY);
    Ok(MassFrame {
        pos,
        quat,
        measure,
        half_box: equivalent_box(spec, moments, measure, &inertia)?,
    })
}

/// Returns the half sizes of the box with these moments at density one and this volume: about x, V (b² + c²) / 3, and
/// so on.
fn equivalent_box(
    spec: &MeshSpec,
    moments: Vec3<f64>,
    measure: f64,
    inertia: &Mat3<f64>,
) -> Result<Vec3<f64>, BuildError> {
    let entries = inertia.rows.iter().flat_map(|row| row.to_array());
    if moments.z.is_nan() || moments.z <= 0.0 || entries.into_iter().any(|x| !x.is_finite()) {
        return Err(spec.error("its inertia is not positive: its triangles enclose no volume"));
    }
    let total = moments.x + moments.y + moments.z;
    let mut half = Vec3::ZERO;
    for axis in 0..3 {
        let excess = total - 2.0 * moments[axis];
        if excess < -(IMPLAUSIBLE.0 * moments[axis] + IMPLAUSIBLE.1) {
            let [a, b, c] = moments.to_array();
            return Err(spec.error(format!(
                "no solid has the principal moments {a}, {b}, {c}: its triangles enclose no volume"
            )));
        }
        half[axis] = 0.5 * (6.0 * excess.max(0.0) / measure).sqrt();
    }
    Ok(half)
}
