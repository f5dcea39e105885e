"""Contact patches of faces on each other: their area compared with MuJoCo's default and with the whole overlap."""

import itertools

import mujoco
import numpy as np
import pytest

import program

# Shapes 0.1 m high, flat at the bottom and top.
FACES = {
    "box": 'type="box" size="0.06 0.04 0.05"',
    "cylinder": 'type="cylinder" size="0.05 0.05"',
    "prism": 'type="mesh" mesh="prism"',
    "block": 'type="mesh" mesh="block"',
}
HALF = 0.05
STATES = 60


def mesh(name, corners):
    vertices = [f"{x:.6f} {y:.6f} {z}" for z in (-HALF, HALF) for x, y in corners]
    return f'<mesh name="{name}" vertex="{"  ".join(vertices)}"/>'


def scene(below, above):
    turn = np.arange(6) * np.pi / 3
    hexagon = 0.05 * np.transpose([np.cos(turn), np.sin(turn)])
    lower = "" if below == "plane" else f"<geom {FACES[below]}/>"
    floor = '<geom type="plane" size="1 1 1"/>' if below == "plane" else ""
    return f"""<mujoco>
      <asset>{mesh("prism", hexagon)} {mesh("block", [(0.05, 0.04), (-0.05, 0.04), (-0.05, -0.04), (0.05, -0.04)])}</asset>
      <worldbody>{floor}
        <body><freejoint/><geom {FACES[above]}/></body>
        {f"<body><freejoint/>{lower}</body>" if lower else ""}
      </worldbody></mujoco>"""


def poses(rng, below):
    """Returns a pose of one body on the other: up to 1 mm deep, displaced, turned about z, slightly tilted."""
    quat, tilt = np.empty(4), np.empty(4)
    axis = rng.standard_normal(3) * 10 ** rng.uniform(-7, -3)
    mujoco.mju_axisAngle2Quat(quat, [0, 0, 1], rng.uniform(0, 2 * np.pi))
    mujoco.mju_axisAngle2Quat(tilt, axis / np.linalg.norm(axis), np.linalg.norm(axis))
    mujoco.mju_mulQuat(quat, tilt, quat.copy())
    height = HALF if below == "plane" else 2 * HALF
    above = [*rng.uniform(-0.03, 0.03, 2), height - rng.uniform(2e-4, 1e-3), *quat]
    return above if below == "plane" else [*above, 0, 0, 0, 1, 0, 0, 0]


def face(shape):
    """Returns the corners of a face, counter-clockwise."""
    if shape in ("box", "block"):
        x, y = (0.06, 0.04) if shape == "box" else (0.05, 0.04)
        return np.array([(x, y), (-x, y), (-x, -y), (x, -y)])
    turn = 2 * np.pi * np.arange(6 if shape == "prism" else 256)
    turn /= len(turn)
    return 0.05 * np.transpose([np.cos(turn), np.sin(turn)])


def overlap(below, above, pose):
    """Returns the corners of the overlap of both faces (Sutherland & Hodgman 1974); tilts are negligible."""
    axes = np.empty(9)
    mujoco.mju_quat2Mat(axes, np.array(pose[3:7]))
    corners = face(above) @ axes.reshape(3, 3)[:2, :2].T + pose[:2]
    sides = () if below == "plane" else zip(face(below), np.roll(face(below), -1, axis=0), strict=True)
    for p, q in sides:
        beyond = (corners - p) @ [q[1] - p[1], p[0] - q[0]]
        left = []
        for a, b, at_a, at_b in zip(corners, np.roll(corners, -1, axis=0), beyond, np.roll(beyond, -1), strict=True):
            if at_a <= 0:
                left.append(a)
            if at_a * at_b < 0:
                left.append(a + (b - a) * (at_a / (at_a - at_b)))
        corners = np.array(left)
    return np.column_stack([corners, np.zeros(len(corners))])


def area(points):
    """Returns the area of the convex hull of points, seen from above (Andrew 1979)."""
    points = sorted({tuple(p) for p in np.round(np.asarray(points).reshape(-1, 3)[:, :2], 9)})
    if len(points) < 3:
        return 0.0

    def chain(points):
        hull = []
        for x, y in points:
            while len(hull) > 1:
                (ax, ay), (bx, by) = hull[-2:]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0:
                    break
                hull.pop()
            hull.append((x, y))
        return hull[:-1]

    x, y = np.transpose(chain(points) + chain(points[::-1]))
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


@pytest.mark.parametrize("below, above", [*itertools.product(["plane"], FACES), *itertools.combinations_with_replacement(FACES, 2)])
def test_patches_are_as_large_as_mujocos_and_nearly_as_the_overlap(tmp_path, below, above):
    path = tmp_path / "faces.xml"
    path.write_text(scene(below, above))
    model = mujoco.MjModel.from_xml_path(str(path))
    data, rng, shares = mujoco.MjData(model), np.random.default_rng(5), []
    whole = []
    with program.Forward(path) as forward:
        for _ in range(STATES):
            data.qpos[:] = poses(rng, below)
            mujoco.mj_forward(model, data)
            own = forward({"qpos": data.qpos.tolist()})["contacts"]
            assert own and all(contact["dist"] < 0 for contact in own), "it lies on the other"
            spanned, expected = area([contact["pos"] for contact in own]), area(data.contact.pos)
            # If MuJoCo's points span almost no area, only the fraction of the true overlap, below, is checked.
            if expected > 1e-6:
                shares.append(spanned / expected)
            whole.append(spanned / area(overlap(below, above, data.qpos)))
    assert min(shares) >= 0.9, f"{np.sum(np.array(shares) < 0.9)} of {STATES} below 0.9, the least {min(shares):.3f}"
    # An octagon has 0.9003 of its circle; the three points of a cylinder on a plane, ours and MuJoCo's, have 0.4135.
    least = 0.41 if (below, above) == ("plane", "cylinder") else 0.85
    assert min(whole) >= least, f"{min(whole):.3f} of the faces' overlap"
