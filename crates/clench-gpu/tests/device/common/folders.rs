//! Third-party models, in folders named by environment variables.

use super::{agree, drift_alike};
use clench_gpu::{GpuBatch, GpuError, GpuOptions};
use clench_rigid::model::Model;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Models that are not compared in single precision: light fingers on heavy arms, accelerated by the rounding errors of
/// large forces (`double.rs` compares them).
const NOT_COMPARED: [&str; 2] = ["manipulator", "stacker"];

/// Asserts that the models (name, states, spread) in the folder named by an environment variable agree with the
/// processor, except for those in `refused`, which must be refused. Does nothing without the variable.
pub fn agree_on_folder(variable: &str, models: &[(&str, usize, f64)], refused: &[&str]) {
    let Some(folder) = std::env::var_os(variable).map(PathBuf::from) else {
        eprintln!("skipped: {variable} names no folder");
        return;
    };
    let load = |name: &str| public(&folder, name);
    hold_for_all(models, |&(name, count, spread)| {
        agree(&load(name), count, spread);
    });
    for name in refused {
        let error = GpuBatch::<f32>::new(load(name), 1, GpuOptions::default())
            .expect_err("what can be done is no longer listed as refused");
        assert!(matches!(error, GpuError::Unsupported(_)), "{name}: {error}");
        println!("{name}: {error}");
    }
    let listed = |name: &str| {
        let known = refused.contains(&name) || NOT_COMPARED.contains(&name);
        known || models.iter().any(|m| m.0 == name)
    };
    for file in folder.read_dir().expect("a folder").flatten() {
        let path = file.path();
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let is_model = path.extension().is_some_and(|e| e == "xml");
        assert!(!is_model || listed(&name), "{name} is not listed");
    }
}

/// Loads a third-party model from a folder.
pub fn public(folder: &Path, name: &str) -> Arc<Model> {
    let path = folder.join(format!("{name}.xml"));
    Arc::new(clench_formats::load(path).expect("a public model loads"))
}

/// Asserts that the models in the folder named by an environment variable drift as on the processor, in `steps` steps
/// from 8 states each. Does nothing without the variable.
pub fn drift_on_folder(variable: &str, models: &[(&str, usize, f64)], steps: usize) {
    let Some(folder) = std::env::var_os(variable).map(PathBuf::from) else {
        eprintln!("skipped: {variable} names no folder");
        return;
    };
    hold_for_all(models, |&(name, ..)| {
        drift_alike(&public(&folder, name), 8, steps)
    });
}

/// Checks all models, then fails with the names of those that failed: one run on a new device reports all.
fn hold_for_all(models: &[(&str, usize, f64)], holds: impl Fn(&(&str, usize, f64))) {
    let mut failed = Vec::new();
    for model in models {
        println!("{}", model.0);
        if catch_unwind(AssertUnwindSafe(|| holds(model))).is_err() {
            failed.push(model.0);
        }
    }
    assert!(failed.is_empty(), "failed, as said above: {failed:?}");
}
