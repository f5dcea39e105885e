"""Attributes that Clench accepts and ignores, with values that MuJoCo accepts and that are not the default.

The test of ignored attributes checks that none of them affects MuJoCo's motion; random models contain some of them.
`SCENE` has every element that such an attribute can be on.
"""

import pathlib
import xml.etree.ElementTree as ET

SCENE = pathlib.Path(__file__).resolve().parent / "harmless.xml"

POSE = {"pos": "0.1 0.2 0.3", "quat": "0.5 0.1 0.2 0.3", "axisangle": "1 0 0 20", "euler": "10 20 30", "xyaxes": "0 1 0 -1 0 0", "zaxis": "1 1 0"}
USER = {"user": "1 2"}
OF_BODIES = {**USER, "mocap": "true", "gravcomp": "1", "simple": "false", "fuse": "false", "sleep": "never"}
TENDON = {"group": "2", "user": "1 2"}
COLOUR = "0.1 0.2 0.3 0.4"

SENSORS = (
    "touch accelerometer velocimeter gyro force torque magnetometer rangefinder camprojection jointpos jointvel jointactuatorfrc ballquat "
    "ballangvel jointlimitpos jointlimitvel jointlimitfrc tendonpos tendonvel tendonactuatorfrc tendonlimitpos tendonlimitvel "
    "tendonlimitfrc actuatorpos actuatorvel actuatorfrc framepos framequat framexaxis frameyaxis framezaxis framelinvel frameangvel "
    "framelinacc frameangacc subtreecom subtreelinvel subtreeangmom insidesite distance normal fromto contact e_potential e_kinetic clock"
).split()

VALUES = {
    "compiler": {
        "texturedir": "textures",
        "usethread": "false",
        "conflict": "merge",
        "passthrough": "textures",
        "savecanonical": "false",
        "savecompiled": "false",
        "saveinertial": "true",
    },
    "option": {
        "ccd_tolerance": "1e-4",
        "ccd_iterations": "1",
        "sdf_iterations": "5",
        "sdf_initpoints": "20",
    },
    "flag": {
        "energy": "enable",
        "fwdinv": "enable",
        "invdiscrete": "enable",
        "midphase": "disable",
        "nativeccd": "disable",
    },
    "size": {
        "memory": "20M",
        "njmax": "500",
        "nconmax": "100",
        "nstack": "100000",
        "nuserdata": "3",
        "nkey": "2",
        **{f"nuser_{kind}": "4" for kind in "body jnt geom site cam tendon actuator sensor".split()},
    },
    "statistic": {"meaninertia": "2", "meanmass": "3", "meansize": "0.5", "extent": "2", "center": "1 2 3"},
    "body": {**USER, "fuse": "false"},
    "frame": {**OF_BODIES, "name": "named_frame"},
    "replicate": {**{name: value for name, value in POSE.items() if name != "euler"}, **OF_BODIES, "name": "named_replicate", "prefix": "copy_"},
    "joint": USER,
    "geom": {**USER, "castshadow": "false"},
    "site": {**USER, "material": "paint", "rgba": COLOUR},
    "camera": {**USER, "ipd": "0.1", "output": "depth"},
    "light": {
        "name": "named_light",
        "class": "soft",
        "mode": "track",
        "target": "arm",
        "pos": "1 2 3",
        "dir": "0 1 0",
        "type": "point",
        "directional": "true",
        "castshadow": "false",
        "active": "false",
        "bulbradius": "0.1",
        "intensity": "2",
        "range": "5",
        "attenuation": "1 0.1 0.1",
        "cutoff": "30",
        "softness": "0.2",
        "exponent": "5",
        "ambient": "0.1 0.1 0.1",
        "diffuse": "0.1 0.1 0.1",
        "specular": "0.1 0.1 0.1",
        "texture": "checks",
    },
    "fixed": TENDON,
    "spatial": {**TENDON, "width": "0.1", "material": "paint", "rgba": COLOUR},
    "default/tendon": {**TENDON, "width": "0.1", "material": "paint", "rgba": COLOUR},
    "general": USER,
    **{kind: USER for kind in "motor position velocity intvelocity orientation damper cylinder muscle pid dcmotor adhesion".split()},
    "global": {
        "cameraid": "0",
        "orthographic": "true",
        "fovy": "30",
        "ipd": "0.1",
        "azimuth": "10",
        "elevation": "20",
        "linewidth": "2",
        "glow": "0.5",
        "offwidth": "100",
        "offheight": "100",
        "realtime": "0.5",
        "ellipsoidinertia": "true",
        "bvactive": "false",
    },
    "quality": {"shadowsize": "100", "offsamples": "2", "numslices": "10", "numstacks": "10", "numquads": "2"},
    "headlight": {"ambient": "0 0 0", "diffuse": "1 0 0", "specular": "0 1 0", "active": "0"},
    "map": {
        name: "0.7"
        for name in "stiffness stiffnessrot force torque alpha fogstart fogend znear zfar haze shadowclip shadowscale actuatortendon".split()
    },
    "scale": {
        name: "0.7"
        for name in (
            "forcewidth contactwidth contactheight connect com camera light selectpoint jointlength jointwidth actuatorlength "
            "actuatorwidth framelength framewidth constraint slidercrank frustum"
        ).split()
    },
    "rgba": {
        name: COLOUR
        for name in (
            "fog haze force inertia joint actuator actuatornegative actuatorpositive com camera light selectpoint connect contactpoint "
            "contactforce contactfriction contacttorque contactgap rangefinder constraint slidercrank crankbroken frustum bv bvactive"
        ).split()
    },
    "texture": {
        "name": "other_texture",
        "class": "soft",
        "type": "cube",
        "colorspace": "sRGB",
        "content_type": "image/png",
        "embed": "true",
        "file": "hills.png",
        "gridsize": "1 1",
        "gridlayout": "R",
        "fileright": "hills.png",
        "fileleft": "hills.png",
        "fileup": "hills.png",
        "filedown": "hills.png",
        "filefront": "hills.png",
        "fileback": "hills.png",
        "builtin": "gradient",
        "rgb1": "1 0 0",
        "rgb2": "0 1 0",
        "mark": "edge",
        "markrgb": "0 0 1",
        "random": "0.1",
        "width": "32",
        "height": "32",
        "hflip": "true",
        "vflip": "true",
        "nchannel": "3",
    },
    "material": {
        "texture": "checks",
        "texrepeat": "2 3",
        "texuniform": "true",
        "emission": "0.1",
        "specular": "0.1",
        "shininess": "0.1",
        "reflectance": "0.1",
        "metallic": "0.1",
        "roughness": "0.1",
    },
    "skin": {
        "name": "other_skin",
        "vertex": "0 0 0 0.2 0 0 0 0.1 0",
        "texcoord": "0 0 1 0 0 1",
        "face": "0 2 1",
        "inflate": "0.01",
        "material": "paint",
        "rgba": COLOUR,
        "group": "2",
    },
    "bone": {"body": "cube", "bindpos": "0.1 0 0", "bindquat": "0 1 0 0", "vertid": "2 1 0", "vertweight": "0.5 1 2"},
    "layer": {"texture": "checks", "role": "normal"},
    "mesh": {
        "texcoord": "0 0 1 0 0 1 1 1",
        "smoothnormal": "true",
    },
    "numeric": {"name": "other_numeric", "size": "5", "data": "3 2"},
    "text": {"name": "other_text", "data": "words"},
    "tuple": {"name": "other_tuple"},
    "element": {"objtype": "geom", "objname": "ball", "prm": "3"},
    **{f"sensor/{kind}": USER for kind in SENSORS},
    "sensor/user": {**USER, "objtype": "body", "objname": "ball", "needstage": "vel"},
}

