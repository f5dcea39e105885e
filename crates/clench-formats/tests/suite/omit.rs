//! Unsupported elements that the loader omits on request, those that it does not omit, and files in memory.

use clench_formats::{LoadError, Loader};
use clench_rigid::builder::ModelBuilder;

fn read(text: &str) -> Result<ModelBuilder, LoadError> {
    Loader::new().ignore_unsupported(true).read_str(text)
}

#[test]
fn plugins_and_deformable_bodies_are_omitted_and_listed() {
    let text = "<mujoco>
  <extension><plugin plugin='p'/></extension>
  <worldbody>
    <flexcomp name='cloth' type='grid' count='2 2 1' spacing='1 1 1'/>
    <body name='b'><freejoint/><geom size='0.1'/></body>
  </worldbody>
</mujoco>";
    assert!(Loader::new().read_str(text).is_err());
    let model = read(text).unwrap();
    assert_eq!(model.bodies.len(), 2);
    assert_eq!(model.omitted.len(), 2, "{:?}", model.omitted);
    assert!(
        model.omitted[0].starts_with("line 2: plugin"),
        "{:?}",
        model.omitted
    );
    assert!(
        model.omitted[1].starts_with("line 4: flexcomp \"cloth\""),
        "{:?}",
        model.omitted
    );
}

#[test]
fn signed_distance_fields_are_omitted_with_their_meshes() {
    let model = read(
        "<mujoco>
           <asset><mesh name='m'><plugin plugin='bowl'/></mesh></asset>
           <worldbody><geom type='sdf' mesh='m'/><geom name='kept' size='1'/></worldbody>
         </mujoco>",
    )
    .unwrap();
    assert_eq!(model.bodies[0].geoms.len(), 1);
    assert_eq!(model.omitted.len(), 2);
}

#[test]
fn nothing_is_omitted_from_a_supported_model() {
    let model = read("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>").unwrap();
    assert!(model.omitted.is_empty());
}

#[test]
fn unknown_keywords_remain_errors() {
    assert!(read("<mujoco><worldbody><goem size='1'/></worldbody></mujoco>").is_err());
    assert!(read("<mujoco><worldbody><geom syze='1'/></worldbody></mujoco>").is_err());
}

#[test]
fn files_in_memory_precede_those_on_disk_regardless_of_folder_and_case() {
    let tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4";
    let loader = Loader::new().assets([
        ("Meshes/T.OBJ", tetrahedron),
        (
            "part.xml",
            "<mujoco><worldbody><body name='b'/></worldbody></mujoco>",
        ),
        ("more.xml", "<mujoco><option timestep='0.5'/></mujoco>"),
    ]);
    let model = loader
        .read_str(
            "<mujoco>
               <compiler meshdir='elsewhere'/>
               <include file='x/more.xml'/>
               <asset><mesh file='t.obj'/><model name='part' file='part.xml'/></asset>
               <worldbody><geom type='mesh' mesh='t'/><attach model='part' prefix='p'/></worldbody>
             </mujoco>",
        )
        .unwrap();
    assert_eq!(model.meshes[0].vertices.len(), 4);
    assert_eq!(model.bodies[1].name, "pb");
    assert_eq!(model.physics.timestep, 0.5);
}

#[test]
fn a_users_own_data_is_kept() {
    let model = Loader::new()
        .load_str(
            "<mujoco>
               <custom>
                 <numeric name='n' size='3' data='1 2'/>
                 <text name='t' data='words'/>
                 <tuple name='u'><element objtype='body' objname='b' prm='2'/></tuple>
               </custom>
               <worldbody><body name='b'/></worldbody>
             </mujoco>",
        )
        .unwrap();
    assert_eq!(model.numeric("n"), Some(&[1.0, 2.0, 0.0][..]));
    assert_eq!(model.text("t"), Some("words"));
    let entry = &model.tuple("u").unwrap()[0];
    assert_eq!((entry.name.as_str(), entry.value), ("b", 2.0));
    assert!(model.numeric("m").is_none());
}
