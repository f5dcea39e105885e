//! Model files, with other files that they can refer to.

use crate::{files, trial};
use std::cell::Cell;

/// The files next to a model, by name.
const BESIDE: [(&str, &[u8]); 6] = [
    ("cube.stl", include_bytes!("../seeds/stl/cube.stl")),
    ("cube.obj", include_bytes!("../seeds/obj/cube.obj")),
    ("cube.msh", include_bytes!("../seeds/msh/cube.msh")),
    ("hills.png", include_bytes!("../seeds/png/hills.png")),
    ("hills.bin", include_bytes!("../seeds/grid/hills.bin")),
    ("part.xml", include_bytes!("../seeds/mjcf/part.xml")),
];
/// The maximum length of an error, excluding paths. People read errors, so long values in them are truncated.
const MAX_ERROR_LENGTH: usize = 4000;

/// Reads a model, and tries it if it is valid.
pub fn mjcf(data: &[u8]) -> bool {
    model("model.xml", data)
}

/// Reads a URDF robot in the same way.
pub fn urdf(data: &[u8]) -> bool {
    model("model.urdf", data)
}

fn model(file: &str, data: &[u8]) -> bool {
    thread_local! {
        static PREPARED: Cell<bool> = const { Cell::new(false) };
    }
    if !PREPARED.replace(true) {
        for (name, bytes) in BESIDE {
            files::write(name, bytes);
        }
    }
    let path = files::write(file, data);
    match clench::load_within(&path, trial::budget()) {
        Ok(model) => {
            trial::run(model);
            true
        }
        Err(error) => {
            let message = error.to_string();
            assert!(message.len() < MAX_ERROR_LENGTH, "a long error: {message}");
            let named = message.contains(file) || message.contains("part.xml");
            assert!(named, "an error that names no file: {message}");
            false
        }
    }
}
