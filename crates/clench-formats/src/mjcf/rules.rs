//! The elements and attributes of MJCF (MuJoCo 4.0) and what this reader does with each.
//!
//! A rule belongs to an element name, or to `parent/name` where the parent gives the name a meaning of its own. An
//! attribute under `later` may carry the value with which it does nothing (`adhesion=0`); that value is accepted.

/// What an element may have; every field is a list of words.
#[derive(Debug)]
pub(crate) struct Rule {
    pub element: &'static str,
    /// Attributes that are read.
    pub read: &'static str,
    /// Attributes that do not act on motion.
    pub ignored: &'static str,
    /// Attributes that are not supported yet, each with the value that does nothing if there is one.
    pub later: &'static str,
    /// Children, in any number.
    pub children: &'static str,
    /// Children of which there can be only one.
    pub once: &'static str,
    /// Children that are not supported yet.
    pub later_children: &'static str,
}

pub(crate) const NONE: Rule = Rule {
    element: "",
    read: "",
    ignored: "",
    later: "",
    children: "",
    once: "",
    later_children: "",
};

/// An element that only matters to the eye, to memory or to a user's program.
const fn ignored(element: &'static str, attributes: &'static str, children: &'static str) -> Rule {
    Rule {
        element,
        ignored: attributes,
        children,
        ..NONE
    }
}

/// A section: it holds elements and has no attributes.
const fn section(
    element: &'static str,
    children: &'static str,
    later_children: &'static str,
) -> Rule {
    Rule {
        element,
        children,
        later_children,
        ..NONE
    }
}

/// What stands in the world, a body, a frame or a replica.
const IN_A_BODY: &str = "body frame replicate geom site camera light inertial joint freejoint";
const IN_A_BODY_LATER: &str = "attach plugin flexcomp";
/// What no shortcut of an actuator can do yet.
const SHORTCUT_LATER: &str =
    "nsample=0 interp delay=0 damping=0 armature=0 cranklength cranksite slidersite site refsite";

