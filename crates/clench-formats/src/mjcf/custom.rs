//! User data: `<custom>`, and the counts of user numbers of elements.

use super::schema;
use super::sections::entries;
use crate::document::Element;
use crate::error::LoadError;
use crate::spending::Spending;
use clench_builder::UserWidths;
use clench_dynamics::model::{Custom, TupleEntry};
use clench_dynamics::options::{Mjcf, RigidOption, RigidOptions};

/// The kinds of elements that a tuple may list.
const KINDS: &str = "body xbody joint geom site camera light flex mesh skin hfield texture material pair exclude equality tendon \
    actuator sensor numeric text tuple key plugin";

/// Reads the user numbers, texts and tuples, and the options that are texts.
pub(crate) fn read(
    root: &Element,
    options: &mut RigidOptions,
    spending: &mut Spending,
) -> Result<Custom, LoadError> {
    let mut custom = Custom::default();
    let mut texts = Vec::new();
    for element in entries(root, "custom") {
        let name = element.required_text("name")?.to_owned();
        let is_repeated = match element.tag.as_str() {
            "numeric" => {
                let repeated = custom.numerics.iter().any(|(other, _)| *other == name);
                custom
                    .numerics
                    .push((name, read_numbers(element, spending)?));
                repeated
            }
            "text" => {
                let repeated = texts.contains(&name);
                let text = element.string("data");
                if text.is_empty() {
                    return Err(element.error("data cannot be empty"));
                }
                texts.push(name.clone());
                if !read_option(element, &name, &text, options)? {
                    custom.texts.push((name, text));
                }
                repeated
            }
            _ => {
                let repeated = custom.tuples.iter().any(|(other, _)| *other == name);
                custom.tuples.push((name, read_entries(element)?));
                repeated
            }
        };
        if is_repeated && element.text("name") != Some("") {
            return Err(element.error("the name is repeated"));
        }
    }
    Ok(custom)
}

/// Sets the option whose text has this name; returns false if there is none.
fn read_option(
    element: &Element,
    name: &str,
    text: &str,
    options: &mut RigidOptions,
) -> Result<bool, LoadError> {
    let is_named = |option: &&RigidOption| matches!(option.mjcf(), Mjcf::Text(own) if own == name);
    let Some(&option) = RigidOption::ALL.iter().find(is_named) else {
        return Ok(false);
    };
    let default = option.default(false);
    let Some(&(_, value)) = default.keywords().iter().find(|(word, _)| *word == text) else {
        let description = default.description();
        return Err(element.error(format!("{name} is \"{text}\", but must be {description}")));
    };
    (options.set(option, value)).map_err(|wrong| element.error(wrong.to_string()))?;
    Ok(true)
}

/// Reads the counts of user numbers from a `<size>`; -1 means as many as are given.
pub(crate) fn read_widths(size: &Element, widths: &mut UserWidths) -> Result<(), LoadError> {
    let targets = [
        ("nuser_body", &mut widths.body),
        ("nuser_jnt", &mut widths.joint),
        ("nuser_geom", &mut widths.geom),
        ("nuser_site", &mut widths.site),
        ("nuser_cam", &mut widths.camera),
        ("nuser_tendon", &mut widths.tendon),
        ("nuser_actuator", &mut widths.actuator),
        ("nuser_sensor", &mut widths.sensor),
    ];
    for (name, width) in targets {
        match size.integer(name)? {
            None => {}
            Some(count @ ..-1) => {
                return Err(size.error(format!("{name} is {count}, less than -1")));
            }
            Some(count) => *width = usize::try_from(count).ok(),
        }
    }
    Ok(())
}

/// Returns `size` numbers, padded with zeros, or those of `data`.
fn read_numbers(element: &Element, spending: &mut Spending) -> Result<Vec<f64>, LoadError> {
    let mut numbers = element.any_numbers("data")?;
    let size = element.integer("size")?;
    let size = usize::try_from(size.unwrap_or(numbers.len() as i32)).unwrap_or_default();
    if size == 0 {
        return Err(element.error("the size must be positive"));
    }
    if numbers.len() > size {
        return Err(element.error(format!("data has more than {size} numbers")));
    }
    let taken = spending.bytes((size * size_of::<f64>()) as u64);
    taken.map_err(|excess| element.error(excess))?;
    numbers.resize(size, 0.0);
    Ok(numbers)
}

fn read_entries(tuple: &Element) -> Result<Vec<TupleEntry>, LoadError> {
    if tuple.children.is_empty() {
        return Err(tuple.incomplete("a tuple needs at least one element"));
    }
    let read = |element: &Element| {
        let kind = element.required_text("objtype")?;
        let known = || KINDS.split_ascii_whitespace();
        if !known().any(|name| name == kind) {
            let hint = schema::suggestion(kind, known());
            return Err(element.error(format!("unknown objtype \"{kind}\"{hint}")));
        }
        let mut entry = TupleEntry {
            kind: kind.to_owned(),
            name: element.required_text("objname")?.to_owned(),
            value: 0.0,
        };
        element.set_number("prm", &mut entry.value)?;
        Ok(entry)
    };
    tuple.children.iter().map(read).collect()
}
