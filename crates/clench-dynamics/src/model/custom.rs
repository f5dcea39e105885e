//! A user's own data in a model, which moves nothing.

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
