"""Measures each query from Python, next to MuJoCo's function: `python bench/queries.py MODEL [--envs N]`.

Both engines are asked in one state, in turn; times are medians over repetitions. What a batch answers is for all environments.
"""

import argparse
import statistics
import time

import clench
import mujoco
import numpy as np

REPEAT = 7
CALLS = 300


def microseconds(function, calls=CALLS):
    """Returns the time of one call: the median over repetitions."""
    seconds = []
    for _ in range(REPEAT + 1):
        begin = time.perf_counter()
        for _ in range(calls):
            function()
        seconds.append(time.perf_counter() - begin)
    return 1e6 * statistics.median(seconds[1:]) / calls


def questions(sim, model, data, rng):
    """Returns each query as its name, Clench's call and MuJoCo's call."""
    nv, body = model.nv, model.nbody - 1
    out, x = np.zeros((2, 3, nv)), rng.normal(size=nv)
    jacp, jacr, six = np.zeros((3, nv)), np.zeros((3, nv)), np.zeros(6)
    point, force, torque = rng.normal(size=(3, 3))
    directions = rng.normal(size=(100, 3))
    hits, distances, normals = np.zeros(100, np.int32), np.zeros(100), np.zeros(300)
    code = mujoco.mjtObj.mjOBJ_XBODY
    q2, qfrc, full = data.qpos.copy(), np.zeros(nv), np.zeros((nv, nv))
    geom, geoms, ends = np.zeros(1, np.int32), (model.ngeom - 1, model.ngeom // 2), np.zeros(6)
    own = sim.model

    def mujoco_solve():
        mujoco.mj_solveM(model, data, qfrc[None], x[None])

    def mujoco_force():
        qfrc[:] = 0
        mujoco.mj_applyFT(model, data, force, torque, point, body, qfrc)

    def mujoco_rays():
        mujoco.mj_multiRay(model, data, np.zeros(3), directions.ravel(), None, 1, -1, hits, distances, normals, 100, 1e9)

    def mujoco_inverse():
        data.qacc[:] = x
        mujoco.mj_inverse(model, data)

    return [
        ("jacobian(body)", lambda: sim.jacobian(body=body, out=out), lambda: mujoco.mj_jacBody(model, data, jacp, jacr, body)),
        ("jacobian_rate(body)", lambda: sim.jacobian_rate(body=body, point=point), lambda: mujoco.mj_jacDot(model, data, jacp, jacr, point, body)),
        ("subtree_jacobian(0)", lambda: sim.subtree_jacobian(0), lambda: mujoco.mj_jacSubtreeCom(model, data, jacp, 0)),
        ("velocity(body)", lambda: sim.velocity(body=body), lambda: mujoco.mj_objectVelocity(model, data, code, body, six, 0)),
        ("acceleration(body)", lambda: sim.acceleration(body=body), lambda: mujoco.mj_objectAcceleration(model, data, code, body, six, 0)),
        ("mass_matrix", lambda: sim.mass_matrix(), lambda: mujoco.mj_fullM(model, data, full)),
        ("mul_mass", lambda: sim.mul_mass(x), lambda: mujoco.mj_mulM(model, data, qfrc, x)),
        ("solve_mass", lambda: sim.solve_mass(x), mujoco_solve),
        ("joint_forces", lambda: sim.joint_forces(body, force, torque, point), mujoco_force),
        ("integrate_pos", lambda: own.integrate_pos(sim.qpos, x, 0.1), lambda: mujoco.mj_integratePos(model, q2, x, 0.1)),
        ("differentiate_pos", lambda: own.differentiate_pos(sim.qpos, q2), lambda: mujoco.mj_differentiatePos(model, qfrc, 1, data.qpos, q2)),
        ("ray", lambda: sim.ray(point, force), lambda: mujoco.mj_ray(model, data, point, force, None, 1, -1, geom, None)),
        ("rays (100)", lambda: sim.rays([[0, 0, 0]], directions), mujoco_rays),
        ("distance", lambda: sim.distance(*geoms, 10.0), lambda: mujoco.mj_geomDistance(model, data, *geoms, 10.0, ends)),
        ("inverse", lambda: sim.inverse(x), mujoco_inverse),
    ]


def batched(batch, rng):
    """Returns each query of a batch as its name and its call."""
    n, nv = batch.n_envs, batch.model.nv
    qacc, directions = rng.normal(size=(n, nv)), rng.normal(size=(100, 3))
    body = batch.model.nbody - 1
    return [
        ("jacobian(body)", lambda: batch.jacobian(body=body)),
        ("subtree_jacobian(0)", lambda: batch.subtree_jacobian(0)),
        ("velocity(body)", lambda: batch.velocity(body=body)),
        ("acceleration(body)", lambda: batch.acceleration(body=body)),
        ("mass_matrix", lambda: batch.mass_matrix()),
        ("mul_mass", lambda: batch.mul_mass(qacc)),
        ("solve_mass", lambda: batch.solve_mass(qacc)),
        ("rays (100)", lambda: batch.rays([[0, 0, 0]], directions)),
        ("inverse", lambda: batch.inverse(qacc)),
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("model")
    parser.add_argument("--envs", type=int, default=1024)
    args = parser.parse_args()
    own = clench.Model.from_file(args.model)
    model = mujoco.MjModel.from_xml_path(args.model)
    sim, data, rng = clench.Sim(own), mujoco.MjData(model), np.random.default_rng(1)
    sim.qpos[:] = own.integrate_pos(sim.qpos, rng.normal(0, 0.2, own.nv))
    data.qpos[:] = sim.qpos
    sim.forward()
    mujoco.mj_forward(model, data)
    print(f"{'one environment':<22}{'Clench':>10}{'MuJoCo':>10}   µs a call")
    for name, clenchs, mujocos in questions(sim, model, data, rng):
        print(f"{name:<22}{microseconds(clenchs):>10.2f}{microseconds(mujocos):>10.2f}")
    batch = clench.Batch(own, args.envs)
    batch.qpos[:] = own.integrate_pos(batch.qpos, rng.normal(0, 0.2, (args.envs, own.nv)))
    print(f"\n{args.envs} environments, {batch.threads} threads{'':<3}µs an environment")
    for name, query in batched(batch, rng):
        print(f"{name:<22}{microseconds(query, 3) / args.envs:>10.3f}")


if __name__ == "__main__":
    main()
