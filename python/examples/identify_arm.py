"""System identification: a load, dampings and dry frictions of an arm from noisy measurements of its joints.

The measurements come from a simulation with other parameters. `clench.identify` finds these, with their standard
deviations. Needs SciPy::

    pip install scipy
    python python/examples/identify_arm.py
    python python/examples/identify_arm.py --plot identify_arm.png
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import plots
from numpy.typing import NDArray

import clench

if TYPE_CHECKING:
    from matplotlib.axes import Axes

JOINTS = 6
NOISE = {"qpos": 1e-3, "qvel": 1e-2}  # rad, rad/s


def record(model: clench.Model, true: dict[str, NDArray[np.float64]], seed: int) -> dict[str, Any]:
    """Return controls, and noisy measurements of the joints under the true parameters."""
    rng = np.random.default_rng(seed)
    times = model.timestep * np.arange(300)[:, np.newaxis]
    # The arm moves above the box, which is not measured.
    frequency, phase = rng.uniform(0.5, 2.0, JOINTS), rng.uniform(0, 2 * np.pi, JOINTS)
    ctrl = [0, -0.5, -0.6, 0, 0.6, 0] + 0.4 * np.sin(2 * np.pi * frequency * times + phase)
    batch = clench.Batch(model, 1)
    for name, values in true.items():
        batch.randomize(name, values[np.newaxis])
    rows = {name: row[0] for name, row in batch.rollout(ctrl=ctrl, record=["qpos", "qvel"]).items()}
    for name, row in rows.items():
        row += NOISE[name] * rng.normal(size=row.shape)
        row[:, JOINTS:] = np.nan
    return {"ctrl": ctrl, **rows}


def main() -> None:
    """Run the example."""
    options = plots.parser(__doc__).parse_args()
    model = clench.Model.from_file(plots.MODELS / "arm_and_box.xml")
    hand = model.body("hand").id
    rng = np.random.default_rng(1)
    true = {name: np.array(getattr(model, name)) for name in ("body_mass", "dof_damping", "dof_frictionloss")}
    true["body_mass"][hand] += 0.5
    true["dof_damping"][:JOINTS] *= rng.uniform(0.5, 2.0, JOINTS)
    true["dof_frictionloss"][:JOINTS] *= rng.uniform(0.5, 3.0, JOINTS)
    recordings = [record(model, true, seed) for seed in range(1 if options.quick else 2)]

    joints = list(range(JOINTS))
    numbers = {"body_mass": [hand], "dof_damping": joints, "dof_frictionloss": joints}
    found = clench.identify(model, recordings, numbers, scale=NOISE)
    names = [f"{name}[{index}]" for name, indices in numbers.items() for index in indices]
    actual = np.concatenate([true[name][indices] for name, indices in numbers.items()])
    deviation = np.sqrt(np.diag(found.covariance))
    for name, estimate, sigma, value in zip(names, found.estimates, deviation, actual):
        print(f"{name:20} {estimate:.4f} ± {sigma:.4f}, true {value:.4f}")
    print(f"{found.result.nfev} evaluations; the residual is {found.residual:.3f} times the noise")

    def draw(axes: Axes) -> None:
        axes.errorbar(np.arange(len(names)), found.estimates - actual, 2 * deviation, fmt="o")
        axes.axhline(0.0, color="black", linewidth=0.5)
        axes.set_xticks(np.arange(len(names)), names, rotation=90)
        axes.set(ylabel="error, ± 2 σ", title="Parameters of an arm, identified")

    plots.finish(options, draw)


if __name__ == "__main__":
    main()
