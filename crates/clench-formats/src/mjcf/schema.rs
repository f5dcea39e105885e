//! Validation of every element and attribute of a file, before any value is read.
//!
//! The outcomes are: read; accepted and without effect on motion; known to MuJoCo but not supported yet; unknown. The
//! tables are in [`rules`](super::rules).

use super::rules::rules;
use super::sensor;
use crate::document::Element;
use crate::error::LoadError;
use crate::mjcf::rules::Rule;
use clench_dynamics::model::SensorKind;

/// Attributes that an element can have in the model, but not in a default class.
const NOT_IN_DEFAULTS: &[&str] = &[
    "name",
    "class",
    "joint",
    "jointinparent",
    "tendon",
    "site",
    "refsite",
    "cranksite",
    "slidersite",
    "body",
    "lengthrange",
    "tausmooth",
    "geom1",
    "geom2",
    "target",
];

/// Checks a model whose includes are expanded.
pub(crate) fn check(root: &Element) -> Result<(), LoadError> {
    let rule = find("", "mujoco").ok_or_else(|| root.error("unknown element"))?;
    check_element(root, rule)
}

/// Checks a section of MJCF in a file of another format.
pub(crate) fn check_section(section: &Element) -> Result<(), LoadError> {
    let rule = find("mujoco", &section.tag).ok_or_else(|| section.error("unknown element"))?;
    check_element(section, rule)
}

/// Returns the rule of an element below a parent: a specific one for that parent, or the general one.
fn find(parent: &str, tag: &str) -> Option<&'static Rule> {
    if parent == "sensor" {
        return sensor::rule(tag);
    }
    let of = |name: &str| rules().find(|rule| rule.element == name);
    of(&format!("{parent}/{tag}")).or_else(|| of(tag))
}

/// Returns true if an element is known in its parent but not supported yet.
pub(crate) fn is_later(parent: &str, tag: &str) -> bool {
    // The rule of a parent does not depend on its own parent, except for elements without children.
    let rule = find("", parent);
    rule.is_some_and(|rule| words(rule.later_children).any(|later| later == tag))
}

/// Returns true if an attribute of an element is known but not supported yet with this value.
pub(crate) fn is_later_attribute(parent: &str, tag: &str, name: &str, value: &str) -> bool {
    let rule = find(parent, tag);
    let mut later = rule.into_iter().flat_map(|rule| words(rule.later));
    later.any(|later| {
        let (later, harmless) = later.split_once('=').unwrap_or((later, ""));
        later == name && !is_harmless(value, harmless)
    })
}

/// An element whose children are being checked.
struct Level<'a> {
    element: &'a Element,
    rule: &'static Rule,
    /// The index of the next child.
    next: usize,
}

fn check_element(root: &Element, rule: &'static Rule) -> Result<(), LoadError> {
    check_attributes(root, rule)?;
    let mut open = vec![Level {
        element: root,
        rule,
        next: 0,
    }];
    while let Some(Level {
        element,
        rule,
        next,
    }) = open.last_mut()
    {
        let Some(child) = element.children.get(*next) else {
            open.pop();
            continue;
        };
        let child_rule = check_child(element, rule, child)?;
        let once = words(rule.once).any(|tag| tag == child.tag);
        let before = &element.children[..*next];
        if once && before.iter().any(|other| other.tag == child.tag) {
            return Err(child.error(format!("there can be only one in <{}>", element.tag)));
        }
        if element.tag == "default" {
            reject_in_default(child)?;
        }
        *next += 1;
        check_attributes(child, child_rule)?;
        open.push(Level {
            element: child,
            rule: child_rule,
            next: 0,
        });
    }
    Ok(())
}

fn check_attributes(element: &Element, rule: &Rule) -> Result<(), LoadError> {
    for (name, value) in &element.attributes {
        check_attribute(element, rule, name, value)?;
    }
    Ok(())
}

fn check_child(
    element: &Element,
    rule: &Rule,
    child: &Element,
) -> Result<&'static Rule, LoadError> {
    let tag = child.tag.as_str();
    if words(rule.later_children).any(|later| later == tag) {
        return Err(child.error(format!("<{tag}> in <{}> is not supported yet", element.tag)));
    }
    let sensors = match element.tag.as_str() {
        "sensor" => SensorKind::ALL,
        _ => &[],
    };
    let sensors = || sensors.iter().map(|kind| kind.name());
    let allowed_names = || {
        words(rule.children)
            .chain(words(rule.once))
            .chain(sensors())
    };
    let allowed = allowed_names().any(|name| name == tag);
    find(&element.tag, tag).filter(|_| allowed).ok_or_else(|| {
        let hint = suggestion(tag, allowed_names().chain(words(rule.later_children)));
        child.error(format!(
            "unknown element <{tag}> in <{}>{hint}",
            element.tag
        ))
    })
}

fn check_attribute(
    element: &Element,
    rule: &Rule,
    name: &str,
    value: &str,
) -> Result<(), LoadError> {
    if words(rule.read)
        .chain(words(rule.ignored))
        .any(|known| known == name)
    {
        return Ok(());
    }
    for later in words(rule.later) {
        let (later, harmless) = later.split_once('=').unwrap_or((later, ""));
        if later == name {
            return match is_harmless(value, harmless) {
                true => Ok(()),
                false => Err(element.error(format!(
                    "the attribute {name} is not supported yet{}",
                    reason(name)
                ))),
            };
        }
    }
    let later =
        words(rule.later).map(|later| later.split_once('=').map_or(later, |(name, _)| name));
    let supported = words(rule.read).chain(words(rule.ignored)).chain(later);
    let hint = suggestion(name, supported);
    Err(element.error(format!("unknown attribute \"{name}\"{hint}")))
}

