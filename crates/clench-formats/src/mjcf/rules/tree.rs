//! The body tree.

use super::rule::{NONE, Rule, ignored, section};
use clench_builder::joint_attributes;

/// The content of the world, a body, a frame or a replica.
const IN_A_BODY: &str =
    "body frame replicate attach geom site camera light inertial joint freejoint";
const IN_A_BODY_LATER: &str = "plugin flexcomp";

/// The attributes of bodies that MuJoCo also accepts, without effect, on frames; replicas accept more of them.
const OF_BODIES: &str = "mocap gravcomp simple fuse sleep user";

pub(super) const RULES: &[Rule] = &[
    section("worldbody", IN_A_BODY, IN_A_BODY_LATER),
    Rule {
        element: "body",
        read: "name childclass pos quat axisangle euler xyaxes zaxis mocap gravcomp simple fuse sleep user",
        children: IN_A_BODY,
        later_children: IN_A_BODY_LATER,
        ..NONE
    },
    Rule {
        element: "frame",
        read: "name class childclass pos quat axisangle euler xyaxes zaxis scale scaling massscale",
        ignored: OF_BODIES,
        children: IN_A_BODY,
        later_children: IN_A_BODY_LATER,
        ..NONE
    },
    Rule {
        element: "replicate",
        read: "class childclass count offset euler sep",
        ignored: "name prefix pos quat axisangle xyaxes zaxis mocap gravcomp simple fuse sleep user",
        children: IN_A_BODY,
        later_children: IN_A_BODY_LATER,
        ..NONE
    },
    Rule {
        element: "attach",
        read: "model body frame prefix",
        ..NONE
    },
    Rule {
        element: "inertial",
        read: "pos mass diaginertia fullinertia quat axisangle euler xyaxes zaxis",
        ..NONE
    },
    Rule {
        element: "joint",
        read: concat!(
            "name class type group pos axis springdamper limited actuatorfrclimited solreflimit solimplimit \
            solreffriction solimpfriction stiffness range actuatorfrcrange actuatorgravcomp ref springref damping user",
            joint_attributes!()
        ),
        ..NONE
    },
    Rule {
        element: "freejoint",
        read: "name group align",
        ..NONE
    },
    Rule {
        element: "geom",
        read: "name class type contype conaffinity condim group priority size friction mass density shellinertia \
            solmix solref solimp margin gap surfacevel adhesion fluidshape fluidcoef fromto pos quat axisangle euler xyaxes zaxis mesh hfield fitscale material \
            rgba user",
        ignored: "castshadow",
        later_children: "plugin",
        ..NONE
    },
    Rule {
        element: "site",
        read: "name class type group pos fromto size quat axisangle euler xyaxes zaxis mesh user",
        ignored: "material rgba",
        ..NONE
    },
    Rule {
        element: "camera",
        read: "name class mode target pos quat axisangle euler xyaxes zaxis projection fovy resolution focal \
            focalpixel principal principalpixel sensorsize user",
        ignored: "ipd output",
        ..NONE
    },
    ignored(
        "light",
        "name class mode target pos dir type directional castshadow active bulbradius intensity range \
        attenuation cutoff softness exponent ambient diffuse specular texture",
        "",
    ),
];
