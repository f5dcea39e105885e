"""`ModelSpec.decompose`: a cup that is filled becomes one that holds a ball."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import clench
import clench.decompose
import mujoco  # type: ignore[import-untyped]
import numpy as np
import pytest
from numpy.typing import NDArray

needs_coacd = pytest.mark.skipif(importlib.util.find_spec("coacd") is None, reason="needs CoACD")

# Coarse pieces in a second instead of ten.
COARSE: dict[str, Any] = {"threshold": 0.1, "resolution": 200, "mcts_iterations": 10, "mcts_nodes": 5}


def cup(sides: int = 12) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Returns the vertices and triangles of an open cylinder of radius 0.1 m, height 0.2 m and thickness 0.02 m."""
    angle = 2.0 * np.pi * np.arange(sides) / sides
    rings = [(0.1, 0.0), (0.1, 0.2), (0.08, 0.2), (0.08, 0.02)]
    points = [(r * np.cos(a), r * np.sin(a), z) for r, z in rings for a in angle]
    faces = []
    for i in range(sides):
        j = (i + 1) % sides
        for k in range(0, 3 * sides, sides):
            faces += [(k + i, k + j, k + sides + j), (k + i, k + sides + j, k + sides + i)]
        faces += [(4 * sides, j, i), (4 * sides + 1, 3 * sides + i, 3 * sides + j)]
    return np.array([*points, (0, 0, 0), (0, 0, 0.02)]), np.array(faces)


def written(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> str:
    """Returns a mesh as the text of an OBJ file."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    return "\n".join([*lines, *(f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces.tolist()), ""])


def scene(**cup_geom: Any) -> clench.ModelSpec:
    """Returns a cup on a floor, with a ball above it."""
    vertices, faces = cup()
    spec = clench.ModelSpec("table")
    spec.world.add_geom(name="floor", type="plane", size=[1, 1, 1])
    # The mesh is written in other units, and in another frame.
    spec.add_asset(
        "mesh", name="cup", vertex=1000 * vertices + [0, 0, 7], face=faces, scale=[1e-3] * 3, refpos=[0, 0, 7]
    )
    body = spec.world.add_body(name="cup", pos=[0.3, 0, 0])
    body.add_freejoint()
    body.add_geom(**{"name": "cup", "type": "mesh", "mesh": "cup", "friction": [0.7, 0.01, 0.001], **cup_geom})
    ball = spec.world.add_body(name="ball", pos=[0.3, 0, 0.3])
    ball.add_freejoint()
    ball.add_geom(name="ball", size=0.03, mass=0.05)
    return spec


def resting_place(model: clench.Model) -> NDArray[np.float64]:
    """Returns the position of the ball relative to the cup after a second."""
    sim = clench.Sim(model)
    sim.step(500)
    return np.array(sim.body("ball").xpos - sim.body("cup").xpos)


def in_mujoco(text: str) -> Any:
    return mujoco.MjModel.from_xml_string(text)


@pytest.fixture(scope="session")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Returns the folder of the pieces, which are computed once."""
    return tmp_path_factory.mktemp("pieces")


@needs_coacd
def test_a_ball_rests_in_a_cup_of_pieces_and_on_a_filled_one(stored: Path) -> None:
    spec = scene()
    filled = spec.build()
    assert resting_place(filled)[2] > 0.19
    pieces = spec.decompose("cup", cache=stored, **COARSE)
    model = spec.build()
    assert len(pieces) > 4 and [piece.name for piece in pieces] == [f"cup_hull{i}" for i in range(len(pieces))]
    x, y, z = resting_place(model)
    assert np.hypot(x, y) < 0.05 and 0.03 < z < 0.08
    # Mass and inertia are those of the original, also in MuJoCo.
    other = in_mujoco(spec.to_xml())
    for name in ("mass", "ipos", "inertia"):
        expected = getattr(filled, f"body_{name}")
        np.testing.assert_array_equal(getattr(model, f"body_{name}"), expected)
        np.testing.assert_allclose(getattr(other, f"body_{name}"), expected, rtol=1e-6, atol=1e-9)
    assert (model.geom("cup").contype, model.geom("cup").conaffinity) == (0, 0)
    assert model.geom_group.tolist() == [0, 0, *[3] * len(pieces), 0]
    np.testing.assert_array_equal(model.geom("cup_hull0").friction, [0.7, 0.01, 0.001])
    # The pieces are where the mesh is, and as in MuJoCo.
    np.testing.assert_allclose(model.geom_pos[2:-1], other.geom_pos[2:-1], atol=1e-6)
    corners = np.concatenate([moved(model, f"cup_hull{i}") for i in range(len(pieces))])
    np.testing.assert_allclose(
        [corners.min(axis=0), corners.max(axis=0)], [[-0.1, -0.1, 0], [0.1, 0.1, 0.2]], atol=2e-3
    )


def moved(model: clench.Model, geom: str) -> NDArray[np.float64]:
    """Returns the vertices of the mesh of a geom in the frame of its body."""
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, np.array(model.geom(geom).quat))
    mesh = model.mesh(model.names("mesh")[model.geom(geom).dataid])
    return np.array(mesh.vert @ rotation.reshape(3, 3).T + model.geom(geom).pos)


