"""Writes random models into a folder, a file a seed: `python parity/write_random_models.py FOLDER FIRST COUNT`.

Those that MuJoCo refuses are among them. A device is compared with the processor on them (`clench-gpu/tests/device/random.rs`).
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
