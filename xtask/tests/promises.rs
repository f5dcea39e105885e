//! The tests that `docs/testing.md` names exist.

use std::fs;
use std::path::Path;

#[test]
fn every_promise_names_a_test_that_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let text = fs::read_to_string(root.join("docs/testing.md")).expect("the page");
    let (_, promises) = text.split_once("## Promises").expect("the section");
    let (promises, _) = promises.split_once("\n## ").expect("another section");
    let rows = promises
        .lines()
        .filter(|line| line.starts_with('|'))
        .skip(2);
    let mut checked = 0;
    for row in rows {
        let held_by = row.split('|').nth(2).expect("a second column");
        for place in held_by.split(';') {
            // Every second piece is between backticks.
            let mut words = place.split('`').skip(1).step_by(2);
            let file = words.next().unwrap_or_else(|| panic!("no file: {row}"));
            let code = fs::read_to_string(root.join(file))
                .unwrap_or_else(|error| panic!("{file}: {error}"));
            for name in words {
                let there = [format!("fn {name}("), format!("def {name}(")];
                assert!(there.iter().any(|f| code.contains(f)), "{file}: {name}");
                checked += 1;
            }
        }
    }
    assert!(checked > 20, "only {checked} tests are named");
}
