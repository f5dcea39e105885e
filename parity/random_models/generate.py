"""A random model from a seed: a tree of bodies, what they carry, and what acts between them.

Most of what is generated can be compiled; what MuJoCo refuses (a default class that gives a ball joint a negative limit, say) is left
to be thrown away. Names are given only to what can be referred to. In replicas a name means several elements, and so does what refers
to it.
"""

import math
import pathlib
import xml.etree.ElementTree as ET

from random_models import harmless
from random_models.values import ONE_OF, ORIENTATIONS, RANGES, VALUES, Draw, interval, number, quaternion, text, vector

ASSETS = pathlib.Path(__file__).resolve().parent.parent / "shapes/assets"
MESH_FILES = (("rock.obj", "model/obj"), ("wedge.stl", "model/stl"), ("bracket.obj", "model/obj"))
PRIMITIVES = ("sphere", "capsule", "ellipsoid", "cylinder", "box")
STRETCHED = ("capsule", "ellipsoid", "cylinder", "box")
SHORTCUTS = ("general", "motor", "position", "velocity", "intvelocity", "damper", "cylinder", "muscle", "pid", "dcmotor", "adhesion")
SCALAR = ("hinge", "slide")
# What would keep many of the elements of a class from being compiled: a joint's range fits one type of joint, a place contradicts `fromto`,
# dampers take no negative controls, and only what has activations can limit them.
INITIAL = {"geom": ("pos", "mass"), "site": ("pos",)}
NOT_IN_CLASSES = ("fromto", "ctrlrange", "actrange", "tausmooth", "controller", "ki", "slewmax")


def generate(seed):
    """The root element of the model of a seed."""
    return Generator(Draw(seed)).model()


