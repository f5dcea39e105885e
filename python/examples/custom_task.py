"""Custom task: a model of your own as a vector environment of gymnasium.

:class:`Balance` is the whole task: observations, rewards and terminations of all environments at once. Two controllers
then try to hold the pole up::

    python python/examples/custom_task.py
    python python/examples/custom_task.py --plot custom_task.png
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import plots
from numpy.typing import NDArray

from clench.gymnasium import BatchEnv

if TYPE_CHECKING:
    from matplotlib.axes import Axes

CART_POLE = """
<mujoco model="cart pole">
  <option timestep="0.01"/>
  <worldbody>
    <body name="cart">
      <joint name="slider" type="slide" axis="1 0 0" limited="true" range="-2 2" damping="0.1"/>
      <geom type="box" size="0.15 0.1 0.08" mass="1" contype="0" conaffinity="0"/>
      <body name="pole">
        <joint name="hinge" type="hinge" axis="0 1 0"/>
        <geom type="capsule" fromto="0 0 0 0 0 0.8" size="0.03" mass="0.2" contype="0" conaffinity="0"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor joint="slider" gear="10" ctrllimited="true" ctrlrange="-1 1"/>
  </actuator>
</mujoco>
"""

Array = NDArray[Any]


class Balance(BatchEnv):
    """Hold the pole upright."""

    model = CART_POLE
    frame_skip = 2
    max_episode_steps = 500

    def observe(self) -> Array:
        return np.concatenate([self.batch.qpos, self.batch.qvel], axis=1)

    def reward(self, action: Array) -> Array:
        return 1.0 - self.batch.qpos[:, 1] ** 2 - 0.01 * action[:, 0] ** 2

    def terminated(self) -> Array:
        return abs(self.batch.qpos[:, 1]) > 0.5

    def initial_state(self, rng: np.random.Generator) -> tuple[Array, Array]:
        return self.init_qpos + rng.normal(0.0, 0.05, 2), self.init_qvel


def main() -> None:
    """Run the example."""
    options = plots.parser(__doc__).parse_args()
    envs = Balance(num_envs=32 if options.quick else 256)
    steps = 200 if options.quick else 500
    print(f"{envs.num_envs} environments; observations {envs.observation_space.shape}, actions {envs.action_space.shape}")

    def at_random(observation: Array) -> Array:
        return np.asarray(envs.action_space.sample())

    def feedback(observation: Array) -> Array:
        return np.asarray(observation @ [[0.3], [4.0], [0.5], [0.8]])

    angles = {"at random": run(envs, at_random, steps), "linear feedback": run(envs, feedback, steps)}

    def draw(axes: Axes) -> None:
        for color, (name, angle) in zip(("tab:red", "tab:blue"), angles.items()):
            axes.plot(envs.dt * np.arange(steps), angle[:, :20], color=color, alpha=0.4)
            axes.plot([], [], color=color, label=name)
        axes.set(xlabel="time, s", ylabel="angle of the pole, rad", title="A pole on a cart, 20 environments")
        axes.legend()

    plots.finish(options, draw)


def run(envs: Balance, controller: Callable[[Array], Array], steps: int) -> Array:
    """Return the pole's angles (steps, n) under a controller, and print the number of falls."""
    envs.action_space.seed(0)
    observation, _ = envs.reset(seed=0)
    angles, falls, rewards = np.empty((steps, envs.num_envs)), 0, np.zeros(envs.num_envs)
    for k in range(steps):
        observation, reward, terminated, _, _ = envs.step(controller(observation))
        angles[k], falls, rewards = observation[:, 1], falls + int(terminated.sum()), rewards + reward
    print(f"{controller.__name__.replace('_', ' ')}: {falls} falls in {steps} steps, {rewards.mean() / steps:.2f} reward a step")
    return angles


if __name__ == "__main__":
    main()
