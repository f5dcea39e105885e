"""Models: their fields are MuJoCo's, elements are found by name, and errors report their location."""

from __future__ import annotations

import ast
import copy
import inspect
import pickle
from collections.abc import Callable
from pathlib import Path
from threading import Thread
from typing import Any

import clench
import mujoco  # type: ignore[import-untyped]
import numpy as np
import pytest
from models import EXAMPLES, FEATURES, PUBLIC, ROOT, SHAPES

HUMANOID = ROOT / "models/humanoid.xml"
STUB = Path(clench.__file__).with_name("_core.pyi")

KINDS = {
    "body": "body_",
    "joint": "jnt_",
    "geom": "geom_",
    "site": "site_",
    "camera": "cam_",
    "tendon": "tendon_",
    "actuator": "actuator_",
    "sensor": "sensor_",
    "equality": "eq_",
    "keyframe": "key_",
    "pair": "pair_",
    "mesh": "mesh_",
    "hfield": "hfield_",
}
SIZES = ["nq", "nv", "nu", "na", "nactuator", "nbody", "njnt", "ngeom", "nsite", "ncam", "ntendon", "neq", "nkey", "nmocap", "npair"]
SIZES += ["nmesh", "nhfield", "nsensor", "nsensordata"]

# Fields in MuJoCo's options, with their names there.
OPTIONS = {
    "timestep": "timestep",
    "gravity": "gravity",
    "wind": "wind",
    "magnetic": "magnetic",
    "density": "density",
    "viscosity": "viscosity",
    "sleep_tolerance": "sleep_tolerance",
    "override_margin": "o_margin",
    "override_solref": "o_solref",
    "override_solimp": "o_solimp",
    "override_friction": "o_friction",
}
# Fields that MuJoCo combines, by our name: its field and the column.
COLUMNS = {"sensor_interval": ("sensor_interval", 0), "sensor_phase": ("sensor_interval", 1)}
# Fields with another format in MuJoCo, which have a separate test.
OURS = {"wrap_coef", "wrap_sideid", "eq_anchor1", "eq_anchor2", "eq_quat1", "eq_quat2", "eq_torquescale", "eq_polycoef"}
# Fields that MuJoCo stores with fewer digits or triangulates differently.
OURS |= {"mesh_vert", "mesh_face", "hfield_data", "cam_sensorsize", "cam_intrinsic", "cam_fovy"}
# Fields that MuJoCo combines in `geom_fluid`, and one that only tracking cameras use.
OURS |= {"geom_fluidcoef", "geom_virtualmass", "geom_virtualinertia", "cam_poscom0"}
# Fields with many rows per element.
LISTS = {"mesh_vert", "mesh_face", "hfield_data"}


def field_names() -> list[str]:
    """Returns the fields that every model has."""
    return [name for name in dir(clench.Model.from_xml("<mujoco/>")) if not hasattr(clench.Model, name)]


@pytest.fixture(scope="module")
def humanoid() -> clench.Model:
    return clench.Model.from_file(HUMANOID)


@pytest.fixture(params=EXAMPLES + FEATURES + SHAPES, ids=lambda path: path.stem)
def both(request: pytest.FixtureRequest) -> tuple[clench.Model, mujoco.MjModel]:
    """Returns a file's model in Clench and in MuJoCo."""
    return clench.Model.from_file(request.param), mujoco.MjModel.from_xml_path(str(request.param))


def expected_field(theirs: mujoco.MjModel, name: str) -> np.ndarray:
    """Returns MuJoCo's values of a field in our shape."""
    if name in COLUMNS:
        field, column = COLUMNS[name]
        return np.asarray(getattr(theirs, field))[:, column]
    value = np.asarray(getattr(theirs.opt, OPTIONS[name]) if name in OPTIONS else getattr(theirs, name))
    if name in ("key_mpos", "key_mquat"):
        return value.reshape(theirs.nkey, theirs.nmocap, 3 if name == "key_mpos" else 4)
    if name.startswith("actuator_") and len(value) == theirs.nout != theirs.nactuator:
        # Outputs of an orientation servo have equal values, or the first one counts.
        value = value[theirs.actuator_outadr]
    if name in ("eq_obj1id", "eq_obj2id"):
        # MuJoCo stores the sites of an equality, Clench their bodies.
        sites = theirs.eq_objtype == int(mujoco.mjtObj.mjOBJ_SITE)
        value = value.copy()
        value[sites] = theirs.site_bodyid[value[sites]]
    return value


