"""Writes random models into a folder, a file per seed: `python parity/write_random_models.py FOLDER FIRST COUNT`.

They include models that MuJoCo refuses. `clench-gpu/tests/device/random.rs` compares the GPU with the CPU on them.
"""

import pathlib
import sys

from random_models.generate import generate, written


def main(folder, first, count):
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.xml"):
        old.unlink()
    for seed in range(int(first), int(first) + int(count)):
        (folder / f"{seed}.xml").write_text(written(generate(seed)))


if __name__ == "__main__":
    main(*sys.argv[1:])
