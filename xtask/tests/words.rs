//! Doc comments and messages follow `docs/words.md`, as far as a program can check.

use std::fs;
use std::path::{Path, PathBuf};

/// Folders whose sources in Rust and WGSL are checked.
const FOLDERS: [&str; 4] = ["crates", "python/src", "xtask", "fuzz"];
/// Folders whose scripts in Python and TypeScript are checked.
const SCRIPT_FOLDERS: [&str; 4] = ["python", "parity", "bench", "web/src"];
/// Words that no doc comment begins with: what follows them is a noun clause.
const OPENINGS: [&str; 7] = ["What", "Where", "How", "Whether", "Who", "Which", "When"];
/// Words of the glossary's left column that have no other sense here.
const AVOIDED: [&str; 3] = ["sister", "so many", "somebody"];
/// Words of the left column, and odd phrases, that messages do not contain.
const AVOIDED_IN_MESSAGES: [&str; 18] = [
    "anew",
    "at hand",
    "card",
    "cards",
    "film",
    "films",
    "goes with",
    "leaves out",
    "left out",
    "look at",
    "looked at",
    "mend",
    "not there",
    "sister",
    "so many",
    "somebody",
    "told",
    "unasked",
];
const MAX_COLUMNS: usize = 120;

#[test]
fn doc_comments_and_messages_use_the_usual_terms() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files = Vec::new();
    for folder in FOLDERS {
        collect(&root.join(folder), &["rs", "wgsl"], &mut files);
    }
    assert!(files.len() > 800, "only {} files", files.len());
    let mut wrong = Vec::new();
    for file in &files {
        let text = fs::read_to_string(file).expect("a source file");
        let is_test = file.components().any(|part| part.as_os_str() == "tests");
        let messages = if is_test { "" } else { &text };
        for (line, reason) in faults(&text).into_iter().chain(message_faults(messages)) {
            wrong.push(format!("{}:{line}: {reason}", file.display()));
        }
    }
    assert!(wrong.is_empty(), "see docs/words.md:\n{}", wrong.join("\n"));
}

#[test]
fn scripts_use_the_usual_terms() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files = Vec::new();
    for folder in SCRIPT_FOLDERS {
        collect(&root.join(folder), &["py", "pyi", "ts"], &mut files);
    }
    assert!(files.len() > 200, "only {} files", files.len());
    let mut wrong = Vec::new();
    for file in &files {
        let text = fs::read_to_string(file).expect("a source file");
        for (line, reason) in script_faults(&text) {
            wrong.push(format!("{}:{line}: {reason}", file.display()));
        }
    }
    assert!(wrong.is_empty(), "see docs/words.md:\n{}", wrong.join("\n"));
}

/// Collects the files of a folder whose names have one of these ends, except build products.
fn collect(folder: &Path, ends: &[&str], files: &mut Vec<PathBuf>) {
    let entries = fs::read_dir(folder).expect("a folder of the repository");
    for path in entries.map(|entry| entry.expect("an entry").path()) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let is_source = ends
            .iter()
            .any(|&end| path.extension().is_some_and(|e| e == end));
        if path.is_dir() && name != "target" {
            collect(&path, ends, files);
        } else if is_source {
            files.push(path);
        }
    }
}

/// Returns the lines of doc comments that break a rule, with the rule.
fn faults(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let (mut is_inside, mut is_code) = (false, false);
    for (number, line) in (1..).zip(text.lines()) {
        let trimmed = line.trim_start();
        let comment = (trimmed.strip_prefix("///")).or_else(|| trimmed.strip_prefix("//!"));
        let Some(comment) = comment.map(str::trim) else {
            (is_inside, is_code) = (false, false);
            continue;
        };
        is_code ^= comment.starts_with("```");
        if !is_code {
            let first = comment.split([' ', ',']).next().unwrap_or_default();
            if !is_inside && OPENINGS.contains(&first) {
                found.push((number, format!("begins with {first:?}")));
            }
            // Addresses, and the types of arguments in Python's docstrings, stay in one line.
            let is_whole = ["http", " : {"].iter().any(|part| comment.contains(part));
            if line.chars().count() > MAX_COLUMNS && !is_whole {
                found.push((number, format!("is longer than {MAX_COLUMNS} columns")));
            }
            let lower = format!(" {} ", comment.to_lowercase());
            let used = AVOIDED
                .iter()
                .find(|word| lower.contains(&format!(" {word} ")));
            found.extend(used.map(|word| (number, format!("contains {word:?}"))));
        }
        is_inside = !comment.is_empty();
    }
    found
}

