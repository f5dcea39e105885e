//! Conversion of text that MuJoCo's XML parser, TinyXML, accepts to strict XML.
//!
//! Comments may contain `--`, values `<` and a bare `&`, and attributes may follow each other without a space. Prefixes
//! of names need no declaration. Text between elements is ignored, and so is all that follows the first element or a
//! NUL. Line numbers are preserved for errors.

/// The maximum number of prefixes that are declared; the parser copies declarations from element to element.
const MAX_PREFIXES: usize = 10;

/// Converts text that TinyXML accepts to strict XML.
pub fn strict(text: &str) -> String {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut writer = Writer {
        rest: text.split('\0').next().unwrap_or_default(),
        out: String::with_capacity(text.len() + text.len() / 8),
        depth: 0,
        complete: false,
        root: None,
        prefixes: Vec::new(),
    };
    while !writer.rest.is_empty() && !writer.complete {
        writer.piece();
    }
    writer.end();
    writer.declare();
    writer.out
}

struct Writer<'a> {
    rest: &'a str,
    out: String,
    /// The number of open elements.
    depth: usize,
    /// True if the first element has ended.
    complete: bool,
    /// The end of the first element's name in the output.
    root: Option<usize>,
    /// The prefixes of names.
    prefixes: Vec<String>,
}

impl<'a> Writer<'a> {
    /// Takes text up to and including the first occurrence of `end`, or all of it.
    fn take(&mut self, end: &str) -> &'a str {
        let length = self
            .rest
            .find(end)
            .map_or(self.rest.len(), |at| at + end.len());
        let (taken, rest) = self.rest.split_at(length);
        self.rest = rest;
        taken
    }

    /// Drops text except for its line ends.
    fn blank(&mut self, text: &str) {
        self.out.extend(text.chars().filter(|c| *c == '\n'));
    }

    /// Converts the next comment, declaration, tag, or text between them.
    fn piece(&mut self) {
        let rest = self.rest;
        let kinds = [
            ("<!--", "-->"),
            ("<![CDATA[", "]]>"),
            ("<?", "?>"),
            ("<!", ">"),
        ];
        if let Some((open, close)) = kinds.into_iter().find(|(open, _)| rest.starts_with(open)) {
            if open == "<?" && self.depth > 0 {
                // A declaration inside an element is an error for both parsers.
                let taken = self.take(close);
                self.out.push_str(taken);
                return;
            }
            let (start, tail) = rest.split_at(open.len());
            self.rest = tail;
            let closed = tail.contains(close);
            let taken = self.take(close);
            self.blank(taken);
            if !closed {
                self.out.push_str(start);
            }
        } else if rest.starts_with('<') {
            self.tag();
        } else {
            let length = rest.find('<').unwrap_or(rest.len());
            let (text, tail) = rest.split_at(length);
            self.rest = tail;
            match self.depth {
                0 => self.out.push_str(text),
                _ => self.blank(text),
            }
        }
    }

    /// Converts a tag, with its values as strict XML.
    fn tag(&mut self) {
        let closes = self.rest.starts_with("</");
        let mut last = ' ';
        let mut chars = self.rest.char_indices();
        while let Some((at, c)) = chars.next() {
            match c {
                '>' => {
                    self.root.get_or_insert(self.out.len());
                    self.out.push('>');
                    self.rest = &self.rest[at + 1..];
                    match (closes, last) {
                        (true, _) => self.depth = self.depth.saturating_sub(1),
                        (false, '/') => {}
                        (false, _) => self.depth += 1,
                    }
                    self.complete = self.depth == 0;
                    return;
                }
                '"' | '\'' if last == '=' => {
                    let value = &self.rest[at + 1..];
                    let Some(length) = value.find(c) else {
                        // The strict parser reports that the value does not end.
                        self.out.push_str(&self.rest[at..]);
                        self.rest = "";
                        return;
                    };
                    self.value(&value[..length], c);
                    // The next attribute may follow without a space.
                    self.out.push(' ');
                    chars = self.rest.char_indices();
                    chars.find(|(start, _)| *start == at + 1 + length);
                    last = c;
                }
                '<' if at > 0 => {
                    // The tag is not closed: the strict parser reports the location.
                    self.out.push_str(" <");
                    self.rest = &self.rest[at + 1..];
                    return;
                }
                c => {
                    if c == ':' {
                        self.prefix();
                    }
                    if self.root.is_none() && (c.is_whitespace() || c == '/') {
                        self.root = Some(self.out.len());
                    }
                    self.out.push(c);
                    if !c.is_whitespace() {
                        last = c;
                    }
                }
            }
        }
        self.rest = "";
    }

    /// Records the name at the end of the output, which precedes a colon.
    fn prefix(&mut self) {
        let is_border = |c: char| c.is_whitespace() || "<>/=\"'".contains(c);
        let name = self.out.rsplit(is_border).next().unwrap_or_default();
        let known = ["", "xml", "xmlns"].contains(&name) || self.prefixes.iter().any(|p| p == name);
        if !known && self.prefixes.len() < MAX_PREFIXES {
            self.prefixes.push(name.to_owned());
        }
    }

    /// Declares the prefixes that are used and not declared, in the first element.
    fn declare(&mut self) {
        let Some(root) = self.root else {
            return;
        };
        for prefix in std::mem::take(&mut self.prefixes) {
            if !self.out.contains(&format!("xmlns:{prefix}")) {
                let declaration = format!(" xmlns:{prefix}=\"{prefix}\"");
                self.out.insert_str(root, &declaration);
            }
        }
    }

    /// Writes a value in quotes.
    fn value(&mut self, value: &str, quote: char) {
        self.out.push(quote);
        for (at, c) in value.char_indices() {
            match c {
                '<' => self.out.push_str("&lt;"),
                '&' if !is_reference(&value[at..]) => self.out.push_str("&amp;"),
                '\u{1}'..='\u{8}' | '\u{b}' | '\u{c}' | '\u{e}'..='\u{1f}' => {
                    self.out.push('\u{fffd}')
                }
                c => self.out.push(c),
            }
        }
        self.out.push(quote);
    }

    /// Handles the text after the first element: further elements and comments are ignored, text is an error.
    fn end(&mut self) {
        let rest = self.rest.trim_start();
        if self.complete && !rest.starts_with('<') {
            self.out.push_str(self.rest);
        }
    }
}

/// Returns true if a text begins with a reference that XML predefines: to a character or one of the five entities.
fn is_reference(text: &str) -> bool {
    let Some(name) = text[1..].split_once(';').map(|(name, _)| name) else {
        return false;
    };
    let number = |digits: &str, radix| {
        let code = u32::from_str_radix(digits, radix)
            .ok()
            .and_then(char::from_u32);
        code.is_some_and(|c| !c.is_control() || c.is_whitespace())
    };
    match (name.strip_prefix("#x"), name.strip_prefix('#')) {
        (Some(digits), _) => number(digits, 16),
        (None, Some(digits)) => number(digits, 10),
        (None, None) => ["lt", "gt", "amp", "quot", "apos"].contains(&name),
    }
}
