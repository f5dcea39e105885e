//! The top level: compiler, options, defaults, keyframes, and user data.

use super::rule::{NONE, Rule, ignored, section};

pub(super) const RULES: &[Rule] = &[
    Rule {
        element: "mujoco",
        read: "model",
        children: "compiler option size statistic visual default extension asset worldbody deformable contact tendon \
            equality actuator sensor custom keyframe",
        ..NONE
    },
    Rule {
        element: "compiler",
        read: "angle eulerseq coordinate autolimits boundmass boundinertia settotalmass balanceinertia \
            inertiafromgeom inertiagrouprange alignfree assetdir meshdir strippath fitaabb discardvisual conflict \
            fusestatic",
        ignored: "texturedir usethread passthrough savecanonical savecompiled saveinertial",
        once: "lengthrange",
        ..NONE
    },
    Rule {
        element: "lengthrange",
        read: "accel interval inttotal maxforce mode timeconst timestep tolrange useexisting uselimit",
        ..NONE
    },
    Rule {
        element: "option",
        read: "timestep gravity wind magnetic density viscosity integrator cone jacobian solver impratio tolerance \
            ls_tolerance noslip_tolerance iterations ls_iterations noslip_iterations o_margin o_solref o_solimp \
            o_friction actuatorgroupdisable sleep_tolerance ccd_tolerance ccd_iterations",
        // For signed distance fields, which are rejected.
        ignored: "sdf_iterations sdf_initpoints",
        once: "flag",
        ..NONE
    },
    Rule {
        element: "flag",
        read: "constraint equality frictionloss limit contact spring damper gravity clampctrl warmstart \
            filterparent actuation refsafe island eulerdamp multiccd autoreset sensor sleep override \
            diagexact invdiscrete",
        // `nativeccd` and `midphase` select algorithms that find the same contacts. Energy, and the comparison of
        // `fwdinv`, are always available on request.
        ignored: "energy fwdinv midphase nativeccd",
        // `ipc` is a mode of flexes. `speculative` contacts, which MuJoCo 4.0 calls subject to change, sweep shapes
        // through a step.
        later: "ipc=disable speculative=disable",
        ..NONE
    },
    Rule {
        element: "size",
        read: "nkey nuser_body nuser_jnt nuser_geom nuser_site nuser_cam nuser_tendon nuser_actuator nuser_sensor",
        ignored: "memory njmax nconmax nstack nuserdata",
        ..NONE
    },
    ignored(
        "statistic",
        "meaninertia meanmass meansize extent center",
        "",
    ),
    Rule {
        element: "default",
        read: "class",
        children: "default",
        once: "mesh texture material joint geom site camera light pair equality tendon general motor position \
            velocity intvelocity orientation damper cylinder muscle pid dcmotor adhesion",
        ..NONE
    },
    section("extension", "", "plugin"),
    section("deformable", "skin", "flex"),
    // The table of sensors defines their kinds and attributes.
    section("sensor", "", "plugin"),
    section("keyframe", "key", ""),
    Rule {
        element: "key",
        read: "name time qpos qvel act plastic ctrl mpos mquat",
        ..NONE
    },
    section("custom", "numeric text tuple", ""),
    ignored("numeric", "name size data", ""),
    ignored("text", "name data", ""),
    ignored("tuple", "name", "element"),
    ignored("element", "objtype objname prm", ""),
];
