"""A quadruped learns to walk in about two minutes, on two processor cores.

:class:`Walk` is the task, for all environments at once; ``ppo.py`` is the learner. The same seed gives the same curve.
Needs PyTorch (``pip install torch``)::

    python python/examples/walk.py --save walk.pt --record walk.html --plot walk.png
    python python/examples/walk.py --load walk.pt --evaluate
    python python/examples/walk.py --mujoco --save mujoco.pt --plot both.png --beside walk.pt
"""

from __future__ import annotations

import argparse
import time
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import plots
import torch
from gymnasium.spaces import Box
from numpy.typing import NDArray
from ppo import Learner, Policy, Rollout

import clench
from clench.gymnasium import BatchEnv

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[Any]
Curve = list[tuple[float, int, float]]  # seconds, samples, reward a second

FEET = ("front_left_foot", "front_right_foot", "rear_left_foot", "rear_right_foot")


def quadruped() -> clench.Model:
    """Return the model with twice its time step, which is accurate enough for this task."""
    spec = clench.ModelSpec.from_file(plots.MODELS / "quadruped.xml")
    spec.section("option")["timestep"] = 0.004
    return spec.build()


class Motion(NamedTuple):
    """The motion of the trunks, seen from the trunks."""

    gravity: Array  # (n, 3), the direction down
    velocity: Array  # (n, 3), m/s
    spin: Array  # (n, 3), rad/s
    heading: Array  # (n,), rad, from the world's x


class Walk(BatchEnv):
    """Walk along the world's x at the commanded speed, at a trot.

    Actions move the set points of the position servos from the stance.
    """

    frame_skip = 5
    max_episode_steps = 500
    precision = "32"
    outputs = ("geom_xpos",)
    autoreset_mode = "SameStep"
    single_action_space = Box(-10.0, 10.0, (12,))

    speeds = (0.3, 1.0)  # m/s, the range of commands
    reach = 0.3  # rad, by which an action of 1 moves a set point
    stride = 2.0  # Hz
    lift = 0.06  # m, of a swinging foot

    def __init__(self, num_envs: int, **kwargs: Any) -> None:
        super().__init__(num_envs, model=quadruped(), **kwargs)
        model = self.batch.model
        self.feet = [model.geom(foot).id for foot in FEET]
        self.radius = float(model.geom(FEET[0]).size[0])
        self.speed = np.zeros(num_envs)
        self.action, self.previous = np.zeros((num_envs, 12)), np.zeros((num_envs, 12))

    @property
    def sizes(self) -> tuple[int, int]:
        """The numbers of observations and of actions."""
        return self.observe().shape[1], self.batch.model.nu

    def motion(self) -> Motion:
        """Return the motion of all trunks."""
        w, x, y, z = self.batch.qpos[:, 3:7].T.astype(np.float64)
        # The rows of the rotation matrix are the world's axes, seen from the trunk.
        forward = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], axis=1)
        left = np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], axis=1)
        up = np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1)
        vx, vy, vz = self.batch.qvel[:, :3].T[:, :, np.newaxis]
        heading = np.arctan2(left[:, 0], forward[:, 0])
        return Motion(-up, vx * forward + vy * left + vz * up, self.batch.qvel[:, 3:6], heading)

    def turn(self, heading: Array) -> Array:
        """Return the commanded turning speeds (n,), rad/s: back to the world's x axis."""
        return np.asarray(np.clip(-heading - 0.5 * self.batch.qpos[:, 1], -0.5, 0.5))

    def clock(self) -> Array:
        """Return the sines and cosines (n, 2) of the trot's phase: one diagonal pair of feet swings, then the other."""
        phase = 2 * np.pi * self.stride * self.dt * self.elapsed
        return np.stack([np.sin(phase), np.cos(phase)], axis=1)

    def control(self, action: Array) -> Array:
        self.previous, self.action = self.action, action.copy()
        return self.reach * action

    def observe(self) -> Array:
        motion = self.motion()
        command = np.stack([self.speed, self.turn(motion.heading)], axis=1)
        joints = self.batch.qpos[:, 7:], 0.1 * self.batch.qvel[:, 6:]
        parts = motion.gravity, motion.velocity, motion.spin, *joints, self.action, command, self.clock()
        return np.concatenate(parts, axis=1, dtype=np.float32)

    def reward(self, action: Array) -> Array:
        motion = self.motion()
        off_course = np.square(motion.velocity[:, 0] - self.speed) + np.square(motion.velocity[:, 1])
        off_turn = np.square(motion.spin[:, 2] - self.turn(motion.heading))
        swing = self.lift * np.maximum(0.0, self.clock()[:, :1] * [-1, 1, 1, -1])
        off_step = self.batch.geom_xpos[:, self.feet, 2] - self.radius - swing
        per_second: Array = (
            1.5 * np.exp(-6 * off_course)
            + 0.75 * np.exp(-4 * off_turn)
            + 0.75 * np.exp(-np.square(off_step / 0.02)).mean(axis=1)
            - 1.0 * np.square(motion.velocity[:, 2])
            - 0.05 * np.square(motion.spin[:, :2]).sum(axis=1)
            - 2.0 * np.square(motion.gravity[:, :2]).sum(axis=1)
            - 0.02 * np.square(action - self.previous).sum(axis=1)
            - 0.3 * np.square(self.batch.qpos[:, 7::3]).sum(axis=1)  # Legs stay below the trunk.
            - 0.0005 * np.square(self.batch.qvel[:, 6:]).sum(axis=1)
        )
        return self.dt * per_second - self.terminated()

    def terminated(self) -> Array:
        low = self.batch.qpos[:, 2] < 0.2
        return np.asarray(low | (self.motion().gravity[:, 2] > -0.6))

    def initial_states(self, envs: NDArray[np.intp]) -> tuple[Array, Array]:
        qpos, qvel = np.tile(self.init_qpos, (len(envs), 1)), np.tile(self.init_qvel, (len(envs), 1))
        for row, env in enumerate(envs.tolist()):
            rng = self.generator(env)
            half = rng.uniform(-0.2, 0.2)
            qpos[row, 3:7] = np.cos(half), 0, 0, np.sin(half)
            qpos[row, 7:] += rng.uniform(-0.1, 0.1, 12)
            qvel[row] = rng.uniform(-0.2, 0.2, 18)
            self.speed[env] = rng.uniform(*self.speeds)
        return qpos, qvel

    def on_reset(self, mask: Array) -> None:
        self.action[mask] = 0.0