def test_fields_are_those_of_mujoco(both: tuple[clench.Model, mujoco.MjModel]) -> None:
    ours, theirs = both
    for name in field_names():
        if name in OURS:
            continue
        found, expected = np.asarray(getattr(ours, name)), expected_field(theirs, name)
        assert (found.shape, found.dtype) == (expected.shape, expected.dtype), name
        if found.dtype == np.float64:
            np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12, err_msg=name)
        else:
            np.testing.assert_array_equal(found, expected, err_msg=name)


@pytest.mark.parametrize("name", PUBLIC)
def test_robots_of_other_packages_are_those_of_mujoco(name: str) -> None:
    """Compares masses, frames and sizes, most of which follow from meshes."""
    path = ROOT / ".venv/models" / name
    ours, theirs = clench.Model.from_file(path), mujoco.MjModel.from_xml_path(str(path))
    for field in ["body_mass", "body_inertia"]:
        np.testing.assert_allclose(getattr(ours, field), getattr(theirs, field), rtol=1e-9, atol=1e-15, err_msg=field)
    for field in ["body_ipos", "geom_pos", "geom_size", "geom_rbound", "mesh_pos"]:
        np.testing.assert_allclose(getattr(ours, field), getattr(theirs, field), rtol=0, atol=1e-9, err_msg=field)
    for field in ["body_iquat", "geom_quat", "mesh_quat"]:
        # If moments are nearly equal, rounding decides the axes.
        cosine = np.abs((getattr(ours, field) * getattr(theirs, field)).sum(axis=1))
        np.testing.assert_allclose(cosine, 1.0, rtol=0, atol=1e-14, err_msg=field)


def test_fields_that_mujoco_packs(both: tuple[clench.Model, mujoco.MjModel]) -> None:
    ours, theirs = both
    numbered, geoms = theirs.wrap_type <= 2, theirs.wrap_type >= 4
    np.testing.assert_array_equal(ours.wrap_coef, np.where(numbered, theirs.wrap_prm, 0))
    np.testing.assert_array_equal(ours.wrap_sideid, np.where(geoms, theirs.wrap_prm, -1))
    of_bodies = theirs.eq_objtype == int(mujoco.mjtObj.mjOBJ_BODY)
    connect, weld = (of_bodies & (theirs.eq_type == code) for code in (0, 1))
    scalar = theirs.eq_type >= 2
    data = theirs.eq_data
    for found, rows, expected in [
        (ours.eq_anchor1, connect, data[:, 0:3]),
        (ours.eq_anchor2, connect, data[:, 3:6]),
        (ours.eq_anchor2, weld, data[:, 0:3]),
        (ours.eq_anchor1, weld, data[:, 3:6]),
        (ours.eq_quat1, weld, data[:, 6:10]),
        (ours.eq_torquescale, weld, data[:, 10]),
        (ours.eq_polycoef, scalar, data[:, :5]),
    ]:
        np.testing.assert_allclose(found[rows], expected[rows], rtol=1e-9, atol=1e-12)
    np.testing.assert_array_equal(ours.eq_quat2[weld], np.tile([1.0, 0.0, 0.0, 0.0], (weld.sum(), 1)))


def test_meshes_and_height_fields(both: tuple[clench.Model, mujoco.MjModel]) -> None:
    ours, theirs = both
    assert ours.mesh_vert.dtype == ours.hfield_data.dtype == np.float64
    np.testing.assert_allclose(ours.mesh_vert, theirs.mesh_vert, rtol=0, atol=1e-7)
    np.testing.assert_array_equal(ours.hfield_data, theirs.hfield_data)
    assert ours.mesh_face.shape == theirs.mesh_face.shape
    for i in range(ours.nmesh):
        mesh = ours.mesh(i)
        np.testing.assert_array_equal(mesh.vert, ours.mesh_vert[mesh.vertadr : mesh.vertadr + mesh.vertnum])
        np.testing.assert_array_equal(mesh.face, ours.mesh_face[mesh.faceadr : mesh.faceadr + mesh.facenum])
        assert mesh.face.max() < mesh.vertnum and not mesh.vert.flags.writeable
        expected = theirs.mesh_face[mesh.faceadr : mesh.faceadr + mesh.facenum]
        volume, theirs_volume = (np.linalg.det(mesh.vert[face]).sum() for face in (mesh.face, expected))
        np.testing.assert_allclose(volume, theirs_volume, rtol=1e-9)
    for i in range(ours.nhfield):
        field = ours.hfield(i)
        assert field.data.shape == (field.nrow, field.ncol) and not field.data.flags.writeable
        np.testing.assert_allclose(field.data, theirs.hfield(i).data, rtol=0, atol=1e-7)


