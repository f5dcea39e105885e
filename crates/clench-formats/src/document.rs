//! The elements of a file, each with its source location.
//!
//! The tree is owned, not `roxmltree`'s, because includes splice the elements of several files into one. Neither
//! this module nor the readers recurse over it, so that a deep file needs no more stack than a flat one.

use crate::error::LoadError;
use crate::spending::Spending;
use crate::tolerant;
use clench_builder::Origin;
use roxmltree::{Document, Error, Node};
use std::sync::Arc;

/// The maximum nesting depth of elements, as in MuJoCo.
pub(crate) const MAX_DEPTH: usize = 500;
/// The maximum number of attributes; MJCF elements have fewer than a quarter. The parser compares each with all
/// preceding ones.
const MAX_ATTRIBUTES: usize = 200;
/// The maximum number of namespace declarations, which are ignored here. The parser copies them from element to
/// element.
const MAX_NAMESPACES: usize = 20;
/// The memory that an element or attribute takes during and after parsing, in addition to its text, bytes.
const MARK: u64 = 300;

/// An element with its attributes and children; text and comments are dropped.
#[derive(Clone, Debug)]
pub(crate) struct Element {
    pub tag: String,
    pub attributes: Vec<(String, String)>,
    pub children: Vec<Element>,
    pub origin: Origin,
    /// The index in the model's [`Sources`](crate::mjcf::source::Sources) with which it is read.
    pub source: usize,
    /// The number by which keyframes of an attached model refer to it; 0 if none does.
    pub number: u32,
}

impl Element {
    /// Creates an element without children at the location of another.
    pub(crate) fn with_location_of(other: &Element, tag: &str) -> Element {
        Element {
            tag: tag.to_owned(),
            attributes: Vec::new(),
            children: Vec::new(),
            origin: other.origin.clone(),
            source: other.source,
            number: 0,
        }
    }

    /// Sets the source of the element and all its descendants.
    pub(crate) fn set_source(&mut self, source: usize) {
        self.source = source;
        let mut pending: Vec<&mut Element> = self.children.iter_mut().collect();
        while let Some(element) = pending.pop() {
            element.source = source;
            pending.extend(element.children.iter_mut());
        }
    }
}

/// Drops children iteratively: the compiler-generated drop would recurse.
impl Drop for Element {
    fn drop(&mut self) {
        let mut pending = std::mem::take(&mut self.children);
        while let Some(mut element) = pending.pop() {
            pending.append(&mut element.children);
        }
    }
}

/// Parses a file's content and returns its root element.
///
/// Accepts what MuJoCo's parser, TinyXML, accepts beyond XML. Invalid UTF-8 is replaced, as it occurs in comments of
/// older files.
///
/// # Errors
/// Returns an error if the content is empty, UTF-16, not well-formed, nested too deeply, uses namespaced names, or
/// exceeds the budget.
pub(crate) fn parse(
    bytes: &[u8],
    file: &Arc<str>,
    spending: &mut Spending,
) -> Result<Element, LoadError> {
    if let [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..] = bytes {
        let message = "the text is encoded as UTF-16: save it as UTF-8";
        return Err(LoadError::file(file, message));
    }
    let text = String::from_utf8_lossy(bytes);
    if text.trim().is_empty() {
        return Err(LoadError::file(file, "the file is empty"));
    }
    let first = match parse_strictly(&text, file, spending) {
        Err(Failure::Malformed(error)) => error,
        Err(Failure::Other(error)) => return Err(error),
        Ok(root) => return Ok(root),
    };
    match parse_strictly(&tolerant::strict(&text), file, spending) {
        Err(Failure::Malformed(_)) => Err(first),
        Err(Failure::Other(error)) => Err(error),
        Ok(root) => Ok(root),
    }
}

/// The reason for which a text is not a document.
enum Failure {
    /// It is not XML.
    Malformed(LoadError),
    Other(LoadError),
}

fn parse_strictly(
    text: &str,
    file: &Arc<str>,
    spending: &mut Spending,
) -> Result<Element, Failure> {
    check_marks(text, file, spending).map_err(Failure::Other)?;
    let document = Document::parse(text).map_err(|error| {
        let row = match error {
            // The parser reports these two at the first line.
            Error::UnexpectedEndOfStream | Error::UnclosedRootNode => {
                1 + count_newlines(text.trim_end().as_bytes())
            }
            _ => error.pos().row,
        };
        let message = format!("not well-formed XML: {error}");
        Failure::Malformed(LoadError::line(file, row, message))
    })?;
    let converter = Converter {
        text,
        file,
        newlines: text.match_indices('\n').map(|(at, _)| at).collect(),
        namespaces: is_urdf(document.root_element().tag_name().name()),
    };
    let root = converter.convert(document.root_element(), spending);
    root.map_err(Failure::Other)
}

/// Returns true if the root element is that of a URDF file, ignoring case as MuJoCo does.
pub(crate) fn is_urdf(tag: &str) -> bool {
    tag.eq_ignore_ascii_case("robot")
}

/// Returns the error message for elements below `MAX_DEPTH`.
pub(crate) fn too_deep() -> String {
    format!("elements are nested more than {MAX_DEPTH} deep")
}

fn count_newlines(bytes: &[u8]) -> u32 {
    bytes.iter().filter(|&&b| b == b'\n').count() as u32
}

