//! How much room a shape takes, and how its mass resists rotation.
//!
//! Solids are homogeneous; a shell spreads its mass evenly over the surface. Sizes are MuJoCo's half sizes, moments are
//! about the shape's own origin and axes, which are principal for every shape here. Textbook integrals; where MuJoCo
//! approximates (the ellipsoid's shell, a height field as a box) its approximation is used, so that a file means the same mass.

use super::placed::PlacedGeom;
use clench_collide::ShapeKind;
use clench_math::Vec3;
use std::f64::consts::PI;

/// Exponent of Thomsen's formula for the surface of an ellipsoid, as in MuJoCo.
const THOMSEN: f64 = 1.6075;
/// Thickness (m) of the layer that stands for an ellipsoid's shell, as in MuJoCo.
const LAYER: f64 = 1e-6;

/// Volume in m³, or the surface in m² of a shell. A plane has neither.
pub(super) fn measure(geom: &PlacedGeom) -> f64 {
    let Vec3 { x: a, y: b, z: c } = geom.size;
    let (radius, height) = (a, 2.0 * b);
    match (geom.spec.kind, geom.spec.shellinertia) {
        (ShapeKind::Plane, _) => 0.0,
        (ShapeKind::Mesh, _) => geom.mesh.map_or(0.0, |(_, mesh)| mesh.measure),
        (ShapeKind::Sphere, false) => 4.0 * PI * a * a * a / 3.0,
        (ShapeKind::Sphere, true) => 4.0 * PI * a * a,
        (ShapeKind::Capsule, false) => {
            PI * (radius * radius * height + 4.0 * radius * radius * radius / 3.0)
        }
        (ShapeKind::Capsule, true) => 4.0 * PI * radius * radius + 2.0 * PI * radius * height,
        (ShapeKind::Cylinder, false) => PI * radius * radius * height,
        (ShapeKind::Cylinder, true) => 2.0 * PI * radius * radius + 2.0 * PI * radius * height,
        (ShapeKind::Ellipsoid, false) => 4.0 * PI * a * b * c / 3.0,
        (ShapeKind::Ellipsoid, true) => {
            let sum = (a * b).powf(THOMSEN) + (b * c).powf(THOMSEN) + (c * a).powf(THOMSEN);
            4.0 * PI * (sum / 3.0).powf(1.0 / THOMSEN)
        }
        (ShapeKind::Box | ShapeKind::HeightField, false) => a * b * c * 8.0,
        (ShapeKind::Box | ShapeKind::HeightField, true) => 8.0 * (a * b + b * c + c * a),
    }
}

/// Principal moments in kg m² of the shape with this mass, about its own axes.
pub(super) fn moments(geom: &PlacedGeom, mass: f64) -> Vec3<f64> {
    let size = geom.size;
    match (geom.spec.kind, geom.spec.shellinertia) {
        (ShapeKind::Plane, _) => Vec3::ZERO,
        (ShapeKind::Mesh, _) => {
            let half = geom.mesh.map_or(Vec3::ZERO, |(_, mesh)| mesh.half_box);
            about_axes(half.scale_by(half) * (mass / 3.0))
        }
        (ShapeKind::Sphere, false) => equal(2.0 * mass * size.x * size.x / 5.0),
        (ShapeKind::Sphere, true) => equal(2.0 * mass * size.x * size.x / 3.0),
        (ShapeKind::Capsule, false) => capsule(size.x, size.y, mass),
        (ShapeKind::Capsule, true) => capsule_shell(size.x, size.y, mass),
        (ShapeKind::Cylinder, false) => cylinder(size.x, size.y, mass),
        (ShapeKind::Cylinder, true) => cylinder_shell(size.x, size.y, mass),
        (ShapeKind::Ellipsoid, false) => about_axes(size.scale_by(size) * (mass / 5.0)),
        (ShapeKind::Ellipsoid, true) => ellipsoid_shell(size, mass),
        (ShapeKind::Box | ShapeKind::HeightField, false) => {
            about_axes(size.scale_by(size) * (mass / 3.0))
        }
        (ShapeKind::Box | ShapeKind::HeightField, true) => box_shell(size, mass),
    }
}

