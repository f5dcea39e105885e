"""What every part of a random model is made with: names, classes and attributes with random values."""

import xml.etree.ElementTree as ET

from random_models.values import ONE_OF, RANGES, VALUES, interval

PRIMITIVES = ("sphere", "capsule", "ellipsoid", "cylinder", "box")
STRETCHED = ("capsule", "ellipsoid", "cylinder", "box")
SHORTCUTS = ("general", "motor", "position", "velocity", "intvelocity", "damper", "cylinder", "muscle", "pid", "dcmotor", "adhesion")
SCALAR = ("hinge", "slide")


class Maker:
    """A model in the making, and what of it can be referred to."""

    def __init__(self, draw, later, last):
        self.draw = draw
        # For what came after most models had been compared, in two waves, so that the rest of each stays as it was.
        self.later = later
        self.last = last
        self.density = draw.choice((0.05, 0.15, 0.3, 0.5))
        draw.degrees = draw.chance(0.6)
        draw.autolimits = draw.chance(0.9)
        self.naming = draw.chance(0.5)
        self.root = ET.Element("mujoco", model="random")
        self.classes, self.meshes, self.hfields, self.materials, self.parts = [], [], [], [], []
        self.frames, self.inner = [], []  # what the model can attach to itself
        self.bodies, self.geoms, self.sites, self.joints, self.tendons = ["world"], [], [], [], []
        self.cameras, self.actuator_names = [], []
        self.round = []  # spheres and cylinders, which tendons can go around
        self.limited = set()  # joints and tendons whose range an actuator can take over
        self.replicated, self.groups = 0, 0  # how deep in replicas, and how many outermost groups of them so far
        self.count = 0

    def add(self, parent, tag, **attributes):
        element = ET.SubElement(parent, tag)
        for name, value in attributes.items():
            if value is not None:
                element.set(name, str(value))
        return element

    def always(self, kind):
        """A new name. It ends in a letter, since MuJoCo takes one that ends in the number of a replica for that replica's."""
        self.count += 1
        return f"{kind}{self.count}x"

    def name(self, kind):
        """A new name, and now and then none."""
        return self.always(kind) if self.draw.chance(0.95) else None

    def named(self, kind, name, body):
        """Registers an element of a body under a name, where it can be referred to."""
        if self.unnamed():
            return None
        {"geom": self.geoms, "site": self.sites}[kind].append((name, body))
        return name

    def unnamed(self):
        """Whether nothing gets a name here. What refers to two groups of replicas follows neither, so at most the first group has names."""
        return self.replicated and (self.groups > 1 or not self.naming)

    def fill(self, element, key=None, without=()):
        """Gives the element some of the attributes that its key can have and that it does not have yet."""
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
        """A range and whether it counts, as this file has to write it."""
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
        """Gives a motor the constants that it cannot be without."""
        for name in ("resistance", "motorconst"):
            if name not in motor.attrib and "nominal" not in motor.attrib:
                motor.set(name, VALUES["dcmotor"][name](self.draw))
