//! Models of others, in folders that environment variables name.

use super::{agree, drift_alike};
use clench_gpu::{GpuBatch, GpuError, GpuOptions};
use clench_rigid::model::Model;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Models that are not compared in single precision: light fingers on heavy arms, which what rounding leaves of large forces accelerates
/// (`double.rs` compares them).
const NOT_COMPARED: [&str; 2] = ["manipulator", "stacker"];

/// Every model of a folder that an environment variable names agrees with the processor on so many states of each, so far from its
/// initial one, but for those whose names are `refused`, which are. Without the variable there is nothing to test.
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

/// A model of others, in a folder.
pub fn public(folder: &Path, name: &str) -> Arc<Model> {
    let path = folder.join(format!("{name}.xml"));
    Arc::new(clench_formats::load(path).expect("a public model loads"))
}

/// Every model of a list in a folder that an environment variable names drifts as on the processor, in 200 steps from 8 states each. Without the
/// variable there is nothing to test.
pub fn drift_on_folder(variable: &str, models: &[(&str, usize, f64)]) {
    let Some(folder) = std::env::var_os(variable).map(PathBuf::from) else {
        eprintln!("skipped: {variable} names no folder");
        return;
    };
    hold_for_all(models, |&(name, ..)| {
        drift_alike(&public(&folder, name), 8, 200)
    });
}

/// Fails with the names of all models for which something does not hold: a device that was never tried tells more at a time.
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