def test_sizes_and_names(both: tuple[clench.Model, mujoco.MjModel]) -> None:
    ours: Any
    ours, theirs = both
    for size in SIZES:
        assert getattr(ours, size) == getattr(theirs, size), size
    objects = {"joint": "jnt", "camera": "cam", "equality": "eq", "keyframe": "key"}
    for kind in KINDS:
        count = getattr(theirs, f"n{objects.get(kind, kind)}")
        assert ours.names(kind) == [getattr(theirs, objects.get(kind, kind))(i).name for i in range(count)], kind


def test_every_field_of_an_element_is_a_row(both: tuple[clench.Model, mujoco.MjModel]) -> None:
    model: Any
    model, _ = both
    for kind, prefix in KINDS.items():
        for i, name in enumerate(model.names(kind)):
            element = getattr(model, kind)(i)
            assert (element.kind, element.id, element.name) == (kind, i, name)
            if name:
                assert getattr(model, kind)(name).id == i
            for field in field_names():
                if field.startswith(prefix) and field not in LISTS:
                    np.testing.assert_array_equal(getattr(element, field[len(prefix) :]), getattr(model, field)[i])


def test_elements_give_plain_numbers(humanoid: clench.Model) -> None:
    torso = humanoid.body("torso")
    assert (type(torso.mass), type(torso.parentid)) == (float, int)
    assert torso.mass == humanoid.body_mass[torso.id]
    assert humanoid.joint("right_knee").limited is True
    assert humanoid.body(np.int64(torso.id)).name == "torso"
    assert repr(torso) == '<clench.Element: body 1, "torso">'
    standing = humanoid.keyframe("standing")
    np.testing.assert_array_equal(standing.qpos, humanoid.key_qpos[standing.id])


def test_joints_have_rows_of_their_dofs(humanoid: clench.Model) -> None:
    root, knee = humanoid.joint("root"), humanoid.joint("right_knee")
    assert root.dof_damping.shape == (6,) and root.dof_solimp.shape == (6, 5)
    np.testing.assert_array_equal(knee.dof_armature, humanoid.dof_armature[knee.dofadr : knee.dofadr + 1])
    np.testing.assert_array_equal(root.qpos0, humanoid.qpos0[:7])
    assert not hasattr(humanoid.body("torso"), "dof_damping")


def test_fields_cannot_be_written_to(humanoid: clench.Model) -> None:
    for name in field_names():
        value = getattr(humanoid, name)
        if isinstance(value, np.ndarray):
            assert not value.flags.writeable, name
            assert value.flags.c_contiguous and value.flags.aligned, name
    assert not humanoid.joint("root").range.flags.writeable
    assert not humanoid.joint("root").dof_damping.flags.writeable
    with pytest.raises(ValueError, match="read-only"):
        humanoid.body_mass[1] = 0.0
    with pytest.raises(AttributeError):
        humanoid.body_mass = 0.0  # type: ignore[misc, assignment]


def test_stubs_list_what_there_is(humanoid: clench.Model) -> None:
    classes = {node.name: node for node in ast.parse(STUB.read_text()).body if isinstance(node, ast.ClassDef)}

    def declared(name: str) -> set[str]:
        body = classes[name].body
        fields = {ast.unparse(node.target) for node in body if isinstance(node, ast.AnnAssign)}
        methods = {node.name for node in body if isinstance(node, ast.FunctionDef)}
        return {name for name in fields | methods if not name.startswith("__")}

    def found(thing: object) -> set[str]:
        return {name for name in dir(thing) if not name.startswith("__")}

    assert declared("Model") == found(humanoid)
    everything = clench.Model.from_xml(
        """<mujoco>
             <asset>
               <mesh name="a" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/>
               <hfield name="a" nrow="2" ncol="3" size="1 1 1 1"/>
             </asset>
             <worldbody>
               <body name="a"><joint name="a"/><geom name="a" size="1"/><site name="a"/><camera name="a"/></body>
               <body name="b"><joint name="b"/><geom name="b" size="1"/></body>
             </worldbody>
             <tendon><fixed name="a"><joint joint="a" coef="1"/></fixed></tendon>
             <actuator><motor name="a" joint="a"/></actuator>
             <sensor><gyro name="a" site="a"/></sensor>
             <equality><connect name="a" body1="a" anchor="0 0 0"/></equality>
             <contact><pair name="a" geom1="a" geom2="b"/></contact>
             <keyframe><key name="a"/></keyframe>
           </mujoco>"""
    )
    assert declared("Element") == set().union(*(found(getattr(everything, kind)("a")) for kind in KINDS))
    # Classes without their own fields: the stub declares all of their members.
    for name in ["RigidOptions", "SolverStats", "Block", "Solution"]:
        assert declared(name) == found(getattr(clench, name)), name


