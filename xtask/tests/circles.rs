//! No file of a crate uses, directly or indirectly, a file that uses it, so each can be read with its dependencies
//! only. The exception is the dispatch of lanes, which returns number types that it is implemented for. Folders may use
//! each other, but few files do so against the order of their crate's folders.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::slice::from_ref;

/// A module by its path in the crate; the root is empty.
type Module = Vec<String>;

/// A name that a module imports.
struct Import {
    name: String,
    path: Module,
    /// True if it is re-exported, which does not count as a use.
    exported: bool,
}

/// The file that may be part of a cycle.
const EXEMPT: &str = "lanes::dispatch";
/// The maximum number of uses in a crate that run against the order of its folders.
const MAX_BACK_ARROWS: usize = 10;
/// The maximum length of a chain of re-exports.
const MAX_EXPORTS: usize = 8;

#[test]
fn files_use_each_other_in_no_circle() {
    let mut files = 0;
    for folder in crates() {
        let modules = modules(&folder.join("src"));
        files += modules.len();
        let circle = circle(&uses(&modules));
        assert!(circle.is_empty(), "{}: {circle:#?}", folder.display());
    }
    assert!(files > 400, "only {files} files were found");
}

#[test]
fn few_uses_run_against_the_order_of_folders() {
    for folder in crates() {
        let found = back_arrows(&uses(&modules(&folder.join("src"))));
        println!("{}: {found:#?}", folder.display());
        assert!(
            found.len() <= MAX_BACK_ARROWS,
            "{}: {found:#?}",
            folder.display()
        );
    }
}

#[test]
fn a_use_against_the_order_of_folders_is_found() {
    let modules = |uses: &[(&str, &str)]| {
        let module = |path: &str| Module::from_iter(path.split("::").map(str::to_owned));
        let mut found: BTreeMap<Module, BTreeSet<Module>> = BTreeMap::new();
        for (user, used) in uses {
            found.entry(module(user)).or_default().insert(module(used));
        }
        found
    };
    let uses = [
        ("a::x", "b::x"),
        ("a::y", "b::y"),
        ("b::z", "a::z"),
        ("c", "a::x"),
    ];
    assert_eq!(back_arrows(&modules(&uses)), ["b::z uses a::z"]);
    assert!(back_arrows(&modules(&[("a::x", "a::y"), ("a::y", "b")])).is_empty());
}

/// Returns the folders of all crates.
fn crates() -> impl Iterator<Item = PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let crates = fs::read_dir(root.join("crates")).expect("the folder is there");
    let crates = crates.map(|entry| entry.expect("it can be listed").path());
    crates.chain([root.join("python"), root.join("xtask")])
}

#[test]
fn a_circle_is_found_through_what_is_exported_again() {
    let code = [
        ("", "mod a;\nmod b;\npub use b::Thing;"),
        ("a", "use crate::Thing;"),
        ("b", "use super::{a::{self, Other}, c};"),
        ("c", ""),
    ];
    let module = |path: &str| Module::from_iter(path.split_terminator("::").map(str::to_owned));
    let mut modules = BTreeMap::from(code.map(|(path, text)| (module(path), text.to_owned())));
    assert_eq!(circle(&uses(&modules)), ["a uses b", "b uses a"]);
    modules.insert(module("b"), "// use super::a;\nuse super::c;".into());
    assert!(circle(&uses(&modules)).is_empty());
}

/// Returns the text of each module below a source folder, without comments and tests.
fn modules(src: &Path) -> BTreeMap<Module, String> {
    let (mut found, mut open) = (BTreeMap::new(), vec![src.to_owned()]);
    while let Some(folder) = open.pop() {
        let entries = fs::read_dir(&folder).expect("the folder is there");
        let paths = entries.map(|entry| entry.expect("it can be listed").path());
        for path in paths {
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|end| end == "rs") && !path.ends_with("tests.rs")
            {
                let text = fs::read_to_string(&path).expect("it can be read");
                let text = text.split("#[cfg(test)]\nmod tests {").next();
                found.insert(module_of(src, &path), text.unwrap_or_default().to_owned());
            }
        }
    }
    found
}

fn module_of(src: &Path, path: &Path) -> Module {
    let path: PathBuf = path
        .strip_prefix(src)
        .expect("it is below")
        .with_extension("");
    let parts = path.iter().map(|part| part.to_string_lossy().into_owned());
    let mut module = Module::from_iter(parts);
    if matches!(
        module.last().map(String::as_str),
        Some("mod" | "lib" | "main")
    ) {
        module.pop();
    }
    module
}

