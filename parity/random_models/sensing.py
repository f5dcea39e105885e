"""The sensors of a random model."""

from random_models import harmless
from random_models.maker import PRIMITIVES, Maker
from random_models.values import VALUES, text

# These measure active tendon ranges, which few models have.
RARE = ("tendonlimitpos", "tendonlimitvel", "tendonlimitfrc") * 3


class Sensing(Maker):
    """The section of sensors."""

    def sensors(self):
        draw = self.draw
        if draw.chance(0.5):
            return
        section = self.add(self.root, "sensor")
        copies = any(element.tag in ("replicate", "attach") for element in self.root.iter())
        for _ in range(draw.randint(1, 30)):
            kind = draw.choice((*harmless.SENSORS, *RARE, "contact", "contact", "rangefinder", "user"))
            attached = self.attached(kind)
            if attached is None:
                continue
            if copies and not attached.keys() - {"dim"}:  # each replica would duplicate sensors without references
                continue
            sensor = self.add(section, kind, **attached)
            if draw.chance(0.3):
                sensor.set("name", self.always("sensor"))
            self.fill(sensor, f"sensor/{kind}")
            if "nsample" in sensor.attrib and draw.chance(0.7):
                sensor.set("delay", text(draw.scale(0.001, 0.03)))
            if "nsample" in sensor.attrib and self.later.chance(0.5):
                period = self.later.scale(0.001, 0.03)
                sensor.set("interval", text(period, *self.later.choice(((), (0,), (-period * self.later.number(0, 0.99),)))))
            if sensor.get("reduce") == "netforce" and "data" in sensor.attrib:
                kept = [word for word in sensor.get("data").split() if word not in ("linvel", "angvel")]
                sensor.set("data", " ".join(kept) or "found")

        self.skins(section)

    def enclose(self):
        """Adds sensors of the protrusion from round sites, whose search does not depend on rounding."""
        draw = self.last
        sections = list(self.root.iter("sensor"))
        classed = any(element.get("type") for default in self.root.iter("default") for element in default if element.tag in ("geom", "site"))
        kinds = {(element.tag, element.get("name")): element.get("type", "sphere") for element in self.root.iter() if element.tag in ("geom", "site")}
        named = [("geom", name) for name, _ in self.geoms] + [("site", name) for name, _ in self.sites]
        bounded = [pair for pair in named if kinds.get(pair) in (*PRIMITIVES, "mesh")]
        round_ = [name for of, name in bounded if of == "site" and kinds[of, name] in ("sphere", "ellipsoid")]
        if not sections or classed or not round_ or draw.chance(0.5):
            return
        for _ in range(draw.randint(1, 3)):
            of, name = draw.choice(bounded)
            self.add(sections[-1], "insidesite", site=draw.choice(round_), objtype=of, objname=name, enclosed="true")

    def skins(self, section):
        """Adds tactile sensors with a mesh in the frame of a geom."""
        draw = self.last
        geoms = [name for name, _ in self.geoms]
        # MuJoCo aborts the process if a tactile sensor touches a height field.
        terrain = any(geom.get("type") == "hfield" for geom in self.root.iter("geom"))
        if not self.meshes or not geoms or terrain or draw.chance(0.7):
            return
        for _ in range(draw.randint(1, 3)):
            skin = self.add(section, "tactile", mesh=draw.choice(self.meshes), geom=draw.choice(geoms))
            for name, value in VALUES["sensor/tactile"].items():
                if draw.chance(0.2):
                    skin.set(name, value(draw))
            if draw.chance(0.1):
                skin.set("name", f"skin{len(section)}")
            if "nsample" in skin.attrib and draw.chance(0.7):
                skin.set("delay", text(draw.scale(0.001, 0.03)))
            if "nsample" in skin.attrib and draw.chance(0.3):
                skin.set("interval", text(draw.scale(0.001, 0.03)))

    def attached(self, kind):
        """Returns the object that a sensor of this kind measures, or None if the model has no such object."""
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
        """Returns a random object with a frame."""
        kinds = {"body": self.bodies, "xbody": self.bodies, "site": sites, "geom": geoms, "camera": self.cameras}
        kind = self.draw.choice([kind for kind in sorted(kinds) if kinds[kind]])
        return {f"{word}type": kind, f"{word}name": self.draw.choice(kinds[kind])}
