//! Fuzz targets: each is a function that reads arbitrary bytes with one of our readers, and returns true if they were
//! accepted.
//!
//! None may panic, hang or exhaust the memory, and accepted input must be usable. `cargo xtask fuzz` searches for
//! failing inputs, guided by coverage; the tests of this crate replay `seeds` and `regressions`.

mod checksums;
mod contacts;
mod dictionary;
mod files;
mod mjcf;
mod npy;
mod shapes;
mod states;
mod trial;

pub use contacts::contacts;
pub use dictionary::dictionary;
pub use mjcf::{mjcf, urdf};
pub use npy::npy;
pub use shapes::{dae, gltf, grid, msh, obj, png, stl};
pub use states::states;

/// The name of a target, which is also that of its folders, and its function.
pub type Target = (&'static str, fn(&[u8]) -> bool);

/// All targets.
pub const TARGETS: [Target; 12] = [
    ("mjcf", mjcf),
    ("urdf", urdf),
    ("stl", stl),
    ("obj", obj),
    ("msh", msh),
    ("dae", dae),
    ("gltf", gltf),
    ("png", png),
    ("grid", grid),
    ("npy", npy),
    ("states", states),
    ("contacts", contacts),
];