class Scalars:
    """The numbers of each iteration for TensorBoard, if a directory was given."""

    def __init__(self, directory: str | None) -> None:
        self.writer: Any = None
        if directory is not None:
            try:
                from torch.utils.tensorboard import SummaryWriter
            except ImportError as error:
                raise SystemExit("--tensorboard needs TensorBoard: pip install tensorboard") from error
            self.writer = SummaryWriter(directory)

    def add(self, step: int, **values: float) -> None:
        """Write numbers by name."""
        for name, value in values.items() if self.writer is not None else ():
            self.writer.add_scalar(name, value, step)


def train(envs: Walk, policy: Policy, iterations: int, seed: int, scalars: Scalars) -> Curve:
    """Train a policy and return its curve."""
    learner = Learner(policy)
    rollout, noise = Rollout(24, envs.num_envs, *envs.sizes), torch.Generator().manual_seed(seed)
    envs.reset(seed=seed)
    # Episodes that end at different times keep the samples of an iteration diverse.
    envs.elapsed[:] = np.random.default_rng(seed).integers(0, 500, envs.num_envs)
    observation = torch.from_numpy(envs.observation())
    policy.watch(observation)
    curve: Curve = []
    begin, processor, stepping = time.perf_counter(), time.process_time(), 0.0
    for k in range(iterations):
        before = time.perf_counter()
        observation = rollout.collect(envs, policy, observation, noise)
        stepping += time.perf_counter() - before
        learner.update(rollout)

        seconds, samples = time.perf_counter() - begin, (k + 1) * rollout.reward.numel()
        reward = float(rollout.reward.mean()) / envs.dt
        off = float(np.abs(envs.motion().velocity[:, 0] - envs.speed).mean())
        curve.append((seconds, samples, reward))
        line = f"iteration {k + 1:3}: reward {reward:6.2f} a second, speed off by {off:.2f} m/s   {seconds:5.1f} s"
        print(line, flush=True)
        scalars.add(samples, reward=reward, speed_error=off, kl=learner.kl, learning_rate=learner.rate)
    processor = time.process_time() - processor
    print(f"{samples:,} steps of environments in {seconds:.1f} s, of which {stepping:.1f} s to act and step;", end=" ")
    print(f"{processor:.1f} s of processor time")
    return curve


class Gait(NamedTuple):
    """The results of an evaluation."""

    upright: float  # the share of episodes without a fall
    speed: float  # m/s
    drift: float  # m, sideways at the end, the mean of absolute values
    tilt: float  # degrees, the mean over time

    def walks(self, speed: float) -> bool:
        """Return true if the robot walks stably at about this speed."""
        return self.upright == 1.0 and abs(self.speed - speed) < 0.1 and self.drift < 0.3 and self.tilt < 8.0


