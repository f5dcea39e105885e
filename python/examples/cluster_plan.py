"""Planning on a cluster: the cross-entropy method finds a gait of a quadruped, its tries spread over Ray's workers.

A gait is a sine wave per actuator. Each round tries many gaits at once, on all workers, and draws the next ones from a
normal distribution around the best. With ``--kill`` a worker is killed half-way, and the result is bitwise the same.
Needs Ray::

    pip install 'clench[ray]'
    python python/examples/cluster_plan.py --workers 2
    RAY_ADDRESS=auto python python/examples/cluster_plan.py
"""

from __future__ import annotations

import os
import signal
from typing import TYPE_CHECKING

import numpy as np
import plots
from numpy.typing import NDArray

import clench
import clench.ray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Floats = NDArray[np.float64]


def controls(gaits: Floats, steps: int, model: clench.Model) -> Floats:
    """Return the controls (n, steps, nu) of gaits (n, 3 nu + 1).

    A gait has centres, amplitudes and phases of waves, and their frequency, Hz.
    """
    centre, amplitude, phase = np.split(gaits[:, np.newaxis, : 3 * model.nu], 3, axis=2)
    times = model.timestep * np.arange(steps)[:, np.newaxis]
    waves: Floats = centre + amplitude * np.sin(2.0 * np.pi * np.abs(gaits[:, np.newaxis, -1:]) * times + phase)
    return waves


def main() -> None:
    """Run the example."""
    parser = plots.parser(__doc__)
    parser.add_argument("--workers", type=int, help="number of workers (default: one per machine)")
    parser.add_argument("--kill", action="store_true", help="kill a worker in the middle of the run")
    options = parser.parse_args()
    n, steps, rounds = (64, 100, 4) if options.quick else (1024, 500, 15)

    # The workers do not need the file.
    model = clench.ModelSpec.from_file(plots.MODELS / "quadruped.xml").build()
    start = np.concatenate([[0.0], model.qpos0, np.zeros(model.nv)])
    rng = np.random.default_rng(0)
    mean = np.concatenate([np.zeros(model.nu), np.full(model.nu, 0.25), np.zeros(model.nu), [2.0]])
    spread = np.concatenate([np.full(model.nu, 0.2), np.full(model.nu, 0.2), np.full(model.nu, 2.0), [0.7]])
    best = []
    with clench.ray.Batch(model, n, workers=options.workers) as batch:
        for attempt in range(rounds):
            if options.kill and attempt == rounds // 2:
                os.kill(batch.workers[-1][1], signal.SIGKILL)
            gaits = rng.normal(mean, spread, (n, mean.size))
            distance = batch.rollout(start, controls(gaits, steps, model), record=["qpos"])["qpos"][:, -1, 0]
            distance = np.nan_to_num(distance, nan=-np.inf)
            elite = gaits[np.argsort(distance)[-n // 10 :]]
            mean, spread = elite.mean(axis=0), elite.std(axis=0) + 0.01
            best.append(float(distance.max()))
            print(f"round {attempt + 1}: the best goes {best[-1]:.4f} m")
        print(f"{len(batch.workers)} workers, {batch.replaced} replaced")

    def draw(axes: Axes) -> None:
        axes.plot(np.arange(1, rounds + 1), best, marker="o")
        axes.set(xlabel="round", ylabel="distance forward, m", title="A gait found by the cross-entropy method")

    plots.finish(options, draw)


if __name__ == "__main__":
    main()
