//! Frames that scale their contents. The Python tests compare every field with MuJoCo's, over
//! `parity/models/scaled_frames.xml`.

use clench_formats::load_str;
use clench_math::Vec3;
use clench_rigid::{Model, Sim};
use std::sync::Arc;

fn load(sections: &str) -> Model {
    match load_str(&format!("<mujoco>{sections}</mujoco>")) {
        Ok(model) => model,
        Err(error) => panic!("{error}"),
    }
}

fn refused(sections: &str) -> String {
    match load_str(&format!("<mujoco>{sections}</mujoco>")) {
        Ok(_) => panic!("it loads: {sections}"),
        Err(error) => error.to_string(),
    }
}

/// Loads a pendulum on a slider, under gravity, in a frame.
fn pendulum(frame: &str, gravity: f64) -> Model {
    load(&format!(
        "<option gravity='0 0 {gravity}' integrator='RK4'/>
         <worldbody><frame {frame}>
           <body pos='0 0 1'>
             <joint name='slide' type='slide' axis='1 0 0' stiffness='20 3 1' damping='0.4 0.1' springref='0.1' armature='0.1'/>
             <geom type='box' size='0.1 0.1 0.1'/>
             <body pos='0 0 -0.3'>
               <joint name='hinge' axis='0 1 0' stiffness='1 0.5' damping='0.02' armature='0.01'/>
               <geom type='capsule' fromto='0 0 0 0.1 0 -0.4' size='0.03'/>
             </body>
           </body>
         </frame></worldbody>"
    ))
}

/// A scaled model moves as the original would in proportionally weaker gravity: lengths are scaled, and angles are
/// equal.
#[test]
fn a_similar_copy_moves_equally_in_proportional_gravity() {
    let (small, large) = (
        pendulum("", -9.81),
        pendulum("scale='2' massscale='5'", -19.62),
    );
    let [mut small, mut large] =
        [small, large].map(|model| Sim::<f64>::new(Arc::new(model)).unwrap());
    for sim in [&mut small, &mut large] {
        sim.state.qvel[1] = 2.0;
    }
    for _ in 0..500 {
        small.step().unwrap();
        large.step().unwrap();
    }
    let [small, large] = [small.state.qpos.clone(), large.state.qpos.clone()];
    assert!(small[1].abs() > 0.05 && small[0].abs() > 1e-3, "{small:?}");
    assert!(
        (large[0] - 2.0 * small[0]).abs() < 1e-10,
        "{small:?} {large:?}"
    );
    assert!((large[1] - small[1]).abs() < 1e-10, "{small:?} {large:?}");
}

#[test]
fn frames_multiply_and_each_keeps_its_policy() {
    let model = load(
        "<worldbody><frame pos='1 0 0' scale='2' scaling='geometry'>
           <frame pos='1 0 0' euler='0 0 90' scale='3 3 3'>
             <body pos='1 0 0'><joint stiffness='1'/><geom size='1' mass='1'/></body>
           </frame>
         </frame></worldbody>",
    );
    let pos = model.params.body_pos[1] - Vec3::new(3.0, 6.0, 0.0);
    assert!(pos.dot(pos) < 1e-20);
    assert_eq!(model.params.body_mass[1], 216.0);
    // Torques scale only with the inner frame, whose mass grows with its volume.
    assert_eq!(model.params.jnt_stiffness[0], 243.0);
    assert_eq!(model.params.geom_size[0].x, 6.0);
}

#[test]
fn a_policy_without_a_scale_changes_nothing() {
    let geoms = "<body><joint stiffness='3'/><geom size='0.5'/></body>";
    let plain = load(&format!("<worldbody><frame>{geoms}</frame></worldbody>"));
    for said in [
        "scaling='geometry'",
        "scaling='similar'",
        "scale='1'",
        "massscale='0'",
    ] {
        let model = load(&format!(
            "<worldbody><frame {said}>{geoms}</frame></worldbody>"
        ));
        assert_eq!(model.params.body_mass, plain.params.body_mass);
        assert_eq!(model.params.jnt_stiffness, plain.params.jnt_stiffness);
    }
}

