//! `cargo xtask wheel`: the Python package as users install it, with the licences of all that is compiled into it.

use crate::package::wheel;
use crate::run::{cargo, root};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The file of the texts, next to the project's own licences, so that every wheel includes it.
const FILE: &str = "python/LICENSE-THIRD-PARTY.txt";

/// The prefixes of the names of licence files.
const TEXTS: [&str; 5] = ["LICENSE", "LICENCE", "COPYING", "NOTICE", "COPYRIGHT"];

/// A package that is compiled in.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Part {
    /// The name and version, as in the name of its folder.
    name: String,
    /// The declared licence.
    licence: String,
}

/// Writes the notices and builds the wheel.
///
/// # Errors
/// Returns an error if a package has no licence text, or a command fails.
pub(crate) fn build() -> Result<(), String> {
    let parts = parts()?;
    let sources = sources()?;
    let mut folders = Vec::from_iter(parts.iter().map(|part| (part, sources.find(&part.name))));
    // The viewer's page is also compiled in.
    let scripts = ["three", "uplot"].map(|name| Part {
        name: name.to_owned(),
        licence: "MIT".to_owned(),
    });
    for script in &scripts {
        let folder = root().join("web/node_modules").join(&script.name);
        folders.push((script, folder.is_dir().then_some(folder)));
    }
    let text = notices(&folders)?;
    fs::write(root().join(FILE), text).map_err(|e| format!("cannot write {FILE}: {e}"))?;
    println!("{} packages in {FILE}", folders.len());
    wheel()
}

/// Returns the external crates of the module.
fn parts() -> Result<Vec<Part>, String> {
    let mut tree = cargo(&["tree", "--locked", "--package", "clench-python"]);
    tree.args(["--features", "gpu,render,derivatives"]);
    tree.args(["--edges", "normal,no-proc-macro", "--prefix", "none"]);
    tree.args(["--format", "{p}\t{l}"]);
    let done = tree.output().map_err(|e| format!("cargo tree: {e}"))?;
    if !done.status.success() {
        return Err(String::from_utf8_lossy(&done.stderr).into_owned());
    }
    Ok(read_tree(&String::from_utf8_lossy(&done.stdout)))
}

/// Parses the output of `cargo tree`, one crate per line: name, version and licence. Crates with a path are the
/// project's own.
fn read_tree(text: &str) -> Vec<Part> {
    let foreign = text.lines().filter(|line| !line.contains(" (/"));
    let part = |line: &str| {
        let (package, licence) = line.split_once('\t')?;
        let (name, version) = package.split_once(" v")?;
        Some(Part {
            name: format!("{name}-{}", version.trim_end_matches(" (*)")),
            licence: licence.trim_end_matches(" (*)").to_owned(),
        })
    };
    let mut parts = Vec::from_iter(foreign.filter_map(part));
    parts.sort();
    parts.dedup();
    parts
}

/// The folders into which cargo unpacks fetched crates.
struct Sources(Vec<PathBuf>);

fn sources() -> Result<Sources, String> {
    let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let own = || std::env::var_os("HOME").map(|home| PathBuf::from(home).join(".cargo"));
    let home = home
        .or_else(own)
        .ok_or("neither CARGO_HOME nor HOME is set")?;
    let folder = home.join("registry/src");
    let found =
        fs::read_dir(&folder).map_err(|e| format!("cannot read {}: {e}", folder.display()))?;
    Ok(Sources(found.flatten().map(|entry| entry.path()).collect()))
}

impl Sources {
    fn find(&self, name: &str) -> Option<PathBuf> {
        let mut folders = self.0.iter().map(|folder| folder.join(name));
        folders.find(|folder| folder.is_dir())
    }
}

/// Returns all texts, each once with the packages that contain it; packages without a text are listed with the name of
/// their licence.
fn notices(folders: &[(&Part, Option<PathBuf>)]) -> Result<String, String> {
    let mut texts: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    let mut without = Vec::new();
    for (part, folder) in folders {
        let folder = folder.as_ref().ok_or_else(|| {
            format!(
                "{} does not exist: build the package and the page first",
                part.name
            )
        })?;
        let own = licence_texts(folder)?;
        if own.is_empty() {
            without.push(format!("{}: {}", part.name, part.licence));
        }
        for text in own {
            texts.entry(text).or_default().push(&part.name);
        }
    }
    let mut out = String::from("The crates compiled into this package, and their licences.\n");
    for part in folders.iter().map(|(part, _)| part) {
        out += &format!("\n{}: {}", part.name, part.licence);
    }
    if !without.is_empty() {
        out += "\n\nThe following of these contain no licence text:\n\n";
        out += &without.join("\n");
    }
    for (text, names) in texts {
        let rule = "-".repeat(80);
        out += &format!("\n\n{rule}\n{}\n\n{}", names.join(", "), text.trim_end());
    }
    Ok(out + "\n")
}

/// Reads the licence files of a package.
fn licence_texts(folder: &Path) -> Result<Vec<String>, String> {
    let failed = |e: std::io::Error| format!("cannot read {}: {e}", folder.display());
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let name = path
            .file_name()
            .map(|name| name.to_string_lossy().to_uppercase());
        let is_text = name.is_some_and(|name| TEXTS.iter().any(|text| name.starts_with(text)));
        if is_text && path.is_file() {
            files.push(path);
        }
    }
    files.sort();
    let read = |path: PathBuf| fs::read(&path).map_err(failed);
    let texts = files.into_iter().map(read);
    texts
        .map(|text| Ok(String::from_utf8_lossy(&text?).replace("\r\n", "\n")))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crates_of_others_are_listed_once() {
        let tree = "clench-python v0.1.0 (/home/one/clench/python)\tMIT OR Apache-2.0\nnumpy v0.30.0\tBSD-2-Clause\n\
                    libc v0.2.1\tMIT OR Apache-2.0\nnumpy v0.30.0\tBSD-2-Clause (*)\n";
        let names = Vec::from_iter(read_tree(tree).into_iter().map(|part| part.name));
        assert_eq!(names, ["libc-0.2.1", "numpy-0.30.0"]);
    }
}
