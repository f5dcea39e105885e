//! Meshes: from files of every format and from the model itself, processed as by MuJoCo.

use crate::assets::*;
use std::f64::consts::{PI, TAU};

#[test]
fn every_format_reads_the_same_cube() {
    let folder = Folder::new("formats");
    folder.write("parts/cube.stl", binary_stl());
    folder.write("parts/text.STL", text_stl());
    folder.write("parts/two.stl", text_stl_of_two());
    folder.write("parts/deep/cube.obj", obj());
    folder.write("parts/cube.msh", msh());
    folder.write("parts/cube.bin", msh());
    for inertia in ["legacy", "exact", "convex"] {
        for source in [
            "file='cube.stl'",
            "file='text.STL'",
            "file='two.stl'",
            r"file='deep\cube.obj'",
            "file='cube.msh'",
            "file='cube.bin' content_type='model/vnd.mujoco.msh'",
            "file='cube.msh' content_type=''",
            "file='cube.stl' content_type='application/octet-stream'",
            &written(),
        ] {
            let model = folder.load_mesh(&format!("{source} inertia='{inertia}'"));
            assert_cube(&model.unwrap_or_else(|error| panic!("{source}: {error}")));
        }
    }
}

#[test]
fn a_note_reports_the_faces_of_further_objects() {
    let folder = Folder::new("objects");
    let further = "g rest\nf 1 2 3\nf 1 2 4\n";
    folder.write("parts/cube.obj", [obj(), further.into()].concat());
    let model = folder.load_mesh("file='cube.obj'").unwrap();
    assert_cube(&model);
    let [note] = &model.notes[..] else {
        panic!("{:?}", model.notes);
    };
    assert!(
        note.contains("model.xml:") && note.contains("2 faces"),
        "{note}"
    );
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
    // Moments descend, so the longest edge comes first.
    near(p.geom_size[0].to_array(), [0.05, 0.1, 0.15]);
    // (x, y) becomes (y, -x), then x doubles.
    near(p.geom_pos[1].to_array(), [1.0, -0.5, 0.5]);
    assert!((p.body_mass[2] - 2.0).abs() < 1e-12);
}

#[test]
fn builtin_meshes_have_the_shapes_that_they_are_named_after() {
    let folder = Folder::new("builtin");
    // Vertices, faces and volume. A fine mesh of a smooth shape has nearly the volume of the shape.
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
        ("builtin='grid' params='3 2 2 1 2 3'", 12, 12, 12.0),
        ("builtin='box' params='3 4 5 .1 .1 .1 3'", 55, 12, 0.024),
        ("builtin='cylinder' params='21 21 2 .1 .1 2'", 883, 316, TAU),
        (
            "builtin='ellipsoid' params='21 21 21 .1 .1 .2'",
            2403,
            4800,
            8.0 * PI / 3.0,
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
        let straight = ["cone", "grid", "box"]
            .iter()
            .any(|kind| attributes.contains(kind));
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
fn visual_geoms_have_mass_but_may_be_discarded() {
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
fn referenced_geoms_are_not_visual() {
    let model = clench_formats::load_str(
        "<mujoco><compiler discardvisual='true'/>
           <default><geom size='.1' contype='0' conaffinity='0'/></default>
           <worldbody><geom name='a'/><geom name='b'/><geom name='c'/><geom name='d'/><geom name='e'/><geom name='seen'/>
             <body><freejoint/><geom name='f' contype='1'/></body></worldbody>
           <contact><pair geom1='a' geom2='f'/></contact>
           <sensor><framepos objtype='geom' objname='b'/><distance geom1='c' body2='world'/><contact geom1='d'/></sensor>
           <custom><tuple name='t'><element objtype='geom' objname='e'/></tuple></custom></mujoco>",
    )
    .unwrap();
    let names: Vec<&str> = model.geoms.iter().map(|geom| geom.name.as_str()).collect();
    assert_eq!(names, ["a", "b", "c", "d", "e", "f"]);
}

#[test]
fn a_shell_spreads_its_mass_over_the_surface() {
    let folder = Folder::new("shell");
    let model = folder
        .load_mesh(&format!("{} inertia='shell'", written()))
        .unwrap();
    // Six faces of 1000 kg; the inertia of a hollow cube is m a² 5/18.
    assert!((model.params.body_mass[1] - 6000.0).abs() < 1e-9);
    assert!((model.params.body_inertia[1].x - 6000.0 * 5.0 / 18.0).abs() < 1e-9);
}
