//! Compares derivatives by recursion with those of passes in dual numbers, which a requested output needs.

use crate::common::{Random, load};
use clench_derivatives::{InputTangent, Linearizer, Matrix, Request};
use clench_dynamics::model::ParamField;
use clench_math::Vec3;
use clench_rigid::options::{FrictionCone, RigidOptions};
use clench_rigid::{Model, Output, Sim};
use std::collections::BTreeSet;
use std::sync::Arc;

/// The largest difference relative to 1 + the magnitude.
const TOLERANCE: f64 = 1e-10;

fn compare(recursive: &Matrix, passes: &Matrix) {
    assert_eq!(recursive.shape, passes.shape);
    for (k, (a, b)) in recursive.values.iter().zip(&passes.values).enumerate() {
        let (row, column) = (k / passes.shape[1], k % passes.shape[1]);
        assert!(
            (a - b).abs() <= TOLERANCE * (1.0 + b.abs()),
            "row {row}, column {column}: {a} by recursion, {b} by passes"
        );
    }
}

/// Compares all derivatives in every fifth step under random controls. Returns the most contacts of a state.
fn check(model: Model, options: RigidOptions, steps: usize) -> usize {
    let mut sim = Sim::<f64>::with_options(Arc::new(model), options).expect("a simulation");
    check_sim(&mut sim, steps).contacts
}

/// The events of a comparison.
#[derive(Debug, Default)]
struct Seen {
    /// The most contacts of a state.
    contacts: usize,
    /// True if recursions found derivatives: they round otherwise than passes.
    recursed: bool,
    /// The kinds of constraints whose force was not zero.
    forces: BTreeSet<&'static str>,
}

fn check_sim(sim: &mut Sim<f64>, steps: usize) -> Seen {
    let mut linearizer = Linearizer::new(sim.model()).expect("lanes of this processor");
    let mut random = Random(1);
    let with_output = Request {
        outputs: vec![Output::find("subtree_com").expect("an output")],
        ..Request::default()
    };
    let mut seen = Seen::default();
    for step in 0..steps {
        if step % 10 == 0 {
            for control in &mut sim.state.ctrl {
                *control = 0.5 * random.next();
            }
        }
        sim.step().expect("a step");
        let ws = sim.workspace();
        seen.contacts = seen.contacts.max(ws.contacts.len());
        for (block, record) in ws.problem.blocks().zip(&ws.record.blocks) {
            if ws.solver.force()[block.rows()].iter().any(|&f| f != 0.0) {
                seen.forces.insert(record.source.kind());
            }
        }
        if step % 5 == 0 {
            let recursive = linearizer.linearize(sim, &Request::default());
            let recursive = recursive.expect("derivatives").clone();
            let passes = linearizer.linearize(sim, &with_output);
            let passes = passes.expect("derivatives");
            compare(&recursive.a, &passes.a);
            compare(&recursive.b, &passes.b);
            compare_sensors(&recursive.c, &passes.c);
            compare_sensors(&recursive.d, &passes.d);
            seen.recursed |= recursive.a != passes.a;
            assert_eq!(recursive.switching.len(), passes.switching.len());
            compare_parameters(&mut linearizer, sim);
        }
    }
    seen
}

/// Compares the derivatives of sensors, which precede those of outputs.
fn compare_sensors(recursive: &Matrix, passes: &Matrix) {
    let mut passes = passes.clone();
    passes.shape[0] = recursive.shape[0];
    passes.values.truncate(recursive.values.len());
    compare(recursive, &passes);
}

/// Compares derivatives by parameters, and those along a tangent, with and without passes along the state.
fn compare_parameters(linearizer: &mut Linearizer, sim: &Sim<f64>) {
    let field = ParamField::find("body_mass").expect("a parameter");
    let mut request = Request {
        parameters: vec![(field, 1)],
        ..Request::default()
    };
    let apart = linearizer.linearize(sim, &request);
    let apart = apart.expect("derivatives").clone();
    request.outputs = vec![Output::find("subtree_com").expect("an output")];
    let together = linearizer.linearize(sim, &request).expect("derivatives");
    compare(&apart.a, &together.a);
    compare(&apart.e, &together.e);
    let ones = |rows: usize| Matrix {
        shape: [rows, 1],
        values: vec![1.0; rows],
    };
    let tangent = InputTangent {
        x: ones(apart.a.shape[0]),
        u: ones(apart.b.shape[1]),
        p: ones(0),
    };
    request.parameters.clear();
    let passes = linearizer.jvp(sim, &request, &tangent);
    let passes = passes.expect("a directional derivative").x.clone();
    let product = linearizer.jvp(sim, &Request::default(), &tangent);
    compare(&product.expect("a directional derivative").x, &passes);
}

