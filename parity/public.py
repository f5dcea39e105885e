"""Models of other people's packages, genesis-world, dm-control and gym-aloha, which `cargo xtask test python` puts into .venv/models.

`public.txt` lists all that MuJoCo loads, each with what Clench refuses it for, if it does. Where that is sensors or skins, which move
nothing, a copy without them is compared instead.
"""

import functools
import pathlib
import re
import tempfile
import warnings

import mujoco

HERE = pathlib.Path(__file__).resolve().parent
FOLDER = HERE.parent / ".venv/models"
MOVE_NOTHING = re.compile(r"in <sensor>|<skin> in")

copies = tempfile.TemporaryDirectory()


def listed():
    """Pairs of a file below FOLDER and the reason why it is refused, or None."""
    lines = (HERE / "public.txt").read_text().splitlines()
    rows = (line.partition(": ") for line in lines if not line.startswith("#"))
    return [(name, reason or None) for name, _, reason in rows]


def refused():
    return [(name, reason) for name, reason in listed() if reason]


def compared():
    return [name for name, reason in listed() if reason is None or MOVE_NOTHING.search(reason)]


@functools.lru_cache(maxsize=None)
def path(name):
    """The file to compare: the one named, or a copy without sensors and skins."""
    original = FOLDER / name
    if dict(listed()).get(name) is None:
        return original
    spec = mujoco.MjSpec.from_file(str(original))
    for element in [*spec.sensors, *spec.skins]:
        spec.delete(element)
    spec.meshdir, spec.texturedir = (str(original.parent / folder) for folder in (spec.meshdir, spec.texturedir))
    copy = pathlib.Path(copies.name) / name.replace("/", "-")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that an attribute is deprecated
        spec.compile()
        copy.write_text(spec.to_xml())
    return copy
