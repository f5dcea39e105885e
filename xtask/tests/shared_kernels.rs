//! All packages are built with the same `clench-dynamics`, which takes most of the build time. With different features
//! of any dependency it would be compiled once for each.

use std::collections::BTreeSet;
use std::process::Command;

#[test]
fn kernel_crates_have_equal_features_in_all_packages() {
    let program = below("clench-dynamics ", "clench-cli");
    assert!(program.len() > 10, "{program:?}");
    for package in ["clench-python", "clench-gpu", "clench-formats"] {
        assert_eq!(program, below("clench-dynamics ", package), "{package}");
    }
}

/// Checks the same for `wgpu` and the readers, which take a minute: the Python package is built separately, and the
/// tests with all packages at once.
#[test]
fn rendering_crates_have_equal_features_in_the_package_and_in_tests() {
    let package = below("clench-render ", "clench-python");
    assert!(
        package.iter().any(|part| part.starts_with("wgpu ")),
        "{package:?}"
    );
    let mut tests = tree(&["--prefix", "none", "--edges", "normal,build,dev"]);
    tests.args(["--format", "{p} {f}", "--workspace"]);
    let features = "clench-cli/gpu,clench-cli/render,clench-python/gpu,clench-python/render";
    tests.args(["--features", features]);
    let tests = output(tests);
    let tests: BTreeSet<&str> = (tests.lines())
        .map(|line| line.trim_end_matches(" (*)").trim_end())
        .collect();
    let others = package.iter().filter(|part| !tests.contains(&***part));
    let others = Vec::from_iter(others);
    assert!(
        others.is_empty(),
        "python/Cargo.toml does not ask for the features that tests have: {others:#?}"
    );
}

/// Returns the dependencies of the package `top` in the build of `package`, each with its features.
fn below(top: &str, package: &str) -> BTreeSet<String> {
    let mut tree = tree(&[
        "--no-dedupe",
        "--edges",
        "normal,build",
        "--prefix",
        "depth",
    ]);
    tree.args(["--format", " {p} {f}", "--package", package]);
    if package == "clench-python" {
        // With the features of its tests.
        tree.args(["--features", "gpu,render"]);
    }
    let mut inside = None;
    let mut found = BTreeSet::new();
    for line in output(tree).lines() {
        let Some((depth, text)) = line.split_once(' ') else {
            continue;
        };
        let depth: usize = depth.parse().expect("a depth");
        match inside {
            Some(top) if depth > top => _ = found.insert(text.trim_end().to_owned()),
            _ => inside = text.starts_with(top).then_some(depth),
        }
    }
    found
}

fn tree(arguments: &[&str]) -> Command {
    let mut tree = Command::new(env!("CARGO"));
    tree.arg("tree").args(arguments);
    tree
}

fn output(mut command: Command) -> String {
    let output = command.output().expect("cargo runs");
    assert!(output.status.success(), "{output:?}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}