#[test]
fn robots_in_contact() {
    for cone in [FrictionCone::Pyramidal, FrictionCone::Elliptic] {
        let options = RigidOptions::new().friction_cone(cone);
        // The humanoid also touches itself, the arm a table and a box.
        for name in ["humanoid.xml", "quadruped.xml", "arm_and_box.xml"] {
            assert!(check(load(name), options, 150) > 1);
        }
        assert!(check(load("box_stack.xml"), options, 20) > 4);
        check(load("rolling_sphere.xml"), options, 100);
    }
}

/// A chain of all kinds of joints, with springs, curved dampers, dry friction and limits, and several actuators.
fn mixed(integrator: &str, root: &str) -> Model {
    let text = format!(
        r#"<mujoco>
          <option integrator="{integrator}" timestep="0.004"/>
          <worldbody>
            <geom type="plane" size="2 2 .1"/>
            <geom type="box" size=".05 .3 .1" pos=".35 0 .1"/>
            <body pos="0 0 .3">
              {root}
              <geom type="capsule" fromto="0 0 0 .2 0 -.1" size=".03" condim="6"/>
              <body pos=".2 0 -.1">
                <joint name="a" axis="0 1 .2" damping=".05 .02" armature=".01" frictionloss=".02" range="-60 20"/>
                <joint name="b" type="slide" axis="1 0 .1" damping=".5" stiffness="30 5" frictionloss=".1"/>
                <joint name="c" axis="1 0 0" pos=".02 .01 0" actuatorfrcrange="-.3 .3" actuatorfrclimited="true"/>
                <geom type="ellipsoid" pos=".1 0 -.1" size=".1 .05 .04" condim="4"/>
                <body pos=".2 0 -.1">
                  <joint name="d" type="ball" pos=".01 .02 .03" stiffness=".3" damping=".02"/>
                  <geom type="box" pos=".05 0 0" size=".05 .02 .03"/>
                </body>
              </body>
            </body>
          </worldbody>
          <actuator>
            <position joint="a" kp="2" kv=".1" forcerange="-.5 .5"/>
            <general joint="b" dyntype="filter" dynprm=".05" gainprm="2" gear="1.5"/>
            <damper joint="b" kv=".4" ctrlrange="0 1"/>
            <motor joint="c" gear="3"/>
            <motor joint="c" ctrlrange="-.1 .1" ctrllimited="true"/>
          </actuator>
        </mujoco>"#
    );
    clench_formats::load_str(&text).expect("a model")
}

#[test]
fn joints_actuators_and_integrators() {
    let ball = r#"<joint type="ball" damping=".1" stiffness=".2"/>"#;
    let free = r#"<joint type="free" damping=".1" stiffness=".2"/>"#;
    for integrator in ["Euler", "implicitfast"] {
        for root in [ball, free] {
            assert!(check(mixed(integrator, root), RigidOptions::new(), 200) > 1);
        }
    }
}

/// Free bodies that spin, with and without a welded or jointed child, whose gyroscopic forces act at the end of a step.
#[test]
fn free_bodies_with_implicit_steps() {
    let text = r#"<mujoco>
      <option integrator="implicitfast" timestep="0.004"/>
      <worldbody>
        <geom type="plane" size="2 2 .1"/>
        <body pos="0 0 .2">
          <freejoint/><geom type="box" size=".1 .05 .02" pos=".05 .02 .03" euler="20 30 10"/>
          <body pos=".1 0 .1"><geom type="capsule" size=".02 .1"/></body>
        </body>
        <body pos="0 .5 .2">
          <joint type="free" damping=".1" stiffness=".3"/><geom type="ellipsoid" size=".1 .06 .03"/>
        </body>
        <body pos="0 -.5 .2">
          <freejoint/><geom type="box" size=".1 .05 .02"/>
          <body pos=".1 0 0"><joint axis="0 1 1" damping=".01"/><geom type="capsule" size=".02 .1"/></body>
        </body>
      </worldbody>
    </mujoco>"#;
    check_text(text, &["contact"], |sim| {
        for (i, v) in sim.state.qvel.iter_mut().enumerate() {
            *v = (i as f64).sin() * if i % 6 < 3 { 0.1 } else { 5.0 };
        }
    });
}

