//! The table of options.

use clench_rigid::options::{Argument, RigidOption, RigidOptions};

#[test]
fn sentences_contain_the_defaults() {
    for &option in RigidOption::ALL {
        let told = option
            .sentence()
            .split_once("; default ")
            .map_or("", |(_, told)| told);
        let default = option.default(false).to_string();
        assert!(told.starts_with(&default), "{}: {told}", option.name());
        let single = option.default(true).to_string();
        assert!(
            told.contains(&single),
            "{} in single precision",
            option.name()
        );
    }
}

#[test]
fn options_keep_their_values_and_refuse_other_types() {
    for &option in RigidOption::ALL {
        let mut options = RigidOptions::new();
        let value = option.default(false);
        options
            .set(option, value)
            .expect("a default is in its range");
        assert_eq!(options.get(option), Some(value));
        for &other in RigidOption::ALL {
            let alike = value.description() == other.default(false).description();
            assert_eq!(
                options.set(other, value).is_ok(),
                alike,
                "{other:?}: {value}"
            );
        }
    }
}

#[test]
fn names_of_flags_and_attributes_are_different() {
    let mut names: Vec<&str> = Vec::new();
    for &option in RigidOption::ALL {
        let (Argument::Value(flag) | Argument::Sets(flag, ..)) = option.argument();
        names.push(flag);
    }
    let all = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), all);
}
