//! A user's own data in a model, which moves nothing.

use super::Model;

/// Numbers, texts and lists of elements that a model file keeps for its user's program (MJCF's `<custom>`), each kind in the order of
/// the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Custom {
    /// Arrays of numbers by name.
    pub numerics: Vec<(String, Vec<f64>)>,
    /// Texts by name.
    pub texts: Vec<(String, String)>,
    /// Lists of elements by name.
    pub tuples: Vec<(String, Vec<TupleEntry>)>,
}

/// An element in a list of a user.
#[derive(Clone, Debug, PartialEq)]
pub struct TupleEntry {
    /// The kind of the element, in MJCF's words: `body`, `joint`, ...
    pub kind: String,
    /// Its name.
    pub name: String,
    /// A number that goes with it.
    pub value: f64,
}

fn named<'a, T>(list: &'a [(String, T)], name: &str) -> Option<&'a T> {
    let found = list.iter().find(|(other, _)| other == name);
    found.map(|(_, value)| value)
}

impl Model {
    /// The user's array of numbers with this name.
    pub fn numeric(&self, name: &str) -> Option<&[f64]> {
        named(&self.custom.numerics, name).map(Vec::as_slice)
    }

    /// The user's text with this name.
    pub fn text(&self, name: &str) -> Option<&str> {
        named(&self.custom.texts, name).map(String::as_str)
    }

    /// The user's list of elements with this name.
    pub fn tuple(&self, name: &str) -> Option<&[TupleEntry]> {
        named(&self.custom.tuples, name).map(Vec::as_slice)
    }
}
