"""Times one environment on one thread: Clench and MuJoCo's rollout, from the model's initial state or a given one."""

import time

import mujoco
import numpy as np
from mujoco import rollout

from program import Clench
from scene import NEWTON, PGS, Unmeasured, describe, load, smooth_controls
from timing import alternate, table


def compare(path, args):
    """Times all engines on one model, prints its table and returns its rows."""
    model = mujoco.MjModel.from_xml_path(str(path))
    controls = smooth_controls(model, args.steps)
    steps = ["--steps", args.steps]
    engines = {
        "mujoco newton": Rollout(path, NEWTON, controls),
        "clench": Clench(path, {"ctrl": controls}, [*steps, *args.clench.split()]),
    }
    if model.opt.solver == PGS:
        engines["mujoco pgs"] = Rollout(path, PGS, controls)
    seconds = alternate(engines, args.repeat)
    print(f"\n{describe(model, path)}; one environment, {args.steps} steps")
    rows = table(engines, seconds, "mujoco newton", args.steps)
    return [{"model": path.stem, "envs": 1, "threads": 1, "steps": args.steps} | row for row in rows]


class Rollout:
    """MuJoCo's rollout module on the calling thread."""

    def __init__(self, path, solver, controls, state=None):
        self.model = load(path, solver)
        self.data = mujoco.MjData(self.model)
        if state is not None:
            self.data.qpos[:], self.data.qvel[:] = np.split(state, [self.model.nq])
        self.controls = controls[None]
        size = mujoco.mj_stateSize(self.model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        self.start = np.empty((1, size))
        mujoco.mj_getState(self.model, self.data, self.start[0], mujoco.mjtState.mjSTATE_FULLPHYSICS)
        self.states = np.empty((1, len(controls), size))
        self.sensors = np.empty((1, len(controls), self.model.nsensordata))
        self.pool = rollout.Rollout(nthread=0)
        self.gradients = []  # the scaled gradient norm at the end of each step's solve, the maximum over islands
        self.contacts, self.iterations = self.statistics(controls)

    def statistics(self, controls):
        """Returns the mean contacts and iterations of a step (of RK4 the last stage); checks that MuJoCo is stable."""
        data, contacts, iterations = mujoco.MjData(self.model), 0, 0
        mujoco.mj_setState(self.model, data, self.start[0], mujoco.mjtState.mjSTATE_FULLPHYSICS)
        for control in controls:
            data.ctrl[:] = control
            mujoco.mj_step(self.model, data)
            contacts += data.ncon
            counts = data.solver_niter[: max(1, data.nisland)]
            iterations += int(counts.sum())
            self.gradients.append(self.last_gradient(data, counts))
        if any(w.number for w in data.warning):
            raise Unmeasured("MuJoCo warns of an unstable motion: these controls are useless for measurements")
        return contacts / len(controls), iterations / len(controls)

    @staticmethod
    def last_gradient(data, counts):
        """Returns the largest final gradient norm of the islands. MuJoCo does not record all islands."""
        history = data.solver.gradient.reshape(len(data.solver_niter), -1)
        ends = [row[min(count, len(row)) - 1] for row, count in zip(history, counts, strict=False) if count]
        return max(ends, default=0.0)

    def run(self):
        begin = time.perf_counter()
        self.pool.rollout(
            [self.model], [self.data], self.start, self.controls, skip_checks=True, nstep=self.controls.shape[1],
            state=self.states, sensordata=self.sensors,
        )  # fmt: skip
        return time.perf_counter() - begin
