//! Actuators.

use super::{NONE, Rule, section};

/// What no shortcut of an actuator can do yet.
const SHORTCUT_LATER: &str =
    "nsample=0 interp delay=0 damping=0 armature=0 cranklength cranksite slidersite site refsite";

pub(super) const RULES: &[Rule] = &[
    section(
        "actuator",
        "general motor position velocity intvelocity damper cylinder muscle",
        "orientation pid adhesion dcmotor plugin",
    ),
    Rule {
        element: "general",
        read: "name class group joint jointinparent tendon gear lengthrange ctrlrange forcerange forcelimited ctrllimited \
            actlimited actrange actdim actearly dyntype dynprm gaintype gainprm biastype biasprm inheritrange",
        ignored: "user input",
        later: "nsample=0 interp delay=0 damping=0 armature=0 cranklength cranksite slidersite site refsite body \
            velrange=0 ffrange=0",
        ..NONE
    },
    Rule {
        element: "motor",
        read: "name class group joint jointinparent tendon gear lengthrange ctrlrange forcerange forcelimited ctrllimited",
        ignored: "user",
        later: SHORTCUT_LATER,
        ..NONE
    },
    Rule {
        element: "position",
        read: "name class group joint jointinparent tendon gear lengthrange ctrlrange forcerange forcelimited ctrllimited kp kv \
            dampratio timeconst inheritrange",
        ignored: "user",
        later: SHORTCUT_LATER,
        ..NONE
    },
    Rule {
        element: "velocity",
        read: "name class group joint jointinparent tendon gear lengthrange ctrlrange forcerange forcelimited ctrllimited kv",
        ignored: "user",
        later: SHORTCUT_LATER,
        ..NONE
    },
    Rule {
        element: "intvelocity",
        read: "name class group joint jointinparent tendon gear lengthrange ctrlrange forcerange forcelimited ctrllimited \
            actlimited actrange kp kv dampratio inheritrange",
        ignored: "user",
        later: SHORTCUT_LATER,
        ..NONE
    },
    Rule {
        element: "damper",
        read: "name class group joint jointinparent tendon gear lengthrange ctrlrange forcerange forcelimited kv",
        ignored: "user",
        later: SHORTCUT_LATER,
        ..NONE
    },
    Rule {
        element: "cylinder",
        read: "name class group joint jointinparent tendon gear lengthrange ctrlrange forcerange forcelimited ctrllimited \
            timeconst area diameter bias",
        ignored: "user",
        later: SHORTCUT_LATER,
        ..NONE
    },
    Rule {
        element: "muscle",
        read: "name class group joint jointinparent tendon gear lengthrange ctrlrange forcerange forcelimited \
            ctrllimited timeconst tausmooth range force scale lmin lmax vmax fpmax fvmax",
        ignored: "user",
        later: "nsample=0 interp delay=0 damping=0 armature=0 cranklength cranksite slidersite",
        ..NONE
    },
];
