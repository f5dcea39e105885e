"""The protrusion of objects from volumes of sites compared with MuJoCo: all pairs of shapes, in random poses."""

import itertools

import mujoco
import numpy as np
import pytest

import oracle
import program
from compare import assert_close

STATES = 60
NEAR = 1e-12  # m; the searches take the same steps
OF_MESHES = 1e-6  # m; MuJoCo stores vertices in single precision
AT_THE_TOP = 1e-4  # m; if slopes are below MuJoCo's tolerance, rounding decides which step is the last
# Fractions: rounding decides on which side of a ridge a step ends, more often if vertices are rounded.
SAME_STEPS = 0.998
SAME_STEPS_OF_MESHES = 0.95
# In rotated sites rounding decides in MuJoCo which of several equally distant corners a climb starts from, and so its
# path. Iterating to the last digit leads to the same summit, except for a few cases with another one nearby.
SAME_SUMMIT = 0.97
SHAPES = ("sphere", "capsule", "ellipsoid", "cylinder", "box", "rock", "round")
SIZES = {"sphere": "0.2", "capsule": "0.12 0.2", "ellipsoid": "0.1 0.2 0.35", "cylinder": "0.15 0.25", "box": "0.1 0.2 0.3"}
LARGER = {"sphere": "0.6", "capsule": "0.5 0.4", "ellipsoid": "0.5 0.6 0.8", "cylinder": "0.6 0.5", "box": "0.4 0.5 0.6"}
ROCK = (0, 0, 0, 0.4, 0.1, 0, 0, 0.3, 0.1, 0.1, 0, 0.5, 0.3, 0.3, 0.4)
# Limits of the search: MuJoCo's default, those of a file, and none.
BOUNDS = {"default": "", "few": 'ccd_iterations="4"', "one": 'ccd_iterations="1"', "fine": 'ccd_iterations="300" ccd_tolerance="0"'}


def round_vertices():
    """Returns more vertices than MuJoCo searches exhaustively."""
    rng = np.random.default_rng(3)
    points = rng.normal(size=(60, 3))
    return 0.25 * points / np.linalg.norm(points, axis=1)[:, None] * [1, 0.8, 0.6]


def shape(kind, sizes, size):
    return f'type="{kind}" size="{sizes[kind]}"' if kind in sizes else f'type="mesh" mesh="{size} {kind}"'


def scene(bounds, turned=""):
    sensors = [f'site="s_{outer}" objtype="geom" objname="{inner}"' for inner, outer in itertools.product(SHAPES, repeat=2)]
    sensors += [f'site="s_{outer}" objtype="site" objname="s_{inner}"' for inner, outer in itertools.product(SHAPES, repeat=2)]
    sensors += [f'site="s_{outer}" objtype="{kind}" objname="{body}"' for outer in SHAPES for kind in ("body", "xbody") for body in ("stem", "sphere", "world")]
    sensors += ['site="s_box" objtype="geom" objname="box" cutoff="0.05"']
    body = '<body name="{name}" pos="{x} 0 0"><joint type="ball"/><joint axis="1 0 0" type="slide"/><joint axis="0 1 1" type="slide"/><geom name="{name}" {shape}/></body>'
    return f"""<mujoco>
      <option gravity="0 0 0" {bounds}><flag contact="disable"/></option>
      <asset>
        {"".join(f'<mesh name="{size} {kind}" vertex="{" ".join(map(str, vertices))}" scale="{scale} {scale} {scale}"/>'
            for size, scale in (("small", 1), ("large", 3)) for kind, vertices in (("rock", ROCK), ("round", round_vertices().ravel())))}
      </asset>
      <worldbody>
        <geom name="still" size="0.05" pos="0.1 0.2 0.3"/>
        {"".join(f'<site name="s_{name}" {shape(name, LARGER, "large")} pos="0.05 {0.02 * k} 0" {turned}/>' for k, name in enumerate(SHAPES))}
        {"".join(body.format(name=name, x=0.02 * k, shape=shape(name, SIZES, "small")) for k, name in enumerate(SHAPES))}
        <body name="stem"><joint type="free"/><geom size="0.03 0.1" type="capsule"/><geom size="0.02" pos="0.1 0 0"/>
          <body pos="0 0 0.2"><joint axis="0 1 0"/><geom size="0.02 0.03 0.04" type="box" pos="0 0 0.1"/>
            <body pos="0 0.1 0"><geom size="0.01" pos="0 0 0.1" contype="0" conaffinity="0"/></body></body></body>
      </worldbody>
      <sensor>{"".join(f'<insidesite {words} enclosed="true"/>' for words in sensors)}</sensor>
    </mujoco>"""


