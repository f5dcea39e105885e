"""Clench's and MuJoCo's speed side by side, alternating in one run: the same controls, one thread.

The first comparison is of one environment: each repetition steps every engine from the model's default state, Clench
through `clench simulate` (which reports the time of stepping alone) and MuJoCo through its own rollout in C. The next
is of batches (batch.py). Times are medians over repetitions; a ratio is the median of the ratios of repetitions. Both
engines read the same file with its integrator, tolerance and iterations. If the file selects PGS, MuJoCo is timed with
Newton, which Clench uses, and with one environment also with PGS. Further comparisons are the overhead of Python's
calls (calls.py), vector environments and gymnasium's (vector.py), heaps of bodies (heaps.py), collision of pairs of
shapes (pairs.py), and the frames of the viewer (view.py).
`--only public` times all models of the public packages (public_models.py), `--only families` scenes of manipulation and
of many bodies (families.py), `--only gpu` a GPU (gpu.py), and `--only pictures` pictures (pictures.py). The whole run
omits these: they take long or need a graphics device.
"""

import argparse
import importlib
import json
import os
import pathlib
import sys

from timing import processors

DEFAULT_MODELS = ["humanoid", "ant", "half_cheetah"]
# Comparisons that run only on request.
ALONE = ["families", "gpu", "pictures", "public"]
DEFAULT_TASKS = ["HalfCheetah-v5", "Humanoid-v5"]


# The module of each comparison, imported when it runs: `--help` needs neither MuJoCo nor Clench.
COMPARISONS = {
    "one": "single",
    "batch": "batch",
    "calls": "calls",
    "vector": "vector",
    "heaps": "heaps",
    "pairs": "pairs",
    "view": "view",
    "families": "families",
    "gpu": "gpu",
    "pictures": "pictures",
    "public": "public_models",
}


def main():
    args = arguments()
    from scene import Unmeasured

    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0
    if load > 0.5:
        print(f"other programs are running (load {load:.1f}): the figures are unreliable")
    results = []
    for name, module in COMPARISONS.items():
        if name == args.only or (args.only is None and name not in ALONE):
            comparison = importlib.import_module(module)
            try:
                results += [row for subject in subjects(name, comparison, args) for row in comparison.compare(subject, args)]
            except Unmeasured as reason:
                sys.exit(str(reason))
    if args.json:
        pathlib.Path(args.json).write_text(json.dumps(results, indent=2) + "\n")
    print(f"\nratio: MuJoCo's time with Newton over this engine's; medians of {args.repeat} runs")
    slower = {r.get("model", r.get("task", r.get("pair"))) for r in results if r["engine"].startswith("clench") and r["ratio"] < 1}
    if slower:
        print(f"slower than MuJoCo on: {', '.join(sorted(slower))}")
    sys.exit(1 if slower and args.check else 0)


def subjects(name, comparison, args):
    """Returns what a comparison is called for, one after the other."""
    if name == "vector":
        return args.tasks
    if name == "heaps":
        return comparison.SCENES
    if name in ("pairs", "view", "families", "public"):
        return [None]
    from scene import find

    return [find(model) for model in args.models]


def arguments():
    parser = argparse.ArgumentParser(prog="cargo xtask bench", description=__doc__.split("\n")[0])
    parser.add_argument("models", nargs="*", default=DEFAULT_MODELS, help="gymnasium's names, or files")
    parser.add_argument("--only", choices=list(COMPARISONS), help="one of the comparisons")
    parser.add_argument("--filter", default="", metavar="TEXT", help="public models, or scenes of the families, whose name contains this")
    parser.add_argument("--docs", action="store_true", help="rewrite the figures and plots in docs/ of families or of public models")
    parser.add_argument("--steps", type=int, default=5000, help="steps per run of one environment (default: %(default)s)")
    parser.add_argument("--envs", type=int, default=256, help="environments of the batch (default: %(default)s)")
    parser.add_argument("--batch-steps", type=int, default=500, help="steps per run of the batch (default: %(default)s)")
    parser.add_argument("--tasks", nargs="*", default=DEFAULT_TASKS, help="vector environments (default: %(default)s)")
    parser.add_argument("--vector-steps", type=int, default=100, help="steps per run of these (default: %(default)s)")
    parser.add_argument("--gpu-envs", type=int, default=65536, help="maximum number of environments on a GPU (default: %(default)s)")
    parser.add_argument("--heap-steps", type=int, default=1500, help="steps per run of a heap (default: %(default)s)")
    parser.add_argument("--noise", type=float, default=0.1, help="noise of the initial states (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=min(2, processors()), help="threads of Clench's batch, in addition to one")
    parser.add_argument("--repeat", type=int, default=7, help="runs of each engine (default: %(default)s)")
    parser.add_argument("--clench", default="", metavar="FLAGS", help="more flags for clench, as one string")
    parser.add_argument("--json", metavar="FILE", help="write the figures there as well")
    parser.add_argument("--check", action="store_true", help="exit code 1 if Clench is slower on any model")
    return parser.parse_args()


if __name__ == "__main__":
    main()
