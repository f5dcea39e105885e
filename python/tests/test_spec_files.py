"""The files of a `ModelSpec`: where they are found, and that the model keeps them."""

from __future__ import annotations

from pathlib import Path

import clench
import numpy as np
import pytest
from test_spec import ends

# A PNG of one grey pixel.
PIXEL = bytes.fromhex(
    "89504e470d0a1a0a0000000d49484452000000010000000108000000003a7e9b55"
    "0000000a49444154789c636800000082008177cd72b60000000049454e44ae426082"
)


def box(size: float) -> str:
    """Returns the OBJ file of a cube."""
    corners = [f"v {x} {y} {z}" for x in (0, size) for y in (0, size) for z in (0, size)]
    faces = "1 2 3,2 4 3,5 7 6,6 7 8,1 5 2,2 5 6,3 4 7,4 8 7,1 3 5,3 7 5,2 6 4,4 6 8".split(",")
    return "\n".join([*corners, *(f"f {face}" for face in faces)])


def test_files_are_read_once_and_travel_with_the_model(tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes/block.obj").write_text(box(0.1))
    (tmp_path / "parts.xml").write_text('<mujocoinclude><geom name="part" type="mesh" mesh="block"/></mujocoinclude>')
    (tmp_path / "main.xml").write_text(
        '<mujoco><compiler meshdir="meshes"/><asset><mesh name="block" file="block.obj"/></asset>'
        '<worldbody><body name="b"><freejoint/><include file="parts.xml"/></body></worldbody></mujoco>'
    )
    expected = ends(clench.Model.from_file(tmp_path / "main.xml"))
    spec = clench.ModelSpec.from_file(tmp_path / "main.xml")
    for file in ("meshes/block.obj", "parts.xml", "main.xml"):
        (tmp_path / file).unlink()
    assert spec.geom("part")["mesh"] == "block" and list(spec.assets) == ["block.obj"]
    assert ends(spec.build()) == expected
    with pytest.raises(clench.LoadError, match=r"main.xml: cannot read the file: No such file"):
        clench.ModelSpec.from_file(tmp_path / "main.xml")


def test_files_are_found_as_in_a_model(tmp_path: Path) -> None:
    """Beside an included file, in folders of textures, and with the name of another file."""
    for folder, size in (("parts/a", 0.1), ("b", 0.2)):
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / "cube.obj").write_text(box(size))
    (tmp_path / "images").mkdir()
    (tmp_path / "images/grid.png").write_bytes(PIXEL)
    (tmp_path / "parts/assets.xml").write_text(
        '<mujoco><include file="more.xml"/><asset><mesh name="small" file="a/cube.obj"/></asset></mujoco>'
    )
    (tmp_path / "parts/more.xml").write_text('<mujoco><asset><mesh file="b/cube.obj"/></asset></mujoco>')
    path = tmp_path / "model.xml"
    path.write_text(
        '<mujoco><compiler texturedir="images"/><include file="parts/assets.xml"/>'
        '<asset><texture name="grid" type="2d" file="grid.png"/></asset><worldbody>'
        '<body><freejoint/><geom type="mesh" mesh="small"/></body>'
        '<body><freejoint/><geom type="mesh" mesh="cube"/></body></worldbody></mujoco>'
    )
    built, loaded = clench.ModelSpec.from_file(path).build(), clench.Model.from_file(path)
    np.testing.assert_array_equal(built.body_mass, loaded.body_mass)
    assert built.body_mass[2] == pytest.approx(8 * built.body_mass[1])


