//! The attribute `user` of elements. All elements of a kind have the same number of values, as in MuJoCo.

use super::BuildError;
use super::element::Element;
use super::model_builder::ModelBuilder;
use super::physics::UserWidths;
use clench_dynamics::budget::RAISE;
use clench_dynamics::model::Model;
use std::sync::Arc;

/// Resolves the widths of a description.
///
/// # Errors
/// Returns an error if an element has more numbers than the description specifies.
fn resolve(builder: &ModelBuilder) -> Result<UserWidths, BuildError> {
    let specified = builder.user_widths;
    let bodies = || builder.bodies.iter();
    let joints = bodies().flat_map(|body| &body.joints);
    let geoms = bodies().flat_map(|body| &body.geoms);
    let sites = bodies().flat_map(|body| &body.sites);
    let cameras = bodies().flat_map(|body| &body.cameras);
    let (tendons, actuators) = (builder.tendons.iter(), builder.actuators.iter());
    let sensors = builder.sensors.iter();
    Ok(UserWidths {
        body: width(specified.body, bodies().map(|e| (e, &e.user)))?,
        joint: width(specified.joint, joints.map(|e| (e, &e.user)))?,
        geom: width(specified.geom, geoms.map(|e| (e, &e.user)))?,
        site: width(specified.site, sites.map(|e| (e, &e.user)))?,
        camera: width(specified.camera, cameras.map(|e| (e, &e.user)))?,
        tendon: width(specified.tendon, tendons.map(|e| (e, &e.user)))?,
        actuator: width(specified.actuator, actuators.map(|e| (e, &e.user)))?,
        sensor: width(specified.sensor, sensors.map(|e| (e, &e.user)))?,
    })
}

fn width<'a, E: Element + 'a>(
    specified: Option<usize>,
    elements: impl Iterator<Item = (&'a E, &'a Arc<[f64]>)>,
) -> Result<Option<usize>, BuildError> {
    let mut longest = 0;
    for (element, user) in elements {
        let count = user.len();
        match specified {
            Some(width) if count > width => {
                return Err(element.error(format!(
                    "user has {count} numbers, more than the {width} that each {} has",
                    E::KIND
                )));
            }
            _ => longest = longest.max(count),
        }
    }
    Ok(Some(specified.unwrap_or(longest)))
}

/// Pads the numbers of all elements of a kind to the same length with zeros.
///
/// # Errors
/// Returns an error if an element has more numbers, or if all need more memory than the budget allows.
pub(super) fn pad(builder: &ModelBuilder, model: &mut Model) -> Result<(), BuildError> {
    let widths = resolve(builder)?;
    let mut remaining = builder.budget.bytes;
    let mut pad = |width: Option<usize>, rows: Vec<&mut Arc<[f64]>>| {
        let width = width.unwrap_or(0);
        let bytes = (8 * rows.len() as u64).saturating_mul(width as u64);
        remaining = remaining.checked_sub(bytes).ok_or_else(|| {
            let message = format!(
                "its user data would take more than {} bytes; {RAISE}",
                builder.budget.bytes
            );
            BuildError::new("model", message)
        })?;
        rows.into_iter().for_each(|row| pad_row(row, width));
        Ok(())
    };
    pad(widths.body, rows(&mut model.bodies, |e| &mut e.user))?;
    pad(widths.joint, rows(&mut model.joints, |e| &mut e.user))?;
    pad(widths.geom, rows(&mut model.geoms, |e| &mut e.user))?;
    pad(widths.site, rows(&mut model.sites, |e| &mut e.user))?;
    pad(widths.camera, rows(&mut model.cameras, |e| &mut e.user))?;
    pad(widths.tendon, rows(&mut model.tendons, |e| &mut e.user))?;
    pad(widths.actuator, rows(&mut model.actuators, |e| &mut e.user))?;
    pad(widths.sensor, rows(&mut model.sensors, |e| &mut e.user))
}

fn rows<E>(elements: &mut [E], row: fn(&mut E) -> &mut Arc<[f64]>) -> Vec<&mut Arc<[f64]>> {
    elements.iter_mut().map(row).collect()
}

fn pad_row(row: &mut Arc<[f64]>, width: usize) {
    if row.len() < width {
        let zeros = std::iter::repeat(0.0);
        *row = row.iter().copied().chain(zeros).take(width).collect();
    }
}
