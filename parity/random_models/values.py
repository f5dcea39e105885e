"""Values of attributes: for each element of MJCF, each attribute that does not depend on other elements.

A value is a function of a `Draw`, which holds the random numbers and the notation of the file. Values are mostly
ordinary and sometimes at the edge of the range that MuJoCo accepts.
"""

import math
import random

from random_models.harmless import SENSORS


class Draw(random.Random):
    """Random numbers, MJCF values made of them, and the file's notation of angles and limits."""

    degrees = True
    autolimits = True

    def chance(self, probability):
        return self.random() < probability

    def number(self, low, high):
        return self.uniform(low, high)

    def scale(self, low, high):
        """Returns a number between two positive ones, uniform on a logarithmic scale."""
        return math.exp(self.uniform(math.log(low), math.log(high)))

    def angle(self, radians):
        return math.degrees(radians) if self.degrees else radians


def text(*numbers):
    return " ".join(f"{x:.4g}" if isinstance(x, float) else str(x) for x in numbers)


def vector(low, high, count=3):
    return lambda draw: text(*(draw.number(low, high) for _ in range(count)))


def number(low, high):
    return vector(low, high, 1)


def scale(low, high):
    return lambda draw: text(draw.scale(low, high))


def one_of(*words):
    return lambda draw: str(draw.choice(words))


def usually(value, *rare):
    """Returns the value in most cases, otherwise one of the rare ones."""
    return lambda draw: draw.choice(rare) if draw.chance(0.1) else value(draw)


def up_to(most, low, high):
    """Returns one to `most` numbers."""
    return lambda draw: text(*(draw.number(low, high) for _ in range(draw.randint(1, most))))


def solref(draw):
    kind = draw.random()
    if kind < 0.2:
        return text(-draw.scale(100, 5000), -draw.scale(5, 200))
    if kind < 0.3:
        return text(draw.scale(0.005, 0.2))
    if kind < 0.33:
        return draw.choice(("0.02 -1", "-200 0", "-0.5 0.5", "0.0001 1"))
    return text(draw.scale(0.004, 0.2), draw.scale(0.3, 2))


def solimp(draw):
    if draw.chance(0.05):
        return draw.choice(("0 1 0.01", "0.9 0.5 0.01 0.5 2", "1 1 0.001 0.5 1", "0.9 0.95 0 0.5 2", "0.5 0.9 0.1 0 3", "0.9 0.95 0.01 0.5 0.3"))
    low = draw.number(0.3, 0.95)
    numbers = (low, draw.number(low, 0.995), draw.scale(0.0005, 0.1), draw.number(0.1, 0.9), draw.number(1, 6))
    return text(*numbers[: draw.randint(1, 5)])


def polynomial(low, high):
    """Returns the coefficients of a spring or damper: the linear one, and sometimes others."""

    def value(draw):
        linear = draw.choice((1, 1, 1, 0)) * draw.scale(low, high)
        return text(linear, *(draw.number(-0.3, 1) * draw.scale(low, high) for _ in range(draw.choice((0, 0, 1, 2)))))

    return value


def quaternion(draw):
    return text(*(draw.gauss(0, 1) for _ in range(4)))


def axis_angle(draw):
    return text(*(draw.gauss(0, 1) for _ in range(3)), draw.angle(draw.number(-3, 3)))


def euler(draw):
    return text(*(draw.angle(draw.number(-3, 3)) for _ in range(3)))


def gaussians(count):
    return lambda draw: text(*(draw.gauss(0, 1) for _ in range(count)))


def friction(draw):
    numbers = (draw.scale(0.1, 2), draw.scale(0.001, 0.1), draw.scale(0.0001, 0.02))
    return text(*numbers[: draw.randint(1, 3)])


def pair_friction(draw):
    numbers = [draw.scale(0.1, 2) for _ in range(2)] + [draw.scale(0.001, 0.1)] + [draw.scale(0.0001, 0.02) for _ in range(2)]
    return text(*numbers[: draw.randint(1, 5)])


def interval(low, high):
    """Returns two ends in order, with zero between them in most cases."""

    def value(draw):
        ends = sorted((draw.number(low, 0), draw.number(0, high)))
        if draw.chance(0.1):
            ends = sorted((draw.number(low, high), draw.number(low, high)))
        return text(ends[0], ends[1] + 1e-3)

    return value


SWITCH = one_of("disable", "enable")
BOOLEAN = one_of("false", "true")

