//! glTF meshes: locations of bytes, nodes of the scene, kinds of faces, and invalid files.

use crate::assets::Folder;
use clench_formats::load;
use clench_rigid::Model;

/// Returns the corners of a tetrahedron with edges of 3 along the axes and an unused corner, in singles, then 12
/// indices of 16 bits.
fn numbers() -> Vec<u8> {
    let corners: [f32; 15] = [
        0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 3.0, 9.0, 9.0, 9.0,
    ];
    let indices: [u16; 12] = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3];
    let corners = corners.map(f32::to_le_bytes);
    let indices = indices.map(u16::to_le_bytes);
    [corners.as_flattened(), indices.as_flattened()].concat()
}

/// Returns the JSON text for these numbers, with the given buffers and node attributes.
fn text(buffers: &str, node: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
          "nodes": [{{"children": [1], "translation": [0, 0, 0]}}, {{"mesh": 0, {node} "name": "part"}}],
          "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "NORMAL": 7}}, "indices": 1}},
                                   {{"attributes": {{"POSITION": 0}}, "mode": 1}}]}}],
          "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3"}},
                        {{"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}}],
          "bufferViews": [{{"buffer": 0, "byteLength": 60}}, {{"buffer": 0, "byteOffset": 60, "byteLength": 24}}],
          "materials": [{{"name": "red"}}], "buffers": [{buffers}]}}"#
    )
}

