//! Elements as indented text, each with its attributes on one line.

use clench_builder::ElementNumber;
use clench_dynamics::Params;
use std::fmt::Write;

/// The text so far, and the open elements at its end.
#[derive(Default)]
pub(in crate::mjcf) struct Xml {
    text: String,
    open: Vec<&'static str>,
}

/// An element being written, before its attributes are complete.
pub(in crate::mjcf) struct Tag<'a> {
    xml: &'a mut Xml,
    name: &'static str,
}

impl Xml {
    /// Begins an element.
    pub(in crate::mjcf) fn tag(&mut self, name: &'static str) -> Tag<'_> {
        self.indent();
        self.text.push('<');
        self.text.push_str(name);
        Tag { xml: self, name }
    }

    /// Ends the innermost open element.
    pub(in crate::mjcf) fn close(&mut self) {
        if let Some(name) = self.open.pop() {
            self.indent();
            self.text.push_str("</");
            self.text.push_str(name);
            self.text.push_str(">\n");
        }
    }

    /// Returns the number of open elements.
    pub(in crate::mjcf) fn depth(&self) -> usize {
        self.open.len()
    }

    /// Returns the whole text, with every element ended.
    pub(in crate::mjcf) fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.close();
        }
        self.text
    }

    /// Writes a section with the content from `write`; omits it if empty.
    pub(in crate::mjcf) fn section<E>(
        &mut self,
        name: &'static str,
        write: impl FnOnce(&mut Xml) -> Result<(), E>,
    ) -> Result<(), E> {
        let before = self.text.len();
        self.tag(name).open();
        let empty = self.text.len();
        write(self)?;
        if self.text.len() == empty {
            self.open.pop();
            self.text.truncate(before);
        } else {
            self.close();
        }
        Ok(())
    }

    fn indent(&mut self) {
        let depth = self.open.len();
        self.text.extend(std::iter::repeat_n("  ", depth));
    }
}

impl Tag<'_> {
    /// Ends an element without children.
    pub(in crate::mjcf) fn end(self) {
        self.xml.text.push_str("/>\n");
    }

    /// Ends the attributes of an element that has children.
    pub(in crate::mjcf) fn open(self) {
        self.xml.text.push_str(">\n");
        self.xml.open.push(self.name);
    }

    /// Writes an attribute.
    pub(in crate::mjcf) fn text(self, name: &str, value: &str) -> Self {
        let text = &mut self.xml.text;
        let _ = write!(text, " {name}=\"");
        for c in value.chars() {
            match c {
                '&' => text.push_str("&amp;"),
                '<' => text.push_str("&lt;"),
                '>' => text.push_str("&gt;"),
                '"' => text.push_str("&quot;"),
                c if c.is_control() => {
                    let _ = write!(text, "&#{};", u32::from(c));
                }
                c => text.push(c),
            }
        }
        text.push('"');
        self
    }

    /// Writes a name unless it is empty.
    pub(in crate::mjcf) fn name(self, name: &str) -> Self {
        match name {
            "" => self,
            name => self.text("name", name),
        }
    }

    /// Writes `true` or `false`.
    pub(in crate::mjcf) fn boolean(self, name: &str, value: bool) -> Self {
        self.text(name, if value { "true" } else { "false" })
    }

    /// Writes an integer.
    pub(in crate::mjcf) fn integer(self, name: &str, value: impl Into<i64>) -> Self {
        let value: i64 = value.into();
        self.text(name, &value.to_string())
    }

    /// Writes an integer unless it is the default.
    pub(in crate::mjcf) fn integer_unless(self, name: &str, value: i64, default: i64) -> Self {
        match value == default {
            true => self,
            false => self.integer(name, value),
        }
    }

    /// Writes numbers with as many digits as identify each.
    pub(in crate::mjcf) fn numbers(self, name: &str, values: &[f64]) -> Self {
        let text = &mut self.xml.text;
        let _ = write!(text, " {name}=\"");
        for (k, value) in values.iter().enumerate() {
            let digits = format!("{value:?}");
            let space = if k == 0 { "" } else { " " };
            let _ = write!(
                text,
                "{space}{}",
                digits.strip_suffix(".0").unwrap_or(&digits)
            );
        }
        text.push('"');
        self
    }

    /// Writes numbers of single precision in the same way.
    pub(in crate::mjcf) fn singles(self, name: &str, values: impl Iterator<Item = f64>) -> Self {
        let text = &mut self.xml.text;
        let _ = write!(text, " {name}=\"");
        for (k, value) in values.enumerate() {
            let space = if k == 0 { "" } else { " " };
            let digits = format!("{:?}", value as f32);
            let _ = write!(
                text,
                "{space}{}",
                digits.strip_suffix(".0").unwrap_or(&digits)
            );
        }
        text.push('"');
        self
    }

    /// Writes numbers unless they are the default.
    pub(in crate::mjcf) fn numbers_unless(
        self,
        name: &str,
        values: &[f64],
        default: &[f64],
    ) -> Self {
        match values == default {
            true => self,
            false => self.numbers(name, values),
        }
    }

    /// Writes the coefficients of a polynomial, the linear one first, without trailing zeros.
    pub(in crate::mjcf) fn polynomial(self, name: &str, coefficients: [f64; 3]) -> Self {
        let used = coefficients.iter().rposition(|&c| c != 0.0);
        self.numbers_unless(name, &coefficients[..used.map_or(0, |last| last + 1)], &[])
    }

    /// Writes the numbers of element `index` that a table lists and that are not zero.
    pub(in crate::mjcf) fn element_numbers(
        self,
        rows: &[ElementNumber],
        params: &Params<f64>,
        index: usize,
    ) -> Self {
        rows.iter().fold(self, |tag, row| {
            tag.number_unless(row.name, params.number(row.param, 0, index), 0.0)
        })
    }

    /// Writes a number unless it is the default.
    pub(in crate::mjcf) fn number_unless(self, name: &str, value: f64, default: f64) -> Self {
        self.numbers_unless(name, &[value], &[default])
    }

    /// Writes words, if any.
    pub(in crate::mjcf) fn words<'w>(
        self,
        name: &str,
        words: impl Iterator<Item = &'w str>,
    ) -> Self {
        let words: Vec<&str> = words.collect();
        match words.is_empty() {
            true => self,
            false => self.text(name, &words.join(" ")),
        }
    }

    /// Writes a list of integers.
    pub(in crate::mjcf) fn integers(self, name: &str, values: impl Iterator<Item = i64>) -> Self {
        let words: Vec<String> = values.map(|value| value.to_string()).collect();
        self.text(name, &words.join(" "))
    }
}