POSE = {
    "pos": vector(-0.4, 0.4),
    "quat": quaternion,
    "axisangle": axis_angle,
    "euler": euler,
    "xyaxes": gaussians(6),
    "zaxis": gaussians(3),
}
ORIENTATIONS = ("quat", "axisangle", "euler", "xyaxes", "zaxis")
TENDON = {
    "margin": number(0, 0.1),
    "stiffness": polynomial(1, 100),
    "damping": polynomial(0.01, 5),
    "frictionloss": scale(0.01, 2),
    "springlength": usually(lambda draw: text(*sorted(draw.number(-0.3, 0.3) for _ in range(draw.randint(1, 2)))), "-1", "-1 -1"),
    "solreflimit": solref,
    "solimplimit": solimp,
    "solreffriction": solref,
    "solimpfriction": solimp,
}
EQUALITY = {"active": one_of("true", "true", "false"), "solref": solref, "solimp": solimp}
POLYCOEF = lambda draw: text(*(draw.number(-0.5, 0.5) for _ in range(draw.randint(1, 5))))
ACTUATOR = {
    "group": one_of(0, 0, 1, 2, 3, 30),
    "gear": lambda draw: text(*gear(draw)),
    "cranklength": None,  # set with a target
    "damping": lambda draw: text(*(draw.choice((0, draw.scale(0.003, 1))) for _ in range(draw.randint(1, 3)))),
    "armature": usually(scale(0.001, 0.3), "0"),
    "nsample": one_of(20, 50),  # required by `delay`
    "interp": one_of("zoh", "linear", "cubic"),
}
SERVO_GAIN = {"kp": usually(scale(0.1, 100), "0"), "kv": usually(scale(0.01, 5), "0"), "dampratio": usually(scale(0.1, 2), "0")}


def gear(draw):
    """Returns one, three or six numbers: ball joints read three, free joints six, other targets one."""
    numbers = [draw.choice((-1, 1)) * draw.scale(0.1, 10) for _ in range(draw.choice((1, 1, 3, 6)))]
    return [0.0 if k > 0 and draw.chance(0.3) else x for k, x in enumerate(numbers)]


def euler_sequence(draw):
    return "".join(draw.choice("xyzXYZ") for _ in range(3))


def words(known):
    """Returns some of the words, in their order."""
    return lambda draw: " ".join(word for word in known if draw.chance(0.4)) or known[0]


PAST = {"nsample": one_of(20, 50), "interp": one_of("zoh", "linear", "cubic")}
SENSOR = {"noise": scale(0.01, 1), "cutoff": scale(0.02, 5), **PAST}
TURNS = ("framequat", "framexaxis", "frameyaxis", "framezaxis", "ballquat")  # sensors without cutoff
RAY_DATA = ("dist", "dir", "origin", "point", "normal", "depth")
CONTACT_DATA = ("found", "force", "torque", "dist", "pos", "normal", "tangent", "linvel", "angvel")

