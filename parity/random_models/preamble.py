"""The sections before the tree of a random model: settings, classes and assets."""

import pathlib

from random_models.maker import PRIMITIVES, SCALAR, SHORTCUTS, Maker
from random_models.values import VALUES, text, vector

ASSETS = pathlib.Path(__file__).resolve().parent.parent / "shapes/assets"
MESH_FILES = (("rock.obj", "model/obj"), ("wedge.stl", "model/stl"), ("bracket.obj", "model/obj"))
# Attributes with which many elements of a class would not compile: a joint's range fits one type of joint, a position
# contradicts `fromto`, dampers accept no negative controls, and only actuators with activations can limit them.
INITIAL = {"geom": ("pos", "mass"), "site": ("pos",)}
NOT_IN_CLASSES = ("fromto", "ctrlrange", "actrange", "tausmooth", "controller", "ki", "slewmax")


class Preamble(Maker):
    """The sections before the tree."""

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
                flags.attrib.pop("sleep", None)  # refused with RK4
        if any(option.get("integrator") == "discrete" for option in self.root.iter("option")):
            for option in self.root.iter("option"):
                if option.get("solver") == "PGS":
                    del option.attrib["solver"]  # PGS steps in another metric and is refused with discrete
                for flags in option.iter("flag"):
                    flags.attrib.pop("sleep", None)  # refused if the metric couples trees

    def implicit(self):
        """Returns True if the integrator uses derivatives of forces with respect to velocities."""
        return any(option.get("integrator") in ("implicit", "implicitfast", "discrete") for option in self.root.iter("option"))

    def sleeps(self):
        """Returns True if islands at rest sleep."""
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
            if self.last.chance({"joint": 0.15, "tendon": 0.2}.get(tag, 0)):
                element.set("springyield", text(self.last.number(0.01, 0.3)))
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
        """Adds a model that can be attached."""
        part = self.add(asset, "model", file=ASSETS / "part.xml")
        name = self.draw.choice((None, self.always("model")))
        if name:
            part.set("name", name)
        if self.draw.chance(0.3):
            part.set("content_type", "text/xml")
        self.parts.append(name or "part")

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
                "wedge": lambda: (draw.randint(2, 6), draw.randint(2, 6), draw.number(20, 180), draw.number(10, 90), draw.random()),
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
        if "vertex" in mesh.attrib and self.last.chance(0.3):  # a normal and two tangents at each vertex
            mesh.set("normal", text(*(self.last.number(-1, 1) for _ in range(3 * len(mesh.get("vertex").split())))))
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