/// Compares steps of a model in text, in which constraints of the kinds `forces` must act. `prepare` changes the first
/// state.
fn check_text(text: &str, forces: &[&str], prepare: impl Fn(&mut Sim<f64>)) {
    let model = clench_formats::load_str(text).expect("a model");
    let mut sim = Sim::<f64>::new(Arc::new(model)).expect("a simulation");
    prepare(&mut sim);
    let seen = check_sim(&mut sim, 200);
    assert!(seen.recursed, "recursions cover the step");
    for kind in forces {
        assert!(seen.forces.contains(kind), "{kind} among {:?}", seen.forces);
    }
}

/// Fixed tendons with springs, dampers, inertia, friction and limits, with actuators, on branches of a tree, and
/// equalities that make joints and tendons follow others by curves.
fn fingers(integrator: &str) -> String {
    let finger = |name: &str, y: f64| {
        format!(
            r#"<body pos=".1 {y} 0">
              <joint name="{name}0" axis="0 1 .1" range="-40 60" frictionloss=".002"/>
              <geom type="capsule" fromto="0 0 0 .06 0 0" size=".01"/>
              <body pos=".06 0 0">
                <joint name="{name}1" axis="0 1 0"/>
                <geom type="capsule" fromto="0 0 0 .04 0 0" size=".01"/>
                <body pos=".04 0 0">
                  <joint name="{name}2" axis="0 1 0" actuatorfrcrange="-.02 .02" actuatorfrclimited="true"/>
                  <geom type="capsule" fromto="0 0 0 .03 0 0" size=".01"/>
                </body>
              </body>
            </body>"#
        )
    };
    format!(
        r#"<mujoco>
          <option integrator="{integrator}" timestep="0.004"/>
          <default><joint damping=".001" armature=".0005"/></default>
          <worldbody>
            <body>
              <joint name="palm" axis="0 1 0" damping=".1"/>
              <geom type="box" size=".1 .05 .02"/>
              {}{}
            </body>
          </worldbody>
          <tendon>
            <fixed name="flexor" stiffness=".4 .3" damping=".004 .002" springlength=".1 .2" frictionloss=".003">
              <joint joint="a0" coef="1"/><joint joint="a1" coef=".8"/><joint joint="a2" coef=".5"/>
            </fixed>
            <fixed name="spread" armature=".0002" damping=".003" limited="true" range="-.1 .15">
              <joint joint="a0" coef="1"/><joint joint="b0" coef="-1"/><joint joint="palm" coef=".2"/>
            </fixed>
            <fixed name="leader"><joint joint="b0" coef="1"/><joint joint="b1" coef="1"/></fixed>
            <fixed name="follower"><joint joint="b2" coef="1"/><joint joint="b1" coef=".2"/></fixed>
          </tendon>
          <equality>
            <joint joint1="a2" joint2="a1" polycoef=".1 .6 .5 -.2 .3"/>
            <joint joint1="palm" polycoef=".05"/>
            <tendon tendon1="follower" tendon2="leader" polycoef=".02 .5 -.4 .1 .2"/>
          </equality>
          <actuator>
            <position tendon="flexor" kp="1" kv=".02" forcerange="-.4 .4"/>
            <general tendon="spread" dyntype="filter" dynprm=".05" gainprm=".1" biastype="affine" biasprm="0 -.3 -.01" gear="1.5"/>
            <damper tendon="leader" kv=".02" ctrlrange="0 1"/>
            <velocity joint="a2" kv=".01"/>
            <intvelocity tendon="follower" kp=".1" actrange="-.5 .5"/>
          </actuator>
        </mujoco>"#,
        finger("a", 0.04),
        finger("b", -0.04)
    )
}