/// Returns the specific reason that an attribute is not supported, if any.
fn reason(name: &str) -> &'static str {
    match name {
        "speculative" => ": MuJoCo 4.0 says of these contacts that their behavior may still change",
        _ => "",
    }
}

fn reject_in_default(element: &Element) -> Result<(), LoadError> {
    if element.tag == "default" {
        return Ok(());
    }
    match element
        .attributes
        .iter()
        .find(|(name, _)| NOT_IN_DEFAULTS.contains(&name.as_str()))
    {
        Some((name, _)) => Err(element.error(format!("{name} cannot be given in a default"))),
        None => Ok(()),
    }
}

/// Returns true if every word of a value equals (as text or number) the harmless value of an unsupported attribute.
fn is_harmless(value: &str, harmless: &str) -> bool {
    let number = harmless.parse::<f64>().ok();
    let same =
        |word: &str| word == harmless || (number.is_some() && word.parse::<f64>().ok() == number);
    !harmless.is_empty() && value.split_ascii_whitespace().all(same)
}

fn words(text: &'static str) -> impl Iterator<Item = &'static str> {
    text.split_ascii_whitespace()
}

/// The maximum length of names to compare: the work grows with the product of the lengths.
const MAX_SUGGESTED_LENGTH: usize = 100;

/// Returns `; did you mean "..."?` if a known name is similar to a mistaken one.
pub(crate) fn suggestion<'a>(mistaken: &str, known: impl Iterator<Item = &'a str>) -> String {
    let distance =
        |name: &str| strsim::damerau_levenshtein(&mistaken.to_lowercase(), &name.to_lowercase());
    let short = |name: &&str| name.len().max(mistaken.len()) <= MAX_SUGGESTED_LENGTH;
    let nearest = (known.filter(short).map(|name| (distance(name), name))).min();
    match nearest {
        Some((distance, name)) if distance <= 2.max(mistaken.len() / 3) => {
            format!("; did you mean \"{name}\"?")
        }
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::attributes::requested;
    use std::path::{Path, PathBuf};

    #[test]
    fn every_child_that_a_rule_allows_has_a_rule() {
        for rule in rules() {
            let parent = rule.element.rsplit('/').next().unwrap_or_default();
            for tag in words(rule.children).chain(words(rule.once)) {
                assert!(find(parent, tag).is_some(), "<{tag}> in <{parent}>");
            }
        }
    }

    #[test]
    fn no_attribute_is_answered_twice() {
        for rule in rules() {
            let later = words(rule.later).map(|later| later.split('=').next().unwrap_or_default());
            let mut all: Vec<&str> = words(rule.read)
                .chain(words(rule.ignored))
                .chain(later)
                .collect();
            let count = all.len();
            all.sort_unstable();
            all.dedup();
            assert_eq!(all.len(), count, "<{}>", rule.element);
        }
    }

    /// The files of a folder of models.
    fn models(folder: &str) -> impl Iterator<Item = PathBuf> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        let files = std::fs::read_dir(folder).expect("the folder is there");
        let paths = files.map(|file| file.expect("it can be listed").path());
        paths.filter(|path| path.extension().is_some_and(|end| end == "xml"))
    }

    /// Elements missing in the models of the folders.
    const RARE: &str = "<mujoco>
      <option><flag/></option>
      <visual><map/></visual>
      <default><equality/></default>
      <asset>
        <material name='red'/>
        <mesh name='made' builtin='sphere' params='1'/>
        <mesh file='corner.obj'/>
        <hfield file='hills.bin' size='1 1 1 1'/>
        <hfield name='written' nrow='2' ncol='2' elevation='0 0 0 1' size='1 1 1 1'/>
        <model name='part' file='part.xml'/>
      </asset>
      <worldbody><attach model='part' body='b' prefix='p'/></worldbody>
    </mujoco>";

    fn read_rare() {
        let part = "<mujoco><worldbody><body name='b'><geom size='1'/></body></worldbody></mujoco>";
        let corner = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n";
        let numbers = [0.0_f32, 0.0, 0.0, 1.0].map(f32::to_le_bytes);
        let hills = [2_i32.to_le_bytes(), 2_i32.to_le_bytes()];
        let hills = [hills.as_flattened(), numbers.as_flattened()].concat();
        let files = [
            ("part.xml", part.as_bytes()),
            ("corner.obj", corner.as_bytes()),
            ("hills.bin", &hills[..]),
        ];
        let read = crate::Loader::new().assets(files).read_str(RARE);
        read.unwrap_or_else(|error| panic!("{error}"));
    }

    /// Attributes of replicas that are passed on to a frame, which is queried instead.
    const HANDED_ON: [&str; 2] = ["replicate class", "replicate childclass"];

    /// An attribute that a rule lists as read but no reader queries would have no effect.
    #[test]
    fn what_is_said_to_be_read_is_asked_for() {
        read_rare();
        let folders = ["../../models", "../../parity/models"];
        for path in folders.into_iter().flat_map(models) {
            crate::read(&path).unwrap_or_else(|error| panic!("{error}"));
        }
        let mut missing = Vec::new();
        for rule in rules() {
            let tag = rule.element.rsplit('/').next().unwrap_or_default();
            let unread = words(rule.read).filter(|name| !requested::was(tag, name));
            missing.extend(unread.map(|name| format!("{} {name}", rule.element)));
        }
        missing.retain(|name| !HANDED_ON.contains(&name.as_str()));
        assert!(missing.is_empty(), "{missing:#?}");
    }
}
