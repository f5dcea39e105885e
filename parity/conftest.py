"""The models, cones and solvers of the tests, and the check that the program is built."""

import pathlib

import gymnasium
import pytest

import program

ROOT = pathlib.Path(__file__).resolve().parent.parent
GYMNASIUM = pathlib.Path(gymnasium.__file__).parent / "envs/mujoco/assets"


# Heaps whose contacts are patches: one is in `test_shapes.py`, the other is too large to compare.
HEAPS = ("towers", "pile")


def models():
    """Returns every model that is compared: gymnasium's, the examples, and those that cover a feature."""
    return [
        pytest.param(path, id=f"{group}-{path.stem}")
        for group, folder in (("gym", GYMNASIUM), ("example", ROOT / "models"), ("feature", ROOT / "parity/models"))
        for path in sorted(folder.glob("*.xml"))
        if path.stem not in HEAPS
    ]


def pytest_configure(config):
    config.addinivalue_line("markers", "long: takes long; `cargo xtask test --quick` leaves it out")


def pytest_sessionstart(session):
    if not program.CLENCH.is_file():
        pytest.exit(f"{program.CLENCH} is missing: run `cargo build --release -p clench-cli`", returncode=2)
    if len(list(GYMNASIUM.glob("*.xml"))) != 14:
        pytest.exit(f"expected 14 models in {GYMNASIUM}: is that gymnasium 1.4.0?", returncode=2)


def pytest_terminal_summary(terminalreporter):
    """Prints the results of the URDF files, if they were compared."""
    passed = terminalreporter.stats.get("passed", [])
    rows = sorted(value for report in passed for name, value in report.user_properties if name == "urdf")
    if rows:
        terminalreporter.section("URDF files: largest differences, relative to the numbers involved")
        for row in rows:
            terminalreporter.line(row)


def pytest_generate_tests(metafunc):
    for name, values in (("model", models()), ("cone", ["pyramidal", "elliptic"]), ("solver", ["newton", "cg"])):
        if name in metafunc.fixturenames:
            metafunc.parametrize(name, values, scope="session")
