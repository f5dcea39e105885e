//! Collada meshes: units, nodes of the scene, kinds of faces, and invalid files.

use crate::assets::Folder;
use clench_formats::load;
use clench_rigid::Model;

/// The corners of a tetrahedron with edges of 3 along the axes, each with a normal, which the reader of shapes ignores.
const TRIANGLES: &str = "<triangles count='4'><input semantic='VERTEX' source='#points' offset='0'/>\
     <input semantic='NORMAL' source='#normals' offset='1'/>\
     <p>0 0 2 0 1 0 0 0 1 0 3 0 0 0 3 0 2 0 1 0 2 0 3 0</p></triangles>";

/// Returns a file with these faces of the tetrahedron in a node of the scene.
fn file(asset: &str, faces: &str, node: &str) -> String {
    format!(
        "<?xml version='1.0'?>
         <COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'>
           <asset>{asset}</asset>
           <library_geometries><geometry id='shape'><mesh>
             <source id='numbers'>
               <float_array id='array' count='15'>0 0 0  3 0 0  0 3 0  0 0 3  9 9 9</float_array>
               <technique_common><accessor source='#array' count='5' stride='3'/></technique_common>
             </source>
             <vertices id='points'><input semantic='POSITION' source='#numbers'/></vertices>
             {faces}
           </mesh></geometry></library_geometries>
           <library_visual_scenes><visual_scene id='scene'>
             <node>{node}<instance_geometry url='#shape'/></node>
           </visual_scene></library_visual_scenes>
           <scene><instance_visual_scene url='#scene'/></scene>
         </COLLADA>"
    )
}

/// Loads a model of a link on a hinge with this mesh.
fn robot(name: &str, mesh: &str) -> Result<Model, String> {
    let folder = Folder::new(&format!("collada-{name}"));
    folder.write("part.dae", mesh);
    folder.write(
        "model.urdf",
        "<robot name='r'><link name='a'/>
           <link name='b'><collision><geometry><mesh filename='part.dae'/></geometry></collision></link>
           <joint name='j' type='revolute'><parent link='a'/><child link='b'/></joint></robot>",
    );
    load(folder.0.join("model.urdf")).map_err(|error| error.to_string())
}

#[track_caller]
fn read(name: &str, mesh: &str) -> Model {
    robot(name, mesh).unwrap_or_else(|error| panic!("{error}"))
}

/// Returns the mass and centre of mass of the link, whose density is 1000 kg/m³.
fn mass(model: &Model) -> (f64, [f64; 3]) {
    let body = model.params.body_mass.len() - 1;
    let params = &model.params;
    (params.body_mass[body], params.body_ipos[body].to_array())
}

#[track_caller]
fn assert_mass(model: &Model, expected: f64, centre: [f64; 3]) {
    let (mass, found) = mass(model);
    assert!((mass / expected - 1.0).abs() < 1e-6, "{mass}");
    for (found, expected) in found.into_iter().zip(centre) {
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    }
}

#[test]
fn the_unit_scales_a_mesh_and_the_axis_that_points_up_does_not_turn_it() {
    let asset = "<unit meter='0.1' name='decimeter'/><up_axis>Y_UP</up_axis>";
    let node = "<translate>0 0 2</translate>";
    let model = read("unit", &file(asset, TRIANGLES, node));
    assert_mass(
        &model,
        1000.0 * 0.3_f64.powi(3) / 6.0,
        [0.075, 0.075, 0.275],
    );
    // The unused vertex is not part of the mesh.
    assert_eq!(model.meshes[0].vertices.len(), 4);
}

#[test]
fn transforms_of_a_node_apply_from_last_to_first() {
    let parts = "<translate>1 0 0</translate><rotate>0 0 1 90</rotate><scale>1 2 -1</scale>";
    let model = read("parts", &file("", TRIANGLES, parts));
    let centre = [1.0 - 2.0 * 0.75, 0.75, -0.75];
    assert_mass(&model, 2.0 * 4500.0, centre);
    let matrix = "<matrix>0 -2 0 1  1 0 0 0  0 0 -1 0  0 0 0 1</matrix>";
    let model = read("matrix", &file("", TRIANGLES, matrix));
    assert_mass(&model, 2.0 * 4500.0, centre);
}

#[test]
fn polygons_are_cut_into_triangles() {
    let input = "<input semantic='VERTEX' source='#points' offset='0'/>";
    let list = format!(
        "<polylist count='4'>{input}<vcount>3 3 3 3</vcount><p>0 2 1 0 1 3 0 3 2 1 2 3</p></polylist>"
    );
    assert_mass(&read("list", &file("", &list, "")), 4500.0, [0.75; 3]);
    let polygons = format!(
        "<polygons count='4'>{input}<p>0 2 1</p><p>0 1 3</p><p>0 3 2</p><p>1 2 3</p></polygons>"
    );
    assert_mass(
        &read("polygons", &file("", &polygons, "")),
        4500.0,
        [0.75; 3],
    );
}

#[test]
fn an_error_has_its_location_and_reason() {
    let short = TRIANGLES.replace("1 0 2 0 3 0</p>", "1 0 2 0</p>");
    let wild = TRIANGLES.replace("2 0 3 0</p>", "2 0 7 0</p>");
    let strange = TRIANGLES.replace("1 0 2 0 3 0</p>", "1 0 x 0 3 0</p>");
    let skew = "<skew>1 0 0 0 1 0 0</skew>";
    let itself = "<instance_node url='#scene'/>";
    for (name, mesh, message) in [
        (
            "short",
            file("", &short, ""),
            "its faces have 9 corners, but 11 are listed",
        ),
        (
            "wild",
            file("", &wild, ""),
            "line 10: <triangles>: a face refers to vertex 7",
        ),
        (
            "strange",
            file("", &strange, ""),
            "line 10: <p>: \"x\" is not a valid number",
        ),
        (
            "skew",
            file("", TRIANGLES, skew),
            "<skew>: is not supported",
        ),
        ("itself", file("", TRIANGLES, itself), "nested too deeply"),
        (
            "unit",
            file("<unit meter='-1'/>", TRIANGLES, ""),
            "<unit>: meter must be a positive number",
        ),
        ("empty", file("", "", ""), "no triangles"),
        ("other", "<svg/>".to_owned(), "not a Collada file"),
        ("text", "solid".to_owned(), "not well-formed XML"),
    ] {
        let error = robot(name, &mesh).unwrap_err();
        assert!(error.contains("model.urdf:2: mesh"), "{error}");
        assert!(error.contains("part.dae\": "), "{error}");
        assert!(error.contains(message), "{error}");
    }
}