def test_options_and_integrator_of_a_file() -> None:
    model = clench.Model.from_xml(
        "<mujoco model='m'><option integrator='implicitfast' iterations='7' cone='elliptic' impratio='2'/></mujoco>"
    )
    assert model.name == "m" and model.integrator == "implicitfast"
    assert model.options.iterations == 7 and model.options.friction_cone == "elliptic" and model.options.impratio == 2.0
    assert model.options.noslip_tolerance is None
    assert clench.Model.from_xml("<mujoco/>").integrator == "Euler"
    assert clench.Model.from_xml("<mujoco><option integrator='discrete'/></mujoco>").integrator == "discrete"
    assert repr(model) == '<clench.Model "m": nbody=1, njnt=0, ngeom=0, nq=0, nv=0, nu=0>'


def test_notes_tell_what_is_done_otherwise() -> None:
    assert clench.Model.from_xml("<mujoco/>").notes == []
    (note,) = clench.Model.from_xml("<mujoco><option solver='PGS'/></mujoco>").notes
    assert "PGS" in note


@pytest.mark.parametrize(
    ("access", "error", "words"),
    [
        (lambda m: m.body("tors"), ValueError, 'there is no body "tors"; did you mean "torso"?'),
        (lambda m: m.joint("zzzzzzzzzzzz"), ValueError, "root, waist_z"),
        (lambda m: m.site("any"), ValueError, 'there is no site "any"'),
        (lambda m: m.geom(""), ValueError, 'there is no geom ""'),
        (lambda m: m.body(-1), IndexError, "there is no body -1: there are 13"),
        (lambda m: m.body(13), IndexError, "there is no body 13: there are 13"),
        (lambda m: m.body(2**80), IndexError, "there are 13"),
        (lambda m: m.body(1.0), TypeError, "a body is chosen by a str or an int, not by float"),
        (lambda m: m.body(None), TypeError, "NoneType"),
        (lambda m: m.body("\ud800"), UnicodeEncodeError, "surrogates"),
        (lambda m: m.names("bdy"), ValueError, 'did you mean "body"?'),
        (lambda m: m.names(3), TypeError, "str"),
        (lambda m: m.body_mas, AttributeError, 'Model has no attribute "body_mas"; did you mean "body_mass"?'),
        (lambda m: m.mass, AttributeError, 'did you mean "body_mass"?'),
        (lambda m: m.body(1).mas, AttributeError, 'kind "body" has no attribute "mas"; did you mean "mass"?'),
        (lambda m: m.joint(1).damping, AttributeError, 'did you mean "dof_damping"?'),
        (lambda m: m.xyzzy, AttributeError, 'Model has no attribute "xyzzy"'),
        (lambda m: type(m)(), TypeError, "cannot create"),
        (lambda m: m.from_xml(b"<mujoco/>"), TypeError, "str"),
        (lambda m: m.from_file(3), TypeError, "PathLike"),
    ],
)
def test_mistakes(
    humanoid: clench.Model, access: Callable[[Any], object], error: type[Exception], words: str
) -> None:
    with pytest.raises(error) as raised:
        access(humanoid)
    assert words in str(raised.value)


def test_load_errors_know_their_place(tmp_path: Path) -> None:
    path = tmp_path / "robot.xml"
    body = "<body name='arm'>\n<joint name='knee' range='1'/>\n</body>"
    path.write_text(f"<mujoco>\n<worldbody>\n{body}\n</worldbody>\n</mujoco>")
    with pytest.raises(clench.LoadError) as raised:
        clench.Model.from_file(path)
    error = raised.value
    assert isinstance(error, clench.ClenchError) and isinstance(error, ValueError)
    assert (error.file, error.line, error.element) == (str(path), 4, 'joint "knee"')
    assert str(error) == f'{path}:4: joint "knee": {error.message}'
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.line) == (str(error), 4)
    # An error of a text has no file name, and one outside an element has no element.
    with pytest.raises(clench.LoadError) as raised:
        clench.Model.from_xml("<mujoco>\n<mujoco>")
    assert raised.value.file == "" and raised.value.element is None
    assert str(raised.value).startswith(f"line {raised.value.line}: ")
    missing = tmp_path / "missing.xml"
    with pytest.raises(clench.LoadError) as raised:
        clench.Model.from_file(str(missing))
    assert (raised.value.file, raised.value.line, raised.value.element) == (str(missing), None, None)
    assert str(raised.value).startswith(f"{missing}: cannot read the file")


