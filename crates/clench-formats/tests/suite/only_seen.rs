//! Visual elements: those that are stored for viewers, and those that are omitted.

use clench_formats::load_str;

#[test]
fn visual_geoms_of_the_world_are_omitted() {
    let text = "<mujoco><compiler inertiafromgeom='true' discardvisual='true'/><worldbody>
        <geom size='1' contype='0' conaffinity='0'/><geom size='1'/>
        </worldbody></mujoco>";
    assert_eq!(load_str(text).expect("valid").geoms.len(), 1);
}

#[test]
fn visual_geoms_outside_the_inertia_groups_are_omitted() {
    let load = |group: &str| {
        load_str(&format!(
            "<mujoco><compiler inertiafromgeom='true' inertiagrouprange='0 2' discardvisual='true'/>
             <worldbody><body><joint/><geom size='1' mass='3'/>
               <geom size='1' mass='5' contype='0' conaffinity='0' group='{group}'/></body>
             </worldbody></mujoco>"
        ))
    };
    let model = load("3").expect("valid");
    assert_eq!((model.geoms.len(), model.params.body_mass[1]), (1, 3.0));
    assert!(load("2").unwrap_err().message.contains("discarded"));
}

#[test]
fn massless_visual_geoms_are_omitted_unless_a_medium_drags_them() {
    for (geom, left) in [
        ("mass='0'", 1),
        ("density='0'", 1),
        ("fluidshape='ellipsoid'", 2),
    ] {
        let text = format!(
            "<mujoco><compiler inertiafromgeom='true' discardvisual='true'/>
             <worldbody><body><joint/><geom size='1' mass='3'/>
               <geom size='1' contype='0' conaffinity='0' {geom}/></body></worldbody></mujoco>"
        );
        assert_eq!(load_str(&text).expect("valid").geoms.len(), left, "{geom}");
    }
}

#[test]
fn visual_geoms_are_accepted() {
    let model = load_str(
        "<mujoco model='seen'>
           <compiler meshdir='meshes' texturedir='textures' strippath='true' discardvisual='false'/>
           <size nuser_geom='1' njmax='500' nconmax='100'/>
           <visual><map fogstart='3'/><headlight ambient='.5 .5 .5'/></visual>
           <statistic extent='2' center='0 0 1'/>
           <asset>
             <texture name='grid' type='2d' builtin='checker' width='100' height='100'/>
             <material name='grid' texture='grid' reflectance='.5'><!-- shiny --></material>
           </asset>
           <custom><numeric name='init' data='1 2'/><text name='author' data='me'/></custom>
           <worldbody>
             <camera name='eye' pos='0 0 3'/>
             <light diffuse='.5 .5 .5' directional='true'/>
             <geom type='plane' size='1 1 1' material='grid' rgba='1 0 0 1' user='7'/>
             <site rgba='1 1 1 1' size='0.1'/>
           </worldbody>
           <sensor/>
         </mujoco>",
    )
    .unwrap();
    assert_eq!((model.name.as_str(), model.geoms.len()), ("seen", 1));
}

#[test]
fn opacity_determines_visibility() {
    let model = load_str(
        "<mujoco>
           <default>
             <material rgba='1 1 1 0'/>
             <default class='glass'><geom rgba='0 0 1 0'/><material rgba='0 1 0 1'/></default>
             <default class='made'><geom material='air'/></default>
           </default>
           <asset>
             <material name='air'/>
             <material name='green' class='glass'/>
             <material name='red' rgba='1 0 0 .01'/>
             <mesh name='spot' material='air' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/>
           </asset>
           <worldbody>
             <geom size='1'/>
             <geom size='1' rgba='1 0 0 0'/>
             <geom size='1' class='glass'/>
             <geom size='1' class='glass' rgba='0 0 1 1'/>
             <geom size='1' material='air' rgba='1 0 0 1'/>
             <geom size='1' class='made'/>
             <geom size='1' class='made' material='green'/>
             <geom size='1' material='red' rgba='1 0 0 0'/>
             <geom type='mesh' mesh='spot'/>
             <geom type='mesh' mesh='spot' material='red'/>
           </worldbody>
         </mujoco>",
    )
    .unwrap();
    let visible: Vec<_> = model.geoms.iter().map(|geom| geom.visible).collect();
    let (yes, no) = (true, false);
    assert_eq!(visible, [yes, no, no, yes, no, no, yes, yes, no, yes]);
    let error = load_str("<mujoco><worldbody><geom size='1' rgba='1 0 0'/></worldbody></mujoco>");
    assert!(
        error
            .unwrap_err()
            .to_string()
            .contains("rgba needs 4 numbers, not 3")
    );
}

#[test]
fn a_mesh_that_nothing_uses_may_be_unreadable_with_discardvisual() {
    let load = |compiler: &str, geom: &str, asset: &str| {
        load_str(&format!(
            "<mujoco><compiler discardvisual='true' {compiler}/><asset><mesh {asset}/></asset>
               <worldbody><body><freejoint/><inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>
                 <geom size='.1'/><geom type='mesh' mesh='m' {geom}/></body></worldbody></mujoco>"
        ))
    };
    let seen = "contype='0' conaffinity='0'";
    for (asset, complaint) in [
        ("name='m' file='nowhere.obj'", "nowhere.obj"),
        ("file='nowhere/m.obj'", "nowhere/m.obj"),
        ("name='m' vertex='0 0 0 1 0 0 1 1 0 0 1 0'", "volume"),
        ("name='m' vertex='0 0 0 1 0 0'", "vertices"),
    ] {
        let model = load("", seen, asset).expect(asset);
        assert_eq!((model.geoms.len(), model.meshes.len()), (1, 0), "{asset}");
        for (compiler, geom) in [("", ""), ("inertiafromgeom='true'", seen)] {
            let error = load(compiler, geom, asset).expect_err(asset);
            assert!(error.message.contains(complaint), "{asset}: {error}");
        }
    }
    assert!(load("", seen, "name='n' vertex='0 0 0'").is_err());
}
