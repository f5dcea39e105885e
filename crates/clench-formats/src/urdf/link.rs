//! `<link>`: a body with its mass and shapes.

use super::element::{consume, inside};
use super::geometry::{GeomReader, read_origin};
use super::tree::Link;
use crate::document::Element;
use crate::error::LoadError;
use crate::spending::Spending;
use clench_builder::{BodySpec, InertiaSpec, InertialSpec, ModelBuilder};
use clench_math::{Mat3, Quat, Vec3};

/// Reads a link other than the world into the next body, without shapes.
///
/// # Errors
/// Returns an error if the link is invalid.
pub(super) fn read_body(
    link: &Link,
    builder: &mut ModelBuilder,
    spending: &mut Spending,
) -> Result<(), LoadError> {
    if link.body == 0 {
        return Ok(());
    }
    let element = link.element;
    let name = element.string("name");
    consume(element, size_of::<BodySpec>(), &[&name], spending)?;
    builder.bodies.push(BodySpec {
        name,
        parent: link.parent,
        quat: Quat::IDENTITY,
        inertial: read_inertial(element).map_err(inside(element))?,
        origin: Some(element.origin.clone()),
        ..BodySpec::default()
    });
    Ok(())
}

/// Reads the shapes of a link into its body.
///
/// # Errors
/// Returns an error if a shape is invalid.
pub(super) fn read_shapes(
    link: &Link,
    geoms: &mut GeomReader,
    builder: &mut ModelBuilder,
    spending: &mut Spending,
) -> Result<(), LoadError> {
    let element = link.element;
    let shapes = geoms.read(element, &mut builder.notes, spending);
    builder.bodies[link.body].geoms = shapes.map_err(inside(element))?;
    Ok(())
}

/// Reads the mass, and the inertia in the axes of `<origin>`, which is rotated to those of the link. A zero inertia is
/// left to the compiler's lower limits.
fn read_inertial(link: &Element) -> Result<Option<InertialSpec>, LoadError> {
    let Some(element) = link.child("inertial")? else {
        return Ok(None);
    };
    let pose = read_origin(element)?;
    let [mass] = element.required_child("mass")?.required_numbers("value")?;
    let inertia = element.required_child("inertia")?;
    let entry = |name| inertia.required_numbers(name).map(|[entry]| entry);
    let (xx, yy, zz) = (entry("ixx")?, entry("iyy")?, entry("izz")?);
    let (xy, xz, yz) = (entry("ixy")?, entry("ixz")?, entry("iyz")?);
    let inertia = match [xx, yy, zz, xy, xz, yz] == [0.0; 6] {
        true => InertiaSpec::Diagonal([0.0; 3]),
        false => {
            let written = Mat3 {
                rows: [
                    Vec3::new(xx, xy, xz),
                    Vec3::new(xy, yy, yz),
                    Vec3::new(xz, yz, zz),
                ],
            };
            let rotation = pose.quat.to_matrix();
            let [x, y, z] = (rotation * written * rotation.transpose()).rows;
            InertiaSpec::Full([x.x, y.y, z.z, x.y, x.z, y.z])
        }
    };
    Ok(Some(InertialSpec {
        pos: pose.pos,
        quat: pose.quat,
        mass,
        inertia,
        origin: Some(element.origin.clone()),
    }))
}