VALUES = {
    "compiler": {
        "angle": None,  # drawn first, like autolimits
        "autolimits": None,
        "eulerseq": euler_sequence,
        "coordinate": one_of("local"),
        "boundmass": scale(0.001, 1),
        "boundinertia": scale(1e-6, 0.01),
        "settotalmass": usually(scale(0.5, 50), "-1", "0"),
        "balanceinertia": BOOLEAN,
        "inertiafromgeom": one_of("auto", "auto", "true", "false"),
        "inertiagrouprange": one_of("0 5", "0 2", "1 3"),
        "alignfree": BOOLEAN,
        "strippath": one_of("false", "true"),
        "fitaabb": BOOLEAN,
        "discardvisual": BOOLEAN,
        "conflict": one_of("warning"),
        "fusestatic": BOOLEAN,
    },
    "option": {
        "timestep": scale(0.0005, 0.01),
        "gravity": usually(vector(-10, 10), "0 0 0"),
        "wind": vector(-3, 3),
        "magnetic": vector(-1, 1),
        "density": scale(0.1, 1500),
        "viscosity": scale(1e-4, 2),
        "sleep_tolerance": usually(scale(1e-5, 0.1), "0", "-1"),
        "integrator": one_of("Euler", "RK4", "implicitfast", "implicit", "discrete"),
        "cone": one_of("pyramidal", "elliptic"),
        "jacobian": one_of("dense", "sparse", "auto"),
        "solver": one_of("Newton", "CG", "PGS"),
        "impratio": scale(0.2, 20),
        "tolerance": scale(1e-12, 1e-4),
        "ls_tolerance": scale(1e-4, 0.1),
        "noslip_tolerance": scale(1e-9, 1e-4),
        "iterations": one_of(0, 1, 20, 200),
        "ls_iterations": one_of(0, 1, 20, 100),
        "noslip_iterations": one_of(0, 1, 5),
        "o_margin": number(0, 0.05),
        "o_solref": solref,
        "o_solimp": solimp,
        "o_friction": pair_friction,
        "actuatorgroupdisable": one_of("0", "1 2", "3", "30 2"),
    },
    "flag": {
        name: SWITCH
        for name in (
            "constraint equality frictionloss limit contact spring damper gravity clampctrl warmstart filterparent actuation "
            "refsafe island eulerdamp multiccd autoreset sensor override diagexact sleep"
        ).split()
    },
    "body": {
        **POSE,
        "simple": one_of("false", "auto"),
        "fuse": one_of("false", "auto"),
        "gravcomp": usually(number(0, 1.5), "1", "-0.5"),
    },
    "frame": POSE,
    "scaled frame": {"scale": scale(0.5, 2), "scaling": one_of("similar", "geometry"), "massscale": scale(0.3, 3)},
    "replicate": {
        "count": one_of(1, 2, 3),
        "offset": vector(-0.3, 0.3),
        "euler": lambda draw: text(*(draw.angle(draw.number(-1, 1)) for _ in range(3))),
        "sep": one_of("-", "_r"),
    },
    "attach": {},
    "model": {},
    "inertial": {},
    "joint": {
        "group": one_of(0, 1, 4),
        "pos": vector(-0.1, 0.1),
        "axis": gaussians(3),
        "springdamper": lambda draw: text(draw.scale(0.05, 2), draw.scale(0.1, 2)),
        "solreflimit": solref,
        "solimplimit": solimp,
        "solreffriction": solref,
        "solimpfriction": solimp,
        "stiffness": polynomial(0.1, 100),
        "actuatorgravcomp": BOOLEAN,
        "margin": number(0, 0.2),
        "ref": lambda draw: text(draw.angle(draw.number(-0.5, 0.5))),
        "springref": lambda draw: text(draw.angle(draw.number(-0.5, 0.5))),
        "armature": scale(1e-4, 1),
        "damping": polynomial(0.01, 10),
        "frictionloss": scale(0.01, 3),
    },
    "freejoint": {"group": one_of(0, 1), "align": one_of("true", "false", "auto")},
    "geom": {
        **{name: value for name, value in POSE.items()},
        "contype": one_of(0, 1, 1, 1, 2, 3),
        "conaffinity": one_of(0, 1, 1, 1, 2, 3),
        "condim": one_of(1, 3, 3, 4, 6),
        "group": one_of(0, 0, 1, 2, 3, 4, 5),
        "priority": one_of(0, 0, 0, 1, 2),
        "friction": friction,
        "mass": scale(0.05, 5),
        "density": usually(scale(50, 5000), "0"),
        "shellinertia": BOOLEAN,
        "solmix": usually(scale(0.01, 10), "0", "-1"),
        "solref": solref,
        "solimp": solimp,
        "margin": number(0, 0.05),
        "gap": number(0, 0.03),
        "surfacevel": usually(vector(-1, 1, 6), "0.5", "0 0.3 0"),
        "adhesion": usually(scale(0.1, 20), "0", "-1"),
        "fluidshape": one_of("none", "ellipsoid"),
        "fluidcoef": up_to(5, 0, 2),
        "rgba": lambda draw: text(*(draw.random() for _ in range(3)), draw.choice((0, 1))),
    },
    "camera": {
        **POSE,
        "mode": one_of("fixed", "track", "trackcom", "targetbody", "targetbodycom"),
        "projection": one_of("perspective", "orthographic"),
        "fovy": number(0.5, 120),
        "resolution": one_of("1 1", "3 2", "2 4"),
    },
    "site": {**POSE, "group": one_of(0, 3), "size": vector(0.01, 0.1)},
    "pair": {
        "condim": one_of(1, 3, 4, 6),
        "friction": pair_friction,
        "solref": solref,
        "solreffriction": solref,
        "solimp": solimp,
        "margin": number(0, 0.05),
        "gap": number(0, 0.03),
        "adhesion": scale(0.1, 20),
    },
    "exclude": {},
    "connect": EQUALITY,
    "weld": {**EQUALITY, "torquescale": usually(scale(0.1, 10), "0")},
    "equality/joint": {**EQUALITY, "polycoef": POLYCOEF},
    "equality/tendon": {**EQUALITY, "polycoef": POLYCOEF},
    "default/equality": EQUALITY,
    "fixed": {**TENDON, "armature": scale(0.001, 0.5)},
    "spatial": {**TENDON, "springlength": usually(lambda draw: text(*sorted(draw.number(0, 1) for _ in range(draw.randint(1, 2)))), "-1")},
    "fixed/joint": {"coef": number(-2, 2)},
    "default/tendon": {**TENDON, "armature": one_of("0", "0", "0.05")},
    "general": {
        **ACTUATOR,
        "actearly": BOOLEAN,
        "dyntype": one_of("none", "integrator", "filter", "filterexact", "muscle", "user"),
        "dynprm": usually(lambda draw: text(draw.scale(0.003, 0.3), *([0.5] * draw.randint(0, 2))), "0"),
        "gaintype": one_of("fixed", "affine", "user"),
        "gainprm": up_to(3, -5, 5),
        "biastype": one_of("none", "affine", "user"),
        "biasprm": lambda draw: text(draw.number(-1, 1), -draw.scale(0.1, 50), *([-draw.scale(0.01, 3)] * draw.randint(0, 1))),
    },
    "motor": ACTUATOR,
    "position": {**ACTUATOR, **SERVO_GAIN, "timeconst": usually(scale(0.003, 0.3), "0")},
    "orientation": {
        "group": ACTUATOR["group"],
        **PAST,
        "kp": scale(0.1, 20),
        "kv": usually(scale(0.01, 3), "0"),
        "dampratio": usually(scale(0.1, 3), "0"),
        "input": one_of("expmap", "quat"),
    },
    "velocity": {**ACTUATOR, "kv": usually(scale(0.01, 10), "0")},
    "intvelocity": {**ACTUATOR, **SERVO_GAIN},
    "damper": {**ACTUATOR, "kv": usually(scale(0.01, 10), "0")},
    "cylinder": {
        **ACTUATOR,
        "timeconst": scale(0.003, 0.3),
        "area": scale(0.1, 5),
        "diameter": scale(0.3, 2),
        "bias": vector(-2, 0),
    },
    "muscle": {
        **ACTUATOR,
        "timeconst": usually(vector(0.003, 0.2, 2), "-1 0.1"),
        "tausmooth": usually(number(0, 1), "0"),
        "range": lambda draw: text(draw.number(0.3, 0.9), draw.number(1, 1.5)),
        "force": usually(scale(0.3, 30), "0", "-1"),
        "scale": scale(1, 300),
        "lmin": number(0, 0.9),
        "lmax": number(1.1, 2),
        "vmax": scale(0.3, 5),
        "fpmax": number(0.1, 3),
        "fvmax": number(0.6, 2),
    },
    "pid": {
        **ACTUATOR,
        **SERVO_GAIN,
        "ki": usually(scale(0.1, 20), "0"),
        "imax": usually(scale(0.03, 1), "0"),
        "slewmax": usually(scale(0.1, 10), "0"),
        "input": one_of("pos vel", "pos", "pos ff", "pos vel ff", "", "vel", "ff"),
        "velrange": interval(-2, 2),
        "ffrange": interval(-2, 2),
    },
    "dcmotor": {
        **ACTUATOR,
        "resistance": scale(0.3, 5),
        "motorconst": lambda draw: text(*(draw.scale(0.03, 1) for _ in range(draw.randint(1, 2)))),
        "nominal": lambda draw: text(draw.scale(3, 30), draw.scale(0.3, 5), draw.scale(5, 100)),
        "saturation": lambda draw: text(draw.choice((0, draw.scale(0.3, 5))), draw.choice((0, draw.scale(0.3, 5))), draw.choice((0, draw.scale(3, 100)))),
        "inductance": lambda draw: text(draw.choice((0, draw.scale(0.003, 0.1))), draw.choice((0, draw.scale(0.003, 0.1)))),
        "cogging": lambda draw: text(draw.scale(0.01, 0.3), draw.randint(1, 12), draw.number(-3, 3)),
        "controller": lambda draw: text(*(draw.choice((0, draw.scale(0.1, 5))) for _ in range(draw.randint(1, 6)))),
        "thermal": lambda draw: text(draw.scale(0.3, 5), draw.choice((0, draw.scale(1, 50))), draw.scale(1, 50), draw.number(0, 0.01), draw.number(0, 30), draw.number(10, 40)),
        "lugre": lambda draw: text(draw.scale(5, 50), draw.scale(0.01, 1), draw.scale(0.01, 0.3), draw.scale(0.01, 0.5), draw.scale(0.03, 1)),
        "input": one_of("", "pos", "pos vel", "vel", "ff", "pos vel ff voltage", "vel voltage", "none", "voltage"),
    },
    "lengthrange": {
        "mode": one_of("none", "muscle"),
        # Without it engines simulate, and their results differ too much if lengths have no limits.
        "useexisting": one_of("true"),
        "uselimit": BOOLEAN,
        "accel": scale(5, 50),
        "maxforce": usually(scale(1, 100), "0"),
        "timeconst": scale(0.1, 2),
        "timestep": usually(scale(0.003, 0.02), "0"),
        "inttotal": scale(1, 10),
        "interval": scale(0.1, 1),
        "tolrange": scale(0.01, 0.2),
    },
    "adhesion": {**{name: ACTUATOR[name] for name in ("group", "nsample", "interp")}, "gain": usually(scale(0.1, 10), "0")},
    "key": {},
    "material": {"rgba": lambda draw: text(*(draw.random() for _ in range(3)), draw.choice((0, 1)))},
    "mesh": {
        "refpos": vector(-0.1, 0.1),
        "refquat": quaternion,
        "inertia": one_of("convex", "exact", "legacy", "shell"),
        "maxhullvert": one_of(-1, 500),  # with a smaller limit, engines choose different vertices
    },
    "default/mesh": {
        "inertia": one_of("convex", "exact", "legacy", "shell"),
        "maxhullvert": one_of(-1, 500),
        "scale": lambda draw: text(*(draw.choice((1, 1, -1)) * draw.scale(0.05, 0.2) for _ in range(3))),
    },
    "hfield": {},
    **{f"sensor/{kind}": SENSOR for kind in SENSORS},
    **{f"sensor/{kind}": {**SENSOR, "data": words(RAY_DATA)} for kind in ("rangefinder",)},
    "sensor/contact": {**SENSOR, "num": one_of(1, 2, 5), "data": words(CONTACT_DATA), "reduce": one_of("none", "mindist", "maxforce", "netforce")},
    "sensor/tactile": {"cutoff": scale(0.02, 5), **PAST},
    "sensor/user": {"noise": scale(0.01, 1), "cutoff": scale(0.02, 5), "datatype": one_of("real", "positive")},
    **{f"sensor/{kind}": {"noise": scale(0.01, 1), "cutoff": one_of(0), **PAST} for kind in TURNS},
}

