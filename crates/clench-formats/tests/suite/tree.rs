//! The body tree: poses, frames, replicas, units, shorthands.

use clench_collide::ShapeKind;
use clench_formats::{load_str, read_str};
use clench_math::{Quat, Vec3};
use clench_rigid::builder::{GeomMass, InertiaSpec, ModelBuilder};
use clench_rigid::model::JointKind;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4, PI};

fn world(content: &str) -> ModelBuilder {
    read(&format!("<worldbody>{content}</worldbody>"))
}

fn read(sections: &str) -> ModelBuilder {
    match read_str(&format!("<mujoco>{sections}</mujoco>")) {
        Ok(builder) => builder,
        Err(error) => panic!("{error}"),
    }
}

fn near(a: Vec3<f64>, b: [f64; 3]) -> bool {
    (a - Vec3::from_array(b)).norm() < 1e-14
}

fn same_rotation(a: Quat<f64>, b: [f64; 4]) -> bool {
    let dot: f64 = a.to_array().iter().zip(b).map(|(x, y)| x * y).sum();
    (dot.abs() - 1.0).abs() < 1e-14
}

#[test]
fn attributes_that_mujoco_ignores_are_no_errors() {
    let model = read_str(
        "<mujoco>
           <compiler inertiagrouprange=''/>
           <worldbody>
             <frame mocap='true' gravcomp='1' sleep='never' fuse='false' simple='false' user='1'>
               <replicate count='2' pos='1 2 3' quat='0 1 0 0' mocap='true' gravcomp='1'>
                 <body><joint/><geom size='1' material=''/><site material=''/></body>
               </replicate>
             </frame>
           </worldbody>
         </mujoco>",
    )
    .unwrap();
    assert_eq!(model.bodies.len(), 3);
    for body in &model.bodies[1..] {
        assert!(!body.mocap && body.gravcomp == 0.0 && body.pos == Vec3::ZERO);
    }
}

#[test]
fn bodies_stand_in_the_order_of_the_file_parents_first() {
    let model = world(
        "<body name='a'><body name='b'/></body><frame><body name='c'><body name='d'/></body></frame>",
    );
    let names: Vec<_> = model.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["world", "a", "b", "c", "d"]);
    let parents: Vec<_> = model.bodies.iter().map(|body| body.parent).collect();
    assert_eq!(parents, [0, 0, 1, 0, 3]);
}

/// As in MuJoCo: an undefined inertial frame has the same offset from the body as the body from its `<frame>`.
#[test]
fn boundmass_applies_to_massless_bodies_in_frames() {
    let text = "<mujoco><compiler boundmass='1' boundinertia='1'/><worldbody>
        <frame pos='1 2 3'><frame pos='4 5 6' euler='90 0 0'>
          <body pos='0.1 0.2 0.3'><joint/></body>
        </frame></frame></worldbody></mujoco>";
    let model = load_str(text).expect("valid");
    assert!(near(model.params.body_ipos[1], [0.1, 0.2, 0.3]));
    assert!(near(model.params.body_pos[1], [5.1, 6.7, 9.2]));
}

#[test]
fn orientations_may_be_written_in_five_ways() {
    let half = FRAC_1_SQRT_2;
    let about_z = [half, 0.0, 0.0, half];
    let ways = [
        ("quat='2 0 0 2'", about_z),
        ("axisangle='0 0 3 90'", about_z),
        ("euler='0 0 90'", about_z),
        ("xyaxes='0 2 0 -1 5 0'", about_z),
        ("zaxis='1 0 0'", [half, 0.0, half, 0.0]),
        ("zaxis='0 0 -4'", [0.0, 1.0, 0.0, 0.0]),
    ];
    for (way, expected) in ways {
        let quat = world(&format!("<body {way}/>")).bodies[1].quat;
        assert!(same_rotation(quat, expected), "{way}: {quat:?}");
    }
}