/// A limit that a text exceeds, with the location.
pub(crate) struct Excess {
    line: u32,
    message: String,
}

impl std::fmt::Display for Excess {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "line {}: {}", self.line, self.message)
    }
}

/// Returns an upper bound on the number of elements, attributes, comments and the like in a text.
///
/// Limits parser work that grows quadratically with the file. A value cannot contain `<`, so a tag has at most as many
/// attributes as there are `=` up to the next `<`.
pub(crate) fn count_marks(text: &str) -> Result<u64, Excess> {
    let (mut marks, mut namespaces, mut at) = (0, 0, 0);
    while let Some(found) = text[at..].find('<') {
        let start = at + found;
        let rest = &text[start..];
        let skip = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")]
            .into_iter()
            .find(|(open, _)| rest.starts_with(open));
        let length = match skip {
            // `<!-->` opens a comment and does not close it.
            Some((open, close)) => match rest[open.len()..].find(close) {
                Some(end) => open.len() + end + close.len(),
                None => rest.len(),
            },
            None => {
                let tag = rest[1..].split('<').next().unwrap_or_default();
                let attributes = tag.bytes().filter(|&b| b == b'=').count();
                namespaces += tag.matches("xmlns").count();
                let message = if attributes > MAX_ATTRIBUTES {
                    format!("an element has more than {MAX_ATTRIBUTES} attributes")
                } else if namespaces > MAX_NAMESPACES {
                    format!("there are more than {MAX_NAMESPACES} declarations of namespaces")
                } else {
                    marks += 1 + attributes as u64;
                    at = start + 1 + tag.len();
                    continue;
                };
                let line = 1 + count_newlines(&text.as_bytes()[..start]);
                return Err(Excess { line, message });
            }
        };
        marks += 1;
        at = start + length;
    }
    Ok(marks)
}

/// Counts the parser's memory before parsing.
fn check_marks(text: &str, file: &Arc<str>, spending: &mut Spending) -> Result<(), LoadError> {
    let marks = count_marks(text)
        .map_err(|Excess { line, message }| LoadError::line(file, line, message))?;
    let bytes = 3 * text.len() as u64 + MARK * marks;
    spending
        .bytes(bytes)
        .map_err(|excess| LoadError::file(file, excess))
}

/// A converter from the parser's elements to `Element`s.
struct Converter<'a> {
    text: &'a str,
    file: &'a Arc<str>,
    /// The offsets of line ends, bytes.
    newlines: Vec<usize>,
    /// True if names may be namespaced: elements retain the prefix, and namespaced attributes are dropped.
    namespaces: bool,
}

impl Converter<'_> {
    /// Converts the tree below a node.
    fn convert(&self, root: Node, spending: &mut Spending) -> Result<Element, LoadError> {
        // The ancestors of the node, outermost first.
        let mut open: Vec<Element> = Vec::new();
        let mut node = root;
        loop {
            let mut element = self.element(node)?;
            spending
                .elements(1)
                .map_err(|excess| element.error(excess))?;
            if open.len() >= MAX_DEPTH {
                return Err(element.error(too_deep()));
            }
            if let Some(child) = node.first_element_child() {
                open.push(element);
                node = child;
                continue;
            }
            // The element is complete, and so are the ancestors that end with it.
            loop {
                let (Some(mut parent), Some(above)) = (open.pop(), node.parent_element()) else {
                    return Ok(element);
                };
                parent.children.push(element);
                if let Some(sibling) = node.next_sibling_element() {
                    open.push(parent);
                    node = sibling;
                    break;
                }
                (element, node) = (parent, above);
            }
        }
    }

    /// Converts an element without its children.
    ///
    /// # Errors
    /// Returns an error if an MJCF file uses a namespace prefix in the name of the element or of an attribute: MJCF has
    /// no namespaces, and MuJoCo rejects such names too. A default namespace has no effect.
    fn element(&self, node: Node) -> Result<Element, LoadError> {
        let start = node.range().start;
        let end = |c: char| c.is_whitespace() || "/>".contains(c);
        let name = self.text[start + 1..].split(end).next().unwrap_or_default();
        let element = Element {
            tag: match self.namespaces {
                true => name.to_owned(),
                false => node.tag_name().name().to_owned(),
            },
            attributes: node
                .attributes()
                .filter(|a| a.namespace().is_none())
                .map(|a| (a.name().to_owned(), a.value().to_owned()))
                .collect(),
            children: Vec::new(),
            origin: Origin {
                file: self.file.clone(),
                line: 1 + self.newlines.partition_point(|&at| at < start) as u32,
            },
            source: 0,
            number: 0,
        };
        if self.namespaces {
            return Ok(element);
        }
        if name.contains(':') {
            return Err(element.error(format!(
                "unknown element <{name}>: its name is in a namespace, and MJCF has none"
            )));
        }
        // At the root, such attributes refer editors to a schema.
        let is_root = node.parent_element().is_none();
        let named = |a: &roxmltree::Attribute| a.namespace().is_some() && !is_root;
        if let Some(attribute) = node.attributes().find(named) {
            let name = &self.text[attribute.range_qname()];
            return Err(element.error(format!(
                "unknown attribute \"{name}\": it is in a namespace, and MJCF has none"
            )));
        }
        Ok(element)
    }
}
