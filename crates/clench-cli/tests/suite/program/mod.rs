//! Runs the program as a user does.

#![allow(dead_code, missing_docs)] // Each test file uses some of it.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use tempfile::TempDir;

/// Returns a folder that is removed at the end of the test.
pub fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder can be made")
}

/// Returns the path of a model of the repository.
pub fn model(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    root.join("models").join(format!("{name}.xml"))
}

/// Writes a model with one control into a folder.
pub fn driven(folder: &Path) -> PathBuf {
    let path = folder.join("driven.xml");
    let text = r#"<mujoco><worldbody><body><joint name="j"/><geom size=".1" pos=".2 0 0"/></body></worldbody>
        <actuator><motor joint="j"/></actuator></mujoco>"#;
    std::fs::write(&path, text).expect("the model can be written");
    path
}

/// Returns the program with these arguments, separated by spaces.
pub fn command(words: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_clench"));
    command.args(words.split_whitespace());
    command
}

/// Runs `clench simulate MODEL` with these arguments, then paths with their flags.
pub fn simulate(model: &Path, words: &str, files: &[(&str, &Path)]) -> Output {
    simulation(model, words, files)
        .output()
        .expect("the program can be run")
}

/// Returns the command without running it.
pub fn simulation(model: &Path, words: &str, files: &[(&str, &Path)]) -> Command {
    let mut command = command("simulate");
    command.arg(model).args(words.split_whitespace());
    for (flag, path) in files {
        command.arg(flag).arg(path);
    }
    command
}

/// Starts a command whose output is captured.
pub fn start(mut command: Command) -> Child {
    let command = command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().expect("the program can be run")
}

pub fn code(output: &Output) -> i32 {
    output
        .status
        .code()
        .unwrap_or_else(|| panic!("it was killed: {}", errors(output)))
}

pub fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Returns the summary of a run with `--json`.
pub fn summary(output: &Output) -> serde_json::Value {
    let text = String::from_utf8_lossy(&output.stdout);
    let last = text
        .lines()
        .last()
        .unwrap_or_else(|| panic!("no summary: {}", errors(output)));
    serde_json::from_str(last).expect("the summary is JSON")
}

/// Asserts that the run was refused, with a message that contains all these words.
pub fn refused(output: &Output, words: &[&str]) {
    let message = errors(output);
    assert_eq!(code(output), 2, "{message}");
    assert!(!message.contains("panicked"), "{message}");
    for word in words {
        assert!(message.contains(word), "{word:?} is not in: {message}");
    }
}

/// Returns the shape and the numbers of an array of a recording.
pub fn array(record: &Path, name: &str) -> (Vec<u64>, Vec<f64>) {
    let file = File::open(record).expect("the record is there");
    let mut archive = zip::ZipArchive::new(file).expect("the record is a whole archive");
    let mut entry = archive
        .by_name(&format!("{name}.npy"))
        .expect("it has the array");
    let mut bytes = Vec::new();
    entry.read_to_end(&mut bytes).expect("the array is whole");
    let array = npyz::NpyFile::new(&bytes[..]).expect("the array is NumPy's");
    (
        array.shape().to_vec(),
        array.into_vec().expect("it holds numbers of 64 bits"),
    )
}

/// Writes an `.npy` file with any header, which may claim a wrong length.
pub fn npy(path: &Path, version: u8, header: &str, claimed: Option<u32>, numbers: &[f64]) {
    let mut bytes = b"\x93NUMPY".to_vec();
    bytes.extend([version, 0]);
    let length = claimed.unwrap_or(header.len() as u32);
    if version == 1 {
        bytes.extend((length as u16).to_le_bytes());
    } else {
        bytes.extend(length.to_le_bytes());
    }
    bytes.extend(header.as_bytes());
    bytes.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
    std::fs::write(path, bytes).expect("the file can be written");
}

/// Returns the header of an array of 64-bit numbers.
pub fn header(rows: u64, columns: u64) -> String {
    format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({rows}, {columns}), }}\n")
}