#[test]
fn fixed_tendons_and_equalities_of_coordinates() {
    let forces = [
        "equality",
        "friction_dof",
        "friction_tendon",
        "limit_tendon",
    ];
    for integrator in ["Euler", "implicitfast"] {
        check_text(&fingers(integrator), &forces, |_| {});
    }
}

/// Connects and welds between bodies of one tree, of two trees, and of a tree and the world.
fn tied(integrator: &str) -> String {
    format!(
        r#"<mujoco>
          <option integrator="{integrator}" timestep="0.004"/>
          <worldbody>
            <body name="mocap" mocap="true" pos="-.4 .1 .3" quat="1 .2 .1 0"/>
            <body name="a" pos="0 0 .5">
              <joint type="ball" damping=".01"/>
              <geom type="capsule" fromto="0 0 0 .2 0 0" size=".03"/>
              <body name="b" pos=".2 0 0">
                <joint axis="0 1 0" pos=".01 0 0"/><joint type="slide" axis="1 0 .2" damping="1"/>
                <geom type="capsule" fromto="0 0 0 .2 .1 0" size=".02"/>
              </body>
              <body name="c" pos=".1 .1 0">
                <joint axis="0 .1 1"/>
                <geom type="box" size=".05 .03 .02"/>
                <body name="d" pos=".1 0 0"><joint axis="1 1 0"/><geom type="box" size=".05 .03 .02"/></body>
              </body>
            </body>
            <body name="e" pos=".3 0 .2">
              <joint type="ball"/><geom type="ellipsoid" pos=".1 0 0" size=".1 .05 .03"/>
            </body>
            <body name="f" pos="-.3 0 .2">
              <joint axis="1 0 .3"/><joint type="ball" pos=".1 0 0"/><geom type="box" pos=".1 .1 0" size=".1 .05 .03"/>
            </body>
          </worldbody>
          <contact><exclude body1="b" body2="e"/><exclude body1="c" body2="b"/><exclude body1="b" body2="d"/></contact>
          <equality>
            <connect body1="b" body2="d" anchor=".1 .1 0"/>
            <connect body1="e" body2="a" anchor=".12 0 .1"/>
            <weld body1="d" body2="e" torquescale=".3" relpose=".1 .1 .2 1 .3 .2 .1" solref=".1 1"/>
            <weld body1="f" body2="mocap" solimp=".8 .95 .5 .5 2" solref=".2 1"/>
            <weld body1="f" relpose="-.4 .1 .2 1 .4 0 .3" solref=".1 .5"/>
          </equality>
        </mujoco>"#
    )
}

#[test]
fn connects_and_welds() {
    for integrator in ["Euler", "implicitfast"] {
        check_text(&tied(integrator), &["equality"], |_| {});
    }
    check_text(&tied("Euler"), &["equality", "dynamic"], |sim| {
        let bodies = &sim.model().bodies;
        let body = |name: &str| bodies.iter().position(|body| body.name == name);
        let [a, b, c, f] = ["a", "b", "c", "f"].map(|name| body(name).expect("a body"));
        sim.add_weld(c, b).expect("a slot");
        sim.add_connect(f, a, Vec3::new(0.1, 0.0, 0.3))
            .expect("a slot");
    });
    check(load("four_bar.xml"), RigidOptions::new(), 100);
}

