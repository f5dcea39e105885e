//! `<hfield>`: a height field from an image, a binary file, or numbers in the model.

use super::files::Files;
use crate::document::Element;
use crate::elevation::{Elevation, HEIGHT, read_grid, read_png};
use crate::error::LoadError;
use crate::spending::Spending;
use clench_builder::HeightFieldSpec;

pub(crate) fn read(
    element: &Element,
    files: &Files,
    spending: &mut Spending,
) -> Result<HeightFieldSpec, LoadError> {
    let mut name = element.string("name");
    let found = match files.read(element, spending)? {
        // As in MuJoCo, the file determines the numbers of rows and columns.
        Some(mut file) => {
            if name.is_empty() {
                name.clone_from(&file.stem);
            }
            let content = element.text("content_type");
            let is_image = match content.filter(|content| !content.is_empty()) {
                Some("image/png") => true,
                Some("image/vnd.mujoco.hfield") => false,
                Some(_) => {
                    let message =
                        "the content_type is neither image/png nor image/vnd.mujoco.hfield";
                    return Err(element.error(message));
                }
                None => file.extension.eq_ignore_ascii_case("png"),
            };
            let reader = if is_image { read_png } else { read_grid };
            file.parse(element, |bytes| reader(&bytes, spending))?
        }
        None => written(element, spending)?,
    };
    if name.is_empty() {
        return Err(element.incomplete("a height field needs a name or a file"));
    }
    let found = found.in_parts();
    Ok(HeightFieldSpec {
        name,
        rows: found.rows,
        columns: found.columns,
        heights: found.heights,
        size: element.required_numbers("size")?,
        origin: Some(element.origin.clone()),
    })
}

/// Reads heights in the model: rows from the positive end of y, as displayed; flat if none are given.
fn written(element: &Element, spending: &mut Spending) -> Result<Elevation, LoadError> {
    let rows = element.count("nrow")?.unwrap_or(0);
    let columns = element.count("ncol")?.unwrap_or(0);
    let count = rows.saturating_mul(columns);
    if count == 0 {
        return Err(element.incomplete("a height field needs a file, or nrow and ncol"));
    }
    let taken = spending.bytes(HEIGHT.saturating_mul(count as u64));
    taken.map_err(|excess| element.error(excess))?;
    let elevation = element.list_of_singles("elevation", usize::MAX)?;
    let heights = match elevation.filter(|heights| !heights.is_empty()) {
        Some(heights) if heights.len() == count => (heights.chunks_exact(columns).rev())
            .flatten()
            .map(|&height| f64::from(height))
            .collect(),
        Some(heights) => {
            let message = format!(
                "elevation needs {rows} x {columns} numbers, but has {}",
                heights.len()
            );
            return Err(element.error(message));
        }
        None => vec![0.0; count],
    };
    Ok(Elevation {
        rows,
        columns,
        heights,
    })
}
