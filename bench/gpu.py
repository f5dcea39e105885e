"""Steps of environments a second on a graphics device, by their number, beside Clench's lanes on the processor (single precision, all
threads) in the same run, with the device's time by stage and its bytes an environment.

The example `speed` of clench-gpu measures. Where MuJoCo Warp is installed (`pip install mujoco-warp`) and has a card, it steps as many
worlds of the same file beside them, by a captured graph. On a software device the figures say nothing of any card.
"""

import json
import os
import subprocess
import time

from scene import ROOT

SPEED = os.environ.get("SPEED", str(ROOT / "target/dist/examples/speed"))
# How long a measurement of MuJoCo Warp lasts at least, s.
LEAST = 1.0


def compare(model, args):
    """Prints a table, and returns no rows: MuJoCo's own batch is not in it."""
    command = [SPEED, str(model), str(args.gpu_envs)]
    lines = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines()
    rows = [json.loads(line) for line in lines]
    if not rows:
        return []
    print(f"\n{model} on {rows[0]['name']}, {rows[-1]['bytes_per_env']} bytes an environment: steps a second")
    print(f"  {'environments':>12}{'device':>14}{'processor':>14}{'ratio':>8}{'MuJoCo Warp':>14}")
    for row in rows:
        warp = warp_speed(model, row["envs"])
        ratio = row["device"] / row["processor"]
        print(f"  {row['envs']:>12}{row['device']:>14.0f}{row['processor']:>14.0f}{ratio:>8.2f}{warp or '-':>14}")
    stages = ", ".join(f"{stage} {µs:.2f}" for stage, µs in rows[-1]["stages"].items())
    print(f"  stages, µs an environment: {stages}")
    return []


def warp_speed(model, worlds):
    """Steps a second of MuJoCo Warp, where it and a card are there."""
    try:
        import mujoco
        import mujoco_warp
        import warp
    except ImportError:
        return None
    if not warp.is_cuda_available():
        return None
    description = mujoco.MjModel.from_xml_path(str(model))
    data = mujoco.MjData(description)
    mujoco.mj_forward(description, data)
    on_card = mujoco_warp.put_model(description)
    states = mujoco_warp.put_data(description, data, nworld=worlds)
    mujoco_warp.step(on_card, states)
    with warp.ScopedCapture() as capture:
        mujoco_warp.step(on_card, states)
    steps, start = 0, time.perf_counter()
    while time.perf_counter() - start < LEAST:
        for _ in range(8):
            warp.capture_launch(capture.graph)
        warp.synchronize()
        steps += 8
    return round(steps * worlds / (time.perf_counter() - start))
