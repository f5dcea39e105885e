//! The elements of a file, each with the place where it was written.
//!
//! An owned tree rather than `roxmltree`'s own, because includes splice the elements of several files into one. Nothing here or
//! in the readers recurses over it, so that a deep file needs no more stack than a flat one.

use crate::LoadError;
use crate::spending::Spending;
use crate::tolerant;
use clench_builder::Origin;
use roxmltree::{Document, Node};
use std::sync::Arc;

/// Deepest nesting of elements, as in MuJoCo.
pub(crate) const MAX_DEPTH: usize = 500;
/// Most attributes of an element; no element of MJCF has a quarter of them. The parser compares each with all before it.
const MAX_ATTRIBUTES: usize = 200;
/// Most declarations of namespaces, which mean nothing here. The parser copies them from element to element.
const MAX_NAMESPACES: usize = 20;
/// What an element or attribute takes while a file is parsed, and after, besides its own text, bytes.
const MARK: u64 = 300;

/// An element with its attributes and children; text and comments are dropped.
#[derive(Clone, Debug)]
pub(crate) struct Element {
    pub tag: String,
    pub attributes: Vec<(String, String)>,
    pub children: Vec<Element>,
    pub origin: Origin,
    /// Which of the model's [`Sources`](crate::mjcf::source::Sources) it is read with.
    pub source: usize,
    /// The number by which keyframes of an attached model refer to it; 0 where none does.
    pub number: u32,
}

impl Element {
    /// An element without children that stands for another, where that one is written.
    pub(crate) fn in_place_of(other: &Element, tag: &str) -> Element {
        Element {
            tag: tag.to_owned(),
            attributes: Vec::new(),
            children: Vec::new(),
            origin: other.origin.clone(),
            source: other.source,
            number: 0,
        }
    }

    /// Marks it and all in it as read with a source.
    pub(crate) fn set_source(&mut self, source: usize) {
        self.source = source;
        let mut pending: Vec<&mut Element> = self.children.iter_mut().collect();
        while let Some(element) = pending.pop() {
            element.source = source;
            pending.extend(element.children.iter_mut());
        }
    }
}

/// Children are taken apart one by one: a compiler's own code would recurse.
impl Drop for Element {
    fn drop(&mut self) {
        let mut pending = std::mem::take(&mut self.children);
        while let Some(mut element) = pending.pop() {
            pending.append(&mut element.children);
        }
    }
}

/// The root element of a file's content.
///
/// Where MuJoCo's parser, TinyXML, takes more than XML allows, so does this. Bytes that are not UTF-8 stand for some character, as they
/// do in comments of older files.
///
/// # Errors
/// Where it is empty, not well-formed, nested too deeply, has names in a namespace, or is larger than the budget.
pub(crate) fn parse(
    bytes: &[u8],
    file: &Arc<str>,
    spending: &mut Spending,
) -> Result<Element, LoadError> {
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

/// Why a text is no document.
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
        let message = format!("not well-formed XML: {error}");
        Failure::Malformed(LoadError::line(file, error.pos().row, message))
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

/// Whether a root element is that of a URDF file, in small letters or capitals, as MuJoCo has it.
pub(crate) fn is_urdf(tag: &str) -> bool {
    tag.eq_ignore_ascii_case("robot")
}

/// What to say about elements below `MAX_DEPTH`.
pub(crate) fn too_deep() -> String {
    format!("elements are nested more than {MAX_DEPTH} deep")
}

fn count_newlines(bytes: &[u8]) -> u32 {
    bytes.iter().filter(|&&b| b == b'\n').count() as u32
}

/// More of something in a text than there may be.
pub(crate) struct Excess {
    line: u32,
    message: String,
}

impl std::fmt::Display for Excess {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "line {}: {}", self.line, self.message)
    }
}

/// How many elements, attributes, comments and the like a text has at most.
///
/// Bounds what the parser does that grows with the square of a file, before it does. A value cannot contain `<`, so a tag has no
/// more attributes than there are `=` up to the next `<`.
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

/// Takes what the parser will, before it does.
fn check_marks(text: &str, file: &Arc<str>, spending: &mut Spending) -> Result<(), LoadError> {
    let marks = count_marks(text)
        .map_err(|Excess { line, message }| LoadError::line(file, line, message))?;
    let bytes = 3 * text.len() as u64 + MARK * marks;
    spending
        .bytes(bytes)
        .map_err(|excess| LoadError::file(file, excess))
}

/// Turns the parser's elements into ours.
struct Converter<'a> {
    text: &'a str,
    file: &'a Arc<str>,
    /// Where lines end, bytes.
    newlines: Vec<usize>,
    /// Elements may have the prefix of a namespace, which they keep, and attributes in one, which no reader of ours wants.
    namespaces: bool,
}

impl Converter<'_> {
    /// The tree below a node.
    fn convert(&self, root: Node, spending: &mut Spending) -> Result<Element, LoadError> {
        // The elements that the node is in, the outermost first.
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
            // The element is complete, and so are those that end with it.
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

    /// An element without its children.
    ///
    /// # Errors
    /// Where its name or that of an attribute in an MJCF file has the prefix of a namespace: MJCF has none, and MuJoCo knows no such
    /// name either. A namespace for all names without a prefix makes no difference.
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
        // At the root they tell editors where to find a schema.
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