fn equal(moment: f64) -> Vec3<f64> {
    Vec3::new(moment, moment, moment)
}

/// Moments about an axis of symmetry z and across it.
fn axial(across: f64, along: f64) -> Vec3<f64> {
    Vec3::new(across, across, along)
}

/// Moments from second moments ∫x² dm, ∫y² dm, ∫z² dm: about an axis, the other two add up.
fn about_axes(second: Vec3<f64>) -> Vec3<f64> {
    Vec3::new(
        second.y + second.z,
        second.x + second.z,
        second.x + second.y,
    )
}

/// A cylinder between two hemispheres. A solid hemisphere's centre of mass is 3r/8 from its flat face, so moving it by
/// h/2 adds m ((h/2 + 3r/8)² − (3r/8)²) = m h (3r + 2h) / 8.
fn capsule(radius: f64, half_height: f64, mass: f64) -> Vec3<f64> {
    let height = 2.0 * half_height;
    let caps = mass * 4.0 * radius / (4.0 * radius + 3.0 * height);
    let sphere = 2.0 * caps * radius * radius / 5.0;
    let moved = caps * height * (3.0 * radius + 2.0 * height) / 8.0;
    cylinder(radius, half_height, mass - caps) + axial(sphere + moved, sphere)
}

/// As the solid, with a hollow hemisphere's centre of mass r/2 from its rim.
fn capsule_shell(radius: f64, half_height: f64, mass: f64) -> Vec3<f64> {
    let caps = mass * radius / (radius + half_height);
    let sphere = 2.0 * caps * radius * radius / 3.0;
    let moved = caps * half_height * (half_height + radius);
    tube(radius, half_height, mass - caps) + axial(sphere + moved, sphere)
}

fn cylinder(radius: f64, half_height: f64, mass: f64) -> Vec3<f64> {
    let (rr, hh) = (radius * radius, half_height * half_height);
    axial(mass * (3.0 * rr + 4.0 * hh) / 12.0, mass * rr / 2.0)
}

/// The curved surface of a cylinder.
fn tube(radius: f64, half_height: f64, mass: f64) -> Vec3<f64> {
    let (rr, hh) = (radius * radius, half_height * half_height);
    axial(mass * (6.0 * rr + 4.0 * hh) / 12.0, mass * rr)
}

/// A tube and two discs.
fn cylinder_shell(radius: f64, half_height: f64, mass: f64) -> Vec3<f64> {
    let discs = mass * radius / (radius + 2.0 * half_height);
    let (rr, hh) = (radius * radius, half_height * half_height);
    tube(radius, half_height, mass - discs) + axial(discs * (rr / 4.0 + hh), discs * rr / 2.0)
}

/// The difference of two solids whose semi-axes differ by [`LAYER`].
fn ellipsoid_shell(size: Vec3<f64>, mass: f64) -> Vec3<f64> {
    let outer = size + equal(LAYER);
    let volume = |s: Vec3<f64>| 4.0 * PI * s.x * s.y * s.z / 3.0;
    let density = mass / (volume(outer) - volume(size));
    let solid = |s: Vec3<f64>| about_axes(s.scale_by(s)) * (volume(s) * density / 5.0);
    solid(outer) - solid(size)
}

/// Six faces. With half lengths a, b, c the two faces across x have mass m bc/(ab + bc + ca) and second moments
/// a², b²/3, c²/3 per mass, and so on around.
fn box_shell(size: Vec3<f64>, mass: f64) -> Vec3<f64> {
    let faces = Vec3::new(size.y * size.z, size.z * size.x, size.x * size.y);
    let faces = faces * (mass / (faces.x + faces.y + faces.z));
    let mut second = Vec3::ZERO;
    for axis in 0..3 {
        second[axis] = size[axis] * size[axis] * (faces[axis] + (mass - faces[axis]) / 3.0);
    }
    about_axes(second)
}
