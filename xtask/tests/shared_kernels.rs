//! All packages are built of the same `clench-rigid`, which takes most of the time of a build: with other features of anything below it,
//! it would be compiled once for each.

use std::collections::BTreeSet;
use std::process::Command;

#[test]
fn what_the_kernels_are_built_of_has_the_same_features_in_all_packages() {
    let program = below_the_kernels("clench-cli");
    assert!(program.len() > 20, "{program:?}");
    for package in ["clench-python", "clench-gpu", "clench-formats"] {
        assert_eq!(program, below_the_kernels(package), "{package}");
    }
}

/// The packages that `clench-rigid` is built of in the build of `package`, each with its features.
fn below_the_kernels(package: &str) -> BTreeSet<String> {
    let tree = Command::new(env!("CARGO"))
        .args(["tree", "--no-dedupe", "--edges", "normal,build"])
        .args(["--prefix", "depth", "--format", " {p} {f}"])
        .args(["--package", package])
        .output()
        .expect("cargo runs");
    assert!(tree.status.success(), "{tree:?}");
    let mut inside = None;
    let mut found = BTreeSet::new();
    for line in String::from_utf8_lossy(&tree.stdout).lines() {
        let Some((depth, text)) = line.split_once(' ') else {
            continue;
        };
        let depth: usize = depth.parse().expect("a depth");
        match inside {
            Some(top) if depth > top => _ = found.insert(text.to_owned()),
            _ => inside = text.starts_with("clench-rigid ").then_some(depth),
        }
    }
    found
}