@pytest.mark.parametrize(
    "text",
    [
        "<!-- a -- b --><mujoco model='a &amp; b'><worldbody/></mujoco>",
        "\ufeff<!DOCTYPE mujoco>\n<mujoco model='a & b'><worldbody/></mujoco>\n<mujoco/>",
        "<mujoco model='a & b'>1 & 2<worldbody/></mujoco>\n\0",
        "<mujoco model='a & b'><size nuser_body='1'nuser_geom='2'/><worldbody/></mujoco>",
    ],
)
def test_text_that_mujoco_accepts_beyond_xml(text: str, tmp_path: Path) -> None:
    (tmp_path / "model.xml").write_text(text)
    clench.Model.from_file(tmp_path / "model.xml")
    spec = clench.ModelSpec.from_file(tmp_path / "model.xml")
    assert spec.name == "a & b" and spec.build().nbody == 1


def test_a_robot_is_recognized_by_its_first_element(tmp_path: Path) -> None:
    text = "\n<?xml version='1.0'?><!-- <mujoco> -- --><Robot name='r'><link name='a'/>&</Robot>"
    (tmp_path / "a.urdf").write_text(text)
    assert clench.ModelSpec.from_file(tmp_path / "a.urdf").build().nbody == 1


DRESSED = """
<mujoco>
  <default><default class="red"><geom material="red"/></default><default class="cubes"><geom type="mesh" mesh="cube"/></default></default>
  <asset>
    <mesh file="parts/cube.obj"/>
    <texture name="grid" type="2d" builtin="checker" width="8" height="8"/>
    <material name="red" rgba="1 0 0 1"/><material name="tiles" texture="grid"/>
  </asset>
  <worldbody>
    <body name="b"><freejoint/>
      <geom name="one" class="cubes"/><geom name="two" type="mesh" mesh="cube" material="tiles"/><geom name="three" class="red" size="0.1"/>
    </body>
  </worldbody>
  <custom><tuple name="all"><element objtype="body" objname="b"/></tuple></custom>
</mujoco>"""


def dressed() -> clench.ModelSpec:
    return clench.ModelSpec.from_xml(DRESSED, {"cube.obj": box(0.1).encode()})


def test_a_mesh_with_the_name_of_its_file_is_renamed_and_removed() -> None:
    spec = dressed()
    assert spec.names("mesh") == ["cube"] and spec.find("mesh", "cube").name == "cube"
    spec.find("mesh", "cube").rename("block")
    assert spec.names("mesh") == spec.build().names("mesh") == ["block"]
    assert spec.geom("two")["mesh"] == "block"
    spec.geom("one").remove()
    spec.find("mesh", "block").remove()
    assert spec.build().names("geom") == ["three"]


def test_materials_of_classes_are_renamed_and_removed() -> None:
    spec, expected = dressed(), dressed().build()
    spec.find("material", "red").rename("ruby")
    assert spec.build().names("geom") == expected.names("geom")
    # Geoms remain, since how they look is not what they are.
    for kind, name in (("material", "ruby"), ("texture", "grid")):
        spec.find(kind, name).remove()
    assert "texture" not in spec.find("material", "tiles") and spec.geom("two")["material"] == "tiles"
    spec.find("material", "tiles").remove()
    np.testing.assert_array_equal(spec.build().body_inertia, expected.body_inertia)


def test_a_tuple_goes_with_its_last_element() -> None:
    spec = dressed()
    spec.body("b").remove()
    assert spec.build().nbody == 1 and not list(spec.section("custom"))


def test_many_files_are_included_once_each(tmp_path: Path) -> None:
    parts = [f"{index}.xml" for index in range(120)]
    for part in parts:
        (tmp_path / part).write_text("<mujoco><worldbody><site/></worldbody></mujoco>")
    model = tmp_path / "model.xml"
    model.write_text("".join(["<mujoco>", *(f'<include file="{part}"/>' for part in parts), "</mujoco>"]))
    assert clench.ModelSpec.from_file(model).build().nsite == 120
    for again in ("7.xml", "./7.xml", "model.xml"):
        (tmp_path / "8.xml").write_text(f'<mujoco><include file="{again}"/></mujoco>')
        with pytest.raises(clench.LoadError, match="is already included"):
            clench.ModelSpec.from_file(model)