/// Returns the modules that each module uses.
fn uses(modules: &BTreeMap<Module, String>) -> BTreeMap<Module, BTreeSet<Module>> {
    let code = modules.iter().map(|(module, text)| (module, plain(text)));
    let code: BTreeMap<&Module, String> = code.collect();
    let imports: BTreeMap<&Module, Vec<Import>> =
        (code.iter().map(|(module, text)| (*module, imports(text)))).collect();
    let resolve = |module: &Module, path: &[String]| resolve(&imports, module, path, 0);
    let of = |module: &Module| {
        let imported = imports[module].iter().filter(|import| !import.exported);
        let imported = imported.map(|import| import.path.clone());
        let named = paths(&code[module]);
        let targets = imported
            .chain(named)
            .filter_map(|path| resolve(module, &path));
        targets.filter(|target| target != module).collect()
    };
    modules
        .keys()
        .map(|module| (module.clone(), of(module)))
        .collect()
}

/// Returns the text without comments.
fn plain(text: &str) -> String {
    let code = text
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default());
    code.collect::<Vec<_>>().join("\n")
}

/// Returns the imports of a text.
fn imports(text: &str) -> Vec<Import> {
    let mut found = Vec::new();
    for statement in text.split(';') {
        let Some((before, tree)) = statement.rsplit_once("use ") else {
            continue;
        };
        let exported = before
            .lines()
            .last()
            .is_some_and(|line| line.contains("pub"));
        let trees = expand("", tree.trim());
        found.extend(trees.into_iter().map(|(name, path)| Import {
            name,
            path,
            exported,
        }));
    }
    found
}

/// Returns the names in an imported tree, each with its path.
fn expand(prefix: &str, tree: &str) -> Vec<(String, Module)> {
    let Some((path, branches)) = tree.split_once('{') else {
        let path = format!("{prefix}{tree}");
        let (path, name) = path.split_once(" as ").unwrap_or((&path, ""));
        let path = path.strip_suffix("::self").unwrap_or(path);
        let path = Module::from_iter(path.split("::").map(|part| part.trim().to_owned()));
        let name = match (name.trim(), path.last()) {
            ("", Some(last)) => last.clone(),
            (name, _) => name.to_owned(),
        };
        return vec![(name, path)];
    };
    let prefix = format!("{prefix}{}", path.trim());
    let branches = branches.trim_end().strip_suffix('}').unwrap_or(branches);
    let (mut depth, mut start, mut found) = (0, 0, Vec::new());
    for (at, c) in branches.char_indices().chain([(branches.len(), ',')]) {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                let branch = branches[start..at].trim();
                if !branch.is_empty() {
                    found.extend(expand(&prefix, branch));
                }
                start = at + 1;
            }
            _ => {}
        }
    }
    found
}

/// Returns the paths in a text that start at the root of the crate or at an enclosing module.
fn paths(text: &str) -> Vec<Module> {
    let named = |c: char| c.is_alphanumeric() || "_:$".contains(c);
    let words = text
        .split(|c: char| !named(c))
        .map(|word| word.trim_end_matches(':'));
    let rooted = words.filter(|word| word.starts_with("crate::") || word.starts_with("super::"));
    // `pub(in crate::a)` is a visibility and uses nothing.
    let used = rooted.filter(|word| !text.contains(&format!("(in {word})")));
    used.map(|word| word.split("::").map(str::to_owned).collect())
        .collect()
}

/// Returns the module that defines the target of a path, if it is in the crate.
fn resolve(
    imports: &BTreeMap<&Module, Vec<Import>>,
    module: &Module,
    path: &[String],
    depth: usize,
) -> Option<Module> {
    let child = |module: &Module, name: &String| [module.as_slice(), from_ref(name)].concat();
    let (mut at, mut path) = (module.clone(), path);
    match path.first()?.as_str() {
        "crate" => (at, path) = (Module::new(), &path[1..]),
        "self" => path = &path[1..],
        "super" => {}
        _ if imports.contains_key(&child(&at, &path[0])) => {}
        _ => return None,
    }
    while path.first().is_some_and(|part| part == "super") {
        at.pop();
        path = &path[1..];
    }
    while let Some(name) = path
        .first()
        .filter(|name| imports.contains_key(&child(&at, name)))
    {
        at = child(&at, name);
        path = &path[1..];
    }
    let named = path.first().and_then(|first| {
        let mut all = imports.get(&at)?.iter();
        all.find(|import| import.name == *first)
    });
    match named {
        Some(import) if depth < MAX_EXPORTS => resolve(imports, &at, &import.path, depth + 1),
        _ => Some(at),
    }
}

