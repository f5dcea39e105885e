//! Meshes and height fields: from files of every format and from the model itself, what MuJoCo makes of them, and files that are
//! broken.

use clench_collide::ShapeKind;
use clench_rigid::Model;
use std::f64::consts::{PI, TAU};
use std::fs;
use std::path::PathBuf;

/// A unit cube from (0, 0, 0) to (1, 1, 1).
const CORNERS: [[f32; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 1.0, 0.0],
    [0.0, 1.0, 1.0],
    [1.0, 0.0, 0.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 0.0],
    [1.0, 1.0, 1.0],
];
const TRIANGLES: [[u32; 3]; 12] = [
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

/// A folder that goes with its test.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let unique = format!("clench-meshes-{name}-{}", std::process::id());
        let path = std::env::temp_dir().join(unique);
        fs::create_dir_all(path.join("parts/deep")).unwrap();
        Folder(path)
    }
    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.0.join(name), bytes).unwrap();
    }
    fn load(&self, text: &str) -> Result<Model, String> {
        self.write("model.xml", text);
        clench_formats::load(self.0.join("model.xml")).map_err(|error| error.to_string())
    }
    /// A free body that is a mesh.
    fn load_mesh(&self, attributes: &str) -> Result<Model, String> {
        self.load(&of_mesh(attributes, ""))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn of_mesh(attributes: &str, geom: &str) -> String {
    let geom = if geom.is_empty() { "type='mesh'" } else { geom };
    format!(
        "<mujoco>
           <compiler meshdir='parts'/>
           <asset><mesh name='m' {attributes}/></asset>
           <worldbody><body><freejoint/><geom {geom} mesh='m'/></body></worldbody>
         </mujoco>"
    )
}

fn binary_stl() -> Vec<u8> {
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

fn text_stl() -> String {
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

fn obj() -> String {
    let mut text = "# a cube\nmtllib none.mtl\no cube\n".to_owned();
    for [x, y, z] in CORNERS {
        text += &format!("v {x} {y} {z}\n");
    }
    text + "vn 0 0 1\ns off\nusemtl red\nf 1//1 2//1 4//1 3//1\nf 5 7 8 6\nusemtl blue\nf 1 5 6 2\nf -6 -5 -1 -2\nf 1 3 7 5\nf 2 6 8 4\n"
}

fn msh() -> Vec<u8> {
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

fn written() -> String {
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
fn assert_cube(model: &Model) {
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

#[test]
fn every_format_reads_the_same_cube() {
    let folder = Folder::new("formats");
    folder.write("parts/cube.stl", binary_stl());
    folder.write("parts/text.STL", text_stl());
    folder.write("parts/deep/cube.obj", obj());
    folder.write("parts/cube.msh", msh());
    folder.write("parts/cube.bin", msh());
    for inertia in ["legacy", "exact", "convex"] {
        for source in [
            "file='cube.stl'",
            "file='text.STL'",
            r"file='deep\cube.obj'",
            "file='cube.msh'",
            "file='cube.bin' content_type='model/vnd.mujoco.msh'",
            &written(),
        ] {
            let model = folder.load_mesh(&format!("{source} inertia='{inertia}'"));
            assert_cube(&model.unwrap_or_else(|error| panic!("{source}: {error}")));
        }
    }
}

#[test]
fn names_and_places_of_files_follow_mujoco() {
    let folder = Folder::new("places");
    folder.write("parts/cube.stl", binary_stl());
    let geom = "<worldbody><body><freejoint/><geom type='mesh' mesh='cube'/></body></worldbody>";
    let accepted = [
        "<compiler meshdir='parts'/><asset><mesh file='cube.stl'/></asset>",
        "<compiler assetdir='parts'/><asset><mesh file='cube.stl'/></asset>",
        "<compiler assetdir='nowhere' meshdir='parts/'/><asset><mesh file='cube.stl'/></asset>",
        "<compiler meshdir='parts' strippath='true'/><asset><mesh file='far/away/cube.stl'/></asset>",
        "<asset><mesh file='parts/cube.stl'/></asset>",
    ];
    for assets in accepted {
        let model = folder.load(&format!("<mujoco>{assets}{geom}</mujoco>"));
        assert_cube(&model.unwrap_or_else(|error| panic!("{assets}: {error}")));
    }
    folder.write(
        "parts/deep/part.xml",
        "<mujoco><asset><mesh file='inner.stl' name='cube'/></asset></mujoco>",
    );
    folder.write("parts/deep/inner.stl", binary_stl());
    let include = "<include file='parts/deep/part.xml'/>";
    assert_cube(
        &folder
            .load(&format!("<mujoco>{include}{geom}</mujoco>"))
            .unwrap(),
    );
}

#[test]
fn scales_references_and_classes_apply() {
    let folder = Folder::new("scales");
    folder.write("parts/cube.stl", binary_stl());
    let text = "<mujoco>
        <default><mesh scale='0.1 0.2 -0.3'/><default class='wide'><mesh scale='2 1 1'/></default></default>
        <compiler meshdir='parts'/>
        <asset>
          <mesh file='cube.stl' refpos='1 0 0'/>
          <mesh name='turned' file='cube.stl' class='wide' refquat='1 0 0 1'/>
        </asset>
        <worldbody>
          <body><freejoint/><geom type='mesh' mesh='cube' density='1'/></body>
          <body><freejoint/><geom type='mesh' mesh='turned' density='1'/></body>
        </worldbody>
      </mujoco>";
    let model = folder.load(text).unwrap();
    let p = &model.params;
    let near = |a: [f64; 3], b: [f64; 3]| {
        assert!(
            a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12),
            "{a:?} {b:?}"
        );
    };
    near(p.geom_pos[0].to_array(), [-0.05, 0.1, -0.15]);
    assert!((p.body_mass[1] - 0.006).abs() < 1e-15);
    // Moments fall, so the longest edge comes first.
    near(p.geom_size[0].to_array(), [0.05, 0.1, 0.15]);
    // (x, y) becomes (y, -x), then x doubles.
    near(p.geom_pos[1].to_array(), [1.0, -0.5, 0.5]);
    assert!((p.body_mass[2] - 2.0).abs() < 1e-12);
}

#[test]
fn builtin_meshes_have_the_shapes_that_they_are_named_after() {
    let folder = Folder::new("builtin");
    // Vertices, faces and volume; of smooth shapes a fine mesh lacks little.
    let (disc, prism) = (PI * PI, 5.0 * (TAU / 5.0).sin());
    for (attributes, vertices, faces, volume) in [
        ("builtin='sphere' params='4'", 2562, 5120, 4.0 * PI / 3.0),
        ("builtin='hemisphere' params='10'", 266, 528, 2.0 * PI / 3.0),
        ("builtin='cone' params='5 1'", 10, 16, prism),
        ("builtin='cone' params='5 0'", 6, 8, prism / 3.0),
        (
            "builtin='supersphere' params='80 1 1'",
            6322,
            12640,
            4.0 * PI / 3.0,
        ),
        (
            "builtin='supertorus' params='80 0.5 1 1'",
            6400,
            12800,
            disc / 2.0,
        ),
    ] {
        let text = of_mesh(
            &format!("{attributes} inertia='exact'"),
            "type='mesh' density='1'",
        );
        let model = folder
            .load(&text)
            .unwrap_or_else(|error| panic!("{attributes}: {error}"));
        let mesh = &model.meshes[0];
        assert_eq!(
            (mesh.vertices.len(), mesh.faces.len()),
            (vertices, faces),
            "{attributes}"
        );
        let mass = model.params.body_mass[1];
        let straight = attributes.contains("cone");
        let lacks = if straight { 1e-6 } else { 0.02 };
        assert!(
            mass < volume * (1.0 + 1e-6) && mass > volume * (1.0 - lacks),
            "{attributes}: {mass}"
        );
    }
}

#[test]
fn primitives_fit_meshes() {
    let folder = Folder::new("fits");
    // Half sizes 0.05, 0.1, 0.15.
    let mesh = format!("{} scale='0.1 0.2 0.3'", written());
    let size = |geom: &str, fitaabb: bool| {
        let text = of_mesh(&mesh, geom).replace("meshdir='parts'", &format!("fitaabb='{fitaabb}'"));
        let model = folder.load(&text).unwrap();
        assert_eq!(model.geoms[0].mesh, None);
        let pos = model.params.geom_pos[0].to_array();
        assert!(
            pos.iter()
                .zip([0.05, 0.1, 0.15])
                .all(|(a, b)| (a - b).abs() < 1e-7)
        );
        model.params.geom_size[0].to_array()
    };
    let near = |a: [f64; 3], b: [f64; 3]| {
        assert!(
            a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-7),
            "{a:?} {b:?}"
        );
    };
    near(size("type='box'", false), [0.05, 0.1, 0.15]);
    near(size("type='box' fitscale='2'", false), [0.1, 0.2, 0.3]);
    near(size("type='ellipsoid'", true), [0.05, 0.1, 0.15]);
    near(size("type='sphere'", false), [0.1, 0.0, 0.0]);
    near(size("type='sphere'", true), [0.15, 0.0, 0.0]);
    near(size("type='cylinder'", false), [0.075, 0.15, 0.0]);
    near(size("type='cylinder'", true), [0.1, 0.15, 0.0]);
    near(size("type='capsule'", false), [0.075, 0.1125, 0.0]);
    near(size("type='capsule'", true), [0.1, 0.05, 0.0]);
}

#[test]
fn what_is_only_seen_weighs_but_may_be_discarded() {
    let folder = Folder::new("visual");
    let text = |compiler: &str| {
        format!(
            "<mujoco>
               <compiler {compiler}/>
               <asset><mesh name='m' {} inertia='exact'/><mesh name='unused' {}/></asset>
               <worldbody><body><freejoint/>
                 <geom name='seen' type='mesh' mesh='m' contype='0' conaffinity='0'/>
                 <geom name='felt' type='sphere' size='0.1' mass='1'/>
               </body></worldbody>
             </mujoco>",
            written(),
            written()
        )
    };
    let kept = folder.load(&text("")).unwrap();
    assert_eq!((kept.geoms.len(), kept.meshes.len()), (2, 2));
    assert!(
        kept.meshes[0].hull.is_none(),
        "what does not collide needs no hull"
    );
    let discarded = folder.load(&text("discardvisual='true'")).unwrap();
    assert_eq!((discarded.geoms.len(), discarded.meshes.len()), (1, 0));
    assert_eq!(discarded.geom("felt"), Some(0));
    assert_eq!(discarded.params.body_mass, kept.params.body_mass);
    assert_eq!(discarded.params.body_inertia, kept.params.body_inertia);
    let refused = folder.load(&text("discardvisual='true' inertiafromgeom='true'"));
    assert!(refused.unwrap_err().contains("discarded"));
    let by_group = folder.load(&text("inertiagrouprange='1 1'"));
    assert!(by_group.unwrap_err().contains("mass"));
}

#[test]
fn a_shell_spreads_its_mass_over_the_surface() {
    let folder = Folder::new("shell");
    let model = folder
        .load_mesh(&format!("{} inertia='shell'", written()))
        .unwrap();
    // Six faces of 1000 kg; a hollow cube has m a² 5/18.
    assert!((model.params.body_mass[1] - 6000.0).abs() < 1e-9);
    assert!((model.params.body_inertia[1].x - 6000.0 * 5.0 / 18.0).abs() < 1e-9);
}

#[test]
fn height_fields_come_from_numbers_and_files() {
    let folder = Folder::new("heights");
    let field = |attributes: &str| {
        let text = format!(
            "<mujoco>
               <compiler meshdir='parts'/>
               <asset><hfield {attributes} size='1 2 3 4'/></asset>
               <worldbody><geom type='hfield' hfield='h'/></worldbody>
             </mujoco>"
        );
        folder.load(&text)
    };
    let mut grid: Vec<u8> = [2i32, 3].iter().flat_map(|n| n.to_le_bytes()).collect();
    grid.extend(
        [4f32, 5.0, 6.0, 1.0, 2.0, 3.0]
            .iter()
            .flat_map(|x| x.to_le_bytes()),
    );
    folder.write("parts/h.bin", &grid);
    let mut image = Vec::new();
    let mut encoder = png::Encoder::new(&mut image, 3, 2);
    encoder.set_color(png::ColorType::Rgb);
    let pixels = [
        50, 0, 9, 100, 7, 7, 150, 1, 1, 200, 0, 0, 250, 0, 0, 255, 0, 0,
    ];
    encoder
        .write_header()
        .unwrap()
        .write_image_data(&pixels)
        .unwrap();
    folder.write("parts/h.PNG", &image);
    for (attributes, expected) in [
        (
            "name='h' nrow='2' ncol='3' elevation='1 2 3 4 5 6'",
            [0.6, 0.8, 1.0, 0.0, 0.2, 0.4],
        ),
        ("file='h.bin'", [0.6, 0.8, 1.0, 0.0, 0.2, 0.4]),
        ("name='h' nrow='2' ncol='3'", [0.0; 6]),
        (
            "file='h.PNG'",
            [150.0, 200.0, 205.0, 0.0, 50.0, 100.0].map(|x| x / 205.0),
        ),
    ] {
        let model = field(attributes).unwrap_or_else(|error| panic!("{attributes}: {error}"));
        let shape = &model.height_fields[0].shape;
        assert_eq!((shape.rows(), shape.columns()), (2, 3));
        let close = shape
            .heights()
            .iter()
            .zip(expected)
            .all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(close, "{attributes}: {:?}", shape.heights());
        assert_eq!(model.geoms[0].kind, ShapeKind::HeightField);
        assert_eq!(model.params.geom_size[0].to_array(), [1.0, 2.0, 2.75]);
        assert!((model.params.geom_rbound[0] - 21f64.sqrt()).abs() < 1e-12);
    }
    grid.pop();
    folder.write("parts/short.bin", &grid);
    folder.write("parts/cut.png", &image[..image.len() - 20]);
    let mut claims = Vec::new();
    drop(png::Encoder::new(&mut claims, 5000, 5000).write_header());
    let header = 33;
    claims.splice(header.., image[header..].iter().copied());
    folder.write("parts/claims.png", &claims);
    for (attributes, complaint) in [
        ("name='h' nrow='2' ncol='3' elevation='1 2 3'", "2 x 3"),
        ("name='h' nrow='1' ncol='3'", "at least two"),
        ("name='h' nrow='2000000000' ncol='2000000000'", "heights"),
        ("name='h' nrow='10000' ncol='10000'", "heights"),
        ("name='h'", "nrow"),
        ("file='h.bin' nrow='2' ncol='3'", "with a file"),
        ("file='nowhere.png'", "nowhere.png"),
        ("name='h' file='short.bin'", "short.bin"),
        ("name='h' file='cut.png'", "cut.png"),
        ("name='h' file='claims.png'", "claims.png\": a PNG image of"),
        ("nrow='2' ncol='2'", "name"),
    ] {
        let error = field(attributes).expect_err(attributes);
        assert!(
            error.contains("model.xml:3: hfield") || error.contains("height field"),
            "{error}"
        );
        assert!(error.contains(complaint), "{attributes}: {error}");
    }
}

#[test]
fn broken_files_are_refused_with_their_names() {
    let folder = Folder::new("broken");
    let stl = binary_stl();
    let with_f32 = |at: usize, number: f32| {
        let mut bytes = stl.clone();
        bytes[at..at + 4].copy_from_slice(&number.to_le_bytes());
        bytes
    };
    let mut many = stl.clone();
    many[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let mut mesh = msh();
    mesh[0..4].copy_from_slice(&i32::MAX.to_le_bytes());
    let mut negative = msh();
    negative[12..16].copy_from_slice(&(-1i32).to_le_bytes());
    let mut astray = msh();
    let last = astray.len() - 4;
    astray[last..].copy_from_slice(&99u32.to_le_bytes());
    let files: &[(&str, Vec<u8>, &str)] = &[
        ("empty.stl", Vec::new(), "empty"),
        ("short.stl", stl[..90].to_vec(), "bytes"),
        ("cut.stl", stl[..stl.len() - 1].to_vec(), "bytes"),
        ("many.stl", many, "bytes"),
        ("nan.stl", with_f32(96, f32::NAN), "not finite"),
        ("infinite.stl", with_f32(96, f32::INFINITY), "not finite"),
        (
            "words.stl",
            b"solid x\nfacet normal 0 0 0\nouter loop\nvertex 1 2 up\n".to_vec(),
            "STL",
        ),
        (
            "none.stl",
            b"solid x\nendsolid x\n".to_vec(),
            "no triangles",
        ),
        ("magic.stl", b"\x7fELF".repeat(40), "bytes"),
        ("words.obj", b"v 1 2 3\nv 1 2 x\n".to_vec(), "line 2"),
        ("short.obj", b"v 1 2\n".to_vec(), "line 1"),
        (
            "zero.obj",
            obj().replace("f 5 7", "f 0 7").into_bytes(),
            "line 16",
        ),
        (
            "back.obj",
            obj().replace("f -6", "f -60").into_bytes(),
            "line 19",
        ),
        (
            "far.obj",
            obj().replace("f 5 7", "f 5 700").into_bytes(),
            "line 16: there is no vertex 700",
        ),
        (
            "nan.obj",
            obj().replace("v 0 0 1", "v 0 nan 1").into_bytes(),
            "not finite",
        ),
        (
            "round.obj",
            format!("{}f{}\n", obj(), " 1".repeat(2000)).into_bytes(),
            "line 22: a face has more than 1000 corners",
        ),
        ("binary.obj", vec![0xff; 100], "not an OBJ"),
        (
            "three.obj",
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_vec(),
            "four vertices",
        ),
        ("many.msh", mesh, "2147483647 vertices"),
        ("negative.msh", negative, "-1 faces"),
        ("astray.msh", astray, "vertex 99"),
        ("short.msh", vec![1, 2, 3], "too short"),
    ];
    for (name, bytes, complaint) in files {
        folder.write(&format!("parts/{name}"), bytes);
        let error = folder.load_mesh(&format!("file='{name}'")).expect_err(name);
        assert!(
            error.contains("model.xml:3: mesh \"m\": "),
            "{name}: {error}"
        );
        assert!(error.contains(complaint), "{name}: {error}");
    }
}

/// Reproducible noise.
fn random() -> impl FnMut() -> u64 {
    let mut state = 0x9E37_79B9_7F4A_7C15u64;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    }
}

#[test]
fn random_bytes_never_panic() {
    let folder = Folder::new("noise");
    let mut random = random();
    let originals = [
        ("x.stl", binary_stl()),
        ("t.stl", text_stl().into_bytes()),
        ("x.obj", obj().into_bytes()),
        ("x.msh", msh()),
    ];
    for round in 0..400 {
        let (name, mut bytes) = originals[round % 4].clone();
        for _ in 0..1 + random() % 4 {
            let at = random() as usize % bytes.len();
            match random() % 3 {
                0 => bytes[at] = random() as u8,
                1 => bytes.truncate(at.max(1)),
                _ => bytes[at] ^= 1 << (random() % 8),
            }
        }
        folder.write(&format!("parts/{name}"), &bytes);
        let inertia = ["legacy", "exact", "convex", "shell"][random() as usize % 4];
        // Whatever comes of it, it comes back.
        let _ = folder.load_mesh(&format!("file='{name}' inertia='{inertia}'"));
    }
}

#[test]
fn numbers_of_any_size_never_panic() {
    const NUMBERS: [&str; 12] = [
        "0", "1", "-1", "0.3", "0.7", "1.5", "1e-8", "1e-160", "1e-320", "1e30", "1e150", "-1e308",
    ];
    let folder = Folder::new("sizes");
    let mut random = random();
    let mut built = 0;
    for _ in 0..800 {
        let mut pick = |count: usize| random() as usize % count;
        let mut numbers = |count: usize| {
            // Most are tame, so that some models come about.
            let number = |_| NUMBERS[if pick(8) > 0 { 3 + pick(3) } else { pick(12) }];
            (0..count).map(number).collect::<Vec<_>>().join(" ")
        };
        let vertices = format!("0 0 0 1 0 0 0 1 0 0 0 1 {}", numbers(6));
        let mesh = format!(
            "vertex='{vertices}' scale='{}' refpos='{}' refquat='{}'",
            numbers(3),
            numbers(3),
            numbers(4)
        );
        let size = format!("fitscale='{}' density='{}'", numbers(1), numbers(1));
        let field = format!("elevation='{}' size='{}'", numbers(6), numbers(4));
        let inertia = ["legacy", "exact", "convex", "shell"][pick(4)];
        let kind = ["mesh", "mesh", "box", "sphere", "capsule", "ellipsoid"][pick(6)];
        let terrain = ["", "<geom type='hfield' hfield='h'/>"][pick(2)];
        let model = folder.load(&format!(
            "<mujoco>
               <asset><mesh name='m' inertia='{inertia}' {mesh}/><hfield name='h' nrow='2' ncol='3' {field}/></asset>
               <worldbody>{terrain}<body><freejoint/><geom type='{kind}' mesh='m' {size}/></body></worldbody>
             </mujoco>"
        ));
        // What is built is finite; whatever else comes of it, it comes back.
        if let Ok(model) = model {
            let p = &model.params;
            let finite = [p.geom_rbound[0], p.body_mass[1], p.body_inertia[1].x];
            assert!(finite.iter().all(|x| x.is_finite()), "{mesh}: {finite:?}");
            built += 1;
        }
    }
    assert!(built > 40, "only {built} models");
}

#[test]
fn meshes_that_cannot_be_are_refused() {
    let folder = Folder::new("refused");
    let flat = "vertex='0 0 0 1 0 0 0 1 0 1 1 0'";
    for (attributes, complaint) in [
        ("", "four vertices"),
        ("vertex='0 0 0 1 0 0 0 1'", "three numbers a vertex"),
        (
            "vertex='0 0 0 1 0 0 0 1 0 0 0 1' face='0 1'",
            "three numbers a face",
        ),
        ("vertex='0 0 0 1 0 0 0 1 0 0 0 1' face='0 1 -2'", "negative"),
        ("vertex='0 0 0 1 0 0 0 1 0 0 0 1' face='0 1 4'", "vertex 4"),
        ("vertex='0 0 0 1 0 0 0 1 0 0 0 nan'", "finite"),
        (
            "vertex='0 0 0 1 0 0 0 1 0 0 0 1' refquat='0 0 0 0'",
            "refquat",
        ),
        (
            "vertex='0 0 0 1 0 0 0 1 0 0 0 1' scale='0 1 1'",
            "too small",
        ),
        (
            "vertex='0 0 0 1 0 0 0 1 0 0 0 1' maxhullvert='3'",
            "maxhullvert",
        ),
        (
            "vertex='0 0 0 1 0 0 0 1 0 0 0 1' builtin='sphere' params='1'",
            "vertex and builtin",
        ),
        (
            "file='m.stl' builtin='sphere' params='1'",
            "file and builtin",
        ),
        ("builtin='sphere'", "params"),
        ("builtin='sphere' params='5'", "needs 0 to 4"),
        ("builtin='sphere' params='-1'", "needs 0 to 4"),
        ("builtin='sphere' params='1 1'", "params"),
        ("builtin='hemisphere' params='11'", "needs 0 to 10"),
        ("builtin='cone' params='2 0.5'", "needs 3 to"),
        ("builtin='cone' params='5 2'", "params"),
        ("builtin='supersphere' params='1e300 1 1'", "needs 3 to"),
        ("builtin='supersphere' params='nan 1 1'", "finite"),
        ("builtin='supersphere' params='9 -1 1'", "params"),
        ("builtin='supertorus' params='9 0 1 1'", "params"),
        ("builtin='plate' params='4 5'", "not supported yet"),
        ("builtin='ball' params='4 5'", "there is no builtin ball"),
        (
            "vertex='0 0 0 1 0 0 0 1 0 0 0 1' face='0 1 2 0 1 3' inertia='exact'",
            "outside",
        ),
        (flat, "plane"),
        ("vertex='0 0 0 1 0 0 2 0 0 3 0 0'", "line"),
        ("vertex='1 2 3 1 2 3 1 2 3 1 2 3'", "coincide"),
        ("file='nowhere.stl'", "nowhere.stl"),
        ("file='nowhere.ply'", "nowhere.ply"),
        (
            "vertex='0 0 0 1 0 0 0 1 0 0 0 1' inertia='thick'",
            "inertia",
        ),
    ] {
        let error = folder.load_mesh(attributes).expect_err(attributes);
        assert!(
            error.contains("model.xml:3: mesh \"m\": "),
            "{attributes}: {error}"
        );
        assert!(error.contains(complaint), "{attributes}: {error}");
    }
    let good = "vertex='0 0 0 1 0 0 0 1 0 0 0 1'";
    for (geom, complaint) in [
        ("type='mesh' shellinertia='true'", "shellinertia"),
        ("type='box' fromto='0 0 0 0 0 1'", "fromto"),
        ("type='box' fitscale='0'", "positive"),
        ("type='hfield'", "height field"),
        ("type='sphere' hfield='m'", "height field"),
    ] {
        let error = folder.load(&of_mesh(good, geom)).expect_err(geom);
        assert!(error.contains("model.xml:4: "), "{geom}: {error}");
        assert!(error.contains(complaint), "{geom}: {error}");
    }
    let unknown = of_mesh(good, "").replace("mesh='m'/>", "mesh='n'/>");
    assert!(
        folder
            .load(&unknown)
            .unwrap_err()
            .contains("there is no mesh \"n\"")
    );
}