# Ranges with the attribute that enables them.
RANGES = {
    "joint": {"range": "limited", "actuatorfrcrange": "actuatorfrclimited"},
    "fixed": {"range": "limited", "actuatorfrcrange": "actuatorfrclimited"},
    "spatial": {"range": "limited", "actuatorfrcrange": "actuatorfrclimited"},
    "default/tendon": {"range": "limited", "actuatorfrcrange": "actuatorfrclimited"},
    **{kind: {"ctrlrange": "ctrllimited", "forcerange": "forcelimited"} for kind in "motor position velocity cylinder muscle".split()},
    "general": {"ctrlrange": "ctrllimited", "forcerange": "forcelimited", "actrange": "actlimited"},
    "intvelocity": {"ctrlrange": "ctrllimited", "forcerange": "forcelimited", "actrange": "actlimited"},
    "damper": {"forcerange": "forcelimited"},
    "adhesion": {"forcerange": "forcelimited"},
    "pid": {"ctrlrange": "ctrllimited", "posrange": "ctrllimited", "forcerange": "forcelimited"},
    "dcmotor": {"ctrlrange": "ctrllimited"},
}

# Mutually exclusive attributes.
ONE_OF = {
    "position": [("kv", "dampratio")],
    "intvelocity": [("kv", "dampratio")],
    "pid": [("kv", "dampratio")],
    **{element: [ORIENTATIONS] for element in ("body", "frame", "geom", "site", "camera", "inertial")},
}
