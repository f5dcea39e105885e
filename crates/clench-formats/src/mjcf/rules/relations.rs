//! Sections that refer to elements of the tree, except actuators.

use super::rule::{NONE, Rule, section};

pub(super) const RULES: &[Rule] = &[
    section("contact", "pair exclude", ""),
    Rule {
        element: "pair",
        read: "name class geom1 geom2 condim friction solref solreffriction solimp margin gap adhesion",
        ..NONE
    },
    Rule {
        element: "exclude",
        read: "name body1 body2",
        ..NONE
    },
    section("tendon", "spatial fixed", ""),
    Rule {
        element: "spatial",
        read: "name class limited range actuatorfrclimited actuatorfrcrange margin stiffness damping armature \
            frictionloss springlength springyield solreflimit solimplimit solreffriction solimpfriction user",
        ignored: "group width material rgba",
        children: "site geom pulley",
        ..NONE
    },
    Rule {
        element: "spatial/site",
        read: "site",
        ..NONE
    },
    Rule {
        element: "spatial/geom",
        read: "geom sidesite",
        ..NONE
    },
    Rule {
        element: "pulley",
        read: "divisor",
        ..NONE
    },
    Rule {
        element: "fixed",
        read: "name class limited range actuatorfrclimited actuatorfrcrange margin stiffness damping armature \
            frictionloss springlength springyield solreflimit solimplimit solreffriction solimpfriction user",
        ignored: "group",
        children: "joint",
        ..NONE
    },
    Rule {
        element: "fixed/joint",
        read: "joint coef",
        ..NONE
    },
    Rule {
        element: "default/tendon",
        read: "limited range actuatorfrclimited actuatorfrcrange margin stiffness damping armature \
            frictionloss springlength springyield solreflimit solimplimit solreffriction solimpfriction user",
        ignored: "group width material rgba",
        ..NONE
    },
];
