"""Scenes of many bodies or geoms, generated as MJCF text for a given number of them."""

import math

import numpy as np

from scene import ROOT

HEAD = """<mujoco model="{name}">
  <option timestep="0.002">{flag}</option>
  <asset>
    <mesh name="rock" vertex="0.06 0 -0.01  0.03 0.05 0  -0.03 0.045 0.01  -0.06 0 0  -0.03 -0.05 0.01  0.03 -0.045 0
                              0.03 0 0.04  -0.02 0.02 0.045  -0.02 -0.025 0.04  0.02 0.02 -0.045  0.02 -0.02 -0.04  -0.03 0 -0.04"/>
    {assets}
  </asset>
  <default> <geom density="800" friction="0.7 0.005 0.0001"/> </default>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1"/>
"""
TAIL = "  </worldbody>\n</mujoco>\n"

# Small bodies of every shape, all within 0.09 m of their centre.
SHAPES = [
    'type="box" size="0.06 0.05 0.04"',
    'type="cylinder" size="0.05 0.05"',
    'type="sphere" size="0.06"',
    'type="mesh" mesh="rock"',
    'type="ellipsoid" size="0.07 0.05 0.04"',
    'type="capsule" size="0.04 0.05"',
]


def document(name, bodies, flag="", assets=""):
    """Returns a model file with these lines in the world body, above a floor."""
    return HEAD.format(name=name, flag=flag, assets=assets) + "\n".join(bodies) + "\n" + TAIL


def free(shape, position, turn=(0, 0, 0), more=""):
    """Returns a free body of one geom."""
    numbers = lambda values: " ".join(f"{value:.6g}" for value in values)
    return f'<body pos="{numbers(position)}" euler="{numbers(turn)}" {more}><freejoint/><geom {shape}/></body>'


def pile(count):
    """Returns `count` bodies of six shapes above a bin, six to ten layers high for any number."""
    rng = np.random.default_rng(count)
    wide = max(3, round(math.sqrt(count / 8)))
    half = 0.1 * wide + 0.05
    walls = [
        f'<geom type="box" size="{"0.05 " + str(half + 0.1) if x else str(half + 0.1) + " 0.05"} 1" '
        f'pos="{x * (half + 0.05):.4g} {y * (half + 0.05):.4g} 1"/>'
        for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))
    ]
    bodies = []
    for k in range(count):
        layer, place = divmod(k, wide * wide)
        x, y = (0.2 * (index - (wide - 1) / 2) for index in divmod(place, wide))
        position = np.array([x, y, 0.1 + 0.16 * layer]) + rng.uniform(-0.01, 0.01, 3)
        bodies.append(free(SHAPES[k % len(SHAPES)], position, rng.uniform(-60, 60, 3)))
    return document(f"pile of {count}", walls + bodies)


def rings(courses, stones=19):
    """Returns a round tower without mortar: rings of stones, each course turned by half a stone."""
    radius, height = 0.16 * stones / (2 * math.pi), 0.06
    shape = f'type="box" size="0.05 0.074 {height / 2}"'
    bodies = []
    for course in range(courses):
        for stone in range(stones):
            angle = 2 * math.pi * (stone + 0.5 * (course % 2)) / stones
            position = radius * math.cos(angle), radius * math.sin(angle), height * (course + 0.5)
            bodies.append(free(shape, position, (0, 0, math.degrees(angle))))
    return document(f"{courses} rings of {stones} stones", bodies)


def wall(count, wide=25):
    """Returns a wall of `count` boxes in courses, each box on two of the course below."""
    bodies = []
    for k in range(count):
        course, place = divmod(k, wide)
        bodies.append(free('type="box" size="0.1 0.05 0.05"', (0.202 * (place + 0.5 * (course % 2)), 0, 0.1 * course + 0.05)))
    return document(f"wall of {count}", bodies)


def asleep(count):
    """Returns `count` boxes that rest apart from each other and sleep from the start."""
    wide = math.ceil(math.sqrt(count))
    places = (divmod(k, wide) for k in range(count))
    bodies = [free('type="box" size="0.05 0.05 0.05"', (0.2 * x, 0.2 * y, 0.05), more='sleep="init"') for x, y in places]
    return document(f"{count} asleep", bodies, flag='<flag sleep="enable"/>')


def chain(count):
    """Returns a chain of `count` links, fixed at one end and initially straight. The links do not collide."""
    link = 'type="capsule" fromto="0 0 0 0.05 0 0" size="0.01" contype="0" conaffinity="0"'
    axes = ("0 1 0", "0 0 1")
    opening = [
        f'<body pos="{0.05 if k else 0} 0 {0 if k else 0.06 * count}"><joint axis="{axes[k % 2]}" damping="0.01" armature="0.001"/><geom {link}/>'
        for k in range(count)
    ]
    return document(f"chain of {count}", [*opening, "</body>" * count])


def humanoids(count):
    """Returns `count` of our humanoids, apart from each other, which fall."""
    wide = math.ceil(math.sqrt(count))
    bodies = []
    for k in range(count):
        x, y = divmod(k, wide)
        bodies.append(f'<frame pos="{1.5 * x} {1.5 * y} 0"><attach model="humanoid" body="torso" prefix="h{k}_"/></frame>')
    model = f'<model name="humanoid" file="{ROOT / "models/humanoid.xml"}"/>'
    return document(f"{count} humanoids", bodies, assets=model)


def room(count):
    """Returns a base on wheels with an arm among `count` static geoms."""
    rng = np.random.default_rng(0)
    wide = math.ceil(math.sqrt(count))
    things = []
    for k in range(count):
        x, y = (0.5 * (index - (wide - 1) / 2) for index in divmod(k, wide))
        if math.hypot(x, y) < 0.7:  # where the base stands, geoms hang above it
            z = 3.0
        else:
            z = rng.uniform(0.05, 0.8)
        turn = " ".join(f"{angle:.3g}" for angle in rng.uniform(-180, 180, 3))
        things.append(f'<geom {SHAPES[k % len(SHAPES)]} pos="{x:.4g} {y:.4g} {z:.4g}" euler="{turn}"/>')
    wheel = '<geom type="cylinder" size="0.1 0.03" euler="90 0 0" condim="4"/>'
    wheels = "".join(
        f'<body pos="{x} {y} 0"><joint name="wheel{x}{y}" axis="0 1 0" damping="0.1"/>{wheel}</body>'
        for x in (-0.2, 0.2)
        for y in (-0.25, 0.25)
    )
    link = 'type="capsule" fromto="0 0 0 0.3 0 0.1" size="0.03"'
    arm = "".join(
        f'<body pos="{"0 0 0.15" if k == 0 else "0.3 0 0.1"}"><joint name="arm{k}" axis="{"0 0 1" if k % 2 == 0 else "0 1 0"}" damping="2" '
        f'armature="0.05" range="-120 120"/><geom {link}/>'
        for k in range(5)
    )
    base = (
        f'<body pos="0 0 0.101"><freejoint/><geom type="box" size="0.3 0.2 0.08" pos="0 0 0.05" density="2000"/>{wheels}{arm}{"</body>" * 5}</body>'
    )
    motors = "".join(f'<velocity joint="wheel{x}{y}" kv="2" ctrlrange="-3 3"/>' for x in (-0.2, 0.2) for y in (-0.25, 0.25))
    motors += "".join(f'<position joint="arm{k}" kp="100" kv="10" ctrlrange="-1 1"/>' for k in range(5))
    text = document(f"room of {count}", [*things, base])
    return text.replace("</worldbody>", f"</worldbody>\n  <actuator>{motors}</actuator>")
