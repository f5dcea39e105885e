"""Compares queries of motion, forces and joints with MuJoCo, and those of a batch with single simulations."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import clench
import mujoco  # type: ignore[import-untyped]
import numpy as np
import pytest
from scenes import example

ARM = """
<mujoco>
  <option timestep="0.002" integrator="implicitfast"/>
  <asset><hfield name="hills" nrow="3" ncol="4" size="2 1.5 0.3 0.1" elevation="0 1 0 2  3 0 1 1  0 2 2 0"/></asset>
  <worldbody>
    <geom name="hills" type="hfield" hfield="hills" pos="0.1 0.2 -0.5"/>
    <body name="base" pos="0 0 0.3">
      <joint name="turn" axis="0 0 1" damping="0.3" armature="0.1" range="-150 150"/>
      <geom type="capsule" fromto="0 0 0 0 0 0.3" size="0.05"/>
      <body name="upper" pos="0 0 0.3">
        <joint name="shoulder" axis="0 1 0" damping="0.3" range="-120 120"/>
        <geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.04"/>
        <body name="lower" pos="0.4 0 0">
          <joint name="elbow" axis="0 1 0" damping="0.3" range="-140 140"/>
          <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.03"/>
          <body name="wrist" pos="0.3 0 0">
            <joint name="wrist" type="ball" damping="0.1"/>
            <geom name="hand" type="box" size="0.05 0.03 0.02" pos="0.05 0 0"/>
            <site name="tool" pos="0.1 0 0" euler="10 20 30"/>
            <camera name="eye" pos="0.05 0 0.05"/>
          </body>
        </body>
      </body>
    </body>
    <body name="box" pos="0.5 0 0.4"><freejoint/><geom type="box" size="0.05 0.06 0.07"/></body>
  </worldbody>
  <tendon><fixed name="string"><joint joint="shoulder" coef="0.3"/><joint joint="elbow" coef="-0.2"/></fixed></tendon>
  <actuator>
    <motor joint="turn" gear="3"/><position joint="elbow" kp="20" kv="1"/><motor tendon="string"/>
  </actuator>
</mujoco>
"""


def mujocos(model: clench.Model) -> Any:
    return mujoco.MjModel.from_xml_string(model.to_xml())


@pytest.fixture(params=["arm", "humanoid", "quadruped"])
def pair(request: pytest.FixtureRequest) -> Iterator[tuple[clench.Sim, Any, Any]]:
    """Yields a simulation in a random state, and MuJoCo's model and data in the same state."""
    model = clench.Model.from_xml(ARM) if request.param == "arm" else example(request.param)
    reference = mujocos(model)
    reference.opt.tolerance, reference.opt.iterations, reference.opt.ls_tolerance = 0, 200, 1e-10
    sim = clench.Sim(model, clench.RigidOptions(tolerance=0.0, iterations=200))
    rng = np.random.default_rng(7)
    sim.qpos[:] = model.integrate_pos(sim.qpos, rng.normal(0, 0.4, model.nv))
    sim.qvel[:] = rng.normal(0, 1, model.nv)
    sim.ctrl[:] = rng.uniform(-0.5, 0.5, model.nu)
    sim.qfrc_applied[:] = rng.normal(0, 1, model.nv)
    data = mujoco.MjData(reference)
    data.qpos[:], data.qvel[:], data.ctrl[:] = sim.qpos, sim.qvel, sim.ctrl
    data.qfrc_applied[:] = sim.qfrc_applied
    mujoco.mj_forward(reference, data)
    mujoco.mj_subtreeVel(reference, data)
    yield sim, reference, data


def close(found: Any, expected: Any, tolerance: float = 1e-10) -> None:
    scale = max(1.0, float(np.max(np.abs(expected), initial=0.0)))
    np.testing.assert_allclose(found, expected, rtol=0, atol=tolerance * scale)


def test_jacobians_are_mujocos(pair: tuple[clench.Sim, Any, Any]) -> None:
    sim, model, data = pair
    own = sim.model
    kinds = {
        "body": (own.nbody, mujoco.mj_jacBody),
        "body_com": (own.nbody, mujoco.mj_jacBodyCom),
        "geom": (own.ngeom, mujoco.mj_jacGeom),
        "site": (own.nsite, mujoco.mj_jacSite),
    }
    room: Any = np.full((2, 3, own.nv), np.nan)
    expected = np.zeros((2, 3, own.nv))
    for kind, (count, function) in kinds.items():
        for index in range(count):
            function(model, data, expected[0], expected[1], index)
            choice: Any = {kind: index}
            close(sim.jacobian(**choice), expected)
            assert sim.jacobian(**choice, out=room) is room
            close(room, expected)
    for body in range(own.nbody):
        mujoco.mj_jacSubtreeCom(model, data, expected[0], body)
        close(sim.subtree_jacobian(body), expected[0])
        point = np.array([0.1, -0.2, 0.3])
        mujoco.mj_jac(model, data, expected[0], expected[1], point, body)
        close(sim.jacobian(body=body, point=point), expected)
        mujoco.mj_jacDot(model, data, expected[0], expected[1], point, body)
        close(sim.jacobian_rate(body=body, point=point), expected)
    for site in range(own.nsite):
        mujoco.mj_jacSite(model, data, expected[0], expected[1], site)
        close(sim.site_jacp[site], expected[0])
        close(sim.site_jacr[site], expected[1])


