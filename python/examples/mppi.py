"""Model predictive path integral control: a pole on a cart is swung up by sampling.

At every step a batch starts from the state of the simulation and tries controls around the last plan. Their mean,
weighted by cost, is the next plan::

    python python/examples/mppi.py
    python python/examples/mppi.py --plot mppi.png
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import plots
from numpy.typing import NDArray

import clench

if TYPE_CHECKING:
    from matplotlib.axes import Axes

CART = """
<mujoco model="cart">
  <option timestep="0.01" integrator="implicitfast"/>
  <worldbody>
    <body name="cart" pos="0 0 1">
      <joint name="slide" type="slide" axis="1 0 0" range="-2 2" damping="0.5"/>
      <geom type="box" size="0.1 0.05 0.04" mass="1"/>
      <body name="pole">
        <joint name="hinge" axis="0 1 0" damping="0.01"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.6" size="0.02" mass="0.2" contype="0" conaffinity="0"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor name="push" joint="slide" gear="20" ctrlrange="-1 1"/></actuator>
</mujoco>
"""


def cost(rows: dict[str, NDArray[Any]]) -> NDArray[Any]:
    """Return the cost of each sample (n), which is low for an upright pole and a centred cart, both at rest."""
    (x, angle), velocity = np.moveaxis(rows["qpos"], 2, 0), rows["qvel"]
    total: NDArray[Any] = (4 * (1 + np.cos(angle)) + 0.5 * x**2 + 0.02 * (velocity**2).sum(axis=2)).sum(axis=1)
    return total


def main() -> None:
    """Run the example."""
    options = plots.parser(__doc__).parse_args()
    samples, horizon, noise, temperature = 256, 60, 0.4, 5.0
    steps = 150 if options.quick else 500

    model = clench.Model.from_xml(CART)
    sim, batch = clench.Sim(model), clench.Batch(model, samples, precision="32")
    rng, plan = np.random.default_rng(0), np.zeros((horizon, model.nu))
    angles = np.empty(steps)
    for k in range(steps):
        tried = np.clip(plan + noise * rng.normal(size=(samples, horizon, model.nu)), -1, 1)
        costs = cost(batch.rollout(sim.state, tried))
        weights = np.exp((costs.min() - costs) / temperature)
        plan = np.einsum("n,nhu->hu", weights / weights.sum(), tried)
        sim.ctrl = plan[0]
        plan = np.vstack([plan[1:], plan[-1:]])
        sim.step()
        angles[k] = sim.qpos[1]
    print(f"after {sim.time:.1f} s the pole is {np.degrees(np.arccos(-np.cos(angles[-1]))):.1f} degrees from upright")

    def draw(axes: Axes) -> None:
        axes.plot(np.arange(1, steps + 1) * float(model.timestep), -np.cos(angles))
        axes.set(xlabel="time, s", ylabel="height of the pole's end over its length", title="A pole is swung up")

    plots.finish(options, draw)


if __name__ == "__main__":
    main()
