"""Proximal policy optimization (Schulman et al., 2017) in plain PyTorch, for the examples that learn.

A :class:`Policy` acts, a :class:`Rollout` stores what happened, and a :class:`Learner` improves the policy from it. As
in RSL-RL, the learning rate follows the KL divergence between the policies before and after each change.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

DISCOUNT, TRACE = 0.99, 0.95


class Policy(nn.Module):  # type: ignore[misc]  # Types are checked without PyTorch.
    """A Gaussian policy and a value function, each a small network of normalized observations."""

    def __init__(self, observations: int, actions: int, hidden: int = 64) -> None:
        super().__init__()
        self.actor = network(observations, hidden, actions, gain=0.01)
        self.critic = network(observations, hidden, 1, gain=1.0)
        self.log_std = nn.Parameter(torch.full((actions,), math.log(0.5)))
        # The policy file must contain what normalizes observations, so these are buffers.
        self.register_buffer("count", torch.tensor(1e-4))
        self.register_buffer("mean", torch.zeros(observations))
        self.register_buffer("variance", torch.ones(observations))

    def forward(self, observation: Tensor) -> tuple[Tensor, Tensor]:
        """Return the mean actions (n, actions) and the values (n,)."""
        normal = ((observation - self.mean) / torch.sqrt(self.variance + 1e-4)).clamp(-10, 10)
        return self.actor(normal), self.critic(normal).squeeze(-1)

    def log_prob(self, mean: Tensor, action: Tensor) -> Tensor:
        """Return the logarithms of the probability densities of actions (n, actions) about their means."""
        apart = (action - mean) * torch.exp(-self.log_std)
        return -(0.5 * apart.square() + self.log_std + 0.5 * math.log(2 * math.pi)).sum(-1)

    @torch.no_grad()  # type: ignore[untyped-decorator]
    def watch(self, observation: Tensor) -> None:
        """Add observations (n, observations) to the mean and variance of all so far."""
        count, mean = len(observation), observation.mean(0)
        total, apart = self.count + count, mean - self.mean
        squares = self.variance * self.count + observation.var(0, correction=0) * count
        self.variance.copy_((squares + apart.square() * self.count * count / total) / total)
        self.mean += apart * count / total
        self.count.copy_(total)


def network(inputs: int, hidden: int, outputs: int, gain: float) -> nn.Sequential:
    """Return a network of two hidden layers; a small ``gain`` makes its first outputs small."""
    layers = [nn.Linear(inputs, hidden), nn.ELU(), nn.Linear(hidden, hidden), nn.ELU(), nn.Linear(hidden, outputs)]
    for layer in layers[::2]:
        nn.init.orthogonal_(layer.weight, math.sqrt(2) if layer is not layers[-1] else gain)
        nn.init.zeros_(layer.bias)
    return nn.Sequential(*layers)


class Rollout:
    """Some steps of all environments: tensors (steps, n, ...), reused from iteration to iteration.

    Pinned memory can be copied to a GPU while the processor continues.
    """

    def __init__(self, steps: int, n: int, observations: int, actions: int, pinned: bool = False) -> None:
        def tensor(*size: int) -> Tensor:
            return torch.zeros(steps, n, *size, pin_memory=pinned)

        self.observation, self.action, self.mean = tensor(observations), tensor(actions), tensor(actions)
        self.log_prob, self.value, self.reward, self.rest, self.done = (tensor() for _ in range(5))
        self.last_value, self.log_std = torch.zeros(n, pin_memory=pinned), torch.zeros(actions, pin_memory=pinned)

    def to(self, device: str) -> Rollout:
        """Return a copy on a device; the processor does not wait for it."""
        copy = Rollout.__new__(Rollout)
        copy.__dict__ = {name: value.to(device, non_blocking=True) for name, value in self.__dict__.items()}
        return copy

    @torch.no_grad()  # type: ignore[untyped-decorator]
    def collect(self, envs: Any, policy: Policy, observation: Tensor, noise: Any) -> Tensor:
        """Fill the rollout from vector environments that reset in the same step; return the last observation.

        ``noise`` is the generator of random numbers.
        """
        self.log_std.copy_(policy.log_std)
        for k in range(len(self.reward)):
            mean, value = policy(observation)
            action = mean + torch.exp(policy.log_std) * torch.randn(mean.shape, generator=noise)
            self.observation[k], self.action[k], self.mean[k], self.value[k] = observation, action, mean, value
            self.log_prob[k] = policy.log_prob(mean, action)
            # Tensors and arrays share their memory here.
            rows, reward, terminated, truncated, _ = envs.step(action.numpy())
            self.reward[k] = torch.from_numpy(reward)
            # An episode that reached its time limit would have gone on: its value stands for the rest.
            self.rest[k] = DISCOUNT * value * torch.from_numpy(truncated & ~terminated)
            self.done[k] = torch.from_numpy(terminated | truncated)
            observation = torch.from_numpy(rows.astype(np.float32, copy=False))
        self.last_value.copy_(policy(observation)[1])
        return observation

    def advantages(self) -> Tensor:
        """Return the generalized advantage estimates (steps, n) (Schulman et al., 2016)."""
        advantage, later, value = torch.zeros_like(self.reward), torch.zeros_like(self.last_value), self.last_value
        for k in reversed(range(len(self.reward))):
            going = 1.0 - self.done[k]
            change = self.reward[k] + self.rest[k] + DISCOUNT * going * value - self.value[k]
            later = change + DISCOUNT * TRACE * going * later
            advantage[k], value = later, self.value[k]
        return advantage


class Learner:
    """Improves a policy from rollouts by the clipped objective."""

    epochs, parts, clip, entropy, target_kl = 5, 4, 0.2, 0.001, 0.02

    def __init__(self, policy: Policy) -> None:
        self.policy, self.rate, self.kl = policy, 1e-3, 0.0
        self.optimizer = torch.optim.Adam(policy.parameters(), lr=self.rate)

    def update(self, rollout: Rollout) -> None:
        """Improve the policy from one rollout."""
        advantage = rollout.advantages()
        returns = (advantage + rollout.value).flatten()
        advantage = ((advantage - advantage.mean()) / (advantage.std() + 1e-8)).flatten()
        stored = ("observation", "action", "mean", "log_prob", "value")
        rows = {name: getattr(rollout, name).flatten(0, 1) for name in stored}
        rows.update(advantage=advantage, returns=returns)
        for _ in range(self.epochs):
            for part in torch.randperm(len(returns), device=returns.device).chunk(self.parts):
                self._improve(rollout.log_std, **{name: value[part] for name, value in rows.items()})
        self.policy.watch(rows["observation"])

    def _improve(
        self,
        log_std: Tensor,
        observation: Tensor,
        action: Tensor,
        mean: Tensor,
        log_prob: Tensor,
        value: Tensor,
        advantage: Tensor,
        returns: Tensor,
    ) -> None:
        """Take one step of gradient descent on a part of the rollout."""
        new_mean, new_value = self.policy(observation)
        self._follow_kl(mean, log_std, new_mean.detach())
        ratio = torch.exp(self.policy.log_prob(new_mean, action) - log_prob)
        surrogate = torch.minimum(ratio * advantage, ratio.clamp(1 - self.clip, 1 + self.clip) * advantage).mean()
        clipped = value + (new_value - value).clamp(-self.clip, self.clip)
        value_loss = torch.maximum((new_value - returns).square(), (clipped - returns).square()).mean()
        loss = value_loss - surrogate - self.entropy * self.policy.log_std.sum()
        self.optimizer.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(self.policy.parameters(), 1.0)
        self.optimizer.step()

    def _follow_kl(self, mean: Tensor, log_std: Tensor, new_mean: Tensor) -> None:
        """Lower the learning rate where the policy has changed much since the rollout, raise it where little."""
        new_log_std = self.policy.log_std.detach()
        spread = (torch.exp(2 * log_std) + (mean - new_mean).square()) / (2 * torch.exp(2 * new_log_std))
        self.kl = float((new_log_std - log_std + spread - 0.5).sum(-1).mean())
        if self.kl > 2 * self.target_kl:
            self.rate = max(1e-5, self.rate / 1.5)
        elif self.kl < self.target_kl / 2:
            self.rate = min(1e-2, self.rate * 1.5)
        for group in self.optimizer.param_groups:
            group["lr"] = self.rate
