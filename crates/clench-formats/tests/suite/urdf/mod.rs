//! URDF: links, joints, meshes of packages, MuJoCo's extension, and invalid files.

mod floating;
mod joints;
mod links;
mod meshes;
mod mistakes;

use clench_formats::load_str;
use clench_rigid::{Model, Sim};

/// Returns a link of one kilogram with additional content.
fn link(name: &str, more: &str) -> String {
    format!(
        "<link name='{name}'><inertial><origin xyz='0 0 0.1'/><mass value='1'/>\
         <inertia ixx='0.1' iyy='0.1' izz='0.1' ixy='0' ixz='0' iyz='0'/></inertial>{more}</link>"
    )
}

/// Returns a joint between two links with additional content.
fn joint(name: &str, kind: &str, from: &str, to: &str, more: &str) -> String {
    format!(
        "<joint name='{name}' type='{kind}'><parent link='{from}'/><child link='{to}'/>{more}</joint>"
    )
}

fn step(sim: &mut Sim<f64>, count: usize) {
    (0..count).for_each(|_| sim.step().unwrap());
}

fn robot(parts: &[String]) -> String {
    format!("<robot name='r'>\n{}\n</robot>", parts.join("\n"))
}

#[track_caller]
fn loaded(parts: &[String]) -> Model {
    load_str(&robot(parts)).unwrap_or_else(|error| panic!("{error}"))
}

/// Loads a model of two links and one joint with the given content.
#[track_caller]
fn with_joint(kind: &str, more: &str) -> Model {
    loaded(&[
        link("a", ""),
        link("b", ""),
        joint("j", kind, "a", "b", more),
    ])
}

fn names<'a>(names: impl Iterator<Item = &'a String>) -> Vec<&'a str> {
    names.map(String::as_str).collect()
}
