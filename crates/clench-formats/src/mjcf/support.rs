//! The supported part of MJCF, for users and for tests that must cover it.

use super::rules::rules;
use super::sensor;
use crate::mjcf::rules::Rule;
use clench_dynamics::model::SensorKind;
use std::borrow::Cow;

/// The treatment of an MJCF element by the reader.
#[derive(Clone, Debug)]
pub struct Support {
    /// Its name, or `parent/name` if the name has another meaning in that parent.
    pub element: Cow<'static, str>,
    /// Attributes that are read.
    pub read: Vec<&'static str>,
    /// Attributes accepted without effect on motion; viewers may show them.
    pub ignored: Vec<&'static str>,
    /// Rejected attributes; one written as `name=value` is accepted with that value, which has no effect.
    pub refused: Vec<&'static str>,
    /// Permitted children.
    pub children: Vec<&'static str>,
}

/// Returns the supported elements of MJCF. An element not listed is rejected.
///
/// ```
/// let geom = clench_formats::supported().find(|support| support.element == "geom");
/// assert!(geom.is_some_and(|geom| geom.read.contains(&"size")));
/// ```
pub fn supported() -> impl Iterator<Item = Support> {
    let listed = rules().map(|rule| support(rule.element.into(), rule));
    let sensors = SensorKind::ALL.iter().filter_map(|kind| {
        let rule = sensor::rule(kind.name())?;
        Some(support(format!("sensor/{}", kind.name()).into(), rule))
    });
    listed.chain(sensors)
}

fn support(element: Cow<'static, str>, rule: &Rule) -> Support {
    let words = |text: &'static str| text.split_ascii_whitespace();
    let kinds: &[SensorKind] = match &*element {
        "sensor" => SensorKind::ALL,
        _ => &[],
    };
    let sensors = kinds.iter().map(|kind| kind.name());
    Support {
        element,
        read: words(rule.read).collect(),
        ignored: words(rule.ignored).collect(),
        refused: words(rule.later).collect(),
        children: words(rule.children)
            .chain(words(rule.once))
            .chain(sensors)
            .collect(),
    }
}
