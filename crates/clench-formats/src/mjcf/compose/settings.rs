//! Merging of an attached model's options and sizes as `<compiler conflict="..."/>` specifies, after MuJoCo's table of
//! mergeable attributes.
//!
//! A value counts as given if it is in the file or was merged from a model attached before.

use super::super::compiler::Conflict;
use crate::mjcf::document::Element;

/// The rule for merging two different values.
#[derive(Clone, Copy)]
enum Merge {
    Least,
    Most,
    /// They cannot be merged.
    Never,
}

/// The attributes of `<option>`, with the rules for merging their values.
const OPTIONS: &[(&str, Merge)] = &[
    ("timestep", Merge::Least),
    ("tolerance", Merge::Least),
    ("ls_tolerance", Merge::Least),
    ("noslip_tolerance", Merge::Least),
    ("ccd_tolerance", Merge::Least),
    ("sleep_tolerance", Merge::Least),
    ("iterations", Merge::Most),
    ("ls_iterations", Merge::Most),
    ("noslip_iterations", Merge::Most),
    ("ccd_iterations", Merge::Most),
    ("sdf_iterations", Merge::Most),
    ("sdf_initpoints", Merge::Most),
    ("impratio", Merge::Never),
    ("density", Merge::Never),
    ("viscosity", Merge::Never),
    ("o_margin", Merge::Never),
    ("integrator", Merge::Never),
    ("cone", Merge::Never),
    ("jacobian", Merge::Never),
    ("solver", Merge::Never),
    ("gravity", Merge::Never),
    ("wind", Merge::Never),
    ("magnetic", Merge::Never),
    ("o_solref", Merge::Never),
    ("o_solimp", Merge::Never),
    ("o_friction", Merge::Never),
];

/// The attributes of `<size>`, merged to the largest value; -1 means unset.
const SIZES: &[&str] = &[
    "nkey",
    "nuser_body",
    "nuser_jnt",
    "nuser_geom",
    "nuser_site",
    "nuser_cam",
    "nuser_tendon",
    "nuser_actuator",
    "nuser_sensor",
];

/// The sections that contain them.
pub(super) const SECTIONS: &[&str] = &["option", "size"];

/// Flags that are off by default; all others are on.
const OFF_BY_DEFAULT: &[&str] = &[
    "override",
    "energy",
    "fwdinv",
    "invdiscrete",
    "sleep",
    "diagexact",
    "ipc",
    "speculative",
];

/// The `<option>`s and `<size>`s of a model, into which others are merged.
#[derive(Clone, Debug, Default)]
pub(super) struct Settings(pub Vec<Element>);

impl Settings {
    pub(super) fn is_empty(&self) -> bool {
        let says = |section: &Element| {
            section.tag == "option" || SIZES.iter().any(|name| section.text(name).is_some())
        };
        !self.0.iter().any(says)
    }

    /// Merges the settings of an attached model as the rule allows. Returns the names of the attributes that changed.
    ///
    /// # Errors
    /// Returns a message with the conflicts.
    pub(super) fn merge(
        &mut self,
        other: &Settings,
        rule: Conflict,
    ) -> Result<Vec<String>, String> {
        let (mut option, mut conflicts) = (Vec::new(), Vec::new());
        for &(name, merge) in OPTIONS {
            match self.compare(other, name, merge, rule) {
                Verdict::Same => {}
                Verdict::Becomes(value) => option.push((name.to_owned(), value)),
                Verdict::Conflict(what) => conflicts.push(what),
            }
        }
        let mut sizes = Vec::new();
        for &name in SIZES {
            match self.compare(other, name, Merge::Most, rule) {
                Verdict::Same => {}
                Verdict::Becomes(value) => sizes.push((name.to_owned(), value)),
                Verdict::Conflict(what) => conflicts.push(what),
            }
        }
        let mut flags = Vec::new();
        for (name, value) in other.flags() {
            match self.compare_flag(name, value, rule) {
                Verdict::Same => {}
                Verdict::Becomes(value) => flags.push((name.to_owned(), value)),
                Verdict::Conflict(what) => conflicts.push(what),
            }
        }
        if !conflicts.is_empty() {
            return Err(conflicts.join("; "));
        }
        if let Some(groups) = other.groups().filter(|_| rule == Conflict::Merge) {
            option.push(("actuatorgroupdisable".to_owned(), groups)); // Those of the model itself stay disabled.
        }
        Ok(self.append(other, option, sizes, flags))
    }

