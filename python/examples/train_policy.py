"""Train a policy with NumPy alone: a half-cheetah learns to run.

Augmented random search (Mania, Guy and Recht, 2018): the policy is linear in normalized observations. Each generation
tries random changes of it and their opposites, a pair of environments per change, and moves towards the better ones::

    python python/examples/train_policy.py
    python python/examples/train_policy.py --plot train_policy.png --generations 200
    python python/examples/train_policy.py --task clench/Swimmer-v5
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
import plots
from numpy.typing import NDArray

import clench.gymnasium  # noqa: F401, which registers the tasks

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]


class Normalizer:
    """The mean and standard deviation of all observations so far."""

    def __init__(self, size: int) -> None:
        self.count, self.mean, self.squares = 1e-4, np.zeros(size), np.zeros(size)

    def add(self, rows: Array) -> None:
        """Add rows of observations."""
        count, mean = len(rows), rows.mean(axis=0)
        total, apart = self.count + count, mean - self.mean
        self.squares += np.square(rows - mean).sum(axis=0) + np.square(apart) * self.count * count / total
        self.mean = self.mean + apart * count / total
        self.count = total

    @property
    def spread(self) -> Array:
        """Return the standard deviations, none of them zero."""
        return np.sqrt(self.squares / self.count) + 1e-6


def returns_of(envs: gymnasium.vector.VectorEnv[Any, Any, Any], policies: Array, seen: Normalizer, steps: int) -> Array:
    """Return the returns of policies (n, actions, observations), one per environment, in up to ``steps`` steps."""
    space = envs.single_action_space
    assert isinstance(space, gymnasium.spaces.Box)
    mean, spread = seen.mean.copy(), seen.spread
    observation, _ = envs.reset()
    total, alive = np.zeros(envs.num_envs), np.ones(envs.num_envs, dtype=np.bool_)
    for _ in range(steps):
        seen.add(observation[alive])
        action = (policies @ ((observation - mean) / spread)[:, :, np.newaxis])[:, :, 0]
        observation, reward, terminated, truncated, _ = envs.step(np.clip(action, space.low, space.high))
        total += np.where(alive, reward, 0.0)
        alive &= ~(terminated | truncated)
        if not alive.any():
            break
    return total


def train(task: str, generations: int, steps: int, pairs: int, seed: int = 0) -> list[float]:
    """Return the mean return of the unchanged policy at the start of each generation."""
    step_size, noise, best, watchers = 0.1, 0.1, pairs // 2, 16
    envs = gymnasium.make_vec(task, num_envs=2 * pairs + watchers)
    envs.reset(seed=seed)
    rng = np.random.default_rng(seed)
    observations, actions = envs.single_observation_space.shape, envs.single_action_space.shape
    assert observations is not None and actions is not None
    policy, seen = np.zeros((actions[0], observations[0])), Normalizer(observations[0])

    curve = []
    for generation in range(generations):
        begin = time.perf_counter()
        # One environment per change, one for its opposite, and some for the unchanged policy.
        changes = rng.standard_normal((pairs, *policy.shape))
        tried = policy + noise * np.concatenate([changes, -changes, np.zeros((watchers, *policy.shape))])
        returns = returns_of(envs, tried, seen, steps)
        forward, backward = returns[:pairs], returns[pairs : 2 * pairs]

        chosen = np.argsort(-np.maximum(forward, backward))[:best]
        gain = (forward - backward)[chosen]
        scale = np.concatenate([forward[chosen], backward[chosen]]).std() + 1e-6
        policy += step_size / (best * scale) * np.tensordot(gain, changes[chosen], axes=1)

        curve.append(float(returns[2 * pairs :].mean()))
        print(f"generation {generation:3}: return {curve[-1]:8.1f}   {time.perf_counter() - begin:.2f} s", flush=True)
    envs.close()
    return curve


def main() -> None:
    """Run the example."""
    parser = plots.parser(__doc__)
    parser.add_argument("--task", default="clench/HalfCheetah-v5", help="any task with continuous actions")
    parser.add_argument("--generations", type=int, help="number of generations (default: 100)")
    parser.add_argument("--seed", type=int, default=0, help="seed of the random numbers")
    options = parser.parse_args()

    generations, steps, pairs = (20, 200, 32) if options.quick else (100, 1000, 64)
    curve = train(options.task, options.generations or generations, steps, pairs, options.seed)
    print(f"return at first {curve[0]:.1f}, at last {curve[-1]:.1f}")

    def draw(axes: Axes) -> None:
        axes.plot(curve)
        axes.set(xlabel="generation", ylabel="return of an episode", title=f"Random search learns {options.task}")

    plots.finish(options, draw)


if __name__ == "__main__":
    main()