/// Gravity compensation, in part by actuators, and forces and torques that a user applies.
#[test]
fn forces_on_bodies() {
    let text = r#"<mujoco>
      <option timestep="0.004" gravity="1 2 -9"/>
      <worldbody>
        <body gravcomp=".7" pos="0 0 .5">
          <joint type="free" damping=".5"/><geom type="box" size=".1 .05 .03"/>
          <body pos=".1 0 0" gravcomp="1.2">
            <joint name="a" axis="0 1 .2" pos="-.02 .01 0" actuatorgravcomp="true"/>
            <geom type="capsule" fromto="0 0 0 .2 0 .1" size=".03"/>
            <body pos=".2 0 .1" gravcomp="1">
              <joint name="b" type="slide" axis="1 0 0" actuatorgravcomp="true" actuatorfrcrange="-1 1"
                actuatorfrclimited="true"/>
              <joint type="ball" pos="0 .05 0" damping=".02"/>
              <geom type="capsule" fromto="0 0 0 .1 .1 .1" size=".02"/>
              <body pos=".1 .1 .1" gravcomp="-.5"><geom size=".03"/></body>
            </body>
          </body>
        </body>
      </worldbody>
      <actuator><motor joint="a"/><position joint="b" kp="10" kv="1"/></actuator>
    </mujoco>"#;
    check_text(text, &[], |_| {});
    check_text(text, &[], |sim| {
        for (b, wrench) in sim.state.xfrc_applied.iter_mut().enumerate() {
            let x = b as f64;
            (wrench.linear.x, wrench.linear.y, wrench.linear.z) = (0.5 - x, 0.3, 0.2 * x);
            (wrench.angular.x, wrench.angular.y, wrench.angular.z) = (0.02, -0.03 * x, 0.01);
        }
    });
}

/// Coordinates whose arms change: spatial tendons around geoms and with pulleys, and actuators of them, of sites, of
/// slider-cranks and of ball and free joints.
fn curved(integrator: &str) -> String {
    format!(
        r#"<mujoco>
          <option integrator="{integrator}" timestep="0.004"/>
          <default><joint damping=".05"/></default>
          <worldbody>
            <site name="root" pos="0 0 .05"/>
            <body pos="0 0 .5">
              <joint name="ball" type="ball"/>
              <geom type="capsule" fromto="0 0 0 .2 0 0" size=".03"/>
              <site name="a0" pos=".05 0 .04" euler="10 20 0"/><site name="side" pos=".2 0 .1"/>
              <body pos=".2 0 0">
                <joint name="knee" axis="0 1 .1"/>
                <geom name="knee" type="cylinder" fromto="0 -.05 0 0 .05 0" size=".035"/>
                <geom type="capsule" fromto="0 0 0 .2 0 0" size=".02"/>
                <site name="a1" pos=".1 .01 .03"/><site name="a2" pos=".2 0 .02" euler="0 30 10"/>
                <body pos=".2 0 0">
                  <joint name="slide" type="slide" axis="1 0 .2" stiffness="20"/>
                  <geom name="tip" type="sphere" size=".03"/><site name="a3" pos=".02 .06 .0"/>
                </body>
              </body>
            </body>
            <body name="free" pos=".3 .4 .3">
              <joint name="free" type="free" damping=".2"/><geom type="box" size=".06 .05 .03"/>
              <site name="f" pos=".05 .02 .01" euler="5 10 20"/><site name="g" pos="-.05 0 .03"/>
            </body>
            <body pos="-.4 0 .3">
              <joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .1 0 0" size=".02"/>
              <site name="crank" pos=".1 0 0"/>
            </body>
            <body pos="-.1 0 .3">
              <joint name="slider" type="slide" axis="1 0 0"/><geom type="box" size=".03 .03 .03"/>
              <site name="slider" zaxis="1 0 0"/>
            </body>
          </worldbody>
          <tendon>
            <spatial name="wrapped" stiffness="30 40" damping=".3 .1" springlength=".1 .2" frictionloss=".2">
              <site site="a0"/><geom geom="knee" sidesite="side"/><site site="a1"/>
              <geom geom="tip"/><site site="a3"/>
            </spatial>
            <spatial name="pulley" limited="true" range="0 .3" damping=".2">
              <site site="f"/><site site="root"/><pulley divisor="2"/><site site="a2"/><site site="g"/>
            </spatial>
            <spatial name="long"><site site="g"/><site site="a3"/></spatial>
          </tendon>
          <equality><tendon tendon1="long" tendon2="pulley" polycoef="0 .3 .2" solref=".1 1"/></equality>
          <actuator>
            <position tendon="wrapped" kp="10" kv=".3" forcerange="-3 3"/>
            <muscle tendon="long" lengthrange=".1 1" force="2"/>
            <motor joint="ball" gear=".1 .2 .3"/>
            <position jointinparent="ball" gear=".1 -.2 .1" kp="2" kv=".1"/>
            <motor joint="free" gear=".3 .2 .5 .01 .02 .03"/>
            <velocity jointinparent="free" gear=".1 .2 .3 .1 .02 .03" kv=".1"/>
            <general site="f" gear=".2 .1 .4 .02 .03 .01" biastype="affine" biasprm="0 0 -.1" dyntype="filter" dynprm=".1"/>
            <position name="pose" site="a2" refsite="a0" gear=".4 .2 .3 .1 0 .2" kp="2" kv=".1"/>
            <intvelocity site="f" refsite="root" gear="0 .1 .2 0 .1 0" kp=".3" actrange="-1 1"/>
            <position cranksite="crank" slidersite="slider" cranklength=".3" kp="5" kv=".2"/>
          </actuator>
        </mujoco>"#
    )
}