@needs_coacd
@pytest.mark.parametrize("kept", ["", "<compiler discardvisual='true'/>", "<compiler inertiagrouprange='0 1'/>"])
def test_classes_frames_and_replicas_keep_their_attributes(stored: Path, kept: str) -> None:
    vertices, faces = cup()
    text = f"""<mujoco>{kept}
      <default>
        <mesh scale="2 2 2"/>
        <default class="c"><geom type="mesh" mesh="cup" condim="4" mass="0.3" group="1"/></default>
      </default>
      <asset><mesh file="cup.obj" scale="1 1 1.5"/></asset>
      <worldbody>
        <geom class="c" pos="3 0 0"/>
        <replicate count="2" offset="0 0 1">
          <body>
            <freejoint/>
            <frame pos="0.1 0 0"><geom class="c" euler="0 40 0"/></frame>
            <geom class="c" contype="0" conaffinity="0"/>
          </body>
        </replicate>
        <geom type="box" mesh="cup"/>
      </worldbody></mujoco>"""
    spec = clench.ModelSpec.from_xml(text, {"cup.obj": written(vertices, faces).encode()})
    before = spec.build()
    pieces = spec.decompose("cup", group=4, cache=stored, max_hulls=8, **COARSE)
    model = spec.build()
    per_geom = len(pieces) // 2
    assert (model.geom_group == 4).sum() == 3 * per_geom and 1 < per_geom <= 8
    assert (model.geom_condim[model.geom_group == 4] == 4).all()
    np.testing.assert_array_equal(model.body_mass, before.body_mass)
    np.testing.assert_array_equal(model.body_inertia, before.body_inertia)
    other = mujoco.MjModel.from_xml_string(spec.to_xml(), spec.assets)
    assert other.ngeom == model.ngeom
    np.testing.assert_allclose(other.body_mass[1:], before.body_mass[1:], rtol=1e-9)
    # The floor of the scaled cup is 0.03 m thick.
    hit = clench.Sim(model).ray([3, 0, 1], [0, 0, -1], groups=[4])
    assert hit is not None and hit.distance == pytest.approx(0.97, abs=0.01)
    with pytest.raises(ValueError, match='"cup" is used by no geom'):
        spec.decompose("cup")


