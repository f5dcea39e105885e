"""Registration of the tasks with gymnasium."""

from __future__ import annotations

import gymnasium

# Name, steps per episode, and gymnasium's reward threshold, the mean return at which the task counts as solved.
_TASKS: tuple[tuple[str, str, int, float | None], ...] = (
    ("Ant", "ant", 1000, 6000.0),
    ("HalfCheetah", "half_cheetah", 1000, 4800.0),
    ("Hopper", "hopper", 1000, 3800.0),
    ("Humanoid", "humanoid", 1000, None),
    ("HumanoidStandup", "humanoid_standup", 1000, None),
    ("InvertedDoublePendulum", "inverted_double_pendulum", 1000, 9100.0),
    ("InvertedPendulum", "inverted_pendulum", 1000, 950.0),
    ("Pusher", "pusher", 100, 0.0),
    ("Reacher", "reacher", 50, -3.75),
    ("Swimmer", "swimmer", 1000, 360.0),
    ("Walker2d", "walker2d", 1000, None),
)


def register_tasks() -> None:
    """Registers ``clench/Ant-v5`` and the others, each as single and as vector environment. Repeated calls have no
    effect."""
    for name, module, max_episode_steps, reward_threshold in _TASKS:
        if f"clench/{name}-v5" not in gymnasium.registry:
            gymnasium.register(
                id=f"clench/{name}-v5",
                entry_point=f"clench.gymnasium.tasks.{module}:{name}Env",
                vector_entry_point=f"clench.gymnasium.tasks.{module}:{name}VectorEnv",
                max_episode_steps=max_episode_steps,
                reward_threshold=reward_threshold,
            )
