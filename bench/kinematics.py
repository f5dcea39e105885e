"""Inverse kinematics beside mink: `python bench/kinematics.py` (needs mink and daqp; `cargo xtask test python` unpacks the models).

The goals are poses that each robot can take, from joints turned at random within their limits, one after the other from the same
start. Both engines get the same costs and the same tolerance, 1e-4 m and rad, and stop there or after 100 iterations. mink runs as its
examples do: a quadratic program by daqp an iteration, the configuration limit, a posture task, damping 1e-3, a full step a time.
"""

import argparse
import pathlib
import time

import clench
import mink
import mujoco
import numpy as np

MODELS = pathlib.Path(__file__).resolve().parent.parent / ".venv/models"
TOLERANCE, ITERATIONS, POSTURE = 1e-4, 100, 1e-3
# Restarts for goals that Clench did not reach; they have their own line in the table.
RESTARTS = 8

# Bodies with target poses, and True if the centre of mass has a target too.
ROBOTS = {
    "arm (Panda, 9 dofs)": ("genesis/assets/xml/franka_emika_panda/panda.xml", ["hand"], False),
    "humanoid (27 dofs)": ("dm_control/suite/humanoid.xml", ["left_foot", "right_foot", "left_hand", "right_hand"], True),
}


class Robot:
    """A model in both engines, and its goals."""

    def __init__(self, path, bodies, com, count, seed=3):
        self.own = clench.Model.from_file(path)
        self.model = mujoco.MjModel.from_xml_path(str(path))
        self.bodies, self.com, self.count = bodies, com, count
        rng = np.random.default_rng(seed)
        data = mujoco.MjData(self.model)
        self.start = data.qpos.copy()
        limited = self.model.jnt_limited.astype(bool)
        adr, (low, high) = self.model.jnt_qposadr[limited], self.model.jnt_range[limited].T
        # Like a home pose, the start is away from the limits.
        self.start[adr] = np.clip(self.start[adr], 0.95 * low + 0.05 * high, 0.05 * low + 0.95 * high)
        self.position, self.quat, self.centre = [], [], []
        for _ in range(count):
            data.qpos[:] = self.start
            data.qpos[adr] += 0.5 * (rng.uniform(low, high) - data.qpos[adr])
            mujoco.mj_kinematics(self.model, data)
            mujoco.mj_comPos(self.model, data)
            self.position.append([data.body(b).xpos.copy() for b in bodies])
            self.quat.append([data.body(b).xquat.copy() for b in bodies])
            self.centre.append(data.subtree_com[0].copy())
        self.position, self.quat = np.array(self.position), np.array(self.quat)
        self.centre = np.array(self.centre)

    def targets(self, k):
        """Returns the targets of goal `k`, or of several goals if `k` is a slice."""
        frames = [
            clench.FrameTarget(body=b, position=self.position[k, i], quat=self.quat[k, i]) for i, b in enumerate(self.bodies)
        ]
        com = [clench.ComTarget(self.centre[k])] if self.com else []
        return [*frames, *com, clench.PostureTarget(self.start, cost=POSTURE)]


def one_by_one(robot):
    sim = clench.Sim(robot.own)
    sim.qpos[:] = robot.start
    begin = time.perf_counter()
    found = [sim.ik(robot.targets(k), iterations=ITERATIONS, tolerance=TOLERANCE) for k in range(robot.count)]
    seconds = time.perf_counter() - begin
    return seconds, [f.errors[:-1].max() for f in found], [f.iterations for f in found]


def at_once(robot, threads, restarts=0):
    batch = clench.Batch(robot.own, robot.count, threads=threads)
    batch.qpos[:] = robot.start
    targets = robot.targets(slice(None))
    seconds = []
    for _ in range(5):
        begin = time.perf_counter()
        found = batch.ik(targets, iterations=ITERATIONS, tolerance=TOLERANCE, restarts=restarts)
        seconds.append(time.perf_counter() - begin)
    return min(seconds), found.errors[:, :-1].max(axis=1), found.iterations


def with_mink(robot, count):
    configuration = mink.Configuration(robot.model)
    frames = [mink.FrameTask(b, "body", position_cost=1.0, orientation_cost=1.0) for b in robot.bodies]
    com = mink.ComTask(cost=1.0) if robot.com else None
    posture = mink.PostureTask(robot.model, cost=POSTURE)
    posture.set_target(robot.start)
    tasks = [*frames, *([com] if com else []), posture]
    limits = [mink.ConfigurationLimit(robot.model)]
    worst, iterations = [], []
    begin = time.perf_counter()
    for k in range(count):
        configuration.update(robot.start)
        for i, frame in enumerate(frames):
            frame.set_target(mink.SE3(np.concatenate([robot.quat[k, i], robot.position[k, i]])))
        if com:
            com.set_target(robot.centre[k])
        for done in range(ITERATIONS + 1):
            parts = [np.linalg.norm(e) for f in frames for e in np.split(f.compute_error(configuration), 2)]
            if com:
                parts.append(np.linalg.norm(com.compute_error(configuration)))
            if max(parts) <= TOLERANCE or done == ITERATIONS:
                break
            velocity = mink.solve_ik(configuration, tasks, 1.0, "daqp", damping=1e-3, limits=limits)
            configuration.integrate_inplace(velocity, 1.0)
        worst.append(max(parts))
        iterations.append(done)
    return time.perf_counter() - begin, worst, iterations


def line(name, count, seconds, worst, iterations):
    worst = np.asarray(worst, np.float64)
    reached = 100 * np.mean(worst <= 1.001 * TOLERANCE)
    print(
        f"  {name:<28}{count / seconds:>12.0f}{reached:>10.1f}{np.median(worst):>12.1e}{np.mean(worst):>12.1e}{np.mean(iterations):>12.1f}",
        flush=True,
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--goals", type=int, default=1024)
    parser.add_argument("--mink-goals", type=int, default=200, help="solve only the first N goals with mink")
    args = parser.parse_args()
    for name, (path, bodies, com) in ROBOTS.items():
        robot = Robot(MODELS / path, bodies, com, args.goals)
        print(f"{name}\n  {'':<28}{'solutions/s':>12}{'reached %':>10}{'median':>12}{'mean error':>12}{'iterations':>12}")
        line("mink", args.mink_goals, *with_mink(robot, args.mink_goals))
        line("Clench, one by one", args.goals, *one_by_one(robot))
        for threads in (1, None):
            line(f"Clench, batch, {threads or 'all'} threads", args.goals, *at_once(robot, threads))
        line(f"the same, {RESTARTS} restarts", args.goals, *at_once(robot, None, RESTARTS))


if __name__ == "__main__":
    main()
