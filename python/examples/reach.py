"""An arm learns to reach for a ball from depth pictures of 64 x 64 pixels, in six minutes of one processor core.

The policy sees nothing else. Rays on the processor make the pictures, so that no graphics device is needed. ``ppo.py``
is the learner, here with a convolutional network. Needs PyTorch (``pip install torch``)::

    python python/examples/reach.py --plot reach.png
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np
import plots
import torch
from gymnasium.spaces import Box
from numpy.typing import NDArray
from ppo import Learner, Policy, Rollout, network
from torch import Tensor, nn

import clench
from clench.gymnasium import BatchEnv

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[Any]

ARM = """
<mujoco model="reach">
  <option timestep="0.01" gravity="0 0 0" integrator="implicitfast"/>
  <default>
    <geom contype="0" conaffinity="0"/>
    <joint damping="0.2" armature="0.01"/>
    <position kp="4" ctrlrange="-10 10"/>
  </default>
  <worldbody>
    <camera name="above" pos="0 0 0.9" fovy="45"/>
    <geom name="table" type="plane" size="1 1 1"/>
    <body pos="0 0 0.08">
      <joint name="shoulder" axis="0 0 1"/>
      <geom type="capsule" fromto="0 0 0 0.16 0 0" size="0.015"/>
      <body pos="0.16 0 0">
        <joint name="elbow" axis="0 0 1" range="-150 150"/>
        <geom type="capsule" fromto="0 0 0 0.14 0 0" size="0.015"/>
        <body name="tip" pos="0.16 0 0"><geom size="0.025" pos="0 0 0.02" mass="0.02"/></body>
      </body>
    </body>
    <body name="ball" pos="0 0 0.02">
      <joint name="ball_x" type="slide" axis="1 0 0"/>
      <joint name="ball_y" type="slide" axis="0 1 0"/>
      <geom size="0.035"/>
    </body>
  </worldbody>
  <actuator><position joint="shoulder"/><position joint="elbow"/></actuator>
</mujoco>
"""


class Reach(BatchEnv):
    """Bring the tip of the arm above the ball; actions move both set points, from the joints' angles."""

    frame_skip = 5
    max_episode_steps = 40
    precision = "32"
    outputs = ("xpos",)
    autoreset_mode = "SameStep"
    single_action_space = Box(-10.0, 10.0, (2,))
    pixels = 64

    def __init__(self, num_envs: int, **kwargs: Any) -> None:
        super().__init__(num_envs, model=clench.Model.from_xml(ARM), **kwargs)
        self.tip, self.ball = (self.batch.model.body(name).id for name in ("tip", "ball"))

    def off(self) -> Array:
        """Return the horizontal distances (n,) of tips and balls, m."""
        apart = self.batch.xpos[:, self.tip, :2] - self.batch.xpos[:, self.ball, :2]
        return np.asarray(np.linalg.norm(apart, axis=1))

    def control(self, action: Array) -> Array:
        return np.asarray(self.batch.qpos[:, :2] + 0.4 * np.clip(action, -1, 1))

    def observe(self) -> Array:
        side = self.pixels
        depth = self.batch.render(None, side, side, camera="above", kind="depth", device="cpu")
        # The heights of what is seen, over that of the tip.
        return ((0.9 - depth) / 0.125).reshape(self.num_envs, -1)

    def reward(self, action: Array) -> Array:
        off = self.off()
        return np.asarray(0.1 * np.exp(-np.square(off / 0.03)) - 0.3 * off - 0.002 * np.square(action).sum(axis=1))

    def initial_states(self, envs: NDArray[np.intp]) -> tuple[Array, Array]:
        qpos = np.zeros((len(envs), 4))
        for row, env in enumerate(envs.tolist()):
            rng = self.generator(env)
            far, towards = rng.uniform(0.15, 0.3), rng.uniform(-1.5, 1.5)
            qpos[row] = rng.uniform(-1.5, 1.5), rng.uniform(-2, 2), far * np.cos(towards), far * np.sin(towards)
        return qpos, np.zeros((len(envs), 4))


class Eyes(Policy):
    """A policy whose networks share what a convolutional network sees."""

    def __init__(self, pixels: int, actions: int, seen: int = 128) -> None:
        super().__init__(1, actions)
        self.pixels = pixels
        self.eyes = nn.Sequential(
            *(nn.Conv2d(1, 16, 8, 4), nn.ELU(), nn.Conv2d(16, 32, 4, 2), nn.ELU(), nn.Flatten()),
            *(nn.LazyLinear(seen), nn.ELU()),
        )
        self.actor, self.critic = network(seen, 64, actions, gain=0.01), network(seen, 64, 1, gain=1.0)
        self.eyes(torch.zeros(1, 1, pixels, pixels))

    def forward(self, observation: Tensor) -> tuple[Tensor, Tensor]:
        """Return the mean actions (n, actions) and the values (n,)."""
        seen = self.eyes(observation.view(-1, 1, self.pixels, self.pixels))
        return self.actor(seen), self.critic(seen).squeeze(-1)

    def watch(self, observation: Tensor) -> None:
        """Do nothing: pictures need no normalization."""


def train(envs: Reach, policy: Eyes, iterations: int) -> list[tuple[float, float]]:
    """Train a policy and return its curve: seconds, and the mean distance, m."""
    learner = Learner(policy)
    learner.epochs = 4
    rollout = Rollout(20, envs.num_envs, envs.pixels**2, 2)
    noise = torch.Generator().manual_seed(0)
    observation = torch.from_numpy(envs.reset(seed=0)[0])
    envs.elapsed[:] = np.random.default_rng(0).integers(0, envs.max_episode_steps, envs.num_envs)
    curve, begin = [], time.perf_counter()
    for k in range(iterations):
        observation = rollout.collect(envs, policy, observation, noise)
        learner.update(rollout)
        curve.append((time.perf_counter() - begin, float(envs.off().mean())))
        line = f"iteration {k + 1:3}: reward {float(rollout.reward.mean()) / envs.dt:6.2f} a second,"
        print(f"{line} {100 * curve[-1][1]:4.1f} cm off   {curve[-1][0]:5.1f} s", flush=True)
    return curve


@torch.no_grad()  # type: ignore[untyped-decorator]
def evaluate(envs: Reach, policy: Eyes) -> tuple[float, float]:
    """Return the share of episodes that end within 3 cm, and their mean distance at the end, m, without noise."""
    observation, _ = envs.reset(seed=1000)
    for _ in range(40):
        action, _ = policy(torch.from_numpy(observation))
        observation, *_ = envs.step(action.numpy())
    return float((envs.off() < 0.03).mean()), float(envs.off().mean())


def main() -> None:
    """Run the example."""
    parser = plots.parser(__doc__)
    parser.add_argument("--envs", type=int, help="number of environments (default: 128)")
    parser.add_argument("--iterations", type=int, help="number of iterations (default: 250)")
    options = parser.parse_args()
    torch.set_num_threads(1)
    torch.manual_seed(0)
    n, iterations = (32, 3) if options.quick else (128, 250)
    policy = Eyes(Reach.pixels, 2)
    curve = train(Reach(options.envs or n), policy, options.iterations or iterations)
    near, off = evaluate(Reach(256, max_episode_steps=-1), policy)
    print(f"256 episodes: {near:.0%} end within 3 cm of the ball, {100 * off:.1f} cm off in the mean")

    def draw(axes: Axes) -> None:
        axes.plot(*np.transpose(curve))
        axes.set(xlabel="time of training, s", ylabel="distance, m", title="An arm learns to reach from pictures")

    plots.finish(options, draw)


if __name__ == "__main__":
    main()
