"""Gives frames of random models scales that differ between axes.

MuJoCo refuses elements that such scales would deform: spheres, and unaligned shapes and joints. These are replaced by
aligned ones.
"""

from random_models.values import ORIENTATIONS, Draw, text

AXES = ("1 0 0", "0 1 0", "0 0 1")
# Rotations that map coordinate axes to coordinate axes.
TURNS = ("1 0 0 0", "1 0 0 1", "1 1 0 0", "0 1 0 0", "0.5 -0.5 0.5 0.5", "0 0 0.7 0.7")


def stretch_frames(root, seed):
    """Gives some frames of some models a scale for each axis."""
    draw = Draw(f"{seed} axes")
    if draw.chance(0.85):
        return
    frames = [frame for frame in root.iter("frame") if frame.get("scaling") != "similar" or draw.chance(0.5)]
    for frame in frames:
        if draw.chance(0.3) or any(inner.get("scaling") == "similar" and "scale" in inner.attrib for inner in frame.iter("frame")):
            continue
        factors = [draw.scale(0.5, 2) for _ in range(3)]
        if draw.chance(0.4):
            factors[1] = factors[0]
        frame.set("scale", text(*factors))
        frame.set("scaling", "geometry")
        for element in frame.iter():
            if element is not frame:
                align(element, draw, round_about_z=factors[0] == factors[1])


def align(element, draw, round_about_z):
    """Gives an element in such a frame a shape and an orientation that the scale preserves."""
    if element.tag == "geom" and "mesh" not in element.attrib:
        kinds = ("cylinder", "capsule", "box") if round_about_z else ("box", "ellipsoid")
        if element.get("type") not in ("plane", "hfield", *kinds):
            element.set("type", draw.choice(kinds))
            element.set("size", sizes(draw))
        if "fromto" in element.attrib and round_about_z:
            element.set("fromto", text(0.1, 0.1, -0.1, 0.1, 0.1, draw.number(0, 0.3)))
        elif element.attrib.pop("fromto", None):
            element.set("size", sizes(draw))
    if element.tag in ("body", "frame") or element.tag == "geom" and "mesh" not in element.attrib:
        for name in ORIENTATIONS:
            element.attrib.pop(name, None)
        if "fromto" not in element.attrib:
            element.set("quat", text(1, 0, 0, draw.number(-1, 1)) if round_about_z else draw.choice(TURNS))
    if element.tag == "replicate":
        element.attrib.pop("euler", None)
    if element.tag == "joint" and element.get("type") in (None, "hinge", "slide"):
        element.set("axis", AXES[2] if round_about_z and draw.chance(0.5) else draw.choice(AXES))


def sizes(draw):
    return text(*(draw.scale(0.03, 0.2) for _ in range(3)))