# Attributes that some of them require.
COMPANIONS = {("sensor/user", "objtype"): {"objname": "ball"}, ("sensor/user", "objname"): {"objtype": "body"}}

# Attributes that are not tested: a skin from a file is equivalent to one in the model.
UNTRIED = {("skin", "file")}

# Attributes that are references or exclude others: only the test sets them, as it depends on the scene.
NAMED = {"class", "target", "texture", "material", "file", "fileright", "fileleft", "fileup", "filedown", "filefront", "fileback", "normal", "texcoord"}
NAMED |= {"sensorsize", "focal", "focalpixel", "principal", "principalpixel", "fovy", "directional", "smoothnormal", "mode", "memory", "njmax", "nstack", "objname", "objtype", "nkey", "name", "content_type", "gridlayout", *POSE}
WHOLE = ("visual", "statistic", "custom", "size", "compiler", "option")
VISUAL = ("global", "quality", "headlight", "map", "scale", "rgba")


def decorate(root, draw):
    """Adds elements and attributes to a model that do not affect its motion."""
    for body in [*root.iter("worldbody"), *root.iter("body")]:
        for tag in ("camera", "light"):
            if draw.chance(0.1):
                ET.SubElement(body, tag)
    visual = ET.SubElement(root, "visual")
    for tag in VISUAL:
        ET.SubElement(visual, tag)
    ET.SubElement(root, "statistic")
    custom = ET.SubElement(root, "custom")
    ET.SubElement(custom, "numeric", name="numeric", data="1 2")
    ET.SubElement(custom, "text", name="text", data="words")
    for tag in ("extension", "deformable", "sensor"):
        if draw.chance(0.2):
            ET.SubElement(root, tag)
    of_others = [child for tag in ("fixed", "spatial", "equality") for section in root.iter(tag) for child in section]
    for element in root.iter():
        if element in of_others:
            continue
        for name, value in VALUES.get(element.tag, {}).items():
            if name not in NAMED and name not in element.attrib and draw.chance(0.1):
                element.set(name, value)