#[test]
fn a_mesh_has_an_instance_for_each_size() {
    let mesh = "<asset><mesh name='m' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/></asset>";
    let geom = "<geom type='mesh' mesh='m'/>";
    let model = load(&format!(
        "{mesh}<worldbody>{geom}<frame scale='2'>{geom}{geom}<frame scale='3'>{geom}</frame></frame></worldbody>"
    ));
    let names: Vec<&str> = model.meshes.iter().map(|mesh| &*mesh.name).collect();
    assert_eq!(names, ["m", "m@1", "m@2"]);
    let used: Vec<_> = model.geoms.iter().map(|geom| geom.mesh).collect();
    assert_eq!(used, [0, 1, 1, 2].map(Some));
    let only = load(&format!(
        "{mesh}<worldbody><frame scale='2'>{geom}</frame></worldbody>"
    ));
    assert_eq!(only.meshes.len(), 1);
    let reach = only.meshes[0]
        .vertices
        .iter()
        .map(|v| v.dot(*v))
        .fold(0.0, f64::max);
    let original = model.meshes[0]
        .vertices
        .iter()
        .map(|v| v.dot(*v))
        .fold(0.0, f64::max);
    assert!((reach - 4.0 * original).abs() < 1e-12);
}

#[test]
fn keyframes_are_scaled_with_their_joints() {
    let model = load(
        "<worldbody><frame scale='2'>
           <body><joint axis='0 1 0'/><joint type='slide'/><geom size='1'/></body>
           <body pos='9 0 0'><freejoint/><geom size='1'/></body>
           <body mocap='true'/>
         </frame></worldbody>
         <keyframe><key qpos='1 1 1 1 1 1 0 0 0' qvel='1 1 1 1 1 1 1 1' mpos='1 1 1'/></keyframe>",
    );
    let key = &model.keyframes[0];
    assert_eq!(key.qpos, [1.0, 2.0, 2.0, 2.0, 2.0, 1.0, 0.0, 0.0, 0.0]);
    assert_eq!(key.qvel, [1.0, 2.0, 2.0, 2.0, 2.0, 1.0, 1.0, 1.0]);
    assert_eq!(key.mocap_pos, [2.0; 3]);
}

#[test]
fn controls_and_activations_are_scaled_by_their_unit() {
    let model = load(
        "<worldbody><site name='w'/><frame scale='2'>
           <body><joint name='slide' type='slide'/><geom size='1'/><site name='s'/></body>
         </frame></worldbody>
         <actuator>
           <pid joint='slide' kp='1' ki='1' slewmax='1' input='pos vel ff'/>
           <cylinder joint='slide' timeconst='1'/>
           <orientation site='s' refsite='w' kp='1'/>
         </actuator>
         <keyframe><key ctrl='1 1 1 1 1 1 1' act='1 1 1'/></keyframe>",
    );
    let (length, force, pressure) = (2.0, 16.0, 4.0);
    let key = &model.keyframes[0];
    assert_eq!(key.ctrl, [length, length, force, pressure, 1.0, 1.0, 1.0]);
    assert_eq!(key.act, [length, length, pressure]);
}