/// One rule an element.
pub(crate) const RULES: &[Rule] = &[
    // Top level.
    Rule {
        element: "mujoco",
        ignored: "model",
        children: "compiler option size statistic visual default extension asset worldbody deformable contact tendon \
            equality actuator sensor custom keyframe",
        ..NONE
    },
    Rule {
        element: "compiler",
        read: "angle eulerseq coordinate autolimits boundmass boundinertia settotalmass balanceinertia \
            inertiafromgeom inertiagrouprange alignfree assetdir meshdir strippath fitaabb discardvisual",
        ignored: "texturedir usethread conflict passthrough savecanonical savecompiled saveinertial",
        later: "fusestatic=false",
        once: "lengthrange",
        ..NONE
    },
    ignored(
        "lengthrange",
        "accel interval inttotal maxforce mode timeconst timestep tolrange useexisting uselimit",
        "",
    ),
    Rule {
        element: "option",
        read: "timestep gravity wind magnetic density viscosity integrator cone jacobian solver impratio tolerance \
            ls_tolerance noslip_tolerance iterations ls_iterations noslip_iterations o_margin o_solref o_solimp \
            o_friction actuatorgroupdisable",
        // MuJoCo's general collision stops at a tolerance or after so many iterations; ours goes on to the last digit.
        // The rest is for sensors, signed distance fields and sleep, which are refused where a file asks for them.
        ignored: "ccd_tolerance ccd_iterations sdf_iterations sdf_initpoints sleep_tolerance",
        once: "flag",
        ..NONE
    },
    Rule {
        element: "flag",
        read: "constraint equality frictionloss limit contact spring damper gravity clampctrl warmstart \
            filterparent actuation refsafe island eulerdamp multiccd autoreset sensor override",
        // `nativeccd` and `midphase` choose between algorithms that look for the same contacts.
        ignored: "energy fwdinv midphase nativeccd",
        later: "diagexact=disable invdiscrete=disable ipc=disable sleep=disable speculative=disable",
        ..NONE
    },
    ignored(
        "size",
        "memory njmax nconmax nstack nuserdata nkey nuser_body nuser_jnt nuser_geom nuser_site nuser_cam \
        nuser_tendon nuser_actuator nuser_sensor",
        "",
    ),
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
            velocity intvelocity damper cylinder",
        later_children: "orientation pid muscle adhesion dcmotor",
        ..NONE
    },
    section("extension", "", "plugin"),
    section("deformable", "skin", "flex"),
    // Which kinds of sensor there are, and with which attributes, says the table of sensors.
    section("sensor", "", "camprojection contact tactile plugin"),
    // The tree of bodies.
    section("worldbody", IN_A_BODY, IN_A_BODY_LATER),
    Rule {
        element: "body",
        read: "name childclass pos quat axisangle euler xyaxes zaxis mocap gravcomp simple",
        ignored: "user sleep fuse",
        children: IN_A_BODY,
        later_children: IN_A_BODY_LATER,
        ..NONE
    },
    Rule {
        element: "frame",
        read: "class childclass pos quat axisangle euler xyaxes zaxis",
        ignored: "name",
        later: "scale=1 scaling massscale=1",
        children: IN_A_BODY,
        later_children: IN_A_BODY_LATER,
        ..NONE
    },
    Rule {
        element: "replicate",
        read: "class childclass count offset euler sep",
        ignored: "name",
        children: IN_A_BODY,
        later_children: IN_A_BODY_LATER,
        ..NONE
    },
    Rule {
        element: "inertial",
        read: "pos mass diaginertia fullinertia quat axisangle euler xyaxes zaxis",
        ..NONE
    },
    Rule {
        element: "joint",
        read: "name class type group pos axis springdamper limited actuatorfrclimited solreflimit solimplimit \
            solreffriction solimpfriction stiffness range actuatorfrcrange actuatorgravcomp margin ref springref \
            armature damping frictionloss",
        ignored: "user",
        later: "springyield=0",
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
            solmix solref solimp margin gap fromto pos quat axisangle euler xyaxes zaxis mesh hfield fitscale material \
            rgba",
        ignored: "castshadow user fluidcoef",
        later: "fluidshape=none surfacevel=0 adhesion=0",
        later_children: "plugin",
        ..NONE
    },
    Rule {
        element: "site",
        read: "name class type group pos fromto size quat axisangle euler xyaxes zaxis",
        ignored: "material rgba user",
        later: "mesh",
        ..NONE
    },
    ignored(
        "camera",
        "name class mode target pos quat axisangle euler xyaxes zaxis projection fovy ipd resolution output \
        focal focalpixel principal principalpixel sensorsize user",
        "",
    ),
    ignored(
        "light",
        "name class mode target pos dir type directional castshadow active bulbradius intensity range \
        attenuation cutoff softness exponent ambient diffuse specular texture",
        "",
    ),
    // Sections that name elements of the tree.
    section("contact", "pair exclude", ""),
    Rule {
        element: "pair",
        read: "name class geom1 geom2 condim friction solref solreffriction solimp margin gap",
        later: "adhesion=0",
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
    section("tendon", "fixed", "spatial"),
    Rule {
        element: "fixed",
        read: "name class limited range actuatorfrclimited actuatorfrcrange margin stiffness damping frictionloss \
            springlength solreflimit solimplimit solreffriction solimpfriction",
        ignored: "group user",
        later: "armature=0 springyield=0",
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
        read: "limited range actuatorfrclimited actuatorfrcrange margin stiffness damping frictionloss springlength \
            solreflimit solimplimit solreffriction solimpfriction",
        ignored: "group user width material rgba",
        later: "armature=0 springyield=0",
        ..NONE
    },
    section(
        "actuator",
        "general motor position velocity intvelocity damper cylinder",
        "orientation pid muscle adhesion dcmotor plugin",
    ),
    Rule {
        element: "general",
        read: "name class group joint jointinparent tendon gear ctrlrange forcerange forcelimited ctrllimited \
            actlimited actrange actdim actearly dyntype dynprm gaintype gainprm biastype biasprm inheritrange",
        ignored: "user lengthrange input",
        later: "nsample=0 interp delay=0 damping=0 armature=0 cranklength cranksite slidersite site refsite body \
            velrange=0 ffrange=0",
        ..NONE
    },
    Rule {
        element: "motor",
        read: "name class group joint jointinparent tendon gear ctrlrange forcerange forcelimited ctrllimited",
        ignored: "user lengthrange",
        later: SHORTCUT_LATER,
        ..NONE
    },
    Rule {
        element: "position",
        read: "name class group joint jointinparent tendon gear ctrlrange forcerange forcelimited ctrllimited kp kv \
            dampratio timeconst inheritrange",
        ignored: "user lengthrange",
        later: SHORTCUT_LATER,
        ..NONE
    },
    Rule {
        element: "velocity",
        read: "name class group joint jointinparent tendon gear ctrlrange forcerange forcelimited ctrllimited kv",
        ignored: "user lengthrange",
        later: SHORTCUT_LATER,
        ..NONE
    },
    Rule {
        element: "intvelocity",
        read: "name class group joint jointinparent tendon gear ctrlrange forcerange forcelimited ctrllimited \
            actlimited actrange kp kv dampratio inheritrange",
        ignored: "user lengthrange",
        later: SHORTCUT_LATER,
        ..NONE
    },
    Rule {
        element: "damper",
        read: "name class group joint jointinparent tendon gear ctrlrange forcerange forcelimited kv",
        ignored: "user lengthrange",
        later: SHORTCUT_LATER,
        ..NONE
    },
    Rule {
        element: "cylinder",
        read: "name class group joint jointinparent tendon gear ctrlrange forcerange forcelimited ctrllimited \
            timeconst area diameter bias",
        ignored: "user lengthrange",
        later: SHORTCUT_LATER,
        ..NONE
    },
    section("keyframe", "key", ""),
    Rule {
        element: "key",
        read: "name time qpos qvel act ctrl mpos mquat",
        later: "plastic",
        ..NONE
    },
    // What is only seen, or only for a user's program.
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
    ignored(
        "map",
        "stiffness stiffnessrot force torque alpha fogstart fogend znear zfar haze shadowclip shadowscale \
        actuatortendon",
        "",
    ),
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
    section("asset", "texture material mesh hfield skin", "model"),
    ignored(
        "texture",
        "name class type colorspace content_type embed file gridsize gridlayout fileright fileleft fileup \
        filedown filefront fileback builtin rgb1 rgb2 mark markrgb random width height hflip vflip nchannel",
        "",
    ),
    Rule {
        element: "material",
        read: "name class rgba",
        ignored: "texture texrepeat texuniform emission specular shininess reflectance metallic roughness",
        children: "layer",
        ..NONE
    },
    ignored("layer", "texture role", ""),
    Rule {
        element: "mesh",
        read: "name class file content_type builtin params vertex face refpos refquat scale inertia maxhullvert \
            material",
        ignored: "normal texcoord smoothnormal",
        later_children: "plugin",
        ..NONE
    },
    Rule {
        element: "default/mesh",
        read: "inertia maxhullvert scale",
        ..NONE
    },
    // A skin is drawn over bodies and follows them.
    ignored(
        "skin",
        "name file vertex texcoord face inflate material rgba group",
        "bone",
    ),
    ignored("bone", "body bindpos bindquat vertid vertweight", ""),
    Rule {
        element: "hfield",
        read: "name file content_type nrow ncol elevation size",
        ..NONE
    },
    section("custom", "numeric text tuple", ""),
    ignored("numeric", "name size data", ""),
    ignored("text", "name data", ""),
    ignored("tuple", "name", "element"),
    ignored("element", "objtype objname prm", ""),
];
