//! A Collada file as XML: its elements by name and by id, and their numbers.

use roxmltree::{Document, Node};
use std::collections::HashMap;

/// A file with its elements indexed by id.
pub(super) struct File<'a> {
    ids: HashMap<&'a str, Node<'a, 'a>>,
}

impl<'a> File<'a> {
    pub(super) fn new(document: &'a Document) -> Self {
        let mut ids = HashMap::new();
        for node in document.descendants() {
            if let Some(id) = node.attribute("id") {
                ids.entry(id).or_insert(node);
            }
        }
        File { ids }
    }

    /// Returns the element that the `url` of another refers to.
    pub(super) fn referred(&self, node: Node<'a, 'a>) -> Result<Node<'a, 'a>, String> {
        self.by_id(node, "url")
    }

    /// Returns the element that the `source` of an input refers to. Ids may repeat across meshes: that in the input's
    /// own takes precedence.
    pub(super) fn source(&self, input: Node<'a, 'a>) -> Result<Node<'a, 'a>, String> {
        let written = input.attribute("source").unwrap_or_default();
        let mesh = input.ancestors().nth(2);
        let mut mesh_folder = mesh.into_iter().flat_map(|mesh| mesh.children());
        let is_meant = |other: &Node| other.attribute("id") == written.strip_prefix('#');
        match mesh_folder.find(|other| other.is_element() && is_meant(other)) {
            Some(found) => Ok(found),
            None => self.by_id(input, "source"),
        }
    }

    fn by_id(&self, node: Node<'a, 'a>, attribute: &str) -> Result<Node<'a, 'a>, String> {
        let written = node.attribute(attribute);
        let written = written.ok_or_else(|| at(node, &format!("{attribute} is missing")))?;
        let found = written.strip_prefix('#').and_then(|id| self.ids.get(id));
        (found.copied()).ok_or_else(|| at(node, &format!("the file has no element \"{written}\"")))
    }
}

/// Returns the first child with a name.
pub(super) fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    children(node, name).next()
}

/// Returns all children with a name.
pub(super) fn children<'a>(node: Node<'a, 'a>, name: &str) -> impl Iterator<Item = Node<'a, 'a>> {
    (node.children()).filter(move |child| child.is_element() && child.tag_name().name() == name)
}

/// Parses the numbers of an element.
pub(super) fn numbers<T: std::str::FromStr>(node: Node) -> Result<Vec<T>, String> {
    let texts = node.children().filter_map(|child| child.text());
    let words = texts.flat_map(str::split_ascii_whitespace);
    words
        .map(|word| {
            let wrong = |_| at(node, &format!("\"{word}\" is not a valid number"));
            word.parse().map_err(wrong)
        })
        .collect()
}

/// Formats an error message with the line and name of an element.
pub(super) fn at(node: Node, message: &str) -> String {
    let line = node.document().text_pos_at(node.range().start).row;
    format!("line {line}: <{}>: {message}", node.tag_name().name())
}