#[test]
fn cutoffs_and_noise_of_sensors_are_scaled_by_their_unit() {
    let model = load(
        "<worldbody><frame scale='2'>
           <body name='b'>
             <joint name='slide' type='slide'/><joint name='hinge'/><geom name='g' size='1'/>
             <site name='s'/><site name='u' pos='1 0 0'/>
           </body>
         </frame></worldbody>
         <tendon><spatial name='t'><site site='s'/><site site='u'/></spatial></tendon>
         <actuator><motor name='m' joint='slide'/></actuator>
         <sensor>
           <gyro site='s' cutoff='1'/>
           <velocimeter site='s' cutoff='1' noise='1'/>
           <touch site='s' cutoff='1'/>
           <torque site='s' cutoff='1'/>
           <subtreelinvel body='b' cutoff='1'/>
           <subtreeangmom body='b' cutoff='1'/>
           <framepos objtype='geom' objname='g' cutoff='1'/>
           <jointpos joint='slide' cutoff='1'/>
           <jointpos joint='hinge' cutoff='1'/>
           <jointactuatorfrc joint='slide' cutoff='1'/>
           <jointactuatorfrc joint='hinge' cutoff='1'/>
           <tendonpos tendon='t' cutoff='1'/>
           <tendonactuatorfrc tendon='t' cutoff='1'/>
           <actuatorvel actuator='m' cutoff='1'/>
           <actuatorfrc actuator='m' cutoff='1'/>
           <clock cutoff='1'/>
         </sensor>",
    );
    let (length, force, torque) = (2.0, 16.0, 32.0);
    let cutoffs = Vec::from_iter(model.sensors.iter().map(|sensor| sensor.cutoff));
    assert_eq!(
        cutoffs,
        [
            1.0, length, force, torque, length, torque, length, length, 1.0, force, torque, length,
            force, length, force, 1.0
        ]
    );
    assert_eq!(model.sensors[1].noise, length);
}

#[test]
fn unscalable_elements_are_refused() {
    let geom = "<body><joint name='j'/><geom size='1'/></body>";
    for (frame, words) in [
        ("scale='0'", "scale must be positive"),
        ("scale='-1'", "scale must be positive"),
        ("scale='1 2'", "1 or 3 numbers"),
        ("scale='nan'", "not a finite number"),
        ("massscale='-1'", "massscale cannot be negative"),
        ("scaling='other'", "not one of similar, geometry"),
        ("scale='1 2 3'", "needs scaling \"geometry\""),
        ("scale='1 2 3' scaling='geometry'", "use an ellipsoid"),
    ] {
        let text = refused(&format!(
            "<worldbody><frame name='f' {frame}>{geom}</frame></worldbody>"
        ));
        assert!(
            text.contains(words) && (text.contains("frame \"f\"") || text.contains("geom")),
            "{text}"
        );
    }
    let motor = "<actuator><dcmotor name='m' joint='j' motorconst='1' resistance='1'/></actuator>";
    let with = |frame: &str| format!("<worldbody><frame {frame}>{geom}</frame></worldbody>{motor}");
    let text = refused(&with("scale='2'"));
    assert!(
        text.contains("actuator \"m\"") && text.contains("use scaling"),
        "{text}"
    );
    load(&with("scale='2' scaling='geometry'"));
}

/// The expected numbers are MuJoCo's.
#[test]
fn yields_and_plastic_states_are_scaled_by_their_unit() {
    let model = load(
        "<compiler angle='radian'/>
         <worldbody><site name='w'/>
           <frame scale='2'><body>
             <joint name='a' type='slide' springyield='.1' springref='.3'/><joint type='hinge' springyield='.2'/>
             <geom size='.1'/><site name='s' pos='1 0 0'/>
           </body></frame>
           <frame scale='2' scaling='geometry'><body>
             <joint type='slide' axis='1 0 0' springyield='.1'/><joint type='ball' springyield='.2'/><geom size='.1'/>
           </body></frame>
         </worldbody>
         <tendon>
           <fixed springyield='.2' springlength='.3'><joint joint='a' coef='1'/></fixed>
           <spatial springyield='.2' springlength='.3'><site site='w'/><site site='s'/></spatial>
         </tendon>
         <keyframe><key plastic='.5 .6 .7 1 0 0 1 .8 .9 1.1 1.2'/></keyframe>",
    );
    assert_eq!(model.params.jnt_springyield, [0.2, 0.2, 0.2, 0.2]);
    assert_eq!(model.params.tendon_springyield, [0.4, 0.2]);
    let half = 0.5_f64.sqrt();
    let expected = [1.0, 0.6, 1.4, half, 0.0, 0.0, half, 1.6, 1.8, 1.1, 1.2];
    let found = &model.keyframes[0].plastic;
    let near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-15;
    assert!(found.iter().zip(&expected).all(near), "{found:?}");
}