@needs_coacd
def test_pairs_are_those_of_the_pieces(stored: Path) -> None:
    spec = scene(contype=0, conaffinity=0)
    spec.section("contact").add("pair", name="p", geom1="ball", geom2="cup", condim=1)
    spec.section("contact").add("pair", name="floor", geom1="floor", geom2="cup")
    assert resting_place(spec.build())[2] > 0.19
    count = len(spec.decompose("cup", cache=stored, **COARSE))
    assert spec.names("pair") == [f"{name}_hull{i}" for name in ("p", "floor") for i in range(count)]
    assert 0.03 < resting_place(spec.build())[2] < 0.08
    spec = scene()
    spec.add_sensor("contact", geom1="cup", geom2="ball")
    with pytest.warns(UserWarning, match='contact sensor names the geom "cup"') as warned:
        spec.decompose("cup", cache=stored, **COARSE)
    assert warned[0].filename == __file__


@needs_coacd
@pytest.mark.parametrize("kind", ["mesh", "geom"])
def test_a_model_stays_as_it_is_if_a_name_is_taken(stored: Path, kind: str) -> None:
    spec = scene()
    if kind == "geom":
        spec.world.add_geom(name="cup_hull2", size=1)
    else:
        spec.add_asset("mesh", name="cup_hull2", builtin="sphere", params=[1])
    before = spec.to_xml()
    with pytest.raises(ValueError, match=f'there is already a {kind} "cup_hull2"'):
        spec.decompose("cup", cache=stored, **COARSE)
    assert spec.to_xml() == before


@needs_coacd
def test_parts_of_attached_models_are_decomposed(stored: Path) -> None:
    room = clench.ModelSpec("room")
    room.world.attach(scene(), prefix="a_")
    pieces = room.decompose("a_cup", cache=stored, **COARSE)
    assert pieces[0].name == "a_cup_hull0" and pieces[0]["mesh"] == "a_cup_hull0"
    model = room.build()
    assert model.ngeom == 3 + len(pieces)
    in_mujoco(room.to_xml())


