//! Shared helpers of the tests of meshes and height fields: a cube in every format, and a folder for files.

use clench_rigid::Model;
use std::fs;
use std::path::PathBuf;

/// The corners of a unit cube from (0, 0, 0) to (1, 1, 1).
pub const CORNERS: [[f32; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 1.0, 0.0],
    [0.0, 1.0, 1.0],
    [1.0, 0.0, 0.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 0.0],
    [1.0, 1.0, 1.0],
];
pub const TRIANGLES: [[u32; 3]; 12] = [
    [0, 1, 3],
    [0, 3, 2],
    [4, 6, 7],
    [4, 7, 5],
    [0, 4, 5],
    [0, 5, 1],
    [2, 3, 7],
    [2, 7, 6],
    [0, 2, 6],
    [0, 6, 4],
    [1, 5, 7],
    [1, 7, 3],
];

/// A folder that is removed at the end of its test.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        let unique = format!("clench-meshes-{name}-{}", std::process::id());
        let path = std::env::temp_dir().join(unique);
        fs::create_dir_all(path.join("parts/deep")).unwrap();
        Folder(path)
    }
    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.0.join(name), bytes).unwrap();
    }
    pub fn load(&self, text: &str) -> Result<Model, String> {
        self.write("model.xml", text);
        clench_formats::load(self.0.join("model.xml")).map_err(|error| error.to_string())
    }
    /// Loads a free body with a mesh geom.
    pub fn load_mesh(&self, attributes: &str) -> Result<Model, String> {
        self.load(&of_mesh(attributes, ""))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

pub fn of_mesh(attributes: &str, geom: &str) -> String {
    let geom = if geom.is_empty() { "type='mesh'" } else { geom };
    format!(
        "<mujoco>
           <compiler meshdir='parts'/>
           <asset><mesh name='m' {attributes}/></asset>
           <worldbody><body><freejoint/><geom {geom} mesh='m'/></body></worldbody>
         </mujoco>"
    )
}

pub fn binary_stl() -> Vec<u8> {
    let mut bytes = b"solid, says this binary file".to_vec();
    bytes.resize(80, 0);
    bytes.extend(12u32.to_le_bytes());
    for triangle in TRIANGLES {
        bytes.extend([0; 12]);
        for corner in triangle {
            bytes.extend(
                CORNERS[corner as usize]
                    .iter()
                    .flat_map(|x| x.to_le_bytes()),
            );
        }
        bytes.extend([0; 2]);
    }
    bytes
}

pub fn text_stl() -> String {
    let mut text = "solid cube\n".to_owned();
    for triangle in TRIANGLES {
        text += "facet normal 0 0 0\nouter loop\n";
        for corner in triangle {
            let [x, y, z] = CORNERS[corner as usize];
            text += &format!("vertex {x} {y} {z}\n");
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid cube\n"
}

/// Returns the same cube as two solids of six triangles, in capitals and without names.
pub fn text_stl_of_two() -> String {
    const LINES_OF_A_TRIANGLE: usize = 7;
    let text = text_stl().to_uppercase().replace(" CUBE", "");
    let mut lines: Vec<&str> = text.lines().collect();
    lines.splice(
        1 + 6 * LINES_OF_A_TRIANGLE..1 + 6 * LINES_OF_A_TRIANGLE,
        ["ENDSOLID", "", "SOLID"],
    );
    lines.join("\r\n")
}

pub fn obj() -> String {
    let mut text = "# a cube\nmtllib none.mtl\no cube\n".to_owned();
    for [x, y, z] in CORNERS {
        text += &format!("v {x} {y} {z}\n");
    }
    text + "vn 0 0 1\ns off\nusemtl red\nf 1//1 2//1 4//1 3//1\nf 5 7 8 6\nusemtl blue\nf 1 5 6 2\nf -6 -5 -1 -2\nf 1 3 7 5\nf 2 6 8 4\n"
}

pub fn msh() -> Vec<u8> {
    let counts = [8u32, 8, 0, 12];
    let mut bytes: Vec<u8> = counts.iter().flat_map(|n| n.to_le_bytes()).collect();
    bytes.extend(CORNERS.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend([0; 8 * 12]);
    bytes.extend(
        TRIANGLES
            .as_flattened()
            .iter()
            .flat_map(|c| c.to_le_bytes()),
    );
    bytes
}

pub fn written() -> String {
    let words = |numbers: Vec<String>| numbers.join(" ");
    let vertices = words(CORNERS.as_flattened().iter().map(f32::to_string).collect());
    let faces = words(
        TRIANGLES
            .as_flattened()
            .iter()
            .map(u32::to_string)
            .collect(),
    );
    format!("vertex='{vertices}' face='{faces}'")
}

#[track_caller]
pub fn assert_cube(model: &Model) {
    let p = &model.params;
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a}, not {b}");
    near(p.body_mass[1], 1000.0);
    for axis in 0..3 {
        near(p.body_inertia[1][axis], 1000.0 / 6.0);
        near(p.geom_pos[0][axis], 0.5);
        near(p.geom_size[0][axis], 0.5);
    }
    near(p.geom_rbound[0], 0.75f64.sqrt());
    let mesh = &model.meshes[0];
    assert_eq!((mesh.vertices.len(), mesh.faces.len()), (8, 12));
    let hull = mesh.hull.as_ref().expect("it collides");
    assert_eq!((hull.vertices().len(), hull.face_count()), (8, 6));
}
