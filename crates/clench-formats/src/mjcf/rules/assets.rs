//! Assets.

use super::rule::{NONE, Rule, ignored, section};

pub(super) const RULES: &[Rule] = &[
    section("asset", "texture material mesh hfield skin model", ""),
    Rule {
        element: "model",
        read: "name file content_type",
        ..NONE
    },
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
        read: "name class file content_type builtin params vertex face normal refpos refquat scale inertia \
            maxhullvert material",
        ignored: "texcoord smoothnormal",
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
];
