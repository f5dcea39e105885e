//! The appearance of elements in a file.

use clench_formats::{SaveModel, load_str};

#[test]
fn colours_materials_and_computed_textures_are_kept() {
    let text = "<mujoco>
           <default>
             <geom rgba='0.1 0.2 0.3 1'/>
             <default class='tiled'><geom material='tiles' rgba='.5 .5 .5 1'/><material specular='0.25'/></default>
           </default>
           <asset>
             <texture name='sky' type='skybox' builtin='gradient' width='8' height='8'/>
             <texture name='squares' type='2d' builtin='checker' rgb1='1 0 0' mark='edge' width='64' height='32'/>
             <material name='tiles' class='tiled' texture='squares' texrepeat='3' texuniform='true' rgba='1 1 1 0.5'/>
             <mesh name='spot' material='tiles' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/>
           </asset>
           <worldbody>
             <geom size='1'/>
             <geom size='1' class='tiled'/>
             <geom size='1' class='tiled' rgba='1 0 0 1'/>
             <geom type='mesh' mesh='spot'/>
             <site name='a' rgba='0 1 0 1'/>
             <site name='b' pos='1 0 0'/>
           </worldbody>
           <tendon><spatial rgba='0 0 1 1' width='0.01'><site site='a'/><site site='b'/></spatial></tendon>
         </mujoco>";
    let model = load_str(text).unwrap();
    let visuals = &model.visuals;
    let colours: Vec<_> = visuals.geoms.iter().map(|&a| visuals.rgba(a)).collect();
    let (own, tiles) = ([0.1, 0.2, 0.3, 1.0], [1.0, 1.0, 1.0, 0.5]);
    assert_eq!(colours, [own, tiles, [1.0, 0.0, 0.0, 1.0], own]);
    assert_eq!(visuals.geoms[3].material, Some(0));
    assert_eq!(visuals.sites[0].rgba, Some([0.0, 1.0, 0.0, 1.0]));
    assert_eq!(visuals.rgba(visuals.sites[1]), [0.5, 0.5, 0.5, 1.0]);
    assert_eq!(visuals.rgba(visuals.tendons[0]), [0.0, 0.0, 1.0, 1.0]);
    assert_eq!(visuals.tendon_width, [0.01]);
    let material = &visuals.materials[0];
    assert_eq!((material.specular, material.texrepeat), (0.25, [3.0, 1.0]));
    let texture = &visuals.textures[material.texture.unwrap()];
    let pixels = texture.pixels();
    assert_eq!(
        ([pixels.width, pixels.height], &pixels.rgb[3 * 65..][..3]),
        ([64, 32], &[255, 0, 0][..])
    );

    let saved = load_str(&model.to_mjcf().unwrap()).unwrap();
    let saved: Vec<_> = (saved.visuals.geoms.iter())
        .map(|&a| saved.visuals.rgba(a))
        .collect();
    assert_eq!(saved, colours);
}

/// As in MuJoCo, a camera without a sensor size has focal lengths of the near clipping distance.
#[test]
fn the_near_distance_is_the_focal_length_of_cameras_without_a_sensor() {
    let stored = |visual: &str| {
        let cameras = "<camera/><camera sensorsize='1 1' resolution='5 5' focal='2 3'/>";
        let text = format!("<mujoco>{visual}<worldbody>{cameras}</worldbody></mujoco>");
        let model = load_str(&text).expect("a model");
        let saved = load_str(&model.to_mjcf().expect("MJCF")).expect("the saved model");
        assert_eq!(saved.params.cam_intrinsic, model.params.cam_intrinsic);
        model.params.cam_intrinsic.clone()
    };
    let own = [2.0, 3.0, 0.0, 0.0];
    assert_eq!(stored(""), [[0.01, 0.01, 0.0, 0.0], own]);
    let visual = "<visual><map znear='0.5' zfar='9'/></visual>";
    assert_eq!(stored(visual), [[0.5, 0.5, 0.0, 0.0], own]);
    let error = load_str("<mujoco><visual><map znear='0'/></visual></mujoco>").expect_err("zero");
    assert!(error.message.contains("must be positive"), "{error}");
}
