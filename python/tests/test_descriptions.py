"""Robots of `robot_descriptions`, with a substitute of the package, since the real one downloads files."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import clench
import pytest

MJCF = "<mujoco><worldbody><body><joint name='hip'/><geom size='0.1'/></body></worldbody></mujoco>"
URDF = """<robot name="dog">
  <link name="trunk">
    <inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><mesh filename="package://dog_description/trunk.obj"/></geometry></collision>
  </link>
</robot>"""
CUBE = "".join(f"v {x} {y} {z}\n" for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)) + (
    "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n"
)


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Yields a package of robots: in MJCF, in URDF with a mesh, in xacro, and one that cannot be fetched."""
    folder = tmp_path / "modules/robot_descriptions"
    robot = tmp_path / "repository/dog_description"
    for path in (folder, robot):
        path.mkdir(parents=True)
    (robot / "arm.xml").write_text(MJCF)
    (robot / "dog.urdf").write_text(URDF)
    (robot / "trunk.obj").write_text(CUBE)
    paths = f"PACKAGE_PATH = {str(robot)!r}\nREPOSITORY_PATH = {str(robot.parent)!r}\n"
    (folder / "__init__.py").write_text("")
    (folder / "arm_mj_description.py").write_text(f"{paths}MJCF_PATH = {str(robot / 'arm.xml')!r}\n")
    (folder / "dog_description.py").write_text(f"{paths}URDF_PATH = {str(robot / 'dog.urdf')!r}\n")
    (folder / "cat_description.py").write_text(f"{paths}XACRO_PATH = 'cat.urdf.xacro'\n")
    (folder / "far_description.py").write_text("raise OSError('no route to host')\n")
    monkeypatch.syspath_prepend(str(folder.parent))
    yield folder
    for name in [name for name in sys.modules if name.split(".")[0] == "robot_descriptions"]:
        del sys.modules[name]


@pytest.mark.usefixtures("package")
def test_a_description_is_loaded() -> None:
    assert clench.load_description("arm_mj_description").joint("hip").name == "hip"
    fixed = clench.load_description("dog_description")
    assert (fixed.nv, fixed.nmesh) == (0, 1)
    assert clench.load_description("dog_description", floating=True).nv == 6


@pytest.mark.usefixtures("package")
@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("dog_descripton", "no description \"dog_descripton\"; did you mean 'dog_description'"),
        ("os", 'no description "os"'),
        ("cat_description", "xacro"),
        ("far_description", 'files of the description "far_description" cannot be fetched: no route to host'),
    ],
)
def test_what_cannot_be_loaded_is_told(name: str, message: str) -> None:
    with pytest.raises(clench.LoadError, match=message):
        clench.load_description(name)


def test_the_package_is_named_where_it_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "robot_descriptions", None)
    with pytest.raises(ModuleNotFoundError, match="pip install robot_descriptions"):
        clench.load_description("go2_description")
