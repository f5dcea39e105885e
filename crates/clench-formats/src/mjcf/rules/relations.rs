//! Sections that name elements of the tree, but for actuators.

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
    section("equality", "connect weld joint tendon", "flex flexstrain"),
    Rule {
        element: "connect",
        read: "name class active solref solimp body1 body2 anchor site1 site2",
        ..NONE
    },
    Rule {
        element: "weld",
        read: "name class active solref solimp body1 body2 anchor relpose site1 site2 torquescale",
        ..NONE
    },
    Rule {
        element: "equality/joint",
        read: "name class active solref solimp joint1 joint2 polycoef",
        ..NONE
    },
    Rule {
        element: "equality/tendon",
        read: "name class active solref solimp tendon1 tendon2 polycoef",
        ..NONE
    },
    Rule {
        element: "default/equality",
        read: "active solref solimp",
        ..NONE
    },
    section("tendon", "spatial fixed", ""),
    Rule {
        element: "spatial",
        read: "name class limited range actuatorfrclimited actuatorfrcrange margin stiffness damping armature \
            frictionloss springlength solreflimit solimplimit solreffriction solimpfriction",
        ignored: "group user width material rgba",
        later: "springyield=0",
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
            frictionloss springlength solreflimit solimplimit solreffriction solimpfriction",
        ignored: "group user",
        later: "springyield=0",
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
            frictionloss springlength solreflimit solimplimit solreffriction solimpfriction",
        ignored: "group user width material rgba",
        later: "springyield=0",
        ..NONE
    },
];
