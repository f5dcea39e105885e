//! URDF: links, joints, meshes of packages, MuJoCo's extension, and what is wrong with a file.

mod floating;
mod joints;
mod links;
mod meshes;
mod mistakes;

use clench_formats::load_str;
use clench_rigid::{Model, Sim};

/// A link of one kilogram, with more in it.
fn link(name: &str, more: &str) -> String {
    format!(
        "<link name='{name}'><inertial><origin xyz='0 0 0.1'/><mass value='1'/>\
         <inertia ixx='0.1' iyy='0.1' izz='0.1' ixy='0' ixz='0' iyz='0'/></inertial>{more}</link>"
    )
}

/// A joint from link to link, with more in it.
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

/// One joint between two links, with this in it.
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