/// Returns the uses between files that are part of a cycle, or connect two.
fn circle(uses: &BTreeMap<Module, BTreeSet<Module>>) -> Vec<String> {
    let mut left: BTreeSet<(String, String)> = BTreeSet::new();
    for (user, used) in uses {
        left.extend(used.iter().map(|used| (user.join("::"), used.join("::"))));
    }
    left.retain(|(user, used)| user != EXEMPT && used != EXEMPT);
    remove_ends(&mut left);
    let left = left.iter();
    left.map(|(user, used)| format!("{user} uses {used}"))
        .collect()
}

/// Removes uses of modules that use nothing, and by modules that nothing uses, until there are no more of them.
fn remove_ends(uses: &mut BTreeSet<(String, String)>) {
    loop {
        let users: BTreeSet<String> = uses.iter().map(|(user, _)| user.clone()).collect();
        let used: BTreeSet<String> = uses.iter().map(|(_, used)| used.clone()).collect();
        let before = uses.len();
        uses.retain(|(from, to)| users.contains(to) && used.contains(from));
        if uses.len() == before {
            break;
        }
    }
}

/// Returns the uses that run against the order of the folders, and of the files beside them: the order in which the
/// fewest uses do so, as far as moving one folder at a time finds it.
fn back_arrows(uses: &BTreeMap<Module, BTreeSet<Module>>) -> Vec<String> {
    let mut folders: BTreeMap<Module, Vec<[&Module; 2]>> = BTreeMap::new();
    for (user, used) in uses {
        for used in used {
            let pairs = user.iter().zip(used);
            let depth = pairs.take_while(|(user, used)| user == used).count();
            let inside = folders.entry(user[..depth].to_vec()).or_default();
            inside.push([user, used]);
        }
    }
    let mut found = Vec::new();
    for (folder, uses) in &folders {
        let name = |module: &Module| module.get(folder.len()).cloned().unwrap_or_default();
        let all = uses.iter().map(|[user, used]| (name(user), name(used)));
        let mut cyclic = BTreeSet::from_iter(all);
        remove_ends(&mut cyclic);
        let tied = (uses.iter()).filter(|[user, used]| cyclic.contains(&(name(user), name(used))));
        let arrows = Vec::from_iter(tied.map(|[user, used]| (name(user), name(used))));
        let order = order(&arrows);
        let place = |of: &String| order.iter().position(|name| name == of);
        let back = |[user, used]: &&[&Module; 2]| {
            let arrow = (name(user), name(used));
            cyclic.contains(&arrow) && place(&arrow.0) < place(&arrow.1)
        };
        let back = uses.iter().filter(back);
        found.extend(
            back.map(|[user, used]| format!("{} uses {}", user.join("::"), used.join("::"))),
        );
    }
    found
}

/// Returns the names in an order in which few arrows run from an earlier to a later one.
fn order(arrows: &[(String, String)]) -> Vec<String> {
    let names = BTreeSet::from_iter(arrows.iter().flat_map(|(from, to)| [from, to]));
    let names = Vec::from_iter(names);
    let index = |of: &String| names.binary_search(&of).expect("it is a name");
    let arrows = Vec::from_iter(arrows.iter().map(|(from, to)| (index(from), index(to))));
    let against = |order: &[usize]| {
        let mut places = vec![0; order.len()];
        (0..)
            .zip(order)
            .for_each(|(place, &name)| places[name] = place);
        let back = |(from, to): &&(usize, usize)| places[*from] < places[*to];
        arrows.iter().filter(back).count()
    };
    let mut best = Vec::from_iter(0..names.len());
    best.sort_by_key(|&name| arrows.iter().filter(|arrow| arrow.0 == name).count());
    let mut least = against(&best);
    loop {
        let before = least;
        for from in 0..best.len() {
            for to in 0..best.len() {
                let mut moved = best.clone();
                let name = moved.remove(from);
                moved.insert(to, name);
                let count = against(&moved);
                if count < least {
                    (best, least) = (moved, count);
                }
            }
        }
        if least == before {
            return best.into_iter().map(|name| names[name].clone()).collect();
        }
    }
}
