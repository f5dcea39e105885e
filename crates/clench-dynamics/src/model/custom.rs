//! A user's own data in a model, which has no effect on physics.

/// Numbers, texts and lists of elements that a model file stores for its user's program (MJCF's `<custom>`), each kind
/// in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Custom {
    /// Arrays of numbers by name.
    pub numerics: Vec<(String, Vec<f64>)>,
    /// Texts by name.
    pub texts: Vec<(String, String)>,
    /// Lists of elements by name.
    pub tuples: Vec<(String, Vec<TupleEntry>)>,
}

/// An entry of a user's list.
#[derive(Clone, Debug, PartialEq)]
pub struct TupleEntry {
    /// The kind of the element, as MJCF keyword: `body`, `joint`, ...
    pub kind: String,
    /// Its name.
    pub name: String,
    /// A number of the entry.
    pub value: f64,
}
