"""The tree of bodies of a random model, with their joints, geoms, sites and cameras."""

import xml.etree.ElementTree as ET

from random_models.maker import PRIMITIVES, STRETCHED, Maker
from random_models.values import ORIENTATIONS, VALUES, interval, number, text, vector


class Tree(Maker):
    """The bodies."""

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

    def wrapped(self, parent):
        """Returns the parent, or a new frame or replicate element in it."""
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
            # In a given state, MuJoCo does not compute the smooth forces of bodies that start asleep.
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

    def attach(self, parent, top=False):
        """Attaches a part of another model or of this one."""
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
            return  # an element under replication cannot be attached
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
            if self.last.chance(0.15):
                self.yielding(joint, kind)
            if len(kinds) > 1:  # parallel axes would make the mass matrix singular
                joint.set("axis", axes.pop())
            if draw.chance(0.35):
                self.joint_range(joint, kind)

    def yielding(self, joint, kind):
        """Makes the spring of a joint yield, and adds a spring if there is none."""
        strain = self.last.number(0.01, 0.3)
        joint.set("springyield", text(strain if kind == "slide" else self.draw.angle(strain)))
        if "stiffness" not in joint.attrib:
            joint.set("stiffness", text(self.last.scale(0.1, 100)))

    def independent_axes(self):
        """Returns three directions, each nearest to a different axis."""
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
        """Adds an inertia with the moments of random point masses on the axes, sometimes with small products."""
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
                geom.attrib.pop("shellinertia", None)  # an attribute of the mesh
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
        if draw.chance(0.3):  # numbers with few binary digits, since MuJoCo stores 24
            camera.attrib.pop("fovy", None)
            camera.set("sensorsize", draw.choice(("0.03125 0.0625", "0.5 0.25")))
            camera.set("resolution", draw.choice(("2 2", "4 2")))
            camera.set(*draw.choice((("focal", "0.25 0.125"), ("focalpixel", "1.5 2.5"))))
            if draw.chance(0.4):
                camera.set(*draw.choice((("principal", "0.0625 0.125"), ("principalpixel", "0.5 0.25"))))