/// Returns the text with the numbers embedded in base 64.
fn embedded(node: &str) -> String {
    let encoded = clench_formats::base64::encode(&numbers());
    let uri =
        format!(r#"{{"uri": "data:application/octet-stream;base64,{encoded}", "byteLength": 84}}"#);
    text(&uri, node)
}

/// Returns a binary file.
fn binary(text: &str, bytes: &[u8]) -> Vec<u8> {
    let padded = format!("{text:<width$}", width = text.len().next_multiple_of(4));
    let chunk = |kind: &[u8; 4], content: &[u8]| {
        [&(content.len() as u32).to_le_bytes()[..], kind, content].concat()
    };
    let chunks = [chunk(b"JSON", padded.as_bytes()), chunk(b"BIN\0", bytes)].concat();
    let length = (12 + chunks.len() as u32).to_le_bytes();
    [&b"glTF\x02\0\0\0"[..], &length, &chunks].concat()
}

/// Loads a model of a link on a hinge with this mesh, which may name the file `numbers of it.bin`.
fn robot(name: &str, extension: &str, mesh: impl AsRef<[u8]>) -> Result<Model, String> {
    let folder = Folder::new(&format!("gltf-{name}"));
    folder.write(&format!("part.{extension}"), mesh);
    folder.write("numbers of it.bin", numbers());
    folder.write(
        "model.urdf",
        format!(
            "<robot name='r'><link name='a'/>
           <link name='b'><collision><geometry><mesh filename='part.{extension}'/></geometry></collision></link>
           <joint name='j' type='revolute'><parent link='a'/><child link='b'/></joint></robot>"
        ),
    );
    load(folder.0.join("model.urdf")).map_err(|error| error.to_string())
}

#[track_caller]
fn assert_mass(model: &Model, expected: f64, centre: [f64; 3]) {
    let body = model.params.body_mass.len() - 1;
    let mass = model.params.body_mass[body];
    assert!((mass / expected - 1.0).abs() < 1e-6, "{mass}");
    for (found, expected) in (model.params.body_ipos[body].to_array().into_iter()).zip(centre) {
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    }
}

#[track_caller]
fn read(name: &str, extension: &str, mesh: impl AsRef<[u8]>) -> Model {
    robot(name, extension, mesh).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn bytes_may_be_in_the_text_in_the_file_or_in_another_file() {
    let beside = text(r#"{"uri": "numbers%20of%20it.bin", "byteLength": 84}"#, "");
    let inside = text(r#"{"byteLength": 84}"#, "");
    for model in [
        read("text", "gltf", embedded("")),
        read("beside", "gltf", beside),
        read("inside", "glb", binary(&inside, &numbers())),
    ] {
        assert_mass(&model, 4500.0, [0.75; 3]);
        // The unused vertex is not part of the mesh.
        assert_eq!(model.meshes[0].vertices.len(), 4);
    }
}

#[test]
fn nodes_are_scaled_turned_and_moved() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let parts = format!(
        r#""translation": [1, 0, 0], "rotation": [0, 0, {half}, {half}], "scale": [1, 2, -1],"#
    );
    let centre = [1.0 - 2.0 * 0.75, 0.75, -0.75];
    assert_mass(&read("parts", "gltf", embedded(&parts)), 9000.0, centre);
    let matrix = r#""matrix": [0, 1, 0, 0, -2, 0, 0, 0, 0, 0, -1, 0, 1, 0, 0, 1],"#;
    assert_mass(&read("matrix", "gltf", embedded(matrix)), 9000.0, centre);
}

#[test]
fn strips_and_fans_are_triangles() {
    // A tetrahedron is a strip of six corners.
    let bytes = [0_u8, 1, 2, 3, 0, 1];
    let strip = [&numbers()[..60], &bytes].concat();
    let said = text(r#"{"byteLength": 66}"#, "")
        .replace("\"indices\": 1}", "\"indices\": 1, \"mode\": 5}")
        .replace("5123, \"count\": 12", "5121, \"count\": 6")
        .replace("\"byteLength\": 24", "\"byteLength\": 6");
    let model = read("strip", "glb", binary(&said, &strip));
    assert_mass(&model, 4500.0, [0.75; 3]);
    assert_eq!(model.meshes[0].faces.len(), 4);
}

#[test]
fn an_error_has_its_location_and_reason() {
    let plain = embedded("");
    let inside = binary(&text(r#"{"byteLength": 84}"#, ""), &numbers());
    for (name, mesh, message) in [
        ("json", "{".to_owned(), "not a glTF file"),
        ("version", plain.replace("2.0", "1.0"), "version 1.0, not 2"),
        (
            "circle",
            plain.replace("\"mesh\": 0,", "\"children\": [0],"),
            "nested more than",
        ),
        (
            "node",
            plain.replace("[1], \"tr", "[9], \"tr"),
            "there is no node 9",
        ),
        (
            "mesh",
            plain.replace("\"mesh\": 0", "\"mesh\": 9"),
            "there is no mesh 9",
        ),
        ("skin", embedded("\"skin\": 0,"), "skeleton"),
        (
            "beyond",
            plain.replace("\"count\": 12", "\"count\": 13"),
            "extends beyond its buffer view",
        ),
        (
            "huge",
            plain.replace("\"count\": 12", "\"count\": 18446744073709551615"),
            "extends beyond",
        ),
        (
            "huge-without-indices",
            plain
                .replacen(", \"indices\": 1}", "}", 1)
                .replace("\"count\": 5", "\"count\": 18446744073709551615"),
            "extends beyond",
        ),
        (
            "view",
            plain.replace("\"byteLength\": 24", "\"byteLength\": 25"),
            "beyond its buffer",
        ),
        (
            "wild",
            plain.replace("\"count\": 5", "\"count\": 3"),
            "refers to vertex 3",
        ),
        ("kind", plain.replace("VEC3", "VEC2"), "not three numbers"),
        (
            "base",
            plain.replace("base64,", "base64,*"),
            "not in base64",
        ),
        ("lost", text(r#"{"uri": "lost.bin"}"#, ""), "cannot read"),
        ("none", text("{}", ""), "buffer 0: has no data"),
        (
            "lines",
            plain.replace("\"indices\": 1}", "\"mode\": 1}"),
            "no triangles",
        ),
        (
            "draco",
            plain.replace(
                "\"scene\": 0",
                "\"extensionsRequired\": [\"KHR_draco_mesh_compression\"], \"scene\": 0",
            ),
            "needs the extension KHR_draco_mesh_compression",
        ),
    ] {
        let error = robot(name, "gltf", mesh).unwrap_err();
        assert!(error.contains("model.urdf:2: mesh"), "{error}");
        assert!(error.contains("part.gltf\": "), "{error}");
        assert!(error.contains(message), "{error}");
    }
    for length in [5, 11, 17, 30, inside.len() - 1] {
        let error = robot("cut", "glb", &inside[..length]).unwrap_err();
        assert!(error.contains("is truncated"), "{length}: {error}");
    }
}
