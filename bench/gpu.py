"""Measures environment steps per second on a GPU by number of environments, with its time by stage and its memory.

The example `speed` of clench-gpu measures the GPU and, in the same run, Clench's lanes on the CPU (single precision,
all threads). If MuJoCo Warp is installed (`pip install mujoco-warp`) and has a GPU, it steps as many worlds of the same
file by a captured graph. Figures of a software device say nothing about a GPU.
"""

import json
import os
import subprocess
import time

import numpy as np
from scene import ROOT

SPEED = os.environ.get("SPEED", str(ROOT / "target/dist/examples/speed"))
# As in `speed`: timed steps, steps before them, and steps between new controls.
STEPS = 1000
WARM_UP = 24
HOLD = 8


def compare(model, args):
    """Prints a table; returns no rows, since MuJoCo's own batch is not in it."""
    command = [SPEED, str(model), str(args.gpu_envs)]
    lines = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines()
    rows = [json.loads(line) for line in lines]
    if not rows:
        return []
    print(f"\n{model} on {rows[0]['name']}, {rows[-1]['bytes_per_env']} bytes per environment: steps per second")
    print(f"  {'environments':>12}{'device':>14}{'processor':>14}{'ratio':>8}{'MuJoCo Warp':>14}")
    for row in rows:
        warp = warp_speed(model, row["envs"])
        ratio = row["device"] / row["processor"]
        print(f"  {row['envs']:>12}{row['device']:>14.0f}{row['processor']:>14.0f}{ratio:>8.2f}{warp or '-':>14}")
        if row["failed"]:
            print(f"  {row['failed']} of these {row['envs']} environments failed and were not stepped: the figure is invalid")
    stages = ", ".join(f"{stage} {µs:.2f}" for stage, µs in rows[-1]["stages"].items())
    print(f"  stages, µs per environment: {stages}")
    return []


def warp_speed(model, worlds):
    """Returns the steps per second of MuJoCo Warp, or None if it or a GPU is missing.

    As in `speed`, worlds start from the first keyframe, and each gets its own new controls every eight steps.
    """
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
    if description.nkey:
        mujoco.mj_resetDataKeyframe(description, data, 0)
    mujoco.mj_forward(description, data)
    on_card = mujoco_warp.put_model(description)
    states = mujoco_warp.put_data(description, data, nworld=worlds)
    mujoco_warp.step(on_card, states)
    with warp.ScopedCapture() as capture:
        for _ in range(HOLD):
            mujoco_warp.step(on_card, states)
    low, high = description.actuator_ctrlrange.T
    half = np.where(description.actuator_ctrllimited, 0.5 * (high - low), 1.0)
    random = np.random.default_rng(0)
    noise = [random.uniform(-0.01, 0.01, (worlds, description.nu)) for _ in range(8)]
    controls = [(data.ctrl + half * draw).astype(np.float32) for draw in noise]
    start = None
    for call in range((WARM_UP + STEPS) // HOLD):
        if call * HOLD == WARM_UP:
            start = time.perf_counter()
        states.ctrl.assign(controls[call % len(controls)])
        warp.capture_launch(capture.graph)
        warp.synchronize()
    return round(STEPS * worlds / (time.perf_counter() - start))
