//! Tendons, transmissions, limits and equalities, and sensors of their motion.

use super::check_text;

/// Fixed tendons with springs, dampers, inertia, friction and limits, with actuators, on branches of a tree, and
/// equalities that make joints and tendons follow others by curves.
pub(super) fn fingers(integrator: &str) -> String {
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
    for integrator in ["Euler", "implicitfast", "RK4"] {
        check_text(&fingers(integrator), &forces, |_| {});
    }
}

/// Coordinates whose arms change: spatial tendons around geoms and with pulleys, and actuators of them, of sites, of
/// slider-cranks and of ball and free joints.
pub(super) fn curved(integrator: &str) -> String {
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
    for integrator in ["Euler", "implicitfast", "RK4"] {
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
        for integrator in ["Euler", "implicitfast", "RK4"] {
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
