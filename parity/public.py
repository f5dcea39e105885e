"""Models of genesis-world, dm-control and gym-aloha, which `cargo xtask test python` puts into .venv/models.

`public.txt` lists all models that MuJoCo loads, with the reason if Clench refuses one.
"""

import pathlib

HERE = pathlib.Path(__file__).resolve().parent
FOLDER = HERE.parent / ".venv/models"


def listed():
    """Returns pairs of a file below FOLDER and the reason why Clench refuses it, or None."""
    lines = (HERE / "public.txt").read_text().splitlines()
    rows = (line.partition(": ") for line in lines if not line.startswith("#"))
    return [(name, reason or None) for name, _, reason in rows]


def refused():
    return [(name, reason) for name, reason in listed() if reason]


def compared():
    return [name for name, reason in listed() if reason is None]


def path(name):
    """Returns the path of a listed file."""
    return FOLDER / name