/// The expected numbers are MuJoCo's.
#[test]
fn scales_that_differ_between_axes_act_by_axis() {
    let model = load(
        "<worldbody><frame scale='1 2 3' scaling='geometry'>
           <body pos='1 1 1' quat='1 0 0 1'>
             <joint type='slide' axis='1 0 0' range='0 1' limited='true'/><joint type='slide' axis='0 0 1' range='0 1' limited='true'/>
             <geom type='box' size='.1 .2 .3' pos='1 2 0' mass='1' friction='1 1 1'/>
             <site size='.1' pos='1 0 0'/>
           </body>
         </frame></worldbody>",
    );
    let near = |v: Vec3<f64>, expected: [f64; 3]| {
        let apart = v - Vec3::from_array(expected);
        apart.dot(apart) < 1e-20
    };
    let (params, cube_root) = (&model.params, 6.0_f64.cbrt());
    assert!(near(params.body_pos[1], [1.0, 2.0, 3.0]));
    // In the axes of the rotated body the scale is 2 1 3.
    assert!(near(params.geom_size[0], [0.2, 0.2, 0.9]));
    assert!(near(params.geom_pos[0], [2.0, 2.0, 0.0]));
    assert!((params.jnt_range[0][1] - 2.0).abs() < 1e-12);
    assert!((params.jnt_range[1][1] - 3.0).abs() < 1e-12);
    assert!((params.body_mass[1] - 6.0).abs() < 1e-12);
    // Quantities without a direction scale with the cube root of the product.
    assert!((params.geom_friction[0][1] - cube_root).abs() < 1e-12);
    assert!((params.site_size[0].x - 0.1 * cube_root).abs() < 1e-12);
}

#[test]
fn elements_that_a_scale_by_axis_would_deform_are_refused() {
    for (scale, part, words) in [
        ("2 2 3", "<geom size='1'/>", "use an ellipsoid"),
        (
            "1 2 3",
            "<geom type='capsule' size='1 1'/>",
            "across its axis",
        ),
        (
            "1 2 3",
            "<geom type='box' fromto='0 0 0 0 0 1' size='1'/>",
            "across its axis",
        ),
        (
            "2 2 3",
            "<geom type='cylinder' size='1 1' euler='0 30 0'/>",
            "across its axis",
        ),
        (
            "2 3 2",
            "<geom type='box' size='1 1 1' euler='0 0 30'/>",
            "not aligned",
        ),
        (
            "2 2 3",
            "<geom type='plane' size='1 1 1' euler='0 30 0'/>",
            "not aligned",
        ),
        ("1 2 3", "<joint axis='1 1 0'/>", "not aligned"),
        ("1 2 3", "<joint type='slide' axis='1 0 1'/>", "not aligned"),
    ] {
        let text = refused(&format!(
            "<worldbody><frame scale='{scale}' scaling='geometry'><body>{part}</body></frame></worldbody>"
        ));
        assert!(text.contains(words), "{part}: {text}");
    }
    // Angles below 0.0349 and scales with a smaller relative difference than that are treated as zero.
    load(
        "<worldbody><frame scale='1 1.036 3' scaling='geometry'>
           <geom type='cylinder' size='1 1' quat='1 0.002 0 0'/><geom type='box' size='1 1 1' euler='0 0 1'/>
         </frame></worldbody>",
    );
}

#[test]
fn a_mirrored_mesh_keeps_its_outside() {
    let mesh = "<asset><mesh name='m' vertex='0 0 0 1 0 0 0 1 0 0 0 1' scale='1 -1 1'/></asset>";
    let geom = "<geom type='mesh' mesh='m' density='1' euler='0 0 30'/>";
    let model = load(&format!(
        "{mesh}<worldbody><frame scale='1 2 3' scaling='geometry'><body><joint type='ball'/>{geom}</body></frame></worldbody>"
    ));
    assert!(
        (model.params.body_mass[1] - 1.0).abs() < 1e-6,
        "{}",
        model.params.body_mass[1]
    );
}