@needs_coacd
@pytest.mark.parametrize("kind", ["obj", "stl"])
def test_pieces_are_stored_next_to_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str) -> None:
    vertices, faces = cup(8)
    data = written(vertices, faces).encode()
    if kind == "stl":
        triangles = np.zeros(len(faces), np.dtype([("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")]))
        triangles["v"] = vertices[faces]
        data = bytes(80) + np.uint32(len(faces)).tobytes() + triangles.tobytes()
    (tmp_path / "meshes").mkdir()
    (tmp_path / f"meshes/cup.{kind}").write_bytes(data)
    model = tmp_path / "cup.xml"
    model.write_text(
        f'<mujoco><compiler meshdir="meshes"/><asset><mesh file="cup.{kind}"/></asset>'
        '<worldbody><body><freejoint/><geom type="mesh" mesh="cup"/></body></worldbody></mujoco>'
    )
    first = clench.ModelSpec.from_file(model)
    first.decompose("cup", **COARSE)
    (stored,) = (tmp_path / "meshes").glob("cup-*.hulls.npz")
    # Stored pieces need no CoACD; other options and changed meshes do.
    monkeypatch.setitem(sys.modules, "coacd", None)
    again = clench.ModelSpec.from_file(model)
    again.decompose("cup", **COARSE)
    assert again.to_xml() == first.to_xml()
    for options in ({**COARSE, "seed": 1}, {**COARSE, "cache": False}):
        with pytest.raises(ModuleNotFoundError, match=r"pip install 'clench\[decompose\]'"):
            clench.ModelSpec.from_file(model).decompose("cup", **options)
    monkeypatch.undo()
    # A broken file is replaced.
    whole = stored.read_bytes()
    stored.write_bytes(whole[: len(whole) // 2])
    third = clench.ModelSpec.from_file(model)
    third.decompose("cup", **COARSE)
    assert third.to_xml() == first.to_xml() and clench.decompose._stored(stored) is not None


@needs_coacd
def test_the_program_writes_a_file_that_loads_anywhere(tmp_path: Path) -> None:
    vertices, faces = cup(6)
    (tmp_path / "cup.obj").write_text(written(vertices, faces))
    (tmp_path / "in.xml").write_text(
        '<mujoco><asset><mesh file="cup.obj"/><mesh name="ball" builtin="sphere" params="1"/></asset><worldbody>'
        '<body><freejoint/><geom type="mesh" mesh="cup"/><geom type="mesh" mesh="ball"/></body></worldbody></mujoco>'
    )

    def run(*arguments: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "clench.decompose", "in.xml", *arguments]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=250)

    done = run("out.xml", "--threshold", "0.3", "--max-hulls", "9")
    assert (done.returncode, done.stderr) == (0, "")
    assert (found := re.match(r"cup: (\d) pieces\nball: convex, unchanged\n", done.stdout)), done.stdout
    (tmp_path / "elsewhere").mkdir()
    moved = (tmp_path / "out.xml").rename(tmp_path / "elsewhere/out.xml")
    model = clench.Model.from_file(moved)
    assert model.ngeom == in_mujoco(moved.read_text()).ngeom == 2 + int(found[1])
    np.testing.assert_allclose(model.body_mass, clench.Model.from_file(tmp_path / "in.xml").body_mass, rtol=1e-12)
    for arguments, message in ((("in.xml",), "same file"), (("out.xml", "--mesh", "bowl"), 'no mesh "bowl"')):
        done = run(*arguments)
        assert done.returncode == 1 and done.stderr.startswith("error: ") and message in done.stderr
    assert not (tmp_path / "out.xml").exists()


def test_replicas_are_found_beside_longer_names() -> None:
    text = (
        '<mujoco><asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset><worldbody><geom name="gripper" size="1"/>'
        '<replicate count="2" sep="-"><geom name="g" type="mesh" mesh="m"/><geom name="grip" size="1"/></replicate>'
        "</worldbody></mujoco>"
    )
    assert clench.decompose.colliding_meshes(clench.ModelSpec.from_xml(text)) == ["m"]


def test_the_output_of_the_program_may_be_a_link_or_no_file(tmp_path: Path) -> None:
    (tmp_path / "in.xml").write_text("<mujoco/>")
    (tmp_path / "link.xml").symlink_to("out.xml")
    assert clench.decompose.main([str(tmp_path / "in.xml"), str(tmp_path / "link.xml")]) == 0
    assert (tmp_path / "link.xml").is_symlink() and (tmp_path / "out.xml").read_text().startswith("<mujoco")
    assert clench.decompose.main([str(tmp_path / "in.xml"), "/dev/null"]) == 0
    assert not Path("/dev/null").is_file()


def test_decompose_refuses() -> None:
    spec = scene()
    spec.add_asset("mesh", name="unused", builtin="sphere", params=[1])
    cases: list[tuple[dict[str, Any], str]] = [
        ({"mesh": "bowl"}, 'there is no mesh "bowl": there are cup'),
        ({"mesh": "unused"}, 'the mesh "unused" is used by no geom$'),
        ({"mesh": "cup", "threshold": 0}, "the threshold is 0, not between"),
        ({"mesh": "cup", "threshold": float("nan")}, "the threshold is nan"),
        ({"mesh": "cup", "max_hulls": 0}, "max_hulls is 0"),
    ]
    before = spec.to_xml()
    for arguments, message in cases:
        with pytest.raises(ValueError, match=message):
            spec.decompose(**arguments)
    vertices, faces = cup()
    with pytest.raises(ValueError, match="vertices of shape"):
        clench.decompose.hulls(vertices * np.nan, faces)
    with pytest.raises(ValueError, match="faces of shape"):
        clench.decompose.hulls(vertices, faces + 1000)
    assert spec.to_xml() == before


def test_decompose_names_the_missing_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "coacd", None)
    spec = scene()
    before = spec.to_xml()
    with pytest.raises(ModuleNotFoundError, match=r"pip install 'clench\[decompose\]'"):
        spec.decompose("cup")
    assert spec.to_xml() == before
