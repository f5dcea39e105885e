//! Actuators.

use super::{NONE, Rule, section};

/// What no shortcut of an actuator can do yet.
const SHORTCUT_LATER: &str = "cranklength cranksite slidersite site refsite";

pub(super) const RULES: &[Rule] = &[
    section(
        "actuator",
        "general motor position velocity intvelocity damper cylinder muscle pid dcmotor",
        "orientation adhesion plugin",
    ),
    Rule {
        element: "general",
        read: "name class group nsample interp delay joint jointinparent tendon gear damping armature lengthrange ctrlrange forcerange forcelimited ctrllimited \
            actlimited actrange actdim actearly dyntype dynprm gaintype gainprm biastype biasprm inheritrange \
            input velrange ffrange",
        ignored: "user",
        later: "cranklength cranksite slidersite site refsite body",
        ..NONE
    },
    Rule {
        element: "motor",
        read: "name class group nsample interp delay joint jointinparent tendon gear damping armature lengthrange ctrlrange forcerange forcelimited ctrllimited",
        ignored: "user",
        later: SHORTCUT_LATER,
        ..NONE
    },
    Rule {
        element: "position",
        read: "name class group nsample interp delay joint jointinparent tendon gear damping armature lengthrange ctrlrange forcerange forcelimited ctrllimited kp kv \
            dampratio timeconst inheritrange",
        ignored: "user",
        later: SHORTCUT_LATER,
        ..NONE
    },
    Rule {
        element: "velocity",
        read: "name class group nsample interp delay joint jointinparent tendon gear damping armature lengthrange ctrlrange forcerange forcelimited ctrllimited kv",
        ignored: "user",
        later: SHORTCUT_LATER,
        ..NONE
    },
    Rule {
        element: "intvelocity",
        read: "name class group nsample interp delay joint jointinparent tendon gear damping armature lengthrange ctrlrange forcerange forcelimited ctrllimited \
            actlimited actrange kp kv dampratio inheritrange",
        ignored: "user",
        later: SHORTCUT_LATER,
        ..NONE
    },
    Rule {
        element: "damper",
        read: "name class group nsample interp delay joint jointinparent tendon gear damping armature lengthrange ctrlrange forcerange forcelimited kv",
        ignored: "user",
        later: SHORTCUT_LATER,
        ..NONE
    },
    Rule {
        element: "cylinder",
        read: "name class group nsample interp delay joint jointinparent tendon gear damping armature lengthrange ctrlrange forcerange forcelimited ctrllimited \
            timeconst area diameter bias",
        ignored: "user",
        later: SHORTCUT_LATER,
        ..NONE
    },
    Rule {
        element: "muscle",
        read: "name class group nsample interp delay joint jointinparent tendon gear damping armature lengthrange ctrlrange forcerange forcelimited \
            ctrllimited timeconst tausmooth range force scale lmin lmax vmax fpmax fvmax",
        ignored: "user",
        later: "cranklength cranksite slidersite",
        ..NONE
    },
    Rule {
        element: "pid",
        read: "name class group nsample interp delay joint jointinparent tendon gear damping armature lengthrange ctrlrange forcerange forcelimited \
            ctrllimited kp kv dampratio ki imax slewmax input posrange velrange ffrange inheritrange",
        ignored: "user",
        later: SHORTCUT_LATER,
        ..NONE
    },
    Rule {
        element: "dcmotor",
        read: "name class group nsample interp delay joint jointinparent tendon gear damping armature lengthrange ctrlrange ctrllimited motorconst resistance \
            nominal saturation inductance cogging controller thermal lugre input",
        ignored: "user",
        later: SHORTCUT_LATER,
        ..NONE
    },
];