def test_velocities_and_accelerations_of_objects_are_mujocos(pair: tuple[clench.Sim, Any, Any]) -> None:
    sim, model, data = pair
    mujoco.mj_rnePostConstraint(model, data)
    kinds = {
        "body": (mujoco.mjtObj.mjOBJ_XBODY, sim.model.nbody),
        "body_com": (mujoco.mjtObj.mjOBJ_BODY, sim.model.nbody),
        "geom": (mujoco.mjtObj.mjOBJ_GEOM, sim.model.ngeom),
        "site": (mujoco.mjtObj.mjOBJ_SITE, sim.model.nsite),
        "camera": (mujoco.mjtObj.mjOBJ_CAMERA, sim.model.ncam),
    }
    expected = np.zeros(6)
    for kind, (code, count) in kinds.items():
        for index in range(count):
            choice: Any = {kind: index}
            for local in (False, True):
                mujoco.mj_objectVelocity(model, data, code, index, expected, local)
                close(sim.velocity(**choice, local=local).ravel(), np.roll(expected, 3))
                mujoco.mj_objectAcceleration(model, data, code, index, expected, local)
                close(sim.acceleration(**choice, local=local).ravel(), np.roll(expected, 3), 1e-7)


def test_products_with_the_mass_matrix_are_mujocos(pair: tuple[clench.Sim, Any, Any]) -> None:
    sim, model, data = pair
    x = np.random.default_rng(1).normal(size=(3, model.nv))
    expected = np.zeros(model.nv)
    for row, product, solution in zip(x, sim.mul_mass(x), sim.solve_mass(x), strict=True):
        mujoco.mj_mulM(model, data, expected, row)
        close(product, expected)
        close(sim.mul_mass(row), expected)
        mujoco.mj_solveM(model, data, expected[None], row[None])
        close(solution, expected, 1e-9)


def test_forces_on_bodies_are_mujocos_along_the_dofs(pair: tuple[clench.Sim, Any, Any]) -> None:
    sim, model, data = pair
    force, torque, point = np.random.default_rng(2).normal(size=(3, 3))
    for body in range(model.nbody):
        expected = np.zeros(model.nv)
        mujoco.mj_applyFT(model, data, force, torque, point, body, expected)
        close(sim.joint_forces(body, force, torque, point), expected)
        expected[:] = 0
        mujoco.mj_applyFT(model, data, force, torque, data.xipos[body], body, expected)
        close(sim.joint_forces(body, force, torque), expected)


def test_moment_arms_are_mujocos(pair: tuple[clench.Sim, Any, Any]) -> None:
    sim, model, data = pair
    expected = np.zeros((model.nu, model.nv))
    mujoco.mju_sparse2dense(expected, data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind)
    close(sim.actuator_moment, expected)
    close(sim.ten_J @ sim.qvel, data.ten_velocity)


def test_forces_between_bodies_are_mujocos(pair: tuple[clench.Sim, Any, Any]) -> None:
    sim, model, data = pair
    mujoco.mj_rnePostConstraint(model, data)
    for name in ("cacc", "cfrc_int", "cfrc_ext"):
        close(sim.output(name), getattr(data, name), 1e-6)


def test_positions_are_integrated_and_differentiated_as_mujoco_does(pair: tuple[clench.Sim, Any, Any]) -> None:
    sim, model, data = pair
    own, velocity = sim.model, np.random.default_rng(3).normal(size=(4, model.nv))
    starts = np.repeat(sim.qpos[None], 4, axis=0)
    ends = own.integrate_pos(starts, velocity, 0.3)
    expected, rate = data.qpos.copy(), np.zeros(model.nv)
    mujoco.mj_integratePos(model, expected, velocity[2], 0.3)
    close(ends[2], expected)
    close(own.integrate_pos(sim.qpos, velocity[2], 0.3), expected)
    mujoco.mj_differentiatePos(model, rate, 0.3, data.qpos, expected)
    close(own.differentiate_pos(starts, ends, 0.3)[2], rate)
    close(own.differentiate_pos(starts, ends, 0.3), velocity)