#[test]
fn angles_are_degrees_unless_the_compiler_sets_radian() {
    let body = "<worldbody><body euler='0 0 1.5707963267948966'/></worldbody>";
    let quat = read(&format!("<compiler angle='radian'/>{body}")).bodies[1].quat;
    assert!(same_rotation(
        quat,
        [FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2]
    ));
    let degrees = read(body).bodies[1].quat;
    assert!((degrees.z - (FRAC_PI_2.to_radians() / 2.0).sin()).abs() < 1e-15);
}

#[test]
fn eulerseq_orders_rotations_about_moving_or_fixed_axes() {
    let turned = |sequence| {
        let text = format!(
            "<compiler eulerseq='{sequence}'/><worldbody><body euler='90 90 0'/></worldbody>"
        );
        read(&text).bodies[1].quat.rotate(Vec3::new(0.0, 0.0, 1.0))
    };
    // Moving axes: the second rotation is about the new y, which is the old z; z is tipped by the first only, then
    // rotated.
    assert!(near(turned("xyz"), [1.0, 0.0, 0.0]));
    // Fixed axes: the first rotation tips z to −y; the second, about y, leaves it there.
    assert!(near(turned("XYZ"), [0.0, -1.0, 0.0]));
}

#[test]
fn frames_carry_their_contents_along() {
    let model = world(
        "<frame pos='1 0 0' euler='0 0 90'>
           <frame pos='0 2 0'>
             <body pos='0 0 3'>
               <frame pos='0 0 1' euler='90 0 0'>
                 <joint pos='0 1 0' axis='0 1 0'/>
                 <geom size='1' pos='0 1 0'/>
                 <inertial pos='0 1 0' mass='1' diaginertia='1 1 1'/>
               </frame>
             </body>
             <site pos='1 0 0'/>
           </frame>
         </frame>",
    );
    let body = &model.bodies[1];
    assert!(near(body.pos, [-1.0, 0.0, 3.0]));
    assert!(same_rotation(
        body.quat,
        [FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2]
    ));
    assert!(near(body.joints[0].pos, [0.0, 0.0, 2.0]));
    assert!(near(body.joints[0].axis, [0.0, 0.0, 1.0]));
    assert!(near(body.geoms[0].pos, [0.0, 0.0, 2.0]));
    assert!(near(body.inertial.as_ref().unwrap().pos, [0.0, 0.0, 2.0]));
    assert!(near(model.bodies[0].sites[0].pos, [-1.0, 1.0, 0.0]));
}

#[test]
fn a_full_inertia_rotates_with_its_frame() {
    let model = world(
        "<body><frame euler='0 0 90'><inertial pos='0 0 0' mass='1' fullinertia='1 2 3 0.1 0.2 0.3'/></frame></body>",
    );
    let InertiaSpec::Full(inertia) = model.bodies[1].inertial.as_ref().unwrap().inertia else {
        panic!("a full inertia was written");
    };
    // x becomes y, y becomes −x: moments swap, xy changes sign, xz becomes yz, yz becomes −xz.
    let expected = [2.0, 1.0, 3.0, -0.1, -0.3, 0.2];
    assert!(
        inertia
            .iter()
            .zip(expected)
            .all(|(a, b)| (a - b).abs() < 1e-14),
        "{inertia:?}"
    );
}

#[test]
fn degrees_concern_limits_and_references_of_hinges_but_not_slides() {
    let model = world(
        "<body>
           <joint type='hinge' range='-90 45' ref='180' springref='90' springyield='90'/>
           <joint type='hinge' range='-90 45' limited='false'/>
           <joint type='slide' range='-90 45' ref='180' springref='90' springyield='90'/>
         </body>
         <body><joint type='ball' range='0 90' ref='1' springyield='45'/></body>",
    );
    let joints = &model.bodies[1].joints;
    assert_eq!(joints[0].range, [-FRAC_PI_2, FRAC_PI_4]);
    assert_eq!((joints[0].reference, joints[0].springref), (PI, FRAC_PI_2));
    assert_eq!(joints[1].range, [-90.0, 45.0]);
    assert_eq!(joints[2].range, [-90.0, 45.0]);
    assert_eq!((joints[2].reference, joints[2].springref), (180.0, 90.0));
    let ball = &model.bodies[2].joints[0];
    assert_eq!((ball.range, ball.reference), ([0.0, FRAC_PI_2], 1.0));
    let yields = [&joints[0], &joints[2], ball].map(|joint| joint.springyield);
    assert_eq!(yields, [FRAC_PI_2, 90.0, FRAC_PI_4]);
}

