"""The common base of all sections of a random model: names, classes and attributes with random values."""

import xml.etree.ElementTree as ET

from random_models.values import ONE_OF, RANGES, VALUES, interval

PRIMITIVES = ("sphere", "capsule", "ellipsoid", "cylinder", "box")
STRETCHED = ("capsule", "ellipsoid", "cylinder", "box")
SHORTCUTS = ("general", "motor", "position", "velocity", "intvelocity", "damper", "cylinder", "muscle", "pid", "dcmotor", "adhesion")
SCALAR = ("hinge", "slide")


class Maker:
    """A model under construction, and its elements that can be referenced."""

    def __init__(self, draw, later, last):
        self.draw = draw
        # Separate random numbers for features added later, in two stages, so that the rest of each model is unchanged.
        self.later = later
        self.last = last
        self.density = draw.choice((0.05, 0.15, 0.3, 0.5))
        draw.degrees = draw.chance(0.6)
        draw.autolimits = draw.chance(0.9)
        self.naming = draw.chance(0.5)
        self.root = ET.Element("mujoco", model="random")
        self.classes, self.meshes, self.hfields, self.materials, self.parts = [], [], [], [], []
        self.frames, self.inner = [], []  # frames and bodies that the model can attach to itself
        self.bodies, self.geoms, self.sites, self.joints, self.tendons = ["world"], [], [], [], []
        self.cameras, self.actuator_names = [], []
        self.round = []  # spheres and cylinders, around which tendons can wrap
        self.limited = set()  # joints and tendons whose range an actuator can inherit
        self.replicated, self.groups = 0, 0  # the depth in replicas, and the number of outermost groups so far
        self.count = 0

    def add(self, parent, tag, **attributes):
        element = ET.SubElement(parent, tag)
        for name, value in attributes.items():
            if value is not None:
                element.set(name, str(value))
        return element

    def always(self, kind):
        """Returns a new name. It ends in a letter, since MuJoCo takes a final number for that of a replica."""
        self.count += 1
        return f"{kind}{self.count}x"

    def name(self, kind):
        """Returns a new name, or sometimes None."""
        return self.always(kind) if self.draw.chance(0.95) else None

    def named(self, kind, name, body):
        """Registers an element of a body under a name, if it can be referenced."""
        if self.unnamed():
            return None
        {"geom": self.geoms, "site": self.sites}[kind].append((name, body))
        return name

    def unnamed(self):
        """Returns True if elements get no names here: at most the first group of replicas has names.

        A reference to two groups of replicas would be replicated with neither.
        """
        return self.replicated and (self.groups > 1 or not self.naming)

    def fill(self, element, key=None, without=()):
        """Gives the element some of the attributes that its key allows and that it does not have yet."""
        key = key or element.tag
        for name, value in VALUES[key].items():
            if value and name not in without and name not in element.attrib and self.draw.chance(self.density):
                element.set(name, value(self.draw))
        for names in ONE_OF.get(key, ()):
            given = [name for name in names if name in element.attrib]
            for name in given:
                if len(given) > 1 and name != given[len(given) // 2]:
                    del element.attrib[name]
        for name, switch in RANGES.get(key, {}).items():
            if name not in without and self.draw.chance(self.density):
                self.limit(element, name, switch, interval(-2, 2)(self.draw))
        return element

    def limit(self, element, name, switch, value):
        """Sets a range and the switch that enables it, as this file's autolimits requires."""
        element.set(name, value)
        modes = ("", "", "auto", "true", "false") if self.draw.autolimits else ("true", "true", "false")
        mode = self.draw.choice(modes)
        if mode:
            element.set(switch, mode)

    def classed(self, element, attribute="class", probability=0.25):
        if self.classes and self.draw.chance(probability):
            element.set(attribute, self.draw.choice(self.classes))
        return element

    def two(self, things):
        return self.draw.sample(things, 2) if len(things) > 1 else None

    def scalar_joints(self):
        return [name for name, kind in self.joints if kind in SCALAR]

    def constants(self, motor):
        """Gives a motor the constants that it requires."""
        for name in ("resistance", "motorconst"):
            if name not in motor.attrib and "nominal" not in motor.attrib:
                motor.set(name, VALUES["dcmotor"][name](self.draw))