    /// Appends sections with values of an attached model. Returns the names of the values.
    fn append(
        &mut self,
        other: &Settings,
        option: Vec<(String, String)>,
        sizes: Vec<(String, String)>,
        flags: Vec<(String, String)>,
    ) -> Vec<String> {
        let Some(last) = other.0.last() else {
            return Vec::new();
        };
        let names: Vec<String> = (option.iter().chain(&sizes).chain(&flags))
            .map(|(name, _)| name.clone())
            .collect();
        let mut section = Element::with_location_of(last, "option");
        section.attributes = option;
        if !flags.is_empty() {
            let mut flag = Element::with_location_of(last, "flag");
            flag.attributes = flags;
            section.children.push(flag);
        }
        if !section.attributes.is_empty() || !section.children.is_empty() {
            self.0.push(section);
        }
        if !sizes.is_empty() {
            let mut section = Element::with_location_of(last, "size");
            section.attributes = sizes;
            self.0.push(section);
        }
        names
    }

    fn compare(&self, other: &Settings, name: &str, merge: Merge, rule: Conflict) -> Verdict {
        let Some(its) = other.value(name) else {
            return Verdict::Same;
        };
        let Some(own) = self.value(name) else {
            return match rule {
                Conflict::Merge => Verdict::Becomes(its.join(" ")),
                _ => Verdict::Same,
            };
        };
        if same(&own, &its) {
            return Verdict::Same;
        }
        match (rule, merge) {
            (Conflict::Merge, Merge::Least | Merge::Most) => {
                let number = |value: &[String]| value.first()?.parse::<f64>().ok();
                match (number(&own), number(&its)) {
                    (Some(own), Some(its)) if (own < its) == matches!(merge, Merge::Least) => {
                        Verdict::Same
                    }
                    _ => Verdict::Becomes(its.join(" ")), // The reader of the option rejects it if it is not a number.
                }
            }
            _ => Verdict::Conflict(format!(
                "{name}: here {}, there {}",
                own.join(" "),
                its.join(" ")
            )),
        }
    }

    /// Merges a flag only if it differs from its default.
    fn compare_flag(&self, name: &str, value: &str, rule: Conflict) -> Verdict {
        let own = self.flag(name);
        match (rule, own) {
            (Conflict::Merge, _) if is_set(name, value) && own != Some(value) => {
                Verdict::Becomes(value.to_owned())
            }
            (Conflict::Error, Some(own)) if own != value => {
                Verdict::Conflict(format!("flag {name}: here {own}, there {value}"))
            }
            _ => Verdict::Same,
        }
    }

    /// Returns the words of an attribute after all sections; later ones overwrite the leading words.
    fn value(&self, name: &str) -> Option<Vec<String>> {
        let mut texts = self.0.iter().filter_map(|section| section.text(name));
        let mut value = words(texts.next()?);
        for text in texts {
            let new = words(text);
            let kept = value.split_off(new.len().min(value.len()));
            value = new;
            value.extend(kept);
        }
        Some(value).filter(|value| !(SIZES.contains(&name) && *value == ["-1"]))
    }

    /// Returns the flags with their last values.
    fn flags(&self) -> impl Iterator<Item = (&str, &str)> {
        let elements = self.0.iter().flat_map(|section| &section.children);
        let all: Vec<&(String, String)> = elements.flat_map(|flags| &flags.attributes).collect();
        let last = all.clone();
        (all.into_iter().enumerate())
            .filter(move |(k, (name, _))| !last[k + 1..].iter().any(|(later, _)| later == name))
            .map(|(_, (name, value))| (name.as_str(), value.as_str()))
    }

    fn flag(&self, name: &str) -> Option<&str> {
        let mut flags = self.flags();
        flags.find_map(|(known, value)| (known == name).then_some(value))
    }

    /// Returns the disabled groups of actuators.
    fn groups(&self) -> Option<String> {
        let texts = (self.0.iter())
            .filter_map(|section| section.text("actuatorgroupdisable"))
            .collect::<Vec<_>>();
        (!texts.is_empty()).then(|| texts.join(" "))
    }
}

/// The result of comparing an attribute.
enum Verdict {
    Same,
    Becomes(String),
    Conflict(String),
}

fn words(text: &str) -> Vec<String> {
    text.split_ascii_whitespace().map(str::to_owned).collect()
}

/// Returns true if two values are the same words or numbers.
fn same(a: &[String], b: &[String]) -> bool {
    let equal = |(a, b): (&String, &String)| {
        let number = |word: &String| word.parse::<f64>().ok();
        a == b || (number(a).is_some() && number(a) == number(b))
    };
    a.len() == b.len() && a.iter().zip(b).all(equal)
}

/// Returns true if a flag differs from its default, as encoded in MuJoCo's bits.
fn is_set(name: &str, value: &str) -> bool {
    (value == "enable") == OFF_BY_DEFAULT.contains(&name)
}
