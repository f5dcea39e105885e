//! Meshes and the paths at which they are found.

use super::{joint, link, names, robot};
use crate::assets::Folder;
use clench_formats::{Loader, load};

/// Returns a tetrahedron with this side.
fn tetrahedron(side: f64) -> String {
    format!(
        "v 0 0 0\nv {side} 0 0\nv 0 {side} 0\nv 0 0 {side}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    )
}

fn with_meshes(files: &[&str]) -> String {
    let shape = |file: &&str| format!("<collision><geometry><mesh {file}/></geometry></collision>");
    let shapes: String = files.iter().map(shape).collect();
    robot(&[
        link("a", ""),
        link("b", &shapes),
        joint("j", "revolute", "a", "b", ""),
    ])
}

#[test]
fn meshes_of_packages_are_found_around_the_model_and_on_the_path() {
    let folder = Folder::new("urdf-packages");
    let deep = |name: &str, bytes: &str| {
        let path = folder.0.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    };
    deep("share/arm/meshes/part.obj", &tetrahedron(1.0));
    deep("elsewhere/hand/part.obj", &tetrahedron(2.0));
    let model = "share/arm/urdf/arm.urdf";
    let path = folder.0.join(model);
    let text = |file: &str| with_meshes(&[&format!("filename='{file}'")]);

    deep(model, &text("package://arm/meshes/part.obj"));
    assert_eq!(load(&path).unwrap().meshes[0].name, "part");
    deep(model, &text("../meshes/part.obj"));
    load(&path).unwrap();
    deep(
        model,
        &text(&format!(
            "file://{}/share/arm/meshes/part.obj",
            folder.0.display()
        )),
    );
    load(&path).unwrap();

    deep(model, &text("package://hand/part.obj"));
    let error = load(&path).unwrap_err().to_string();
    assert!(error.contains("the package \"hand\""), "{error}");
    for place in ["elsewhere", "elsewhere/hand"] {
        let loader = Loader::new().package_path([folder.0.join(place)]);
        loader.load(&path).unwrap();
    }
    let stripped = text("package://hand/part.obj").replace(
        "<link name='a'>",
        "<mujoco><compiler strippath='true' meshdir='../meshes'/></mujoco><link name='a'>",
    );
    deep(model, &stripped);
    load(&path).unwrap();
}

#[test]
fn escapes_of_uris_are_decoded() {
    let folder = Folder::new("urdf-escapes");
    folder.write("parts/a part.obj", tetrahedron(1.0));
    let here = folder.0.display();
    let path = folder.0.join("model.urdf");
    for file in [
        "package://parts/a%20part.obj".to_owned(),
        format!("file://{here}/parts/a%20part.obj"),
    ] {
        folder.write("model.urdf", with_meshes(&[&format!("filename='{file}'")]));
        assert_eq!(load(&path).unwrap().meshes[0].name, "a part", "{file}");
    }
    // Neither a URI nor escapes.
    folder.write("parts/a%20%zz%.obj", tetrahedron(1.0));
    for file in ["parts/a%20%zz%.obj", "package://parts/a%2520%zz%.obj"] {
        folder.write("model.urdf", with_meshes(&[&format!("filename='{file}'")]));
        assert_eq!(load(&path).unwrap().meshes[0].name, "a%20%zz%", "{file}");
    }
}

#[test]
fn every_object_and_group_counts() {
    let folder = Folder::new("urdf-objects");
    let [first, second] = [1.0, 2.0].map(tetrahedron);
    folder.write("part.obj", format!("o a\n{first}g b\n{second}"));
    folder.write("model.urdf", with_meshes(&["filename='part.obj'"]));
    let model = load(folder.0.join("model.urdf")).unwrap();
    assert_eq!(model.meshes[0].faces.len(), 8);
    assert!(model.notes.is_empty());
}

#[test]
fn a_mesh_is_read_once_for_each_scale() {
    let folder = Folder::new("urdf-scales");
    folder.write("part.obj", tetrahedron(1.0));
    folder.write("parts/part.obj", tetrahedron(2.0));
    folder.write(
        "model.urdf",
        with_meshes(&[
            "filename='part.obj'",
            "filename='part.obj' scale='2 2 2'",
            "filename='part.obj' scale='2 2 2'",
            "filename='parts/part.obj'",
        ]),
    );
    let model = load(folder.0.join("model.urdf")).unwrap();
    assert_eq!(
        names(model.meshes.iter().map(|m| &m.name)),
        ["part", "part1", "part2"]
    );
    let meshes: Vec<_> = model.geoms.iter().map(|geom| geom.mesh).collect();
    assert_eq!(meshes, [Some(0), Some(1), Some(1), Some(2)]);
}
