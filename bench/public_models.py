"""Times all rigid models of the public packages with nv ≥ 3: one environment, then a batch of 64, on one thread.

Each model has a line with MuJoCo's time over ours; the last lines give the geometric mean, the lowest decile and the
minimum. A run takes MuJoCo a fixed time, so that small models are timed over more steps. Models whose motion diverges
under these controls in either engine are not measured but listed. `--docs` also writes docs/public-models.svg and the figures
of docs/performance.md.
"""

import math
import pathlib
import re
import sys
import time

import mujoco

import plots
from single import Rollout
from batch import Batch
from program import Clench
from scene import NEWTON, ROOT, Unmeasured, load, perturbed_states, smooth_controls
from timing import alternate, ratio

sys.path.insert(0, str(ROOT / "parity"))
import public

MIN_NV = 3
ENVS = 64
SECONDS = 0.15  # MuJoCo's time in a run
COLUMNS = {"alone": "one environment", "f64": f"batch of {ENVS}, f64", "f32": f"batch of {ENVS}, f32"}


def compare(_, args):
    """Prints the table and returns a row per model."""
    print(f"\npublic models with nv of {MIN_NV} or more: MuJoCo's time over Clench's; alone, and {ENVS} environments in either precision")
    print(f"  {'model':<52}{'nv':>5}{'contacts':>9}{'µs alone':>10}{'µs f64':>9}" + "".join(f"{name:>8}" for name in COLUMNS))
    if args.docs and args.filter:
        sys.exit("--docs needs all models: omit --filter")
    chosen = [name for name in public.compared() if args.filter in name]
    results, omitted = [], []
    for name in chosen:
        path = public.path(name)
        model = load(path)
        if model.nv < MIN_NV:
            continue
        try:
            results.append(measure(name, path, model, args))
        except Unmeasured as reason:
            omitted.append(f"{name}: {str(reason).splitlines()[-1]}")
            continue
        row = results[-1]
        print(
            f"  {name.removesuffix('.xml')[-51:]:<52}{model.nv:>5}{row['contacts_mean']:>9.1f}{row['alone_microseconds']:>10.2f}"
            f"{row['f64_microseconds']:>9.2f}" + "".join(f"{row[column]:>8.2f}" for column in COLUMNS),
            flush=True,
        )
    summaries = {label: summarize(column, sorted((row[column], row["model"]) for row in results)) for column, label in COLUMNS.items()}
    if args.docs:
        plots.public(results, COLUMNS, ROOT / "docs" / "public-models.svg")
        rewrite(ROOT / "docs" / "performance.md", summaries)
    print("not measured:", *(omitted or ["none"]), sep="\n  ")
    return [row | {"engine": "clench", "ratio": row["alone"]} for row in results]


def measure(name, path, model, args):
    """Returns the ratios of one model."""
    steps = affordable(model, 1, 1000)
    controls = smooth_controls(model, steps)
    alone = {"mujoco": Rollout(path, NEWTON, controls), "clench": Clench(path, {"ctrl": controls}, ["--steps", steps])}
    seconds = alternate(alone, args.repeat)
    row = {"model": name, "nv": model.nv, "contacts_mean": alone["mujoco"].contacts}
    row |= {"alone": ratio(seconds["mujoco"], seconds["clench"]), "alone_microseconds": 1e6 * min(seconds["clench"]) / steps}

    steps = affordable(model, ENVS, 200)
    arrays = {"ctrl": smooth_controls(model, steps), "states": perturbed_states(model, ENVS, args.noise)}
    engines = {"mujoco": Batch(model, **arrays)}
    for bits in (64, 32):
        engines[f"f{bits}"] = Clench(path, arrays, ["--envs", ENVS, "--threads", 1, "--precision", bits])
    seconds = alternate(engines, args.repeat)
    row |= {key: ratio(seconds["mujoco"], seconds[key]) for key in ("f64", "f32")}
    return row | {f"{key}_microseconds": 1e6 * min(seconds[key]) / steps / ENVS for key in ("f64", "f32")}


def affordable(model, envs, limit):
    """Returns the number of steps that MuJoCo takes with `envs` environments in SECONDS: 5 to `limit`."""
    data = mujoco.MjData(model)
    trial = 20
    begin = time.perf_counter()
    mujoco.mj_step(model, data, trial)
    step = (time.perf_counter() - begin) / trial
    return min(limit, max(5, round(SECONDS / step / envs)))


def summarize(column, ratios):
    """Prints the geometric mean, the lowest decile and the minimum, and returns them as a line of a table."""
    if not ratios:
        return ""
    mean = math.exp(sum(math.log(value) for value, _ in ratios) / len(ratios))
    tenth, (least, slowest) = ratios[len(ratios) // 10][0], ratios[0]
    print(f"  {column:<6} geometric mean {mean:.2f}, a tenth below {tenth:.2f}, least {least:.2f} ({pathlib.Path(slowest).stem})")
    return f"{mean:.2f} | {tenth:.2f} | {least:.2f} ({pathlib.Path(slowest).stem})"


def rewrite(page, summaries):
    """Replaces the lines of a page's table that begin with a summary's label."""
    text = page.read_text()
    for label, summary in summaries.items():
        text = re.sub(rf"^\| {label} \|.*$", f"| {label} | {summary} |", text, flags=re.MULTILINE)
    page.write_text(text)
