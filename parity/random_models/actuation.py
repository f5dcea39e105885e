"""The actuators of a random model."""

from random_models.maker import SHORTCUTS, Maker
from random_models.values import VALUES, interval, text


class Actuation(Maker):
    """The section of actuators on joints, tendons, sites and bodies."""

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
        if self.later.chance(0.3):
            self.orientation(section)

    def orientation(self, section):
        """Adds an orientation servo of a ball joint, or of a site in the frame of another, if there is any."""
        draw = self.later
        balls = [name for name, kind in self.joints if kind == "ball"]
        if not balls and len(self.sites) < 2:
            return
        servo = self.add(section, "orientation")
        if balls and draw.chance(0.5) or len(self.sites) < 2:
            servo.set("joint", draw.choice(balls))
        else:
            first, second = (name for name, _ in draw.sample(self.sites, 2))
            servo.attrib.update(site=first, refsite=second)
        for name, value in VALUES["orientation"].items():
            if draw.chance(0.5) and not (name == "dampratio" and "kv" in servo.attrib):
                servo.set(name, value(draw))
        # With implicit integrators rounding decides in MuJoCo whether a torque at its limit is damped.
        if draw.chance(0.4) and not self.implicit():
            servo.set("forcerange", text(0, draw.scale(0.1, 3)))
            servo.set("forcelimited", draw.choice(("true", "true", "false")))
        if self.draw.autolimits and draw.chance(0.4):
            servo.set("ctrlrange", text(-draw.number(0, 1), draw.number(0.1, 2)))
        if self.classes and draw.chance(0.2):
            servo.set("class", draw.choice(self.classes))
        if "nsample" in servo.attrib and draw.chance(0.5):
            servo.set("delay", text(draw.scale(0.001, 0.03)))
        if draw.chance(0.5):
            servo.set("name", f"orientation{draw.randint(1, 9)}x")

    def target(self, actuator):
        """Sets the transmission target of an actuator."""
        draw = self.draw
        if actuator.tag == "adhesion" or actuator.tag == "general" and draw.chance(0.1):
            actuator.set("body", draw.choice(self.bodies))
        elif self.tendons and draw.chance(0.3):
            actuator.set("tendon", draw.choice(self.tendons))
        elif len(self.sites) > 1 and draw.chance(0.3):
            first, second = (name for name, _ in draw.sample(self.sites, 2))
            if actuator.tag == "muscle" or draw.chance(0.4):  # muscles do not act on sites
                actuator.attrib.update(cranksite=first, slidersite=second, cranklength=text(draw.scale(0.1, 2)))
            else:
                actuator.set("site", first)
                if draw.chance(0.5):
                    actuator.set("refsite", second)
        else:
            actuator.set(draw.choice(("joint", "joint", "jointinparent")), draw.choice(self.joints)[0])

    def law(self, actuator):
        """Sets attributes that depend on other attributes of an actuator or on its target."""
        draw, kind = self.draw, actuator.tag
        # Actuators damp only joints and tendons.
        if kind != "adhesion" and not {"joint", "jointinparent", "tendon"} & actuator.attrib.keys():
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
