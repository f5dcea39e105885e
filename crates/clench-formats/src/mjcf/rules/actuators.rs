//! Actuators.

use super::rule::{NONE, Rule, section};

/// Lists the attributes of an actuator: common ones, those of the named groups, and its own.
macro_rules! reads {
    ($($group:ident)*: $own:literal) => {
        concat!("name class group nsample interp delay ctrlrange user ", $(group!($group), " ",)* $own)
    };
}

macro_rules! group {
    (moves) => {
        "joint jointinparent tendon cranksite slidersite cranklength gear damping armature lengthrange"
    };
    (sites) => {
        "site refsite"
    };
    (forces) => {
        "forcerange forcelimited"
    };
}

const fn actuator(element: &'static str, read: &'static str) -> Rule {
    Rule {
        element,
        read,
        ..NONE
    }
}

pub(super) const RULES: &[Rule] = &[
    section(
        "actuator",
        "general motor position velocity intvelocity orientation damper cylinder muscle pid dcmotor adhesion",
        "plugin",
    ),
    actuator(
        "general",
        reads!(moves sites forces: "body ctrllimited actlimited actrange actdim actearly dyntype dynprm \
             gaintype gainprm biastype biasprm inheritrange input velrange ffrange"),
    ),
    actuator("motor", reads!(moves sites forces: "ctrllimited")),
    actuator(
        "position",
        reads!(moves sites forces: "ctrllimited kp kv dampratio timeconst inheritrange"),
    ),
    actuator("velocity", reads!(moves sites forces: "ctrllimited kv")),
    actuator(
        "intvelocity",
        reads!(moves sites forces: "ctrllimited actlimited actrange kp kv dampratio inheritrange"),
    ),
    actuator(
        "orientation",
        reads!(sites forces: "joint kp kv dampratio input"),
    ),
    actuator("damper", reads!(moves sites forces: "kv")),
    actuator(
        "cylinder",
        reads!(moves sites forces: "ctrllimited timeconst area diameter bias"),
    ),
    actuator(
        "muscle",
        reads!(moves forces: "ctrllimited timeconst tausmooth range force scale lmin lmax vmax fpmax fvmax"),
    ),
    actuator(
        "pid",
        reads!(moves sites forces: "ctrllimited kp kv dampratio ki imax slewmax input posrange velrange ffrange \
             inheritrange"),
    ),
    actuator(
        "dcmotor",
        reads!(moves sites: "ctrllimited motorconst resistance nominal saturation inductance cogging controller \
             thermal lugre input"),
    ),
    actuator("adhesion", reads!(forces: "body gain")),
];
