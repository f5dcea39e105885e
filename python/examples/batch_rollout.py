"""Batch rollout: try many gaits of a quadruped at once, and keep the one that goes furthest.

Each environment has its own sequence of controls, made of random sine waves. One call steps all environments on all
processors and returns the records::

    python python/examples/batch_rollout.py
    python python/examples/batch_rollout.py --plot batch_rollout.png
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np
import plots
from numpy.typing import NDArray

import clench

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def random_gaits(rng: np.random.Generator, n: int, steps: int, model: clench.Model) -> NDArray[np.float64]:
    """Return controls (n, steps, nu): sine waves with one frequency per gait, and other parameters per actuator."""
    frequency = rng.uniform(1.0, 4.0, (n, 1, 1))
    amplitude, centre = rng.uniform(0.0, 0.5, (n, 1, model.nu)), rng.uniform(-0.2, 0.2, (n, 1, model.nu))
    phase = rng.uniform(0.0, 2.0 * np.pi, (n, 1, model.nu))
    times = model.timestep * np.arange(steps)[:, np.newaxis]
    gaits: NDArray[np.float64] = centre + amplitude * np.sin(2.0 * np.pi * frequency * times + phase)
    return gaits


def step_alone(model: clench.Model, gait: NDArray[np.float64]) -> NDArray[Any]:
    """Return the final positions of one gait in a single simulation."""
    sim = clench.Sim(model)
    for controls in gait:
        sim.ctrl = controls
        sim.step()
    return sim.qpos


def main() -> None:
    """Run the example."""
    options = plots.parser(__doc__).parse_args()
    n, steps = (64, 250) if options.quick else (1024, 1000)

    model = clench.Model.from_file(plots.MODELS / "quadruped.xml")
    batch = clench.Batch(model, n)
    gaits = random_gaits(np.random.default_rng(0), n, steps, model)

    begin = time.perf_counter()
    recorded = batch.rollout(ctrl=gaits, record=["time", "qpos", "contact_count"])
    seconds = time.perf_counter() - begin
    print(f"{n} gaits of {steps} steps in {seconds:.2f} s: {n * steps / seconds:,.0f} steps a second")

    forward = recorded["qpos"][:, :, 0]
    best = int(forward[:, -1].argmax())
    print(f"the best, gait {best}, goes {forward[best, -1]:.2f} m; the median {np.median(forward[:, -1]):.2f} m")
    print(f"it has {recorded['contact_count'][best].mean():.1f} contacts on average")

    same = np.array_equal(step_alone(model, gaits[best]), recorded["qpos"][best, -1])
    print(f"in a simulation of its own it ends {'in the same place, to the bit' if same else 'somewhere else'}")

    def draw(axes: Axes) -> None:
        axes.plot(recorded["time"][0], forward[:200].T, color="tab:blue", alpha=0.1)
        axes.plot(recorded["time"][0], forward[best], color="tab:red", label=f"gait {best}")
        axes.set(xlabel="time, s", ylabel="distance forward, m", title="Random gaits of a quadruped")
        axes.legend()

    plots.finish(options, draw)


if __name__ == "__main__":
    main()
