"""The package as a whole: its dependencies, contents and documentation."""

from __future__ import annotations

import doctest
import inspect
import pathlib
import re
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import clench
import numpy as np
import pytest
from scenes import ROOT, ball, example, puppet

CLASSES = [getattr(clench, name) for name in clench.__all__ if inspect.isclass(getattr(clench, name))]
ERRORS = [cls for cls in CLASSES if issubclass(cls, Exception)]


def python(program: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)


def test_numpy_is_all_that_it_needs() -> None:
    program = """
import sys
class Refuse:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in ("gymnasium", "mujoco", "matplotlib", "scipy", "torch", "jax"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
sys.meta_path.insert(0, Refuse())
import clench
assert "clench.gymnasium" not in sys.modules
model = clench.Model.from_xml("<mujoco><worldbody><body><freejoint/><geom size='1'/></body></worldbody></mujoco>")
clench.Batch(model, 3).step()
try:
    import clench.gymnasium
except ImportError as error:
    assert "gymnasium" in str(error), error
else:
    raise AssertionError("clench.gymnasium without gymnasium")
"""
    done = python(program)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(
    ("module", "package", "extra"),
    [("torch", "torch", "torch"), ("jax", "jax", "jax"), ("gymnasium.sb3", "stable_baselines3", "sb3")],
)
def test_a_missing_package_is_named_with_its_extra(module: str, package: str, extra: str) -> None:
    done = python(f"import sys; sys.modules[{package!r}] = None; import clench.{module}")
    assert f"pip install 'clench[{extra}]'" in done.stderr.splitlines()[-1]


def test_it_is_loaded_quickly() -> None:
    program = "import sys, clench; print(*sys.modules)"
    loaded = python(program).stdout.split()
    assert "clench._core" in loaded
    assert not {"gymnasium", "mujoco", "matplotlib", "scipy", "unittest"} & set(loaded)


def test_names() -> None:
    assert set(clench.__all__) <= set(dir(clench))
    assert len(set(clench.__all__)) == len(clench.__all__)
    assert re.fullmatch(r"\d+\.\d+\.\d+.*", clench.__version__)
    for names in (clench.OUTPUTS, clench.PARAMETERS):
        assert isinstance(names, tuple) and len(set(names)) == len(names) > 20
    offered = {name for name in dir(clench) if not name.startswith("_")}
    modules = {name for name in offered if inspect.ismodule(getattr(clench, name))}
    assert offered - modules == set(clench.__all__) - {"__version__"}


def members(cls: type) -> dict[str, Any]:
    own = [base for base in cls.__mro__ if base.__module__.startswith("clench")]
    found: dict[str, Any] = {}
    for base in own:
        for name in vars(base):
            if not name.startswith("_"):
                found.setdefault(name, getattr(cls, name))
    return found


@pytest.mark.parametrize("cls", CLASSES, ids=lambda cls: cls.__name__)
def test_everything_is_documented(cls: type) -> None:
    assert inspect.getdoc(cls)
    assert cls.__module__.startswith("clench")
    for name, member in members(cls).items():
        if isinstance(member, cls) or cls is clench.State or cls in ERRORS:
            continue  # members of an enumeration, fields
        assert inspect.getdoc(member), f"{cls.__name__}.{name}"


@pytest.mark.parametrize("cls", [*CLASSES, clench], ids=lambda thing: thing.__name__)
def test_every_signature_can_be_read(cls: Any) -> None:
    functions = {name: member for name, member in members(cls).items() if callable(member)} if cls is not clench else {}
    if cls is clench:
        functions = {"solve": clench.solve}
    elif cls in (clench.Sim, clench.Batch, clench.RigidOptions, clench.Block, clench.State):
        functions[cls.__name__] = cls
    for name, function in functions.items():
        signature = inspect.signature(function)
        doc = inspect.getdoc(function) or ""
        for parameter in signature.parameters.values():
            if parameter.name not in ("self", "cls") and parameter.kind is not parameter.VAR_POSITIONAL:
                assert re.search(rf"^{parameter.name}\b|\b{parameter.name}\b.* : ", doc, re.M), (name, parameter.name)


def test_signatures_say_the_defaults() -> None:
    batch = inspect.signature(clench.Batch)
    assert list(batch.parameters) == ["model", "n_envs", "precision", "threads", "options", "record", "device", "env_model"]
    assert batch.parameters["precision"].default is None and batch.parameters["threads"].default is None
    assert batch.parameters["device"].default == "cpu"
    assert batch.parameters["options"].kind is inspect.Parameter.KEYWORD_ONLY
    assert inspect.signature(clench.Sim).parameters["precision"].default == "64"
    assert inspect.signature(clench.Batch.step).parameters["n"].default == 1
    assert inspect.signature(clench.Batch.rollout).parameters["record"].default == ("qpos", "qvel")


def test_errors_are_what_they_say() -> None:
    assert {cls.__name__ for cls in ERRORS} == {"BusyError", "ClenchError", "LoadError", "SimulationError"}
    assert all(issubclass(cls, clench.ClenchError) for cls in ERRORS)
    assert issubclass(clench.LoadError, ValueError)
    assert str(clench.LoadError("wrong", "robot.xml", 12)) == "robot.xml:12: wrong"
    assert str(clench.LoadError("wrong", "", 12, "geom")) == "line 12: geom: wrong"
    assert issubclass(clench.SimulationError, RuntimeError) and issubclass(clench.BusyError, RuntimeError)


def test_status_codes() -> None:
    assert [(status.name, int(status)) for status in clench.EnvStatus] == [
        ("RUNNING", 0),
        ("NOT_FINITE", 1),
        ("SINGULAR", 2),
        ("DIVERGED", 3),
        ("CONTACT_OVERFLOW", 4),
        ("OVER_BUDGET", 5),
        ("UNFINISHED", 6),
    ]


@pytest.mark.parametrize("cls", [clench.Contacts, clench.Constraints, clench.SolverStats, clench.StateViews])
def test_what_only_simulations_make(cls: Any) -> None:
    makes: list[Callable[[], Any]] = [cls, lambda: cls(1), lambda: cls.__new__(cls), lambda: object.__new__(cls)]
    for make in makes:
        with pytest.raises(TypeError):
            make()


def test_arrays_of_one_kind_have_one_dtype() -> None:
    """Every array has the requested precision, in C order and native byte order."""
    double, single = clench.Sim(puppet()), clench.Sim(puppet(), precision="32")
    for sim, number in ((double, np.float64), (single, np.float32)):
        sim.step()
        for name in clench.OUTPUTS:
            output = sim.output(name)
            if np.ndim(output):
                assert output.dtype == number and output.flags.c_contiguous, name
        for name in clench.PARAMETERS:
            assert sim.param(name).dtype == number, name


def test_examples_in_docstrings_are_true(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    monkeypatch.setitem(sys.modules, "clench.gymnasium", None)
    found = doctest.testmod(clench, extraglobs={"clench": clench, "np": np, "model": example("humanoid")})
    assert found.attempted > 10 and found.failed == 0


def test_types_are_shipped() -> None:
    folder = pathlib.Path(clench.__file__).parent
    assert (folder / "py.typed").is_file() and (folder / "_core.pyi").is_file()
    assert repr(clench.Sim(ball())) == '<clench.Sim of "ball", 64 bits>'
