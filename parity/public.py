"""Models of other people's packages, genesis-world, dm-control and gym-aloha, which `cargo xtask test python` puts into .venv/models.

`public.txt` lists all that MuJoCo loads, each with what Clench refuses it for, if it does.
"""

import pathlib

HERE = pathlib.Path(__file__).resolve().parent
FOLDER = HERE.parent / ".venv/models"


def listed():
    """Pairs of a file below FOLDER and the reason why it is refused, or None."""
    lines = (HERE / "public.txt").read_text().splitlines()
    rows = (line.partition(": ") for line in lines if not line.startswith("#"))
    return [(name, reason or None) for name, _, reason in rows]


def refused():
    return [(name, reason) for name, reason in listed() if reason]


def compared():
    return [name for name, reason in listed() if reason is None]


def path(name):
    """Where a listed file is."""
    return FOLDER / name