class Generator:
    def __init__(self, draw):
        self.draw = draw
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
        return self.root

    # What everything is made with.

    def add(self, parent, tag, **attributes):
        element = ET.SubElement(parent, tag)
        for name, value in attributes.items():
            if value is not None:
                element.set(name, str(value))
        return element

    def name(self, kind):
        """A new name, and now and then none."""
        return self.always(kind) if self.draw.chance(0.95) else None

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

    # Sections before the tree.

    def compiler(self):
        draw = self.draw
        compiler = self.add(self.root, "compiler")
        if not draw.degrees or draw.chance(0.3):
            compiler.set("angle", "degree" if draw.degrees else "radian")
        if not draw.autolimits or draw.chance(0.2):
            compiler.set("autolimits", str(draw.autolimits).lower())
        if draw.chance(0.3):
            self.fill(compiler)
        compiler.set(draw.choice(("assetdir", "meshdir")), str(ASSETS))
        if draw.chance(0.2):
            self.fill(self.add(compiler, "lengthrange"))

    def options(self):
        for _ in range(self.draw.choice((0, 1, 1, 1, 2))):
            option = self.fill(self.add(self.root, "option"))
            if self.draw.chance(0.5):
                flags = self.fill(self.add(option, "flag"))
                for name in ("constraint", "contact", "actuation"):  # without these there is little to compare
                    if self.draw.chance(0.7):
                        flags.attrib.pop(name, None)
        if any(option.get("integrator") == "RK4" for option in self.root.iter("option")):
            for flags in self.root.iter("flag"):
                flags.attrib.pop("sleep", None)  # is refused beside it

    def sleeps(self):
        """Whether islands at rest sleep."""
        return any(flags.get("sleep") == "enable" for flags in self.root.iter("flag"))

    def defaults(self):
        if self.draw.chance(0.4):
            return
        main = self.add(self.root, "default")
        if self.draw.chance(0.3):
            main.set("class", "main")
        self.class_elements(main)
        parents = [main]
        for k in range(self.draw.randint(0, 3)):
            nested = self.add(self.draw.choice(parents), "default", **{"class": f"class{k}"})
            self.classes.append(f"class{k}")
            parents.append(nested)
            self.class_elements(nested)

    def class_elements(self, default):
        kinds = ("joint", "geom", "site", "camera", "pair", "equality", "tendon", "mesh", "material", *SHORTCUTS)
        for tag in kinds:
            if not self.draw.chance(0.15):
                continue
            element = self.add(default, tag)
            key = f"default/{tag}" if f"default/{tag}" in VALUES else tag
            self.fill(element, key, without=(*INITIAL.get(tag, ()), *NOT_IN_CLASSES, *(("range",) if tag == "joint" else ())))
            if tag == "joint" and self.draw.chance(0.2):
                element.set("type", self.draw.choice(SCALAR))
            if tag == "joint" and self.draw.chance(0.3):
                self.limit(element, "range", "limited", text(0, self.draw.angle(self.draw.number(0.1, 0.5))))
            if tag == "geom" and self.draw.chance(0.3):
                element.set("type", self.draw.choice(PRIMITIVES))
                element.set("size", vector(0.03, 0.15)(self.draw))
            if tag == "dcmotor":
                self.constants(element)
            if tag in ("damper", "adhesion"):  # limits the controls of the whole class
                element.set("ctrlrange", text(0, self.draw.number(0.2, 2)))

    def assets(self):
        draw = self.draw
        if draw.chance(0.5):
            return
        asset = self.add(self.root, "asset")
        for _ in range(draw.randint(0, 2)):
            material = self.classed(self.add(asset, "material", name=self.always("material")))
            self.fill(material)
            self.materials.append(material.get("name"))
        for _ in range(draw.randint(0, 2)):
            self.mesh(asset)
        if draw.chance(0.3):
            self.hfield(asset)
        if draw.chance(0.3):
            self.part(asset)

    def part(self, asset):
        """A model that can be attached."""
        part = self.add(asset, "model", file=ASSETS / "part.xml")
        name = self.draw.choice((None, self.always("model")))
        if name:
            part.set("name", name)
        if self.draw.chance(0.3):
            part.set("content_type", "text/xml")
        self.parts.append(name or "part")

    def always(self, kind):
        """A new name. It ends in a letter, since MuJoCo takes one that ends in the number of a replica for that replica's."""
        self.count += 1
        return f"{kind}{self.count}x"

    def mesh(self, asset):
        draw = self.draw
        mesh = self.classed(self.add(asset, "mesh", name=self.always("mesh")))
        size = draw.scale(0.05, 0.2)
        kind = draw.choice(("points", "faces", "builtin", "file"))
        if kind == "points":
            count = draw.randint(4, 12)
            mesh.set("vertex", text(*(size * draw.gauss(0, 0.7) for _ in range(3 * count))))
        elif kind == "faces":
            corners = [size * draw.scale(0.5, 1.5) for _ in range(3)]
            mesh.set("vertex", text(0, 0, 0, corners[0], 0, 0, 0, corners[1], 0, 0, 0, corners[2]))
            mesh.set("face", "0 2 1 0 1 3 0 3 2 1 2 3")
        elif kind == "builtin":
            shapes = {
                "sphere": lambda: (draw.randint(0, 2),),
                "hemisphere": lambda: (draw.randint(0, 3),),
                "cone": lambda: (draw.randint(3, 8), draw.choice((0, draw.number(0.1, 1), 1))),
                "supersphere": lambda: (draw.randint(3, 8), draw.scale(0.3, 2), draw.scale(0.3, 2)),
                "supertorus": lambda: (draw.randint(3, 8), draw.scale(0.1, 0.9), draw.scale(0.4, 2), draw.scale(0.4, 2)),
            }
            shape = draw.choice(sorted(shapes))
            mesh.set("builtin", shape)
            mesh.set("params", text(*shapes[shape]()))
            mesh.set("scale", text(*(size * draw.scale(0.5, 1.5) for _ in range(3))))
        else:
            file, media_type = draw.choice(MESH_FILES)
            mesh.set("file", file)
            if draw.chance(0.3):
                mesh.set("content_type", media_type)
        if "scale" not in mesh.attrib and draw.chance(0.3):
            mesh.set("scale", text(*(draw.choice((1, 1, -1)) * draw.scale(0.5, 2) for _ in range(3))))
        if draw.chance(0.2) and self.materials:
            mesh.set("material", draw.choice(self.materials))
        self.fill(mesh)
        self.meshes.append(mesh.get("name"))

    def hfield(self, asset):
        draw = self.draw
        field = self.add(asset, "hfield", name=self.always("hfield"))
        field.set("size", text(draw.number(0.5, 1.5), draw.number(0.5, 1.5), draw.number(0.05, 0.3), draw.number(0.02, 0.2)))
        if draw.chance(0.3):
            field.set("file", "hills.png")
            if draw.chance(0.5):
                field.set("content_type", "image/png")
        else:
            rows, columns = draw.randint(2, 6), draw.randint(2, 6)
            field.set("nrow", str(rows))
            field.set("ncol", str(columns))
            if draw.chance(0.9):
                field.set("elevation", text(*(draw.random() for _ in range(rows * columns))))
        self.hfields.append(field.get("name"))

    # The tree.

    def world(self):
        draw = self.draw
        world = self.add(self.root, "worldbody")
        if draw.chance(0.7):
            floor = self.fill(self.add(world, "geom", name=self.named("geom", "floor", 0)), without=("mass", *ORIENTATIONS))
            floor.attrib.update(type="plane", size="2 2 0.1")
            floor.set("pos", text(0, 0, draw.number(-0.3, 0)))
        if self.hfields and draw.chance(0.8):
            ground = self.fill(self.add(world, "geom", name=self.named("geom", "ground", 0)), without=("mass", *ORIENTATIONS))
            ground.attrib.update(type="hfield", hfield=self.hfields[0])
            ground.set("pos", text(0, 0, draw.number(-0.5, -0.1)))
        for _ in range(draw.choice((0, 0, 1))):
            self.geom(world, 0)
        for _ in range(draw.randint(0, 1)):
            self.site(world, 0)
        if draw.chance(0.2):
            self.camera(world)
        for _ in range(draw.randint(1, 4)):
            self.body(self.wrapped(world), 0, 0)
            self.replicated = 0
        if self.parts and draw.chance(0.5):
            self.attach(self.wrapped(world), top=True)
            self.replicated = 0
        if draw.chance(0.1):
            self.body(self.add(self.root, "worldbody"), 0, 0)

    def named(self, kind, name, body):
        """Registers an element of a body under a name, where it can be referred to."""
        if self.unnamed():
            return None
        {"geom": self.geoms, "site": self.sites}[kind].append((name, body))
        return name

    def wrapped(self, parent):
        """The parent, or a frame or replicas in it."""
        draw = self.draw
        if draw.chance(0.15):
            frame = self.fill(self.classed(self.add(parent, "frame")))
            self.classed(frame, "childclass", 0.1)
            return self.wrapped(frame)
        if draw.chance(0.07):
            self.groups += not self.replicated
            self.replicated += 1
            replicate = self.classed(self.add(parent, "replicate"))
            for name in ("offset", "euler", "sep"):
                if draw.chance(0.6):
                    replicate.set(name, VALUES["replicate"][name](draw))
            replicate.set("count", VALUES["replicate"]["count"](draw))
            return self.classed(replicate, "childclass", 0.1)
        return parent

    def body(self, parent, depth, parent_index):
        draw = self.draw
        inside = self.replicated
        body = self.add(parent, "body")
        index = -1 if self.unnamed() else len(self.bodies)
        name = self.always("body")
        if not self.unnamed():
            self.bodies.append(name)
        body.set("name", name)
        self.fill(self.classed(body, "childclass", 0.1))
        spread = 0.5 if depth == 0 else 0.2
        body.set("pos", text(*(draw.number(-spread, spread) for _ in range(2)), draw.number(0, 0.6) if depth == 0 else draw.number(-0.2, 0.2)))
        if depth == 0 and draw.chance(0.07) and not inside:
            body.set("mocap", "true")
        else:
            self.body_joints(body, depth)
        if depth == 0 and body.find("joint") is not None and draw.chance(self.density):
            # In a state that is given, MuJoCo has no smooth forces of what begins asleep.
            body.set("sleep", draw.choice(("auto", "never", "allowed", *(() if self.sleeps() else ("init",)))))
        self.solids(body, index)
        for _ in range(draw.choice((0, 0, 1, 2))):
            self.site(body, index)
        if draw.chance(0.1):
            self.attach(self.wrapped_frame(body))
        if draw.chance(0.15):
            self.camera(body)
        if depth and not inside:
            self.inner.append(name)
        if depth < 3:
            for _ in range(draw.choice((0, 0, 1, 1, 2)) if depth else draw.choice((0, 1, 1, 2))):
                was = self.replicated
                self.body(self.wrapped(body), depth + 1, index)
                self.replicated = was

    def unnamed(self):
        """Whether nothing gets a name here. What refers to two groups of replicas follows neither, so at most the first group has names."""
        return self.replicated and (self.groups > 1 or not self.naming)

    def attach(self, parent, top=False):
        """A part of another model, or of this one."""
        draw, prefix = self.draw, self.always("at")
        attach = ET.Element("attach", prefix=prefix)
        if self.parts:
            attach.set("model", draw.choice(self.parts))
            whole = None if top else draw.choice((("body", "arm"), ("body", "hand"), ("frame", "wrist")))
            if whole:
                attach.set(*whole)
            if whole != ("body", "hand") and whole != ("frame", "wrist") and not self.unnamed():
                self.joints.append((f"{prefix}turn", "hinge"))
        elif self.replicated:
            return  # what is being replicated cannot be attached
        elif self.frames and draw.chance(0.5):
            attach.set("frame", draw.choice(self.frames))
        elif self.inner:
            attach.set("body", draw.choice(self.inner))
        else:
            return
        parent.append(attach)

    def body_joints(self, body, depth):
        draw = self.draw
        direct = depth == 0
        if direct and draw.chance(0.4):
            if draw.chance(0.7):
                free = self.add(body, "freejoint", name=self.joint_name("free"))
                self.fill(free)
            else:
                free = self.add(body, "joint", name=self.joint_name("free"), type="free")
                if draw.chance(0.5):
                    self.fill(free, without=("range", "springdamper", "margin"))
            return
        kinds = draw.choice(
            ([], ["hinge"], ["hinge"], ["hinge"], ["slide"], ["ball"], ["hinge", "hinge"], ["slide", "hinge"], ["slide", "ball"], 3 * ["slide"])
        )
        axes = self.independent_axes()
        for kind in kinds:
            holder = self.add(body, "frame", **{"pos": vector(-0.1, 0.1)(draw), "euler": text(draw.angle(draw.number(-1, 1)), 0, 0)}) if draw.chance(0.05) else body
            joint = self.classed(self.add(holder, "joint", name=self.joint_name(kind)))
            if kind != "hinge" or draw.chance(0.3):
                joint.set("type", kind)
            self.fill(joint, without=("range",))
            for name in ("ref", "springref"):
                if kind == "slide" and name in joint.attrib:
                    joint.set(name, number(-0.2, 0.2)(draw))
            if len(kinds) > 1:  # two axes in one direction would move no mass against each other
                joint.set("axis", axes.pop())
            if draw.chance(0.35):
                self.joint_range(joint, kind)

    def independent_axes(self):
        """Three directions, each nearest to another axis."""
        directions = [[self.draw.number(-0.3, 0.3) for _ in range(3)] for _ in range(3)]
        for k, direction in enumerate(directions):
            direction[k] = self.draw.choice((-1.0, 1.0))
        self.draw.shuffle(directions)
        return [text(*direction) for direction in directions]

    def joint_range(self, joint, kind):
        draw = self.draw
        reach = 0.2 if kind == "slide" else draw.angle(0.8)
        if kind == "ball":
            value = text(0, draw.number(0.1, 1) * reach)
        else:
            value = interval(-reach, reach)(draw)
            if joint.get("name"):
                self.limited.add(joint.get("name"))
        self.limit(joint, "range", "limited", value)

    def joint_name(self, kind):
        name = None if self.unnamed() else self.name("joint")
        if name:
            self.joints.append((name, kind))
        return name

    def solids(self, body, index):
        draw = self.draw
        geoms = draw.choice((0, 1, 1, 1, 2))
        for _ in range(geoms):
            self.geom(self.wrapped_frame(body), index)
        if geoms == 0 or draw.chance(0.2):
            self.inertial(body)

    def wrapped_frame(self, body):
        draw = self.draw
        if draw.chance(0.08):
            frame = self.fill(self.classed(self.add(body, "frame")))
            if draw.chance(0.5) and not self.replicated:
                frame.set("name", self.always("frame"))
                self.frames.append(frame.get("name"))
            return frame
        return body

    def inertial(self, body):
        """Moments are those of three random point masses on the axes, or a bit less than such moments can be."""
        draw = self.draw
        mass = draw.scale(0.1, 5)
        squares = [draw.scale(1e-4, 0.02) for _ in range(3)]
        moments = [mass * (sum(squares) - s) for s in squares]
        inertial = self.add(body, "inertial", pos=vector(-0.1, 0.1)(draw), mass=text(mass))
        if draw.chance(0.3):
            products = [draw.number(-0.3, 0.3) * min(squares) * mass for _ in range(3)]
            inertial.set("fullinertia", text(*moments, *products))
        else:
            inertial.set("diaginertia", text(*moments))
            if draw.chance(0.6):
                kind = draw.choice(ORIENTATIONS)
                inertial.set(kind, VALUES["body"][kind](draw))

    def geom(self, parent, body):
        draw = self.draw
        geom = self.classed(self.add(parent, "geom", name=self.named("geom", self.always("geom"), body)))
        self.fill(geom)
        kind = draw.choice(PRIMITIVES)
        if self.meshes and draw.chance(0.4):
            geom.set("mesh", draw.choice(self.meshes))
            if draw.chance(0.3):
                geom.set("type", kind)
                if draw.chance(0.5):
                    geom.set("fitscale", text(draw.number(0.5, 1.5)))
            else:
                geom.set("type", "mesh")
                geom.attrib.pop("shellinertia", None)  # is said of the mesh
        else:
            geom.set("type", kind)
            sizes = [draw.scale(0.03, 0.2) for _ in range(3)]
            geom.set("size", text(*sizes))
            if kind in STRETCHED and draw.chance(0.3):
                for name in ("pos", *ORIENTATIONS):
                    geom.attrib.pop(name, None)
                geom.set("fromto", vector(-0.25, 0.25, 6)(draw))
                geom.set("size", text(sizes[0]))
        if geom.get("type") in ("sphere", "cylinder") and geom.get("name"):
            self.round.append(geom.get("name"))
        if self.materials and draw.chance(0.3):
            geom.set("material", draw.choice(self.materials))

    def site(self, parent, body):
        draw = self.draw
        site = self.classed(self.add(parent, "site", name=self.named("site", self.always("site"), body)))
        self.fill(site)
        if draw.chance(0.3):
            site.set("type", draw.choice(STRETCHED))
            if draw.chance(0.5):
                for name in ("pos", *ORIENTATIONS):
                    site.attrib.pop(name, None)
                site.set("fromto", vector(-0.25, 0.25, 6)(draw))

    def camera(self, parent):
        draw = self.draw
        camera = self.fill(self.classed(self.add(parent, "camera")))
        if not self.replicated:
            camera.set("name", self.always("camera"))
            self.cameras.append(camera.get("name"))
        if "mode" in camera.attrib and not self.replicated and draw.chance(0.5):
            camera.set("target", draw.choice(self.bodies))
        if draw.chance(0.3):  # numbers of few binary digits: MuJoCo keeps 24
            camera.attrib.pop("fovy", None)
            camera.set("sensorsize", draw.choice(("0.03125 0.0625", "0.5 0.25")))
            camera.set("resolution", draw.choice(("2 2", "4 2")))
            camera.set(*draw.choice((("focal", "0.25 0.125"), ("focalpixel", "1.5 2.5"))))
            if draw.chance(0.4):
                camera.set(*draw.choice((("principal", "0.0625 0.125"), ("principalpixel", "0.5 0.25"))))

    # What refers to the tree.

    def contacts(self):
        draw = self.draw
        if draw.chance(0.6):
            return
        section = self.add(self.root, "contact")
        for _ in range(draw.randint(0, 3)):
            two = self.two(self.geoms)
            if two and two[0][1] != two[1][1]:
                pair = self.classed(self.add(section, "pair", geom1=two[0][0], geom2=two[1][0]))
                if draw.chance(0.3):
                    pair.set("name", self.always("pair"))
                self.fill(pair)
        for _ in range(draw.randint(0, 2)):
            two = self.two(self.bodies)
            if two:
                exclude = self.add(section, "exclude", body1=two[0], body2=two[1])
                if draw.chance(0.3):
                    exclude.set("name", self.always("exclude"))

    def two(self, things):
        return self.draw.sample(things, 2) if len(things) > 1 else None

    def scalar_joints(self):
        return [name for name, kind in self.joints if kind in SCALAR]

    def tendon_section(self):
        draw, joints = self.draw, self.scalar_joints()
        kinds = ["fixed"] * bool(joints) + ["spatial"] * (len(self.sites) > 1)
        if not kinds or draw.chance(0.4):
            return
        section = self.add(self.root, "tendon")
        for _ in range(draw.randint(1, 3)):
            tendon = self.classed(self.add(section, draw.choice(kinds), name=self.always("tendon")))
            self.fill(tendon)
            if tendon.tag == "fixed":
                for joint in draw.sample(joints, draw.randint(1, min(3, len(joints)))):
                    self.add(tendon, "joint", joint=joint, coef=VALUES["fixed/joint"]["coef"](draw))
            else:
                self.string(tendon)
            self.tendons.append(tendon.get("name"))
            if "range" in tendon.attrib:
                self.limited.add(tendon.get("name"))

    def string(self, tendon):
        """One branch or two, each through some sites, around geoms between them; a string without geoms can have inertia."""
        draw = self.draw
        for branch in range(draw.choice((1, 1, 2))):
            if branch > 0 or draw.chance(0.2):
                self.add(tendon, "pulley", divisor=text(draw.number(0.5, 3)))
            path = draw.sample(self.sites, min(len(self.sites), draw.randint(2, 4)))
            for k, (site, _) in enumerate(path):
                if k > 0 and self.round and draw.chance(0.5):
                    geom = self.add(tendon, "geom", geom=draw.choice(self.round))
                    if draw.chance(0.5):
                        geom.set("sidesite", draw.choice(self.sites)[0])
                self.add(tendon, "site", site=site)
        if tendon.find("geom") is None and draw.chance(0.3):
            tendon.set("armature", text(draw.scale(0.001, 1)))

    def equalities(self):
        draw = self.draw
        if draw.chance(0.5):
            return
        section = self.add(self.root, "equality")
        for _ in range(draw.randint(1, 3)):
            # MuJoCo's sleep knows no tendon equalities yet.
            kind = draw.choice(("connect", "weld", "joint", *(() if self.sleeps() else ("tendon",))))
            element = ET.Element(kind)
            if draw.chance(0.3):
                element.set("name", self.always("equality"))
            if kind in ("connect", "weld"):
                placed = self.link(element, kind)
            else:
                names = self.scalar_joints() if kind == "joint" else self.tendons
                placed = bool(names)
                if names:
                    chosen = draw.sample(names, min(len(names), draw.randint(1, 2)))
                    element.attrib.update({f"{kind}{k + 1}": name for k, name in enumerate(chosen)})
            if placed:
                self.fill(self.classed(element), f"equality/{kind}" if kind in ("joint", "tendon") else kind)
                section.append(element)

    def link(self, element, kind):
        """What a connect or weld ties together: two sites, two bodies, or a body and the world."""
        draw = self.draw
        two = self.two(self.sites)
        if two and draw.chance(0.4):
            element.attrib.update(site1=two[0][0], site2=two[1][0])
            return True
        two = self.two(self.bodies)
        if not two:
            return False
        element.set("body1", two[0])
        if two[1] != "world" or draw.chance(0.3):
            element.set("body2", two[1])
        if kind == "connect" or draw.chance(0.4):
            element.set("anchor", vector(-0.2, 0.2)(draw))
        if kind == "weld" and draw.chance(0.3):
            element.set("relpose", vector(-0.2, 0.2)(draw) + " " + draw.choice((quaternion(draw), "0 0 0 0")))
        return True

    def actuators(self):
        draw = self.draw
        if not self.joints or draw.chance(0.25):
            return
        section = self.add(self.root, "actuator")
        for _ in range(draw.randint(1, 5)):
            kind = draw.choice(("general", *SHORTCUTS))
            actuator = self.classed(self.add(section, kind))
            if draw.chance(0.5):
                actuator.set("name", self.always("actuator"))
                self.actuator_names.append(actuator.get("name"))
            self.target(actuator)
            self.fill(actuator, without=() if kind == "intvelocity" else ("actrange",))
            self.law(actuator)

    def sensors(self):
        draw = self.draw
        if draw.chance(0.5):
            return
        section = self.add(self.root, "sensor")
        copies = any(element.tag in ("replicate", "attach") for element in self.root.iter())
        for _ in range(draw.randint(1, 15)):
            kind = draw.choice((*harmless.SENSORS, "contact", "contact", "rangefinder", "user"))
            attached = self.attached(kind)
            if attached is None:
                continue
            if copies and not attached.keys() - {"dim"}:  # each replica would double the sensors that refer to nothing
                continue
            sensor = self.add(section, kind, **attached)
            if draw.chance(0.3):
                sensor.set("name", self.always("sensor"))
            self.fill(sensor, f"sensor/{kind}")
            if "nsample" in sensor.attrib and draw.chance(0.7):
                sensor.set("delay", text(draw.scale(0.001, 0.03)))
            if sensor.get("reduce") == "netforce" and "data" in sensor.attrib:
                kept = [word for word in sensor.get("data").split() if word not in ("linvel", "angvel")]
                sensor.set("data", " ".join(kept) or "found")

    def attached(self, kind):
        """What a sensor of this kind measures, None where there is nothing of the sort."""
        draw = self.draw
        sites, geoms = ([name for name, _ in found] for found in (self.sites, self.geoms))
        joints = [name for name, of in self.joints if of == "ball" or not kind.startswith("ball")]
        one = lambda attribute, names: {attribute: draw.choice(names)} if names else None
        switches = {element.get("name"): element.get("limited") for element in self.root.iter()}
        limited = [name for name in (*joints, *self.tendons) if name in self.limited and switches.get(name) == "true"]
        if "limit" in kind:
            return one("joint" if kind.startswith("joint") else "tendon", [n for n in limited if n.startswith("tendon") != kind.startswith("joint")])
        if not kind.startswith("ball"):
            joints = self.scalar_joints()
        if kind in ("e_potential", "e_kinetic", "clock"):
            return {}
        if kind == "user":
            return {"dim": draw.choice((1, 3))}
        if kind.startswith("frame"):
            objects = self.frame("obj", sites, geoms)
            referred = self.frame("ref", sites, geoms) if draw.chance(0.4) and not kind.endswith("acc") else {}
            return {**objects, **referred}
        if kind.startswith(("joint", "ball")):
            return one("joint", joints)
        if kind.startswith("tendon"):
            return one("tendon", self.tendons)
        if kind.startswith("actuator"):
            return one("actuator", self.actuator_names)
        if kind.startswith("subtree"):
            return {"body": draw.choice(self.bodies)}
        if kind == "insidesite":
            return {**one("site", sites), **self.frame("obj", sites, geoms)} if sites else None
        if kind == "camprojection":
            return {**one("site", sites), **one("camera", self.cameras)} if sites and self.cameras else None
        if kind == "rangefinder" and self.cameras and draw.chance(0.5):
            return one("camera", self.cameras)
        if kind in ("distance", "normal", "fromto"):
            two = self.two([name for name in geoms if name != "ground"]) if draw.chance(0.6) else self.two(self.bodies)
            word = "body" if two and two[0] in self.bodies else "geom"
            return two and {f"{word}{k + 1}": name for k, name in enumerate(two)}
        if kind == "contact":
            named = {"geom": geoms, "body": self.bodies, "subtree": self.bodies}
            chosen = {}
            for side in (1, 2):
                if draw.chance(0.6):
                    word = draw.choice(sorted(named))
                    chosen |= one(f"{word}{side}", named[word]) or {}
                elif side == 1 and draw.chance(0.4):
                    chosen |= one("site", sites) or {}
            return chosen
        return one("site", sites)

    def frame(self, word, sites, geoms):
        """The object of a frame."""
        kinds = {"body": self.bodies, "xbody": self.bodies, "site": sites, "geom": geoms, "camera": self.cameras}
        kind = self.draw.choice([kind for kind in sorted(kinds) if kinds[kind]])
        return {f"{word}type": kind, f"{word}name": self.draw.choice(kinds[kind])}

    def target(self, actuator):
        """What an actuator pulls on."""
        draw = self.draw
        if actuator.tag == "adhesion" or actuator.tag == "general" and draw.chance(0.1):
            actuator.set("body", draw.choice(self.bodies))
        elif self.tendons and draw.chance(0.3):
            actuator.set("tendon", draw.choice(self.tendons))
        elif len(self.sites) > 1 and draw.chance(0.3):
            first, second = (name for name, _ in draw.sample(self.sites, 2))
            if actuator.tag == "muscle" or draw.chance(0.4):  # muscles do not pull on sites
                actuator.attrib.update(cranksite=first, slidersite=second, cranklength=text(draw.scale(0.1, 2)))
            else:
                actuator.set("site", first)
                if draw.chance(0.5):
                    actuator.set("refsite", second)
        else:
            actuator.set(draw.choice(("joint", "joint", "jointinparent")), draw.choice(self.joints)[0])

    def law(self, actuator):
        """What depends on other attributes of an actuator, or on its target."""
        draw, kind = self.draw, actuator.tag
        if kind != "adhesion" and not {"joint", "jointinparent"} & actuator.attrib.keys():  # tendons are not damped by actuators yet
            actuator.attrib.update(damping="0 0 0", armature="0")
        if "nsample" in actuator.attrib and draw.chance(0.7):
            actuator.set("delay", text(draw.scale(0.001, 0.03)))
        if kind in ("damper", "adhesion"):
            ends = sorted((draw.number(0, 1), draw.number(0, 2)))
            actuator.set("ctrlrange", text(ends[0], ends[1] + 0.01))
        dynamics = actuator.get("dyntype")
        if kind == "general" and draw.chance(0.2):
            actuator.set("actdim", {None: "-1", "none": draw.choice(("-1", "0")), "user": draw.choice("123")}.get(dynamics, "1"))
        if kind == "general" and dynamics == "muscle":
            actuator.set("dynprm", VALUES["muscle"]["timeconst"](draw))
        if kind != "adhesion" and (kind == "muscle" or draw.chance(0.1)):
            actuator.set("lengthrange", interval(-0.5, 0.5)(draw))
        if kind == "general" and dynamics not in (None, "none") and draw.chance(0.3):
            self.limit(actuator, "actrange", "actlimited", interval(-1, 1)(draw))
        if kind == "dcmotor":
            self.constants(actuator)
        if kind in ("pid", "dcmotor") and {"controller", "ki", "slewmax"} & set(actuator.attrib):
            actuator.set("input", draw.choice(("pos", "pos vel", "pos vel ff")))
        elif kind == "dcmotor" and "input" not in actuator.attrib:
            actuator.set("input", "")
        if kind == "general" and draw.chance(0.1):
            self.controlled(actuator)
        target = actuator.get("joint") or actuator.get("tendon")
        if target in self.limited and kind in ("position", "intvelocity", "pid", "general") and draw.chance(0.3):
            of_activations = kind == "intvelocity" or dynamics == "integrator"
            actuator.set("inheritrange", text(draw.number(0.5, 1.2)))
            actuator.attrib.pop("actrange" if of_activations else "ctrlrange", None)
            actuator.attrib.pop("actlimited" if of_activations else "ctrllimited", None)
            actuator.attrib.pop("posrange", None)
            if kind == "general":
                actuator.attrib.pop("input", None)
                gain = text(draw.scale(0.5, 20))
                actuator.attrib.update(gaintype="fixed", gainprm=gain, biastype="affine", biasprm=f"0 -{gain}")


    def constants(self, motor):
        """Gives a motor the constants that it cannot be without."""
        for name in ("resistance", "motorconst"):
            if name not in motor.attrib and "nominal" not in motor.attrib:
                motor.set(name, VALUES["dcmotor"][name](self.draw))

    def controlled(self, actuator):
        """Turns a general actuator into a PID controller."""
        draw = self.draw
        stateful = draw.chance(0.5)
        actuator.attrib.update(gaintype="pid", biastype="affine", dyntype="pid" if stateful else "none")
        actuator.attrib.update(gainprm=text(draw.scale(0.3, 5) if stateful else 0), dynprm=text(draw.number(0, 1), draw.number(0.1, 3)))
        actuator.set("biasprm", text(draw.number(-1, 1), -draw.scale(0.3, 30), -draw.scale(0.03, 3)))
        actuator.attrib.update({name: VALUES["pid"][name](draw) for name in ("velrange", "ffrange")}, input=draw.choice(("pos", "pos vel ff")))
        actuator.attrib.pop("actdim", None)
        if not stateful:
            for name in ("actrange", "actlimited"):
                actuator.attrib.pop(name, None)


def with_keyframe(root, model, draw):
    """Adds a keyframe to the file of a compiled model, which knows how many numbers it needs."""
    section = ET.SubElement(root, "keyframe")
    key = ET.SubElement(section, "key", name="key")
    lengths = {"qpos": model.nq, "qvel": model.nv, "act": model.na, "ctrl": model.nu, "mpos": 3 * model.nmocap, "mquat": 4 * model.nmocap}
    for name, length in lengths.items():
        if length and draw.chance(0.5):
            key.set(name, text(*(draw.gauss(0, 0.5) for _ in range(length))))
    if draw.chance(0.5):
        key.set("time", text(draw.number(0, 10)))
    return root


def written(root):
    """The model as text, an element a line."""
    ET.indent(root)
    return ET.tostring(root, encoding="unicode")
