//! Wrong arguments: the message names the argument and its error.

use crate::program::{code, command, driven, errors, folder, model, refused, simulate};

fn printed(words: &str) -> String {
    let output = command(words).output().expect("the program can be run");
    assert_eq!(code(&output), 0, "{}", errors(&output));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn negative_numbers_are_values_of_the_option_before_them() {
    let model = model("pendulum");
    for (words, flag) in [
        ("--time -1", "--time"),
        ("--steps -3", "--steps"),
        ("--noise -0.1", "--noise"),
        ("--timestep -0.001", "--timestep"),
        ("--budget -1", "--budget"),
    ] {
        refused(&simulate(&model, words, &[]), &[flag, "-"]);
    }
}

#[test]
fn an_option_out_of_range_is_named_by_its_flag() {
    let model = model("pendulum");
    for (words, words_of_error) in [
        (
            "--ls-tolerance -1",
            ["'--ls-tolerance <X>'", "not negative"],
        ),
        ("--impratio 0", ["'--impratio <X>'", "positive"]),
        ("--budget 0", ["'--budget <FACTOR>'", "positive"]),
    ] {
        refused(&simulate(&model, words, &[]), &words_of_error);
    }
}

#[test]
fn a_folder_is_no_broken_array() {
    let folder = folder();
    let output = simulate(&driven(folder.path()), "", &[("--ctrl", folder.path())]);
    refused(&output, &["--ctrl"]);
    assert!(!errors(&output).contains("header"), "{}", errors(&output));
}

#[test]
fn flags_say_what_they_do() {
    assert!(printed("--help").starts_with("Simulate articulated rigid bodies"));
    let help = printed("simulate --help");
    for flag in [
        "Disable joint limits",
        "Disable all constraints",
        "Make friction stick",
    ] {
        assert!(help.contains(flag), "{flag}");
    }
    for line in help.lines().map(str::trim_end) {
        assert!(
            !line.ends_with(": true") && !line.ends_with(": false"),
            "{line}"
        );
    }
}

#[test]
fn the_model_is_the_first_argument_of_a_conversion() {
    let help = printed("convert --help");
    let place = |text: &str| {
        help.find(text)
            .unwrap_or_else(|| panic!("{text} is not in: {help}"))
    };
    assert!(place("  <MODEL>") < place("  <OUTPUT>"), "{help}");
    assert_eq!(help.matches("Arguments:").count(), 1, "{help}");
}

#[test]
fn a_conversion_to_urdf_is_refused() {
    let folder = folder();
    let path = folder.path().join("pendulum.urdf");
    let mut command = command("convert");
    let output = command.args([&model("pendulum"), &path]).output();
    let output = output.expect("the program can be run");
    refused(&output, &["pendulum.urdf", "MJCF, not URDF"]);
    assert!(!path.exists());
}

#[test]
fn elements_of_mjcf_are_found_by_their_own_name() {
    assert!(printed("mjcf touch").starts_with("sensor/touch\n"));
    assert!(printed("mjcf sensor/touch").starts_with("sensor/touch\n"));
    let output = command("mjcf jiont")
        .output()
        .expect("the program can be run");
    refused(&output, &["jiont", "clench mjcf"]);
}

#[test]
fn the_error_of_a_truncated_file_is_at_its_end() {
    let folder = folder();
    let path = folder.path().join("cut.xml");
    for text in [
        "<mujoco>\n<worldbody>\n<geom si",
        "<mujoco>\n<worldbody>\n<geom size='1'/>\n",
    ] {
        std::fs::write(&path, text).expect("the file can be written");
        refused(&simulate(&path, "", &[]), &["cut.xml:3: not well-formed"]);
    }
}
