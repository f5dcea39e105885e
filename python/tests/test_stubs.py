"""Parts of the stubs that stubtest cannot check: generated sections, and attributes that are looked up by name."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import clench
import pytest
from scenes import puppet
from stubs import rewrite

STUB = Path(clench.__file__).with_name("_core.pyi").read_text()
STATE = {"time", "qpos", "qvel", "act"}


def attributes(name: str) -> dict[str, str]:
    """Returns the annotated names of a class with the shapes in their comments, if any."""
    (found,) = (node for node in ast.parse(STUB).body if isinstance(node, ast.ClassDef) and node.name == name)
    lines = STUB.splitlines()
    result = {}
    for node in found.body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            shape = re.search(r"# \((.*?)\)", lines[node.lineno - 1])
            result[node.target.id] = shape[1] if shape else ""
    return result


def test_sections_of_stub_are_as_the_tables_in_rust() -> None:
    assert rewrite(STUB) == STUB, "run `cargo xtask stubs`"


def test_shapes_of_the_state_are_true() -> None:
    sim = clench.Sim(puppet())
    sizes = dict.fromkeys(
        (
            "ntree where trees may sleep, else 0",
            "nq + 7 nmocap where trees may sleep, else 0",
            "max_stick_pairs with the option stiction, else 0",
            "nv + ntendon with the option stiction, else 0",
        ),
        0,
    )
    for name, _, shape, _ in clench._core._STATE_FIELDS:
        first, *width = shape.strip("()").rsplit(", ", 1) if shape[-2] != "," else [shape.strip("(),")]
        size = sizes[first] if first in sizes else getattr(sim.model, first)
        assert getattr(sim, name).shape == (size, *map(int, width)), name


@pytest.mark.parametrize("name", ["Sim", "Batch"])
def test_outputs_of_stub_are_those_of_module(name: str) -> None:
    assert {*attributes("_Outputs"), *attributes(name)} | STATE == set(clench.OUTPUTS)


def test_shapes_of_outputs_are_true() -> None:
    model = puppet()
    sim, batch = clench.Sim(model), clench.Batch(model, 3, record=clench.OUTPUTS)
    for name, shape in attributes("_Outputs").items():
        sizes = tuple(int(size) if size.isdigit() else getattr(model, size) for size in re.findall(r"\w+", shape))
        assert sim.output(name).shape == sizes, name
        assert batch.output(name).shape == (3, *sizes), name
    for name in attributes("Sim"):
        assert isinstance(getattr(sim, name), float)
        assert getattr(batch, name).shape == (3,)