#[test]
fn a_free_joint_ignores_defaults() {
    let model = read(
        "<default><joint damping='3' armature='1'/></default>
         <worldbody><body><freejoint name='root' align='false'/></body></worldbody>",
    );
    let joint = &model.bodies[1].joints[0];
    assert_eq!(
        (joint.kind, joint.damping, joint.armature),
        (JointKind::Free, [0.0; 3], 0.0)
    );
    assert_eq!((joint.name.as_str(), joint.align), ("root", Some(false)));
}

#[test]
fn fromto_gives_place_direction_and_length() {
    for (kind, size) in [
        ("capsule", [0.1, 1.5, 0.0]),
        ("cylinder", [0.1, 1.5, 0.0]),
        ("box", [0.1, 0.1, 1.5]),
        ("ellipsoid", [0.1, 0.1, 1.5]),
    ] {
        let model = world(&format!(
            "<geom type='{kind}' fromto='1 0 0 4 0 0' size='0.1'/>"
        ));
        let geom = &model.bodies[0].geoms[0];
        assert_eq!(geom.size.to_array(), size, "{kind}");
        assert!(near(geom.pos, [2.5, 0.0, 0.0]));
        // z points from the second point to the first.
        assert!(near(
            geom.quat.rotate(Vec3::new(0.0, 0.0, 1.0)),
            [-1.0, 0.0, 0.0]
        ));
    }
}

#[test]
fn a_mass_goes_before_a_density() {
    let model =
        world("<geom size='1'/><geom size='1' density='0'/><geom size='1' density='5' mass='2'/>");
    let masses: Vec<_> = model.bodies[0].geoms.iter().map(|geom| geom.mass).collect();
    let expected = [
        GeomMass::Density(1000.0),
        GeomMass::Density(0.0),
        GeomMass::Mass(2.0),
    ];
    assert_eq!(masses, expected);
}

#[test]
fn numbers_may_be_written_loosely() {
    let model = world("<geom size='\t .5  +1.  2e-1\n' type='box' contype='-1'/>");
    let geom = &model.bodies[0].geoms[0];
    assert_eq!(geom.size.to_array(), [0.5, 1.0, 0.2]);
    assert_eq!((geom.kind, geom.contype), (ShapeKind::Box, u32::MAX));
}

#[test]
fn replicas_are_displaced_again_and_again_and_numbered() {
    let model = world(
        "<replicate count='2' offset='0 1 0' euler='90 0 0'>
           <replicate count='2' sep='-' offset='1 0 0' euler='0 90 0'><geom name='Alice' size='0.1'/></replicate>
         </replicate>",
    );
    // The example in MuJoCo's XML reference.
    let expected = [
        ("Alice-00", [0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]),
        (
            "Alice-10",
            [1.0, 0.0, 0.0],
            [FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2, 0.0],
        ),
        (
            "Alice-01",
            [0.0, 1.0, 0.0],
            [FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0, 0.0],
        ),
        ("Alice-11", [1.0, 1.0, 0.0], [0.5, 0.5, 0.5, 0.5]),
    ];
    assert_eq!(model.bodies[0].geoms.len(), expected.len());
    for (geom, (name, pos, quat)) in model.bodies[0].geoms.iter().zip(expected) {
        assert_eq!(geom.name, name);
        assert!(
            near(geom.pos, pos) && same_rotation(geom.quat, quat),
            "{geom:?}"
        );
    }
}

