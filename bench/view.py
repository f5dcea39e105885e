"""Measures the server's cost of a viewer frame: bytes, and time compared with the steps between two frames.

The example `frames` of clench-view measures. MuJoCo has no counterpart, so there is no ratio.
"""

import json
import os
import subprocess

from scene import ROOT

FRAMES = os.environ.get("FRAMES", str(ROOT / "target/dist/examples/frames"))


def compare(_, args):
    """Runs the example and prints a table; returns no rows, since nothing is compared."""
    print("\na frame of the viewer every eighth step, sixty per second")
    print(f"  {'scene':<24}{'bodies':>8}{'contacts':>10}{'bytes':>9}{'changed':>9}{'µs':>8}{'µs of the steps':>17}")
    lines = subprocess.run([FRAMES], capture_output=True, text=True, check=True).stdout.splitlines()
    for row in map(json.loads, lines):
        print(
            f"  {row['model']:<24}{row['bodies']:>8}{row['contacts']:>10}{row['bytes']:>9}{row['changed_bytes']:>9}"
            f"{row['frame_microseconds']:>8.0f}{row['steps_microseconds']:>17.0f}"
        )
    return []