@torch.no_grad()  # type: ignore[untyped-decorator]
def evaluate(envs: Walk, policy: Policy, speed: float, record: str | None = None) -> Gait:
    """Walk for ten seconds at one speed in all environments, without noise, and record the first of them."""
    envs.speeds = speed, speed
    observation, _ = envs.reset(seed=1000)
    recording = clench.Recording()
    start, upright = envs.batch.qpos[:, 0].copy(), np.ones(envs.num_envs, dtype=np.bool_)
    tilt, steps = 0.0, round(10 / envs.dt)
    for _ in range(steps):
        if record is not None:
            recording.append(envs.batch)
        action, _ = policy(torch.from_numpy(observation))
        observation, _, terminated, _, _ = envs.step(action.numpy())
        upright &= ~terminated
        tilt += float(np.degrees(np.arccos(np.clip(-envs.motion().gravity[:, 2], -1, 1))).mean()) / steps
    if record is not None:
        recording.save(record)
        print(f"recording in {record}: open it in a browser")
    forward, sideways = envs.batch.qpos[upright, 0] - start[upright], envs.batch.qpos[upright, 1]
    if not upright.any():
        return Gait(0.0, 0.0, 0.0, tilt)
    return Gait(float(upright.mean()), float(forward.mean()) / 10, float(np.abs(sideways).mean()), tilt)


def arguments() -> argparse.Namespace:
    """Return the options of the command line."""
    parser = plots.parser(__doc__)
    parser.add_argument("--envs", type=int, help="number of environments (default: 512)")
    parser.add_argument("--iterations", type=int, help="number of iterations (default: 250)")
    parser.add_argument("--seed", type=int, default=0, help="seed of the random numbers")
    parser.add_argument("--speed", type=float, default=0.7, help="speed of the evaluation, m/s (default: 0.7)")
    parser.add_argument("--save", metavar="FILE", help="write the policy to FILE (.pt)")
    parser.add_argument("--load", metavar="FILE", help="start with the policy in FILE")
    parser.add_argument("--evaluate", action="store_true", help="do not train; fail if the policy does not walk stably")
    parser.add_argument("--record", metavar="FILE", help="write ten seconds to FILE, a page for the browser (.html)")
    parser.add_argument("--tensorboard", metavar="DIR", help="write the numbers of each iteration to DIR")
    parser.add_argument("--mujoco", action="store_true", help="step with MuJoCo instead: pip install mujoco")
    parser.add_argument("--beside", metavar="FILE", help="also plot the curve that --save wrote to FILE")
    options = parser.parse_args()
    if options.record is not None and options.mujoco:
        parser.error("--record needs the simulation in Clench: save the policy, and load it without --mujoco")
    return options


def main() -> None:
    """Run the example."""
    options = arguments()
    # Networks this small gain little from more threads; with one, the number of cores does not change the curve.
    torch.set_num_threads(1)
    torch.manual_seed(options.seed)
    task: type[Walk] = Walk
    if options.mujoco:
        from walk_mujoco import MujocoWalk as task

    n, iterations = (64, 4) if options.quick else (512, 250)
    envs = task(options.envs or n)
    policy = Policy(*envs.sizes)
    saved: dict[str, Any] = {"engine": "MuJoCo" if options.mujoco else "Clench", "curve": []}
    if options.load is not None:
        saved = torch.load(options.load)
        policy.load_state_dict(saved["policy"])
    if not options.evaluate:
        scalars = Scalars(options.tensorboard)
        saved["curve"] = train(envs, policy, options.iterations or iterations, options.seed, scalars)
    if options.save is not None:
        torch.save({**saved, "policy": policy.state_dict()}, options.save)

    gait = evaluate(task(20, max_episode_steps=-1), policy, options.speed, options.record)
    print(f"20 episodes of 10 s at {options.speed} m/s: {gait.upright:.0%} without a fall, ", end="")
    print(f"{gait.speed:.2f} m/s forward, {gait.drift:.2f} m sideways at the end, {gait.tilt:.1f} degrees of tilt")
    if options.evaluate and not gait.walks(options.speed):
        raise SystemExit("the policy does not walk stably")
    curves = [saved] if options.beside is None else [saved, torch.load(options.beside)]

    def draw(axes: Axes) -> None:
        for curve in curves:
            points = curve["curve"]
            axes.plot([point[0] for point in points], [point[2] for point in points], label=curve["engine"])
        axes.set(xlabel="time of training, s", ylabel="reward per second", title="A quadruped learns to walk")
        axes.legend()

    plots.finish(options, draw)


if __name__ == "__main__":
    main()