#[test]
fn replicas_are_numbered_with_as_many_digits_as_their_count() {
    let model = world("<replicate count='11'><body name='b'/></replicate>");
    assert_eq!(model.bodies[1].name, "b00");
    assert_eq!(model.bodies[11].name, "b10");
}

#[test]
fn mocap_bodies_and_gravity_compensation_are_read() {
    let model = world("<body mocap='true'/><body gravcomp='0.5'/>");
    assert!(model.bodies[1].mocap);
    assert_eq!(model.bodies[2].gravcomp, 0.5);
}

#[test]
fn a_chain_as_deep_as_a_file_may_be_is_read() {
    let depth = 497;
    let chain = "<body><joint/><geom size='1'/>".repeat(depth) + &"</body>".repeat(depth);
    assert_eq!(world(&chain).bodies.len(), depth + 1);
}

#[test]
fn fused_bodies_are_those_that_nothing_needs() {
    let bodies = |attributes: &str, more: &str| {
        let text = format!(
            "<mujoco>
               <compiler fusestatic='true'/>
               <worldbody>
                 <body name='b'>
                   <freejoint/>
                   <geom name='on_b' size='0.1'/>
                   <body name='f' pos='1 0 0' {attributes}>
                     <geom name='on_f' size='0.1'/>
                     <site name='site'/>
                   </body>
                   <body name='hinged' pos='2 0 0'>
                     <joint/>
                     <geom size='0.1'/>
                   </body>
                 </body>
               </worldbody>
               {more}
             </mujoco>"
        );
        let model = load_str(&text).unwrap_or_else(|error| panic!("{error}"));
        model.nbody() - 1
    };
    let fused = |more| bodies("", more) == 2;
    assert!(fused(""));
    assert_eq!(bodies("fuse='false'", ""), 3);
    assert_eq!(bodies("gravcomp='1'", ""), 3);
    assert!(!fused("<option density='1.2'/>"));
    assert!(!fused(
        "<contact><exclude body1='f' body2='hinged'/></contact>"
    ));
    assert!(!fused(
        "<equality><weld body1='f' body2='world'/></equality>"
    ));
    assert!(!fused(
        "<sensor><framepos objtype='xbody' objname='f'/></sensor>"
    ));
    assert!(!fused("<sensor><subtreecom body='f'/></sensor>"));
    assert!(!fused("<sensor><force site='site'/></sensor>"));
    assert!(!fused(
        "<worldbody><camera mode='targetbody' target='f'/></worldbody>"
    ));
    assert!(!fused(
        "<custom><tuple name='t'><element objtype='body' objname='f'/></tuple></custom>"
    ));
    // Elements on the body are moved to its parent.
    assert!(fused(
        "<sensor><framepos objtype='site' objname='site'/></sensor>"
    ));
    assert!(fused(
        "<sensor><distance geom1='on_f' body2='hinged'/></sensor>"
    ));
    assert!(fused(
        "<contact><pair geom1='on_f' geom2='on_b'/></contact>"
    ));
}

/// MuJoCo 4.0's numbers: degrees are converted only if the range is a limit.
#[test]
fn a_range_that_is_no_limit_is_stored_as_written() {
    let range = |joint: &str| {
        let text = format!(
            "<mujoco><worldbody><body><joint {joint}/><geom size='1'/></body></worldbody></mujoco>"
        );
        let model = load_str(&text).expect("it is a valid model");
        (model.joints[0].limited, model.params.jnt_range[0])
    };
    assert_eq!(range("range='-180 180'"), (true, [-PI, PI]));
    assert_eq!(range("range='20 10'"), (false, [20.0, 10.0]));
    assert_eq!(range("type='ball' range='20 10'"), (false, [20.0, 10.0]));
    assert_eq!(
        range("range='0 180' limited='false'"),
        (false, [0.0, 180.0])
    );
}