def test_robots_in_urdf_find_their_packages(tmp_path: Path) -> None:
    gripper = ROOT / "models/gripper/gripper.urdf"
    assert clench.Model.from_file(gripper).nmesh == 1
    moved = tmp_path / "robot.urdf"
    moved.write_text(gripper.read_text())
    with pytest.raises(clench.LoadError, match='package "gripper"'):
        clench.Model.from_file(moved)
    model = clench.Model.from_file(moved, package_path=[ROOT / "models"])
    assert (model.nv, model.neq) == (3, 1)


def test_the_base_of_a_robot_in_urdf_can_float() -> None:
    gripper = ROOT / "models/gripper/gripper.urdf"
    fixed, free = clench.Model.from_file(gripper), clench.Model.from_file(gripper, floating=True)
    assert (free.nq, free.nv) == (fixed.nq + 7, fixed.nv + 6)
    assert free.names("body")[1] == "base" and free.body("base").mass > 0 and "base" not in fixed.names("body")
    spec = clench.ModelSpec.from_file(gripper, floating=True)
    assert spec.build().nv == free.nv and "floating_base" in spec.names("joint")
    ball = "<robot name='r'><link name='ball'><collision><geometry><sphere radius='0.1'/></geometry></collision></link></robot>"
    assert clench.Model.from_xml(ball, floating=True).nv == 6
    assert pickle.loads(pickle.dumps(free)).nv == free.nv
    with pytest.raises(clench.LoadError, match="freejoint"):
        clench.Model.from_file(HUMANOID, floating=True)
    with pytest.raises(clench.LoadError, match="freejoint"):
        clench.ModelSpec.from_file(HUMANOID, floating=True)


@pytest.mark.parametrize("path", [*EXAMPLES, *FEATURES], ids=lambda path: path.stem)
def test_a_saved_model_is_the_model(path: Path) -> None:
    model = clench.Model.from_file(path)
    again = clench.Model.from_xml(model.to_xml())
    # Vertices of sheared meshes have double precision, but files store single precision (docs/saving.md).
    rtol, atol = (1e-6, 1e-7) if path.stem == "stretched_frames" else (1e-9, 1e-12)
    for field in clench.PARAMETERS:
        if field == "actuator_cranklength":  # A class may set it on other transmissions, which ignore it.
            continue
        before, after = getattr(model, field), getattr(again, field)
        np.testing.assert_allclose(after, before, rtol=rtol, atol=atol, err_msg=field)


def test_models_load_in_many_threads() -> None:
    masses: list[float] = []
    threads = [Thread(target=lambda: masses.append(clench.Model.from_file(HUMANOID).body_mass.sum())) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(masses) == 8 and len(set(masses)) == 1


def test_everything_says_what_it_is_for() -> None:
    for thing in [clench.Model, clench.Element, clench.RigidOptions, clench.SolverStats, clench.Block, clench.Solution]:
        assert inspect.getdoc(thing), thing
        for name, member in vars(thing).items():
            if not name.startswith("_"):
                assert inspect.getdoc(member), f"{thing.__name__}.{name}"
    for function in [clench.solve, clench.Model.from_file, clench.Model.from_xml, clench.Model.body]:
        text = inspect.getdoc(function) or ""
        assert all(section in text for section in ("Parameters\n---", "Returns\n---", "Raises\n---"))
    assert list(inspect.signature(clench.Model.from_file).parameters) == [
        "path",
        "budget",
        "package_path",
        "floating",
        "ignore_unsupported",
        "max_dynamic_constraints",
    ]
    assert list(inspect.signature(clench.solve).parameters) == ["M", "a_unc", "blocks", "options"]


def test_copies_of_a_model_are_the_model() -> None:
    model = clench.Model.from_xml("<mujoco><worldbody/></mujoco>")
    assert copy.copy(model) is model
    assert copy.deepcopy({"model": model})["model"] is model