#[test]
fn spatial_tendons_and_curved_transmissions() {
    let forces = ["equality", "friction_tendon", "limit_tendon"];
    for integrator in ["Euler", "implicitfast"] {
        check_text(&curved(integrator), &forces, |sim| sim.state.qvel[1] = 2.0);
    }
}

/// Sensors that follow from positions, also from velocities, and also from accelerations and actuators.
#[test]
fn sensors_of_motion() {
    let positions = r#"
      <magnetometer site="a1"/><jointpos joint="knee"/><ballquat joint="ball"/><tendonpos tendon="wrapped"/>
      <actuatorpos actuator="pose"/><subtreecom body="free"/><framequat objtype="site" objname="a2"/>
      <framepos objtype="site" objname="a2" reftype="site" refname="f"/><framexaxis objtype="site" objname="a2"/>
      <distance geom1="tip" geom2="knee" cutoff="1"/><rangefinder site="a1"/><clock/>"#;
    let velocities = r#"
      <velocimeter site="a1"/><gyro site="f"/><jointvel joint="knee"/><ballangvel joint="ball"/>
      <tendonvel tendon="long"/><actuatorvel actuator="pose"/><subtreelinvel body="free"/>
      <subtreeangmom body="free"/><framelinvel objtype="site" objname="a2"/>
      <frameangvel objtype="site" objname="a2" reftype="site" refname="f"/>"#;
    let forces = r#"
      <accelerometer site="a1"/><jointactuatorfrc joint="slider"/><tendonactuatorfrc tendon="long"/>
      <actuatorfrc actuator="pose"/><framelinacc objtype="site" objname="a2" cutoff="3"/>
      <frameangacc objtype="body" objname="free"/>"#;
    let mut sensors = String::new();
    for more in [positions, velocities, forces] {
        sensors += more;
        for integrator in ["Euler", "implicitfast"] {
            let sensors = format!("</actuator><sensor>{sensors}</sensor>");
            let text = curved(integrator).replace("</actuator>", &sensors);
            check_text(&text, &[], |sim| sim.state.qvel[1] = 2.0);
        }
    }
}

#[test]
fn limits_of_ball_joints() {
    let text = r#"<mujoco>
      <option timestep="0.004"/>
      <worldbody>
        <body>
          <joint type="ball" range="0 40" limited="true"/><geom type="capsule" fromto="0 0 0 .2 0 0" size=".03"/>
          <body pos=".2 0 0">
            <joint type="ball" range="0 20" limited="true" solreflimit=".05 1"/>
            <geom type="capsule" fromto="0 0 0 .2 .1 0" size=".03"/>
          </body>
        </body>
      </worldbody>
    </mujoco>"#;
    check_text(text, &["limit_joint"], |sim| sim.state.qvel[0] = 3.0);
}

/// Kinds of steps that need passes: the results are the same because they are the same.
#[test]
fn other_steps_need_passes() {
    let free = r#"<joint type="free"/>"#;
    // The site of a force sensor.
    let sensed = curved("Euler").replace(
        "</actuator>",
        r#"</actuator><sensor><accelerometer site="a1"/><force site="a1"/></sensor>"#,
    );
    let sensed = clench_formats::load_str(&sensed).expect("a model");
    check(sensed, RigidOptions::new(), 20);
    for integrator in ["implicit", "RK4", "discrete"] {
        check(mixed(integrator, free), RigidOptions::new(), 20);
    }
}
