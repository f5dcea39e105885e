//! The one-word quality of a run: unphysical runs are reported as such, and sound runs are good.

use crate::program::{code, errors, folder, model, simulate, summary};
use std::fs;
use std::path::Path;

/// Returns the quality of a run, and checks that standard error has a warning unless it is good.
fn quality(model: &Path, words: &str) -> String {
    let done = simulate(model, &format!("--json {words}"), &[]);
    let word = summary(&done)["quality"].as_str().unwrap().to_owned();
    let warned = errors(&done).contains("warning: ");
    assert_eq!(warned, word != "good", "{word}: {}", errors(&done));
    word
}

fn scene(folder: &Path, body: &str) -> std::path::PathBuf {
    let path = folder.join("scene.xml");
    fs::write(&path, format!("<mujoco>{body}</mujoco>")).unwrap();
    path
}

#[test]
fn sound_runs_are_good() {
    for entry in fs::read_dir(model("humanoid").parent().unwrap()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|end| end == "xml") {
            for words in [
                "--time 1",
                "--time 0.3 --envs 5 --noise 0.01 --precision 32",
            ] {
                assert_eq!(quality(&path, words), "good", "{} {words}", path.display());
            }
        }
    }
}

#[test]
fn too_long_steps_and_wild_starts_are_deep_penetration() {
    for words in [
        "--timestep 0.5 --time 20",
        "--noise 5",
        "--noise 5 --envs 4",
        "--timestep 0.5 --time 20 --envs 4",
    ] {
        let done = simulate(&model("humanoid"), &format!("--json {words}"), &[]);
        let figures = summary(&done);
        let warnings = figures["warnings"].to_string();
        assert!(figures["quality"] != "good", "{words}: {figures}");
        assert!(
            warnings.contains("deeper than half a geom"),
            "{words}: {warnings}"
        );
        assert!(
            warnings.contains("geom \\\"floor\\\"") || warnings.contains("geom "),
            "{warnings}"
        );
    }
}

#[test]
fn a_soft_bed_explains_how_deep_one_sinks() {
    let folder = folder();
    let bed = |solref: &str| {
        scene(
            folder.path(),
            &format!(
                r#"<worldbody><geom type="box" size="1 1 .5" pos="0 0 -.5" solref="{solref}" solimp=".9 .9 .1" priority="1"/>
                <body pos="0 0 .049"><freejoint/><geom size=".05"/></body></worldbody>"#
            ),
        )
    };
    // At rest (1 − d) g = d k r: with a time constant of 0.4 s it sinks by 14 cm.
    let done = simulate(&bed(".4 1"), "--time 5 --json", &[]);
    let figures = summary(&done);
    assert!(
        figures["penetration_max"].as_f64().unwrap() > 0.1,
        "{figures}"
    );
    assert_eq!(figures["quality"], "good", "{figures}");
}

#[test]
fn an_equality_that_starts_torn_is_a_violation() {
    let folder = folder();
    let path = scene(
        folder.path(),
        r#"<worldbody>
            <body name="a"><joint type="slide" axis="0 0 1"/><geom size=".1"/></body>
            <body name="b" pos="0 0 3"><joint type="slide" axis="0 0 1"/><geom size=".1"/></body>
        </worldbody>
        <equality><weld name="torn" body1="a" body2="b" relpose="0 0 1 1 0 0 0"/></equality>"#,
    );
    for words in ["--json", "--json --envs 3"] {
        let figures = summary(&simulate(&path, words, &[]));
        let warnings = figures["warnings"].to_string();
        assert!(warnings.contains("equality \\\"torn\\\" by "), "{figures}");
        assert_ne!(figures["quality"], "good");
    }
}

#[test]
fn unexplained_energy_is_energy_growth() {
    let folder = folder();
    // An explicit spring with a period too short for the time step.
    let stiff = scene(
        folder.path(),
        r#"<option timestep=".01" gravity="0 0 0"/>
        <worldbody><body><joint type="slide" stiffness="50000" springref=".001" damping="0"/><geom size=".1" mass="1"/></body>
        </worldbody>"#,
    );
    for words in ["--steps 15", "--steps 15 --envs 3"] {
        assert_eq!(quality(&stiff, words), "energy_growth", "{words}");
    }
    // An arm that a servo lifts gets its energy from the servo.
    let lifted = scene(
        folder.path(),
        r#"<worldbody><body pos="0 0 1"><joint name="hinge" axis="0 1 0" damping="1"/><geom type="capsule" size=".03" fromto="0 0 0 0 0 -1"/>
        </body></worldbody>
        <actuator><position joint="hinge" kp="200" kv="20" ctrlrange="3 3"/></actuator>"#,
    );
    for words in ["--time 3", "--time 3 --envs 3"] {
        assert_eq!(quality(&lifted, words), "good", "{words}");
    }
}

#[test]
fn a_failed_batch_reports_the_time() {
    let folder = folder();
    let path = scene(
        folder.path(),
        r#"<option timestep=".01" gravity="0 0 0"/>
        <worldbody><body><joint type="slide" stiffness="50000" springref=".001"/><geom size=".1" mass="1"/></body></worldbody>"#,
    );
    let alone = simulate(&path, "--time 50 --json", &[]);
    let batch = simulate(&path, "--time 50 --json --envs 3", &[]);
    assert_eq!((code(&alone), code(&batch)), (2, 2));
    let [alone, batch] = [alone, batch].map(|done| summary(&done));
    assert_eq!(batch["status"], "failed");
    let time = batch["simulated_time"].as_f64().unwrap();
    assert!(time < 10.0, "{batch}");
    assert_eq!(batch["steps"], alone["steps"]);
    assert!((time - alone["simulated_time"].as_f64().unwrap()).abs() < 1e-9);
    // The text output is the same.
    let text = simulate(&path, "--time 50 --envs 3", &[]);
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    assert!(
        text.contains(&format!("{time:.4} s in {} steps", batch["steps"])),
        "{text}"
    );
}

#[test]
fn the_report_has_the_same_lines_for_every_model() {
    let folder = folder();
    let names = |name: &str, words: &str, paths: &[(&str, &Path)]| {
        let done = simulate(&model(name), &format!("--steps 3 {words}"), paths);
        assert_eq!(code(&done), 0, "{}", errors(&done));
        let text = String::from_utf8(done.stdout).unwrap();
        let name = |line: &str| line.get(2..22).map(|name| name.trim_end().to_owned());
        let names = Vec::from_iter(text.lines().filter_map(name));
        assert!(names.len() >= 12, "{text}");
        names
    };
    // The pendulum conserves its energy except for damping; the humanoid's actuators add energy.
    let record = folder.path().join("run.npz");
    let recorded = names("pendulum", "", &[("--record", &record)]);
    assert_eq!(names("pendulum", "", &[]), recorded);
    assert_eq!(names("humanoid", "", &[]), recorded);
    assert_eq!(
        names("pendulum", "--envs 2", &[]),
        names("humanoid", "--envs 3 --precision 32", &[])
    );
}
