//! Visual settings.

use super::rule::{NONE, Rule, ignored};

pub(super) const RULES: &[Rule] = &[
    Rule {
        element: "visual",
        once: "global quality headlight map scale rgba",
        ..NONE
    },
    ignored(
        "global",
        "cameraid orthographic fovy ipd azimuth elevation linewidth glow offwidth offheight realtime \
        ellipsoidinertia bvactive",
        "",
    ),
    ignored(
        "quality",
        "shadowsize offsamples numslices numstacks numquads",
        "",
    ),
    ignored("headlight", "ambient diffuse specular active", ""),
    Rule {
        element: "map",
        read: "znear",
        ignored: "stiffness stiffnessrot force torque alpha fogstart fogend zfar haze shadowclip shadowscale \
            actuatortendon",
        ..NONE
    },
    ignored(
        "scale",
        "forcewidth contactwidth contactheight connect com camera light selectpoint jointlength jointwidth \
        actuatorlength actuatorwidth framelength framewidth constraint slidercrank frustum",
        "",
    ),
    ignored(
        "rgba",
        "fog haze force inertia joint actuator actuatornegative actuatorpositive com camera light selectpoint \
        connect contactpoint contactforce contactfriction contacttorque contactgap rangefinder constraint \
        slidercrank crankbroken frustum bv bvactive",
        "",
    ),
];
