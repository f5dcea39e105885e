"""The relations between bodies of a random model: contact pairs, tendons, equalities."""

import xml.etree.ElementTree as ET

from random_models.maker import Maker
from random_models.values import VALUES, quaternion, text, vector


class Relations(Maker):
    """The sections that relate elements of the tree."""

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

    def tendon_section(self):
        draw, joints = self.draw, self.scalar_joints()
        kinds = ["fixed"] * bool(joints) + ["spatial"] * (len(self.sites) > 1)
        if not kinds or draw.chance(0.4):
            return
        section = self.add(self.root, "tendon")
        for _ in range(draw.randint(1, 3)):
            tendon = self.classed(self.add(section, draw.choice(kinds), name=self.always("tendon")))
            self.fill(tendon)
            if self.last.chance(0.25):
                tendon.set("springyield", text(self.last.number(0.005, 0.2)))
            if tendon.tag == "fixed":
                for joint in draw.sample(joints, draw.randint(1, min(3, len(joints)))):
                    self.add(tendon, "joint", joint=joint, coef=VALUES["fixed/joint"]["coef"](draw))
            else:
                self.string(tendon)
            self.tendons.append(tendon.get("name"))
            if "range" in tendon.attrib:
                self.limited.add(tendon.get("name"))

    def string(self, tendon):
        """Adds one or two branches of sites and wrapped geoms to a tendon. Without geoms it can have inertia."""
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
            # MuJoCo does not support tendon equalities with sleep yet.
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
        """Sets the ends of a connect or weld: two sites, two bodies, or a body and the world."""
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
