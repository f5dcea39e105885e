//! Model files, with other files beside them that they can name.

use crate::{files, trial};
use std::cell::Cell;

/// The files beside a model, by name.
const BESIDE: [(&str, &[u8]); 6] = [
    ("cube.stl", include_bytes!("../seeds/stl/cube.stl")),
    ("cube.obj", include_bytes!("../seeds/obj/cube.obj")),
    ("cube.msh", include_bytes!("../seeds/msh/cube.msh")),
    ("hills.png", include_bytes!("../seeds/png/hills.png")),
    ("hills.bin", include_bytes!("../seeds/grid/hills.bin")),
    ("part.xml", include_bytes!("../seeds/mjcf/part.xml")),
];
/// An error is read by people: long values in it are cut. Paths, which users choose, come on top.
const MAX_ERROR_LENGTH: usize = 4000;

/// Reads a model, and tries it where it is one.
pub fn mjcf(data: &[u8]) -> bool {
    model("model.xml", data)
}

/// Reads a robot in URDF likewise.
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
