"""The sections of the stub `_core.pyi` that follow from tables in Rust.

As a program, this writes them from the tables of the installed module. `cargo xtask stubs` installs it and runs this.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

from clench import RigidOptions
from clench._core import _STATE_FIELDS

# The type of an option in the documentation, with its types in the stub as an argument and as an attribute.
OPTION_TYPES = {
    "int": ("SupportsIndex", "int"),
    "float": ("SupportsFloat", "float"),
    "bool": ("bool | np.bool_", "bool"),
    'bool or "auto"': ('bool | np.bool_ | Literal["auto"]', 'bool | Literal["auto"]'),
    'int or "auto"': ('SupportsIndex | Literal["auto"]', 'int | Literal["auto"]'),
    '{"Newton", "CG"}': ('Literal["Newton", "CG"]', 'Literal["Newton", "CG"]'),
    '{"pyramidal", "elliptic"}': ('Literal["pyramidal", "elliptic"]', 'Literal["pyramidal", "elliptic"]'),
    '{"convex", "coulomb"}': ('Literal["convex", "coulomb"]', 'Literal["convex", "coulomb"]'),
}
OPTIONS: list[tuple[str, str]] = re.findall(r"^(\w+) : (.*), optional$", RigidOptions.__doc__ or "", re.MULTILINE)
STATE_TYPES = {"number": "NDArray[Any]", "int32": "NDArray[np.int32]", "bool": "_Flags"}


def option_arguments() -> list[str]:
    return [f"{name}: {OPTION_TYPES[kind][0]} | None = None," for name, kind in OPTIONS]


def option_attributes() -> list[str]:
    pairs = [("@property", f"def {name}(self) -> {OPTION_TYPES[kind][1]} | None: ...") for name, kind in OPTIONS]
    return [line for pair in pairs for line in pair]


def state_views() -> list[str]:
    lines = []
    for name, dtype, shape, _ in _STATE_FIELDS:
        lines += [
            "@property",
            f"def {name}(self) -> {STATE_TYPES[dtype]}: ...  # {shape}",
            f"@{name}.setter",
            f"def {name}(self, values: ArrayLike) -> None: ...",
        ]
    return lines


def state_arrays() -> list[str]:
    return [f"{name}: {STATE_TYPES[dtype]}" for name, dtype, *_ in _STATE_FIELDS]


SECTIONS: dict[str, Callable[[], list[str]]] = {
    "arguments of options": option_arguments,
    "attributes of options": option_attributes,
    "views of the state": state_views,
    "arrays of a state": state_arrays,
}


def rewrite(stub: str) -> str:
    """Returns a stub with every section regenerated from its table."""
    for name, lines in SECTIONS.items():
        section = re.compile(rf"^( *)# <{name}>.*\n(?:.*\n)*?\1# </{name}>$", re.MULTILINE)

        def written(found: re.Match[str], name: str = name, lines: Callable[[], list[str]] = lines) -> str:
            whole = [f"# <{name}> Written by `cargo xtask stubs`.", *lines(), f"# </{name}>"]
            return "\n".join(found[1] + line for line in whole)

        stub, count = section.subn(written, stub)
        assert count == 1, f"{count} sections of {name}"
    return stub


if __name__ == "__main__":
    path = Path(__file__).parents[1] / "clench" / "_core.pyi"
    path.write_text(rewrite(path.read_text()))
