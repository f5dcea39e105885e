"""Generates a random model from a seed: a tree of bodies with their elements, and relations between them.

Most models compile; callers discard those that MuJoCo refuses (for example, if a default class gives a ball joint a
negative limit). Only elements that can be referenced have names. In replicas, a name and its references mean several
elements.
"""


import xml.etree.ElementTree as ET

from random_models import harmless
from random_models.actuation import Actuation
from random_models.preamble import Preamble
from random_models.relations import Relations
from random_models.sensing import RARE, Sensing
from random_models.stretching import stretch_frames
from random_models.tree import Tree
from random_models.values import VALUES, Draw, text


def generate(seed):
    """Returns the root element of the model of a seed."""
    root = Generator(Draw(seed), Draw(f"{seed} later"), Draw(f"{seed} last")).model()
    stretch_frames(root, seed)
    return root


class Generator(Preamble, Tree, Relations, Actuation, Sensing):
    """Generates all sections, in the order of a file."""

    def model(self):
        draw = self.draw
        self.compiler()
        self.options()
        self.defaults()
        self.assets()
        self.world()
        self.contacts()
        self.tendon_section()
        self.equalities()
        self.actuators()
        self.sensors()
        if draw.chance(0.1):
            self.add(self.root, "size", nkey=draw.randint(0, 3))
        if draw.chance(0.2):
            harmless.decorate(self.root, draw)
        self.scale_frames()
        self.number_elements()
        self.enclose()
        return self.root

    def scale_frames(self):
        """Gives some frames a scale."""
        draw = self.last
        if draw.chance(0.7):
            return
        for frame in self.root.iter("frame"):
            # MuJoCo rounds lengths given in pixels to single precision.
            pixels = any({"focalpixel", "principalpixel"}.intersection(camera.keys()) for camera in frame.iter("camera"))
            for name, value in VALUES["scaled frame"].items():
                if draw.chance(0.5):
                    drawn = value(draw)
                    if not pixels:
                        frame.set(name, drawn)

    def number_elements(self):
        """Gives sensors, and tendons of some classes, user data."""
        draw = self.last
        sections = [*self.root.iter("sensor"), *self.root.iter("default")]
        for element in (element for section in sections for element in section if section.tag == "sensor" or element.tag == "tendon"):
            if draw.chance(0.5 if element.tag in RARE else 0.1):
                element.set("user", text(*(draw.number(-1, 1) for _ in range(draw.randint(1, 3)))))
        if draw.chance(0.1):
            self.add(self.root, "size", nuser_sensor=draw.choice((-1, 3, 4)))


def with_keyframe(root, model, draw):
    """Adds a keyframe to the file of a compiled model, which gives the numbers of values."""
    section = ET.SubElement(root, "keyframe")
    key = ET.SubElement(section, "key", name="key")
    lengths = {"qpos": model.nq, "qvel": model.nv, "act": model.na, "ctrl": model.nu, "mpos": 3 * model.nmocap, "mquat": 4 * model.nmocap, "plastic": model.nplastic}
    for name, length in lengths.items():
        if length and draw.chance(0.5):
            key.set(name, text(*(draw.gauss(0, 0.5) for _ in range(length))))
    if draw.chance(0.5):
        key.set("time", text(draw.number(0, 10)))
    return root


def written(root):
    """Returns the model as text, an element per line."""
    ET.indent(root)
    return ET.tostring(root, encoding="unicode")
