"""Feed a learner: the batch steps in a thread while the learner improves the policy on a GPU.

There are two rollouts in pinned memory. While one is filled by the policy of the iteration before, the learner copies
the other to the GPU and learns from it. Stepping releases Python's lock, so neither waits for the other. Without a GPU
the learner runs on the processor, and both share its cores. Needs PyTorch (``pip install torch``)::

    python python/examples/feed_learner.py
    python python/examples/feed_learner.py --plot feed_learner.png
"""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor
from copy import deepcopy
from typing import TYPE_CHECKING, Any

import plots
import torch
from ppo import Learner, Policy, Rollout
from walk import Walk

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Spans = dict[str, list[tuple[float, float]]]


class Trainer:
    """A batch that steps, a learner on a device, and two rollouts between them."""

    def __init__(self, n: int, device: str, seed: int = 0) -> None:
        torch.manual_seed(seed)
        self.envs, self.device = Walk(n), device
        self.policy = Policy(*self.envs.sizes, 256).to(device)
        self.learner = Learner(self.policy)
        self.rollouts = [Rollout(24, n, *self.envs.sizes, device != "cpu") for _ in range(2)]
        # Threads that share no generator of random numbers give the same curve for the same seed.
        self.noise = torch.Generator().manual_seed(seed)
        self.observation = torch.from_numpy(self.envs.reset(seed=seed)[0])
        self.policy.watch(self.observation.to(device))
        # The copy that acts stays on the processor: a transfer at every step would take longer than its small networks.
        self.actor = deepcopy(self.policy).to("cpu")
        self.spans: Spans = {"stepping": [], "learning": []}
        self.curve: list[float] = []

    def fill(self, rollout: Rollout) -> None:
        """Step all environments, and measure the time."""
        begin = time.perf_counter()
        self.observation = rollout.collect(self.envs, self.actor, self.observation, self.noise)
        self.spans["stepping"].append((begin, time.perf_counter() - begin))

    def learn(self, rollout: Rollout) -> None:
        """Improve the policy, and measure the time."""
        begin = time.perf_counter()
        self.learner.update(rollout.to(self.device))
        self.spans["learning"].append((begin, time.perf_counter() - begin))
        self.curve.append(float(rollout.reward.mean()) / self.envs.dt)

    def alternate(self, iterations: int) -> None:
        """Step, then learn, and so on: each waits for the other."""
        for _ in range(iterations):
            self.actor.load_state_dict(self.policy.state_dict())
            self.fill(self.rollouts[0])
            self.learn(self.rollouts[0])

    def overlap(self, iterations: int) -> None:
        """Learn from one rollout while the next is filled."""
        # Two changes of the policy lie between its rollout and the end of an update, so its KL divergence is larger.
        self.learner.target_kl *= 2
        with ThreadPoolExecutor(1) as pool:
            filling = pool.submit(self.fill, self.rollouts[0])
            for k in range(iterations):
                filling.result()
                # The policy that acts is one iteration old; the objective corrects by the stored probabilities.
                self.actor.load_state_dict(self.policy.state_dict())
                if k + 1 < iterations:
                    filling = pool.submit(self.fill, self.rollouts[(k + 1) % 2])
                self.learn(self.rollouts[k % 2])


def main() -> None:
    """Run the example."""
    parser = plots.parser(__doc__)
    parser.add_argument("--iterations", type=int, help="number of iterations (default: 20)")
    options = parser.parse_args()
    device = "cuda" if torch.cuda.is_available() else "cpu"
    print("the learner is on the GPU" if device == "cuda" else "no GPU for PyTorch: the learner is on the processor")
    torch.set_num_threads(1)

    n, iterations = (64, 3) if options.quick else (512, 20)
    iterations = options.iterations or iterations
    spans: dict[str, Spans] = {}
    for name in ("alternate", "overlap"):
        trainer = Trainer(n, device)
        begin = time.perf_counter()
        getattr(trainer, name)(iterations)
        seconds = time.perf_counter() - begin
        spans[name] = {what: [(start - begin, length) for start, length in of] for what, of in trainer.spans.items()}
        sums = ", ".join(f"{what} {sum(length for _, length in of):.2f} s" for what, of in trainer.spans.items())
        print(f"{name}: {iterations} iterations in {seconds:.2f} s ({sums}); reward {trainer.curve[-1]:.2f} a second")

    def draw(axes: Axes) -> None:
        draw_spans(axes, spans)

    plots.finish(options, draw)


def draw_spans(axes: Any, spans: dict[str, Spans]) -> None:
    """Draw who worked when."""
    rows = [(f"{name}: {what}", of) for name, each in spans.items() for what, of in each.items()]
    for row, (_, of) in enumerate(rows):
        axes.broken_barh(of, (row - 0.4, 0.8), color=("tab:blue", "tab:orange")[row % 2], edgecolor="white")
    axes.set_yticks(range(len(rows)), [label for label, _ in rows])
    axes.invert_yaxis()
    axes.set(xlabel="time, s", title="Stepping and learning, in turn and at once")


if __name__ == "__main__":
    main()