def test_inverse_dynamics_are_mujocos_and_undo_forward_dynamics(pair: tuple[clench.Sim, Any, Any]) -> None:
    sim, model, data = pair
    qacc = np.random.default_rng(4).normal(0, 5, model.nv)
    data.qacc[:] = qacc
    mujoco.mj_inverse(model, data)
    close(sim.inverse(qacc), data.qfrc_inverse, 1e-9)
    sim.forward()
    close(sim.inverse(sim.qacc), sim.qfrc_actuator + sim.qfrc_applied, 1e-9)
    assert np.array_equal(sim.inverse(np.stack([qacc, sim.qacc]))[0], sim.inverse(qacc))


def test_discrete_inverse_dynamics_undo_a_step(pair: tuple[clench.Sim, Any, Any]) -> None:
    sim, _, _ = pair
    before = sim.state
    sim.forward()
    expected = sim.qfrc_actuator + sim.qfrc_applied
    sim.step()
    qacc = (sim.qvel - before.qvel) / sim.model.timestep
    sim.state = before
    close(sim.inverse(qacc, discrete=True), expected, 1e-8)


def test_a_batch_answers_as_simulations_do() -> None:
    model = clench.Model.from_xml(ARM)
    rng = np.random.default_rng(5)
    batch = clench.Batch(model, 11)
    batch.qpos[:] = model.integrate_pos(batch.qpos, rng.normal(0, 0.4, (11, model.nv)))
    batch.qvel[:] = rng.normal(0, 1, (11, model.nv))
    qacc = rng.normal(size=(11, model.nv))
    directions = rng.normal(size=(6, 3))
    places = rng.normal(size=(11, 5, 2))
    goals = rng.uniform([0.2, -0.3, 0.3], [0.6, 0.3, 0.8], (11, 3))
    jacobian, trees = batch.jacobian(site="tool"), batch.subtree_jacobian("base")
    points = rng.normal(size=(11, 3))
    of_points, rates = batch.jacobian(body="wrist", point=points), batch.jacobian_rate(site="tool")
    rates_of_point = batch.jacobian_rate(body="wrist", point=[0.1, 0.2, 0.3])
    hits = batch.rays([[0, 0, 0]], directions, site="tool", exclude_body="wrist")
    heights, forces = batch.heights("hills", places, body="wrist"), batch.inverse(qacc, discrete=False)
    result = batch.ik([clench.FrameTarget(site="tool", position=goals)])
    velocities, local = batch.velocity(site="tool"), batch.velocity(site="tool", local=True)
    accelerations = batch.acceleration(body="wrist")
    products, solved = batch.mul_mass(qacc), batch.solve_mass(qacc[0])
    assert velocities.shape == accelerations.shape == (11, 2, 3)
    assert jacobian.shape == (11, 2, 3, model.nv)
    assert hits.distance.shape == (11, 6)
    assert result.errors.shape == (11, 1)
    for env in range(11):
        sim = batch.sim(env)
        assert np.array_equal(jacobian[env], sim.jacobian(site="tool"))
        assert np.array_equal(of_points[env], sim.jacobian(body="wrist", point=points[env]))
        assert np.array_equal(rates[env], sim.jacobian_rate(site="tool"))
        assert np.array_equal(rates_of_point[env], sim.jacobian_rate(body="wrist", point=[0.1, 0.2, 0.3]))
        assert np.array_equal(trees[env], sim.subtree_jacobian("base"))
        own = sim.rays([[0, 0, 0]], directions, site="tool", exclude_body="wrist")
        assert np.array_equal(hits.geom[env], own.geom)
        assert np.array_equal(hits.distance[env], own.distance)
        assert np.array_equal(hits.normal[env], own.normal)
        assert np.array_equal(heights[env], sim.heights("hills", places[env], body="wrist"))
        assert np.array_equal(forces[env], sim.inverse(qacc[env], discrete=False))
        assert np.array_equal(velocities[env], sim.velocity(site="tool"))
        assert np.array_equal(local[env], sim.velocity(site="tool", local=True))
        assert np.array_equal(accelerations[env], sim.acceleration(body="wrist"))
        assert np.array_equal(products[env], sim.mul_mass(qacc[env]))
        assert np.array_equal(solved[env], sim.solve_mass(qacc[0]))
        alone = sim.ik([clench.FrameTarget(site="tool", position=goals[env])])
        assert np.array_equal(result.qpos[env], alone.qpos)
        assert (result.iterations[env], result.status[env]) == (alone.iterations, alone.status)


