//! Actuators.

use super::rule::{NONE, Rule, section};

pub(super) const RULES: &[Rule] = &[
    section(
        "actuator",
        "general motor position velocity intvelocity orientation damper cylinder muscle pid dcmotor adhesion",
        "plugin",
    ),
    Rule {
        element: "general",
        read: "name class group nsample interp delay joint jointinparent tendon body site refsite cranksite slidersite \
            cranklength gear damping armature lengthrange ctrlrange forcerange forcelimited ctrllimited \
            actlimited actrange actdim actearly dyntype dynprm gaintype gainprm biastype biasprm inheritrange \
            input velrange ffrange user",
        ..NONE
    },
    Rule {
        element: "motor",
        read: "name class group nsample interp delay joint jointinparent tendon site refsite cranksite slidersite \
            cranklength gear damping armature lengthrange ctrlrange forcerange forcelimited ctrllimited user",
        ..NONE
    },
    Rule {
        element: "position",
        read: "name class group nsample interp delay joint jointinparent tendon site refsite cranksite slidersite \
            cranklength gear damping armature lengthrange ctrlrange forcerange forcelimited ctrllimited kp kv \
            dampratio timeconst inheritrange user",
        ..NONE
    },
    Rule {
        element: "velocity",
        read: "name class group nsample interp delay joint jointinparent tendon site refsite cranksite slidersite \
            cranklength gear damping armature lengthrange ctrlrange forcerange forcelimited ctrllimited kv user",
        ..NONE
    },
    Rule {
        element: "intvelocity",
        read: "name class group nsample interp delay joint jointinparent tendon site refsite cranksite slidersite \
            cranklength gear damping armature lengthrange ctrlrange forcerange forcelimited ctrllimited \
            actlimited actrange kp kv dampratio inheritrange user",
        ..NONE
    },
    Rule {
        element: "orientation",
        read: "name class group nsample interp delay joint site refsite ctrlrange forcerange forcelimited kp kv \
            dampratio input user",
        ..NONE
    },
    Rule {
        element: "damper",
        read: "name class group nsample interp delay joint jointinparent tendon site refsite cranksite slidersite \
            cranklength gear damping armature lengthrange ctrlrange forcerange forcelimited kv user",
        ..NONE
    },
    Rule {
        element: "cylinder",
        read: "name class group nsample interp delay joint jointinparent tendon site refsite cranksite slidersite \
            cranklength gear damping armature lengthrange ctrlrange forcerange forcelimited ctrllimited \
            timeconst area diameter bias user",
        ..NONE
    },
    Rule {
        element: "muscle",
        read: "name class group nsample interp delay joint jointinparent tendon cranksite slidersite \
            cranklength gear damping armature lengthrange ctrlrange forcerange forcelimited \
            ctrllimited timeconst tausmooth range force scale lmin lmax vmax fpmax fvmax user",
        ..NONE
    },
    Rule {
        element: "pid",
        read: "name class group nsample interp delay joint jointinparent tendon site refsite cranksite slidersite \
            cranklength gear damping armature lengthrange ctrlrange forcerange forcelimited \
            ctrllimited kp kv dampratio ki imax slewmax input posrange velrange ffrange inheritrange user",
        ..NONE
    },
    Rule {
        element: "dcmotor",
        read: "name class group nsample interp delay joint jointinparent tendon site refsite cranksite slidersite \
            cranklength gear damping armature lengthrange ctrlrange ctrllimited motorconst resistance \
            nominal saturation inductance cogging controller thermal lugre input user",
        ..NONE
    },
    Rule {
        element: "adhesion",
        read: "name class group nsample interp delay body ctrlrange forcerange forcelimited gain user",
        ..NONE
    },
];