/// Returns the lines of a script that contain an avoided word, or begin its documentation with one of [`OPENINGS`].
fn script_faults(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let trimmed = line.trim_start();
        let comment = ["\"\"\"", "/**"]
            .iter()
            .find_map(|quote| trimmed.strip_prefix(quote));
        let first = comment.and_then(|comment| comment.split_whitespace().next());
        let opening = first.filter(|first| OPENINGS.contains(first));
        found.extend(opening.map(|word| (number, format!("begins with {word:?}"))));
        found.extend(avoided(line).map(|word| (number, format!("contains {word:?}"))));
    }
    found
}

/// Returns the word of [`AVOIDED_IN_MESSAGES`] that a text contains, if any.
fn avoided(text: &str) -> Option<&'static str> {
    let is_letter = |c: char| c.is_ascii_alphabetic() || c == '_';
    let words = text.split(|c| !is_letter(c)).filter(|w| !w.is_empty());
    let spaced = format!(" {} ", Vec::from_iter(words).join(" ").to_lowercase());
    let mut all = AVOIDED_IN_MESSAGES.into_iter();
    all.find(|word| spaced.contains(&format!(" {word} ")))
}

/// Returns the lines of string literals that contain an avoided word, with the word; tests at the end are skipped.
fn message_faults(text: &str) -> Vec<(usize, String)> {
    let text = text.split("#[cfg(test)]").next().unwrap_or_default();
    let mut found = Vec::new();
    for (line, literal) in literals(text) {
        let used = avoided(&literal);
        found.extend(used.map(|word| (line, format!("a message contains {word:?}"))));
    }
    found
}

/// Returns the string literals of a Rust file with their lines.
fn literals(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let (mut rest, mut line) = (text, 1);
    while let Some(at) = rest.find(['"', '/', '\'']) {
        line += rest[..at].matches('\n').count();
        let from = &rest[at..];
        let length = if from.starts_with("//") {
            from.find('\n').unwrap_or(from.len())
        } else if from.starts_with("'\"'") || from.starts_with("'\\") {
            3
        } else if from.starts_with('"') {
            let end = closing_quote(from);
            found.push((line, from[1..end].replace("\\\n", " ")));
            end + 1
        } else {
            1
        };
        let length = length.min(from.len());
        line += from[..length].matches('\n').count();
        rest = &from[length..];
    }
    found
}

/// Returns the index of the quote that closes the literal at the start of a text.
fn closing_quote(text: &str) -> usize {
    let mut is_escaped = false;
    let mut inside = text.char_indices().skip(1);
    let end = inside.find(|&(_, c)| {
        let closes = c == '"' && !is_escaped;
        is_escaped = c == '\\' && !is_escaped;
        closes
    });
    end.map_or(text.len() - 1, |(index, _)| index)
}

#[test]
fn messages_are_found_in_literals() {
    let text = "// \"told\"\nlet a = '\"';\nlet b = \"is told \\\n   anew\"; // film\n";
    let found = message_faults(text);
    assert_eq!(found, [(3, "a message contains \"anew\"".to_owned())]);
    assert!(message_faults("\"a_film {told_apart} retold\"").is_empty());
    assert!(message_faults("#[cfg(test)]\n\"a film\"").is_empty());
    assert_eq!(
        message_faults("r#\"<a/>\"#; \"The device is NOT there.\"").len(),
        1
    );
}

#[test]
fn each_rule_for_scripts_finds_its_faults() {
    let text = "\"\"\"What it costs.\"\"\"\nx = told  # retold\n/** How it is */\n# What for\n";
    let lines = Vec::from_iter(script_faults(text).into_iter().map(|(line, _)| line));
    assert_eq!(lines, [1, 2, 3]);
}

#[test]
fn each_rule_finds_what_breaks_it() {
    let lines = |text: &str| Vec::from_iter(faults(text).into_iter().map(|(line, _)| line));
    assert_eq!(lines("/// What it is.\nfn a() {}\n/// Returns it.\n"), [1]);
    assert_eq!(
        lines("/// Returns it\n/// Where it is.\n\n//! How it is.\n"),
        [4]
    );
    assert_eq!(lines(&format!("/// {}\n", "a".repeat(117))), [1]);
    assert_eq!(
        lines("/// Its sister on the GPU.\n/// A sisterhood.\n"),
        [1]
    );
    assert_eq!(lines("/// ```\n/// What\n/// ```\n"), Vec::<usize>::new());
}
