//! Broken mesh files, meaningless bytes and numbers of any size: an error with a location, and never a panic.

use crate::assets::*;

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
        (
            "nan.stl",
            with_f32(96, f32::NAN),
            "triangle 0: a coordinate is not finite",
        ),
        (
            "infinite.stl",
            with_f32(146, f32::INFINITY),
            "triangle 1: a coordinate is not finite",
        ),
        (
            "words.stl",
            b"solid x\nfacet normal 0 0 0\nouter loop\nvertex 1 2 up\n".to_vec(),
            "not a valid STL file: line 4: \"up\" is not a finite number",
        ),
        (
            "two.stl",
            b"solid\nfacet\nouter loop\nvertex 1 2\n".to_vec(),
            "line 4: a vertex has three coordinates",
        ),
        (
            "four.stl",
            b"solid\nfacet\nouter loop\nvertex 1 2 3 4\n".to_vec(),
            "line 4: a vertex has three coordinates",
        ),
        (
            "far.stl",
            text_stl()
                .replacen("vertex 0 0 1", "vertex 0 1e99 1", 1)
                .into_bytes(),
            "line 5: \"1e99\" is not a finite number",
        ),
        (
            "square.stl",
            text_stl()
                .replacen("endloop", "vertex 0 0 0\nendloop", 1)
                .into_bytes(),
            "line 7: \"vertex\" where endloop should be",
        ),
        (
            "open.stl",
            text_stl()
                .replacen("endsolid cube\n", "\n\n", 1)
                .into_bytes(),
            "line 87: the file ends where facet or endsolid should follow",
        ),
        (
            "second.stl",
            (text_stl() + "solid lid\nfacets\n").into_bytes(),
            "line 88: \"facets\" where facet should be",
        ),
        (
            "after.stl",
            (text_stl() + "and more\n").into_bytes(),
            "line 87: \"and\" where solid should be",
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

/// Returns a noise generator.
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
        // Any result is fine if the call returns.
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
            // Most numbers are moderate, so that some models can be built.
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
        // A model that can be built is finite; any other result is fine if the call returns.
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
fn invalid_meshes_are_refused() {
    let folder = Folder::new("refused");
    let flat = "vertex='0 0 0 1 0 0 0 1 0 1 1 0'";
    for (attributes, complaint) in [
        ("", "four vertices"),
        ("vertex='0 0 0 1 0 0 0 1'", "three numbers per vertex"),
        (
            "vertex='0 0 0 1 0 0 0 1 0 0 0 1' face='0 1'",
            "three numbers per face",
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
        ("builtin='wedge' params='4 5 90 45'", "params"),
        ("builtin='wedge' params='4 5 90 91 0'", "params"),
        (
            "builtin='wedge' params='0 5 90 45 0'",
            "the first of params",
        ),
        (
            "builtin='wedge' params='4 0 90 45 0'",
            "the second of params",
        ),
        ("builtin='plate' params='4 5'", "plane"),
        ("builtin='plate' params='4 1e300'", "needs 1 to"),
        ("builtin='box' params='2 2 1 1 1 1'", "needs 2 to"),
        ("builtin='grid' params='2 2 1001 1 1 1'", "needs 2 to"),
        ("builtin='grid' params='2 2 2 1 1'", "params"),
        ("builtin='cylinder' params='2 2 2 1 1 1 2'", "for flexes"),
        ("builtin='disc' params='3 3 1 1 1 1'", "for flexes"),
        ("builtin='ball' params='4 5'", "there is no builtin ball"),
        (
            "vertex='0 0 0 1 0 0 0 1 0 0 0 1' face='0 1 2 0 1 3' inertia='exact'",
            "not oriented consistently",
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
