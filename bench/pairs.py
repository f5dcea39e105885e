"""Times the collision of each pair of shapes: Clench's narrow phase and MuJoCo's on the same poses.

The example `pairs` of clench-collide generates a thousand poses of each pair of shapes and times itself on them. MuJoCo
gets the same poses in one scene, with the pairs far from each other, and reports its own timer of the narrow phase, at
its defaults. That timer includes the mixing of contact parameters, which is a separate stage in Clench. The engines
alternate; figures are the best of all runs, since every run repeats the same work.
"""

import json
import os
import subprocess
import time

import mujoco
import numpy as np

from scene import ROOT

PAIRS = os.environ.get("PAIRS", str(ROOT / "target/dist/examples/pairs"))
TIMER = int(mujoco.mjtTimer.mjTIMER_COL_NARROW)
TURNS = 3
RUNS = 7
# The distance between pairs, m, and the number of pairs in a row.
SPACING, ROW = 4.0, 32


def compare(_, args):
    """Times both engines on every pair, prints a table and returns its rows."""
    mujoco.set_mjcb_time(lambda: 1e9 * time.perf_counter())
    print("\none pair of shapes, a thousand poses; times in ns, then points per pose")
    print(f"  {'pair':<30}{'clench':>8}{'mujoco':>8}{'ratio':>7}{'clench':>9}{'mujoco':>8}")
    try:
        return [measure(name) for name in example("--list").split("\n") if name]
    finally:
        mujoco.set_mjcb_time(None)


def measure(name):
    """Times both engines alternately on one pair; prints and returns its row."""
    scene = None
    clench, other, contacts = np.inf, np.inf, 0
    for _ in range(TURNS):
        row = json.loads(example("--json", name))
        clench = min(clench, row["ns"])
        scene = scene or MuJoCo(row)
        nanoseconds, contacts = scene.run()
        other = min(other, nanoseconds)
    ratio = other / clench
    print(f"  {name:<30}{clench:>8.0f}{other:>8.0f}{ratio:>7.2f}{row['points']:>9.2f}{contacts:>8.2f}", flush=True)
    return {
        "pair": name, "engine": "clench", "nanoseconds": clench, "mujoco_nanoseconds": other, "ratio": ratio,
        "contacts_mean": row["points"], "mujoco_contacts_mean": contacts,
    }  # fmt: skip


def example(*arguments):
    """Returns the output of the example."""
    return subprocess.run([PAIRS, *arguments], capture_output=True, text=True, check=True).stdout


class MuJoCo:
    """A scene with all poses of a pair."""

    def __init__(self, row):
        self.poses = len(row["bodies"])
        self.model = mujoco.MjModel.from_xml_string(xml(row))
        if self.model.nhfield:
            self.model.hfield_data[:] = row["assets"][0]["heights"]
        self.data = mujoco.MjData(self.model)
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)

    def run(self):
        """Returns the nanoseconds and contacts per pose."""
        timer, best = self.data.timer[TIMER], np.inf
        for _ in range(RUNS):
            timer.duration, timer.number = 0, 0
            mujoco.mj_collision(self.model, self.data)
            best = min(best, timer.duration)
        return best / self.poses, self.data.ncon / self.poses


def xml(row):
    """Returns a model with all pairs as free bodies on a grid.

    A plane or terrain occurs once, and poses are relative to it. Bodies on terrain overlap, so they collide only with
    the terrain.
    """
    kinds = row["pair"]
    terrain = kinds[0] == "terrain"
    meshes = [
        f'<mesh name="{side}_{k}" vertex="{numbers(np.ravel(hull))}"/>'
        for side, hulls in enumerate(assets["hulls"] for assets in row["assets"])
        for k, hull in enumerate(hulls)
    ]
    bodies, ground = [], kinds[0] in ("plane", "terrain")
    if terrain:
        grid, size = row["assets"][0]["grid"], row["assets"][0]["terrain"]
        meshes.append(f'<hfield name="terrain" nrow="{grid}" ncol="{grid}" size="{numbers(size)}"/>')
        bodies.append('<geom type="hfield" hfield="terrain" contype="1" conaffinity="0"/>')
    elif ground:
        bodies.append('<geom type="plane" size="1 1 1"/>')
    for k, pair in enumerate(row["bodies"]):
        corner = np.zeros(3) if terrain else np.array([SPACING * (k % ROW), SPACING * (k // ROW), 0.0])
        for side, body in enumerate(pair):
            if ground and side == 0:
                continue
            position, quat = seen_from(pair[0], body) if ground else (body["pos"], body["quat"])
            place = f'pos="{numbers(corner + position)}" quat="{numbers(quat)}"'
            bodies.append(f"<body {place}><freejoint/>{geom(kinds[side], side, body)}</body>")
    return f"""<mujoco><size memory="200M"/><default><geom mass="1"{' contype="0"' if terrain else ""}/></default>
        <asset>{"".join(meshes)}</asset><worldbody>{"".join(bodies)}</worldbody></mujoco>"""


def geom(kind, side, body):
    if kind.startswith("hull"):
        return f'<geom type="mesh" mesh="{side}_{body["hull"]}"/>'
    return f'<geom type="{kind}" size="{numbers(body["size"])}"/>'


def seen_from(frame, body):
    """Returns the position and quaternion of a body in the frame of another."""
    back, position, quat = np.zeros(4), np.zeros(3), np.zeros(4)
    mujoco.mju_negQuat(back, np.array(frame["quat"]))
    mujoco.mju_rotVecQuat(position, np.array(body["pos"]) - np.array(frame["pos"]), back)
    mujoco.mju_mulQuat(quat, back, np.array(body["quat"]))
    return position, quat


def numbers(values):
    return " ".join(repr(float(v)) for v in values)
