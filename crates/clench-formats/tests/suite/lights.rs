//! Lights: their attributes in a file, and their poses.

use clench_formats::load_str;
use clench_rigid::Sim;
use clench_rigid::model::{Headlight, LightKind};
use clench_rigid::readout::light_poses;
use std::f64::consts::FRAC_1_SQRT_2;
use std::sync::Arc;

const SCENE: &str = "<mujoco><visual><headlight ambient='.2 .2 .2' active='0'/></visual>
  <default><light diffuse='.1 .2 .3'/></default><worldbody><light/>
  <light pos='1 2 3' dir='0 1 -1' type='directional' castshadow='false' active='false' cutoff='30' exponent='5'
    attenuation='1 2 3' ambient='.1 .1 .1' specular='.9 .8 .7'/>
  <light type='point' name='p'/>
  <body name='a' pos='0 0 1' euler='0 30 0'><freejoint/><geom size='.1' pos='.2 0 0'/>
    <light name='f' pos='0 0 1' dir='1 0 0'/><light mode='track' pos='0 0 1' dir='1 0 0'/>
    <light mode='trackcom' pos='0 0 1' dir='1 0 0'/><light mode='targetbody' target='b' pos='0 0 1'/>
    <light mode='targetbodycom' target='b' pos='0 .1 1'/>
    <frame pos='0 0 1' euler='90 0 0'><light mode='trackcom' target='b' pos='0 .1 1'/></frame></body>
  <body name='b' pos='1 0 0'><joint/><geom size='.1' pos='0 .1 0'/></body></worldbody></mujoco>";

#[test]
fn numbers_are_those_of_the_file_or_of_mujoco() {
    let model = load_str(SCENE).unwrap();
    let lights = &model.visuals.lights;
    let kinds: Vec<_> = lights[..3]
        .iter()
        .map(|light| light.properties.kind)
        .collect();
    assert_eq!(
        kinds,
        [LightKind::Spot, LightKind::Directional, LightKind::Point]
    );
    let (first, second) = (&lights[0].properties, &lights[1].properties);
    assert_eq!(
        (first.cutoff, first.exponent, first.attenuation),
        (45.0, 10.0, [1.0, 0.0, 0.0])
    );
    assert_eq!(
        (first.ambient, first.diffuse, first.specular),
        ([0.0; 3], [0.1, 0.2, 0.3], [0.3; 3])
    );
    assert_eq!(
        (
            first.active,
            first.castshadow,
            second.active,
            second.castshadow
        ),
        (true, true, false, false)
    );
    assert_eq!(
        (second.cutoff, second.exponent, second.attenuation),
        (30.0, 5.0, [1.0, 2.0, 3.0])
    );
    assert_eq!(
        (second.ambient, second.specular),
        ([0.1; 3], [0.9, 0.8, 0.7])
    );
    let expected = Headlight {
        active: false,
        ambient: [0.2; 3],
        ..Headlight::default()
    };
    assert_eq!(model.visuals.headlight, expected);
    for (light, words) in [
        ("dir='0 0 0'", "must not be zero"),
        ("mode='targetbody' target='x'", "\"x\""),
        ("target='x'", "\"x\""),
        ("directional='true' type='point'", "directional"),
    ] {
        let text = format!("<mujoco><worldbody><light {light}/></worldbody></mujoco>");
        let error = load_str(&text).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn lights_have_mujocos_poses() {
    let mut sim = Sim::<f64>::new(Arc::new(load_str(SCENE).unwrap())).unwrap();
    sim.state.qpos[..8].copy_from_slice(&[0.1, 0.2, 0.9, 0.5, 0.5, 0.5, 0.5, 0.7]);
    sim.refresh().unwrap();
    // `light_xpos` and `light_xdir` in MuJoCo 4.0.0.
    let expected = [
        [[0.0, 0.0, 0.0], [0.0, 0.0, -1.0]],
        [[1.0, 2.0, 3.0], [0.0, FRAC_1_SQRT_2, -FRAC_1_SQRT_2]],
        [[0.0, 0.0, 0.0], [0.0, 0.0, -1.0]],
        [[1.1, 0.2, 0.9], [0.0, 1.0, 0.0]],
        [[0.6, 0.2, 1.766025403784], [0.8660254037844, 0.0, -0.5]],
        [
            [0.426794919243, 0.4, 1.866025403784],
            [0.8660254037844, 0.0, -0.5],
        ],
        [
            [1.1, 0.2, 0.9],
            [-0.1078327732034, -0.2156655464069, -0.9704949588309],
        ],
        [
            [1.1, 0.2, 1.0],
            [-0.1610515434873, -0.120984024033, -0.9795025606241],
        ],
        [[-0.35, -0.7, 2.852627944163], [0.0, 1.0, 0.0]],
    ];
    let poses = light_poses(&sim.model().visuals.lights, sim.workspace());
    assert_eq!(poses.len(), expected.len());
    for (k, (place, expected)) in poses.iter().zip(expected).enumerate() {
        let both = place.as_flattened().iter().zip(expected.as_flattened());
        assert!(
            both.into_iter().all(|(a, b)| (a - b).abs() < 1e-9),
            "{k}: {place:?} {expected:?}"
        );
    }
}
