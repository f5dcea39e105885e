//! The elements of a file, each with the place where it was written.
//!
//! An owned tree rather than `roxmltree`'s own, because includes splice the elements of several files into one.

use crate::LoadError;
use clench_rigid::builder::Origin;
use roxmltree::{Document, Node};
use std::sync::Arc;

/// Deepest nesting of elements, as in MuJoCo: readers recurse, and a file must not overflow the stack.
pub(crate) const MAX_DEPTH: usize = 500;

/// An element with its attributes and children; text and comments are dropped.
#[derive(Clone, Debug)]
pub(crate) struct Element {
    pub tag: String,
    pub attributes: Vec<(String, String)>,
    pub children: Vec<Element>,
    pub origin: Origin,
}

/// The root element of a file's content.
///
/// # Errors
/// Where it is not UTF-8, empty, not well-formed, or nested too deeply.
pub(crate) fn parse(bytes: &[u8], file: &Arc<str>) -> Result<Element, LoadError> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = 1 + count_newlines(&bytes[..error.valid_up_to()]);
        LoadError::line(file, line, "the text is not valid UTF-8")
    })?;
    if text.trim().is_empty() {
        return Err(LoadError::file(file, "the file is empty"));
    }
    check_depth(text, file)?;
    let document = Document::parse(text).map_err(|error| {
        LoadError::line(
            file,
            error.pos().row,
            format!("not well-formed XML: {error}"),
        )
    })?;
    let newlines: Vec<usize> = text.match_indices('\n').map(|(at, _)| at).collect();
    Ok(convert(document.root_element(), file, &newlines))
}

/// What to say about elements below `MAX_DEPTH`.
pub(crate) fn too_deep() -> String {
    format!("elements are nested more than {MAX_DEPTH} deep")
}

fn count_newlines(bytes: &[u8]) -> u32 {
    bytes.iter().filter(|&&b| b == b'\n').count() as u32
}

/// Bounds the nesting before the parser, which recurses, sees the text.
///
/// Counts `<name` against `</` and `/>`, stepping over comments, CDATA, instructions and quoted values; text that is
/// not well-formed may be counted wrongly, but never as less deep than a parser would follow it.
fn check_depth(text: &str, file: &Arc<str>) -> Result<(), LoadError> {
    let mut depth = 0usize;
    let mut at = 0;
    while let Some(found) = text[at..].find('<') {
        let start = at + found;
        let rest = &text[start..];
        let skip = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")]
            .into_iter()
            .find(|(open, _)| rest.starts_with(open));
        if let Some((_, close)) = skip {
            match rest.find(close) {
                Some(end) => at = start + end + close.len(),
                None => return Ok(()),
            }
            continue;
        }
        let end = tag_end(rest);
        let tag = &rest[..end];
        if tag.starts_with("</") {
            depth = depth.saturating_sub(1);
        } else if !tag.starts_with("<!") {
            depth += 1;
            if depth > MAX_DEPTH {
                let line = 1 + count_newlines(&text.as_bytes()[..start]);
                return Err(LoadError::line(file, line, too_deep()));
            }
            depth -= usize::from(tag.ends_with("/>"));
        }
        at = start + end;
    }
    Ok(())
}

/// Length of the tag that `text` begins with, up to and including its `>` outside quotes.
fn tag_end(text: &str) -> usize {
    let mut quote = None;
    for (at, byte) in text.bytes().enumerate() {
        match (quote, byte) {
            (Some(q), b) if q == b => quote = None,
            (Some(_), _) => {}
            (None, b'"' | b'\'') => quote = Some(byte),
            (None, b'>') => return at + 1,
            (None, _) => {}
        }
    }
    text.len()
}

fn convert(node: Node, file: &Arc<str>, newlines: &[usize]) -> Element {
    let line = 1 + newlines.partition_point(|&at| at < node.range().start) as u32;
    Element {
        tag: node.tag_name().name().to_owned(),
        attributes: node
            .attributes()
            .map(|a| (a.name().to_owned(), a.value().to_owned()))
            .collect(),
        children: node
            .children()
            .filter(Node::is_element)
            .map(|child| convert(child, file, newlines))
            .collect(),
        origin: Origin {
            file: file.clone(),
            line,
        },
    }
}