def states(model):
    """Yields states with the objects near the centre of the sites to far away."""
    rng = np.random.default_rng(0)
    for k in range(STATES):
        data = mujoco.MjData(model)
        mujoco.mj_integratePos(model, data.qpos, rng.normal(size=model.nv) * [0.02, 0.2, 2][k % 3], 1.0)
        yield {"qpos": data.qpos.tolist()}


def answers(path, model):
    """Returns our numbers and MuJoCo's in all states."""
    path = str(path)
    with program.Forward(path) as forward:
        pairs = [(oracle.reference(model, state).sensordata, forward(state)["sensordata"]) for state in states(model)]
    theirs, ours = np.moveaxis(np.array(pairs), 0, 1)
    assert ours.shape == (STATES, model.nsensor)
    return ours, theirs


def of_meshes(model):
    """Returns a mask of the sensors with a mesh as object or site, which have single precision in MuJoCo."""
    meshed = lambda kind, k: int(mujoco.mjtGeom.mjGEOM_MESH) == {mujoco.mjtObj.mjOBJ_GEOM: model.geom_type, mujoco.mjtObj.mjOBJ_SITE: model.site_type}[kind][k]
    found = []
    for k in range(model.nsensor):
        kind = mujoco.mjtObj(model.sensor_objtype[k])
        inner = kind in (mujoco.mjtObj.mjOBJ_GEOM, mujoco.mjtObj.mjOBJ_SITE) and meshed(kind, model.sensor_objid[k])
        of_all = kind == mujoco.mjtObj.mjOBJ_XBODY and model.sensor_objid[k] == 0
        found.append(inner or of_all or meshed(mujoco.mjtObj.mjOBJ_SITE, model.sensor_refid[k]))
    return np.array(found)


@pytest.mark.parametrize("bounds", BOUNDS)
def test_how_far_objects_jut_out(bounds, tmp_path):
    path = tmp_path / "enclosed.xml"
    path.write_text(scene(BOUNDS[bounds]))
    model = mujoco.MjModel.from_xml_path(str(path))
    ours, theirs = answers(path, model)
    meshes = of_meshes(model)
    error = np.abs(ours - theirs)
    if bounds == "default":
        assert error.max() <= AT_THE_TOP
    else:
        assert (error[:, ~meshes] <= NEAR).mean() >= SAME_STEPS
        assert (error[:, meshes] <= OF_MESHES).mean() >= SAME_STEPS_OF_MESHES
    assert ((theirs < 0).any(axis=0) & (theirs > 0).any(axis=0)).mean() > 0.5, "what is inside now and then, and now and then is not"


def test_how_far_objects_jut_out_of_sites_that_are_turned(tmp_path):
    path = tmp_path / "enclosed.xml"
    path.write_text(scene(BOUNDS["fine"], 'euler="20 10 30"'))
    model = mujoco.MjModel.from_xml_path(str(path))
    ours, theirs = answers(path, model)
    same = np.abs(ours - theirs) <= OF_MESHES
    assert same.mean() >= SAME_SUMMIT, f"{same.mean()}"


def test_a_flat_mesh_juts_out_by_its_corners(tmp_path):
    path = tmp_path / "flat.xml"
    path.write_text("""<mujoco>
      <asset><mesh name="sheet" vertex="0 0 0 1 0 0 0 1 0 1 1 0" face="0 1 2 1 3 2" inertia="shell"/></asset>
      <worldbody><site name="room" type="box" size="0.5 0.4 0.3"/>
        <body><freejoint/><geom name="sheet" type="mesh" mesh="sheet" contype="0" conaffinity="0"/></body></worldbody>
      <sensor><insidesite site="room" objtype="geom" objname="sheet" enclosed="true"/></sensor></mujoco>""")
    model = mujoco.MjModel.from_xml_path(str(path))
    ours, theirs = answers(path, model)
    assert_close("sensordata", ours, theirs, AT_THE_TOP, 1.0)
