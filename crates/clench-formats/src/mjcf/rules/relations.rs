//! Sections that refer to elements of the tree, except actuators.

use super::rule::{NONE, Rule, section};
use clench_builder::tendon_attributes;

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
        read: concat!(
            "name class limited range actuatorfrclimited actuatorfrcrange stiffness damping springlength solreflimit solimplimit \
            solreffriction solimpfriction user",
            tendon_attributes!()
        ),
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
        read: concat!(
            "name class limited range actuatorfrclimited actuatorfrcrange stiffness damping springlength solreflimit solimplimit \
            solreffriction solimpfriction user",
            tendon_attributes!()
        ),
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
        read: concat!(
            "limited range actuatorfrclimited actuatorfrcrange stiffness damping springlength solreflimit solimplimit \
            solreffriction solimpfriction user",
            tendon_attributes!()
        ),
        ignored: "group width material rgba",
        ..NONE
    },
];
