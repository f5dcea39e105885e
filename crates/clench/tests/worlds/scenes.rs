//! Scenes with the same joints, actuators and sensors, and different geoms.

use clench::{Model, load_str};
use std::sync::Arc;

/// A tetrahedron, an octahedron and a wedge.
const MESHES: &str = r#"
    <mesh name="tetrahedron" vertex=".1 .1 .1  .1 -.1 -.1  -.1 .1 -.1  -.1 -.1 .1"/>
    <mesh name="octahedron" vertex=".12 0 0  -.12 0 0  0 .12 0  0 -.12 0  0 0 .12  0 0 -.12"/>
    <mesh name="wedge" vertex="-.1 -.1 -.1  .1 -.1 -.1  .1 .1 -.1  -.1 .1 -.1  -.1 -.1 .05  -.1 .1 .05"/>"#;

/// Returns a scene with a hand above an object: the geoms of the object, and those of the world.
pub fn scene(name: &str, object: &str, world: &str) -> String {
    format!(
        r#"<mujoco model="{name}">
          <asset>{MESHES}
            <hfield name="waves" nrow="5" ncol="5" size="1 1 .1 .1"
                elevation="0 1 0 1 0  1 0 1 0 1  0 1 0 1 0  1 0 1 0 1  0 1 0 1 0"/>
            <hfield name="hills" nrow="3" ncol="3" size="1 1 .15 .1" elevation="0 0 1  0 1 0  1 0 0"/>
          </asset>
          <worldbody>
            {world}
            <body name="hand" pos="0 0 .62">
              <joint name="lift" type="slide" axis="0 0 1" damping="3" range="-.3 .3"/>
              <joint name="turn" type="hinge" axis="0 0 1" damping=".1"/>
              <geom name="palm" type="box" size=".15 .1 .02" mass=".5"/>
              <geom type="capsule" fromto=".13 0 0 .13 0 -.2" size=".02" mass=".1"/>
              <geom type="capsule" fromto="-.13 0 0 -.13 0 -.2" size=".02" mass=".1"/>
              <site name="eye" pos="0 0 -.03" euler="180 0 0" size=".1"/>
            </body>
            <body name="{name}" pos="0 0 .35"><freejoint name="object"/>{object}</body>
          </worldbody>
          <actuator>
            <position name="lift" joint="lift" kp="40"/>
            <motor name="turn" joint="turn" gear=".2"/>
          </actuator>
          <sensor>
            <rangefinder name="range" site="eye"/>
            <touch name="touch" site="eye"/>
            <framepos name="place" objtype="geom" objname="palm"/>
            <contact name="hits" body1="hand" data="found force" num="2" reduce="mindist"/>
            <velocimeter name="speed" site="eye"/>
          </sensor>
        </mujoco>"#
    )
}

const FLOOR: &str = r#"<geom name="floor" type="plane" size="3 3 .1"/>"#;

/// Returns models that differ in shapes, meshes, height fields, numbers of geoms, masses and frames.
pub fn models() -> Vec<Arc<Model>> {
    let steps = r#"<geom name="floor" type="plane" size="3 3 .1" pos="0 0 -.1" friction=".6 .01 .001"/>
        <geom type="box" size=".2 .3 .05" pos=".2 0 0"/><geom type="box" size=".2 .3 .1" pos="-.25 0 0"/>"#;
    let waves = r#"<geom type="hfield" hfield="waves"/>"#;
    let hills = r#"<geom type="hfield" hfield="hills" pos="0 0 -.05"/>"#;
    let scenes = [
        scene(
            "box",
            r#"<geom type="box" size=".08 .06 .05" mass=".4"/>"#,
            FLOOR,
        ),
        scene(
            "ball",
            r#"<geom type="sphere" size=".09" mass=".2" condim="6" friction="1 .02 .01"/>"#,
            FLOOR,
        ),
        scene(
            "tetrahedron",
            r#"<geom type="mesh" mesh="tetrahedron" mass=".3"/>"#,
            FLOOR,
        ),
        scene(
            "octahedron",
            r#"<geom type="mesh" mesh="octahedron" pos=".02 0 0" mass=".3"/>"#,
            waves,
        ),
        scene(
            "barbell",
            r#"<geom type="sphere" size=".06" pos=".1 0 0"/><geom type="sphere" size=".06" pos="-.1 0 0"/>
               <geom type="capsule" size=".02" fromto=".1 0 0 -.1 0 0"/>"#,
            hills,
        ),
        scene(
            "toy",
            r#"<geom type="mesh" mesh="wedge" mass=".2"/><geom type="mesh" mesh="octahedron" pos="0 0 .1" mass=".1"/>
               <geom type="cylinder" size=".05 .04" pos=".1 .05 0" euler="90 20 0" mass=".1"/>"#,
            steps,
        ),
        scene(
            "nothing",
            r#"<inertial pos="0 0 .01" mass="1" diaginertia=".01 .02 .02"/>"#,
            FLOOR,
        ),
        scene(
            "egg",
            r#"<geom type="ellipsoid" size=".09 .06 .06" solref=".01 1" margin=".01"/>"#,
            waves,
        ),
        scene(
            "wedge",
            r#"<geom type="mesh" mesh="wedge" euler="10 20 30" mass=".3"/>"#,
            hills,
        ),
    ];
    let load = |text: &String| Arc::new(load_str(text).expect("valid"));
    scenes.iter().map(load).collect()
}