def test_a_step_towards_a_goal_is_no_longer_than_it_may_be() -> None:
    sim = clench.Sim(clench.Model.from_xml(ARM))
    goal = clench.FrameTarget(site="tool", position=[0.4, 0.2, 0.5])
    result = sim.ik([goal], iterations=1, max_step=0.01)
    moved = np.abs(sim.model.differentiate_pos(sim.qpos, result.qpos)).max()
    assert moved == pytest.approx(0.01) and result.iterations == 1
    with pytest.raises(ValueError, match="max_step"):
        sim.ik([goal], max_step=0)


def test_many_rays_are_as_each_alone() -> None:
    sim = clench.Sim(clench.Model.from_xml(ARM))
    rng = np.random.default_rng(6)
    origins, directions = rng.normal(size=(2, 200, 3))
    found = sim.rays(origins, directions)
    assert 10 < np.isfinite(found.distance).sum() < 200
    for k in range(200):
        alone = sim.ray(origins[k], directions[k])
        assert (found.geom[k], found.distance[k]) == ((-1, np.inf) if alone is None else (alone.geom, alone.distance))


def test_heights_are_those_that_rays_from_above_find() -> None:
    sim = clench.Sim(clench.Model.from_xml(ARM))
    places = np.random.default_rng(8).uniform([-1.8, -1.2], [2, 1.6], (50, 2))
    heights = sim.heights("hills", places)
    origins = np.column_stack([places, heights + 1e-4])
    found = sim.rays(origins, [[0, 0, -1]])
    assert (found.geom == 0).all()
    np.testing.assert_allclose(found.distance, 1e-4, atol=1e-12)


def test_inverse_kinematics_reach_what_can_be_reached() -> None:
    model = clench.Model.from_xml(ARM)
    sim = clench.Sim(model)
    start = sim.qpos.copy()
    target = clench.FrameTarget(site="tool", position=[0.4, 0.2, 0.6], quat=[1, 0, 0, 0])
    result = sim.ik([target, clench.PostureTarget(start, cost=1e-4)])
    assert result.reached
    assert result.status == clench.IkStatus.REACHED
    assert np.array_equal(sim.qpos, start)
    sim.qpos[:] = result.qpos
    np.testing.assert_allclose(sim.site_xpos[0], [0.4, 0.2, 0.6], atol=1e-6)
    np.testing.assert_allclose(sim.site_xmat[0].reshape(3, 3), np.eye(3), atol=2e-6)
    far = sim.ik([clench.FrameTarget(site="tool", position=[5, 0, 0])])
    assert not far.reached
    assert far.errors[0] > 3
    held = sim.ik([clench.FrameTarget(site="tool", position=[0.3, 0.3, 0.5])], start=start, dofs=np.arange(model.nv) > 0)
    assert held.qpos[0] == start[0]


def test_bad_questions_are_errors() -> None:
    sim = clench.Sim(clench.Model.from_xml(ARM))
    with pytest.raises(ValueError, match="give one of body"):
        sim.jacobian()
    with pytest.raises(ValueError, match="not several"):
        sim.jacobian(body="base", site="tool")
    with pytest.raises(ValueError, match="point needs body"):
        sim.jacobian(site="tool", point=[0, 0, 0])
    with pytest.raises(ValueError, match="out has shape"):
        sim.jacobian(site="tool", out=np.zeros(3))
    with pytest.raises(TypeError, match="out must be an array of float64"):
        sim.jacobian(site="tool", out=np.zeros((2, 3, sim.model.nv), np.float32))
    with pytest.raises(ValueError, match="qacc has shape"):
        sim.inverse([1, 2])
    nan = np.full(sim.model.nv, np.nan)
    for wrong in (sim.inverse, sim.mul_mass, sim.solve_mass, clench.Batch(sim.model, 2).mul_mass):
        with pytest.raises(ValueError, match=r"\[0\] is NaN, but must be finite"):
            wrong(nan)
    with pytest.raises(ValueError, match="is NaN, but must be finite"):
        sim.rays([[0, 0, np.nan]], [[0, 0, 1]])
    with pytest.raises(ValueError, match="is NaN, but must be finite"):
        sim.ik([clench.ComTarget([np.nan, 0, 0])])
    with pytest.raises(ValueError, match="not a height field"):
        sim.heights("hand", [[0, 0]])
    with pytest.raises(ValueError, match="a position, a quat or both"):
        clench.FrameTarget(site="tool")
    with pytest.raises(TypeError, match="targets are"):
        sim.ik([3])  # type: ignore[list-item]
    with pytest.raises(ValueError, match="position has shape"):
        sim.ik([clench.ComTarget([1, 2])])
    rk4 = clench.Sim(clench.Model.from_xml(ARM.replace("implicitfast", "RK4")))
    with pytest.raises(ValueError, match="RK4 has no discrete"):
        rk4.inverse(np.zeros(rk4.model.nv), discrete=True)
