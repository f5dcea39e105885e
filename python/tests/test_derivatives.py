"""Derivatives of a step, compared with central differences and formulas."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import clench
import numpy as np
import pytest
from numpy.typing import NDArray
from scenes import ball, example, puppet

Floats = NDArray[np.float64]

EXACT = clench.RigidOptions(tolerance=0, iterations=200, ls_iterations=200, ls_tolerance=1e-10)
STEP = 1e-6


def moving(name: str, keyframe: str, steps: int) -> clench.Sim:
    """Returns a simulation that is in contact, with controls."""
    sim = clench.Sim(example(name), EXACT)
    sim.reset(keyframe)
    sim.step(steps)
    sim.ctrl = np.random.default_rng(0).uniform(-0.2, 0.2, sim.model.nu)
    sim.step(5)
    assert len(sim.contacts) > 2
    return sim


def differences(
    sim: clench.Sim, change: Callable[[clench.Sim, float], None], read: Callable[[], Floats] = lambda: np.empty(0)
) -> tuple[Floats, Floats]:
    """Returns the central differences of the next state and of what is read before the step."""
    model, start = sim.model, sim.state
    states, reads = [], []
    for sign in (-1.0, 1.0):
        sim.state = start
        change(sim, sign * STEP)
        sim.forward()
        reads.append(read())
        sim.step()
        states.append(sim.state)
    sim.state = start
    change(sim, 0.0)
    low, high = states
    motion = model.differentiate_pos(low.qpos, high.qpos)
    following = np.concatenate([motion, high.qvel - low.qvel, high.act - low.act])
    return following / (2 * STEP), (reads[1] - reads[0]) / (2 * STEP)


def change_state(column: int) -> Callable[[clench.Sim, float], None]:
    def change(sim: clench.Sim, amount: float) -> None:
        nv = sim.model.nv
        if column < nv:
            sim.qpos = sim.model.integrate_pos(sim.qpos, np.eye(nv)[column], amount)
        elif column < 2 * nv:
            sim.qvel[column - nv] += amount
        else:
            sim.act[column - 2 * nv] += amount

    return change


def change_control(column: int) -> Callable[[clench.Sim, float], None]:
    def change(sim: clench.Sim, amount: float) -> None:
        sim.ctrl[column] += amount

    return change


def change_parameter(sim: clench.Sim, field: str, index: int) -> Callable[[clench.Sim, float], None]:
    values = np.array(sim.param(field))

    def change(sim: clench.Sim, amount: float) -> None:
        changed = values.copy()
        changed.ravel()[index : index + 1] += amount
        sim.set_param(field, changed)

    return change


def assert_near(found: Floats, expected: Floats, scale: float) -> None:
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-6 * scale)


@pytest.mark.parametrize(
    ("name", "keyframe", "steps"), [("humanoid", "standing", 195), ("quadruped", "crouching", 300)]
)
def test_states_and_controls_match_differences(name: str, keyframe: str, steps: int) -> None:
    sim = moving(name, keyframe, steps)
    linear, rng = sim.linearize(), np.random.default_rng(1)
    size = 2 * sim.model.nv + sim.model.na
    assert linear.A.shape == (size, size) and linear.B.shape == (size, sim.model.nu)
    scale = float(np.abs(linear.A).max())
    assert scale > 10.0  # Contacts are stiff.
    for column in rng.choice(size, 12, replace=False):
        expected, _ = differences(sim, change_state(column))
        assert_near(linear.A[:, column], expected, scale)
    for column in rng.choice(sim.model.nu, 4, replace=False):
        expected, _ = differences(sim, change_control(column))
        assert_near(linear.B[:, column], expected, 1.0)


def test_activations_tendons_and_equalities_match_differences() -> None:
    sim = clench.Sim(puppet(), EXACT)
    sim.reset("bent")
    sim.step(20)
    linear = sim.linearize()
    for column in range(2 * sim.model.nv + sim.model.na):
        expected, _ = differences(sim, change_state(column))
        assert_near(linear.A[:, column], expected, float(np.abs(linear.A).max()))


@pytest.mark.parametrize("options", ["", "integrator='RK4'", "integrator='implicit'", "integrator='discrete'"])
@pytest.mark.parametrize("model", [{}, {"contact_model": "coulomb"}, {"stiction": True}])
def test_integrators_and_contact_models_match_differences(options: str, model: dict[str, Any]) -> None:
    text = (
        f"<mujoco><option cone='elliptic' {options}/><worldbody><geom type='plane' size='1 1 1' euler='0 9 0'/>"
        "<body pos='0 0 0.102' euler='0 9 0'><freejoint/><geom type='box' size='0.1 0.1 0.1'/></body>"
        "<body pos='0.5 0 0.1'><joint type='ball' damping='0.1'/><geom type='capsule' fromto='0 0 0 0.2 0 0' "
        "size='0.03'/></body></worldbody></mujoco>"
    )
    precise: dict[str, Any] = {"tolerance": 0, "iterations": 200, "ls_iterations": 200, "ls_tolerance": 1e-10}
    sim = clench.Sim(clench.Model.from_xml(text), clench.RigidOptions(**precise, **model))
    sim.step(40)
    assert len(sim.contacts) > 2
    linear = sim.linearize()
    for column in range(2 * sim.model.nv):
        expected, _ = differences(sim, change_state(column))
        assert_near(linear.A[:, column], expected, float(np.abs(linear.A).max()))


@pytest.mark.parametrize(
    ("field", "index"),
    [
        ("body_mass", 1),
        ("body_inertia", 4),
        ("geom_friction", 3 * 6),
        ("geom_size", 3 * 6),
        ("dof_damping", 8),
        ("dof_armature", 8),
        ("actuator_gainprm", 0),
        ("gravity", 2),
        ("timestep", 0),
    ],
)
def test_parameters_match_differences(field: str, index: int) -> None:
    sim = moving("quadruped", "crouching", 300)
    linear = sim.linearize(parameters={field: [index], "dof_frictionloss": [0, 1]})
    assert linear.parameters["dof_frictionloss"].shape == (2 * sim.model.nv, 2)
    expected, _ = differences(sim, change_parameter(sim, field, index))
    found = linear.parameters[field][:, 0]
    assert_near(found, expected, max(1.0, float(np.abs(found).max())))


def test_all_numbers_of_a_parameter() -> None:
    sim = moving("quadruped", "crouching", 300)
    every = sim.linearize(parameters=["geom_friction"]).parameters["geom_friction"]
    assert every.shape == (2 * sim.model.nv, 3 * sim.model.ngeom)
    some = sim.linearize(parameters={"geom_friction": [18, 3]}).parameters["geom_friction"]
    np.testing.assert_array_equal(some, every[:, [18, 3]])


def test_sensors_and_outputs_match_differences() -> None:
    model = clench.Model.from_xml(
        "<mujoco><worldbody><geom type='plane' size='1 1 1'/><body name='b' pos='0 0 0.0995'><freejoint/>"
        "<geom type='box' size='0.1 0.1 0.1'/><site name='s' pos='0.1 0 0' size='0.2'/></body></worldbody>"
        "<actuator><motor name='m' site='s' gear='1 0 2 0 0 1'/></actuator>"
        "<sensor><accelerometer site='s'/><touch site='s'/><framequat objtype='site' objname='s'/></sensor></mujoco>"
    )
    sim = clench.Sim(model, EXACT)
    sim.step(10)
    sim.ctrl = [0.3]
    names = ["xipos", "qfrc_constraint"]
    linear = sim.linearize(names, {"body_mass": [1]})

    def read() -> Floats:
        return np.concatenate([np.ravel(sim.output(name)) for name in ["sensordata", *names]])

    scale = float(np.abs(linear.C).max())
    assert linear.C.shape == (model.nsensordata + 6 + 6, 12)
    without = sim.linearize(sensors=False)
    assert without.C.shape == (0, 12) and without.D.shape == (0, 1)
    np.testing.assert_allclose(without.A, linear.A, rtol=1e-10, atol=1e-10 * float(np.abs(linear.A).max()))
    for column in range(12):
        assert_near(linear.C[:, column], differences(sim, change_state(column), read)[1], scale)
    assert_near(linear.D[:, 0], differences(sim, change_control(0), read)[1], 1.0)
    by_mass = differences(sim, change_parameter(sim, "body_mass", 1), read)[1]
    assert_near(linear.output_parameters["body_mass"][:, 0], by_mass, float(np.abs(by_mass).max()))


@pytest.mark.parametrize(
    ("name", "keyframe", "steps"), [("humanoid", "standing", 195), ("quadruped", "crouching", 300)]
)
def test_directional_derivatives_are_products(name: str, keyframe: str, steps: int) -> None:
    sim, rng = moving(name, keyframe, steps), np.random.default_rng(1)
    linear = sim.linearize(["subtree_com"], ["body_mass", "gravity"])
    columns = 3
    x, u = rng.normal(size=(linear.A.shape[1], columns)), rng.normal(size=(sim.model.nu, columns))
    mass = rng.normal(size=(sim.model.nbody, columns))
    mass[2] = 0.0
    following, reading = sim.jvp(x, u, {"body_mass": mass}, ["subtree_com"])
    expected = linear.A @ x + linear.B @ u + linear.parameters["body_mass"] @ mass
    np.testing.assert_allclose(following, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    expected = linear.C @ x + linear.D @ u + linear.output_parameters["body_mass"] @ mass
    np.testing.assert_allclose(reading, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    # A vector is a direction without a column.
    for column in range(columns):
        parts = sim.jvp(x[:, column], u[:, column], {"body_mass": mass[:, column]}, ["subtree_com"])
        assert parts[0].shape == (len(x),)
        np.testing.assert_allclose(parts[0], following[:, column], rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(parts[1], reading[:, column], rtol=1e-9, atol=1e-12)
    falling, _ = sim.jvp(parameters={"gravity": [0, 0, 1]})
    np.testing.assert_allclose(falling, linear.parameters["gravity"][:, 2], rtol=1e-9, atol=1e-12)
    assert not sim.jvp()[0].any()


@pytest.mark.parametrize("precision", ["64", "32"])
def test_directional_derivatives_of_a_batch(precision: Any) -> None:
    batch = clench.Batch(example("quadruped"), 3, precision=precision, threads=2)
    rng = np.random.default_rng(0)
    batch.qvel[:] = rng.normal(size=batch.qvel.shape)
    linear = batch.linearize(parameters=["gravity"])
    x, u, gravity = (rng.normal(size=(3, n, 2)) for n in (linear.A.shape[2], batch.model.nu, 3))
    following, reading = batch.jvp(x, u, {"gravity": gravity})
    expected = linear.A @ x + linear.B @ u + linear.parameters["gravity"] @ gravity
    np.testing.assert_allclose(following, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    assert reading.shape == (3, linear.C.shape[1], 2)
    assert batch.jvp(x[:, :, 0])[0].shape == following.shape[:2]
    alone = batch.sim(2).jvp(x[2], u[2], {"gravity": gravity[2]})[0]
    np.testing.assert_array_equal(following[2], alone)


def test_gradients_are_products() -> None:
    sim, rng = moving("quadruped", "crouching", 300), np.random.default_rng(1)
    chosen: Any = {"body_mass": [1, 2], "qfrc_applied": [3]}
    linear = sim.linearize(["subtree_com"], chosen)
    x, y = rng.normal(size=linear.A.shape[0]), rng.normal(size=linear.C.shape[0])
    found = sim.vjp(x, y, chosen, ["subtree_com"])
    for gradient, of_state, of_output in (
        (found[0], linear.A, linear.C),
        (found[1], linear.B, linear.D),
        (found[2]["body_mass"], linear.parameters["body_mass"], linear.output_parameters["body_mass"]),
        (found[2]["qfrc_applied"], linear.parameters["qfrc_applied"], linear.output_parameters["qfrc_applied"]),
    ):
        expected = x @ of_state + y @ of_output
        np.testing.assert_allclose(gradient, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    by_state = sim.vjp(x)[0]
    np.testing.assert_allclose(by_state, x @ linear.A, rtol=0, atol=1e-10 * np.abs(by_state).max())
    assert not sim.vjp()[0].any()


@pytest.mark.parametrize("precision", ["64", "32"])
def test_gradients_of_a_batch(precision: Any) -> None:
    batch = clench.Batch(example("quadruped"), 3, precision=precision, threads=2)
    rng = np.random.default_rng(0)
    batch.qvel[:] = rng.normal(size=batch.qvel.shape)
    x = rng.normal(size=(3, 2 * batch.model.nv + batch.model.na))
    by_state, by_control, by_parameters = batch.vjp(x, parameters=["gravity"])
    assert by_state.shape == x.shape and by_control.shape == batch.ctrl.shape
    for env in range(3):
        alone = batch.sim(env).vjp(x[env], parameters=["gravity"])
        np.testing.assert_array_equal(by_state[env], alone[0])
        np.testing.assert_array_equal(by_control[env], alone[1])
        np.testing.assert_array_equal(by_parameters["gravity"][env], alone[2]["gravity"])


def test_a_driven_mass() -> None:
    sim = clench.Sim(
        clench.Model.from_xml(
            "<mujoco><option timestep='0.01'/><worldbody><body><joint name='x' type='slide'/>"
            "<geom size='0.1' mass='2'/></body></worldbody><actuator><motor joint='x'/></actuator></mujoco>"
        )
    )
    sim.ctrl = [3.0]
    linear = sim.linearize(parameters=["body_mass"])
    # v⁺ = v + h u / m, q⁺ = q + h v⁺.
    np.testing.assert_allclose(linear.A, [[1.0, 0.01], [0.0, 1.0]])
    np.testing.assert_allclose(linear.B, [[5e-5], [0.005]])
    np.testing.assert_allclose(linear.parameters["body_mass"][:, 1], [-0.01 * 0.01 * 3.0 / 4.0, -0.01 * 3.0 / 4.0])


def test_applied_forces_are_inputs() -> None:
    sim = clench.Sim(
        clench.Model.from_xml(
            "<mujoco><option timestep='0.01'/><worldbody><body><joint name='x' type='slide'/>"
            "<geom size='0.1' mass='2'/></body></worldbody></mujoco>"
        )
    )
    linear = sim.linearize(parameters={"qfrc_applied": [0], "xfrc_applied": [6, 8]})
    np.testing.assert_allclose(linear.parameters["qfrc_applied"], [[5e-5], [0.005]])
    np.testing.assert_allclose(linear.parameters["xfrc_applied"], [[0.0, 5e-5], [0.0, 0.005]])
    with pytest.raises(IndexError, match="mocap_pos has 0 numbers"):
        sim.linearize(parameters={"mocap_pos": [0]})


def test_delayed_controls_are_in_the_extended_state() -> None:
    text = (
        "<mujoco><option timestep='0.01'/><worldbody><body><joint name='x' type='slide'/><geom size='0.1' mass='2'/>"
        "</body></worldbody><actuator><motor joint='x' nsample='3' delay='0.02'/></actuator></mujoco>"
    )
    batch = clench.Batch(clench.Model.from_xml(text), 2)
    linear = batch.linearize(memory=True)
    size = 2 + batch.history.shape[1]
    assert linear.A.shape == (2, size, size) and linear.B.shape == (2, size, 1)
    assert not linear.B[:, :2].any()
    np.testing.assert_allclose((linear.A @ linear.A @ linear.B)[:, 1, 0], 0.005)


def test_gradients_contain_stick_references() -> None:
    model, options = example("quadruped"), clench.RigidOptions(stiction=True)
    sim, batch = clench.Sim(model, options), clench.Batch(model, 1, options=options)
    sim.step(300)
    batch.qpos[0], batch.stick_references[0] = sim.qpos, sim.stick_references
    batch.qvel[0], batch.qacc_warmstart[0] = sim.qvel, sim.qacc_warmstart
    matrix = sim.linearize(memory=True).A
    gradient = np.random.default_rng(0).normal(size=len(matrix))
    expected = gradient @ matrix
    assert np.abs(expected[2 * model.nv :]).max() > 1.0
    for found in (
        sim.vjp(gradient, memory=True),
        sim.rollout_vjp([sim.ctrl], [gradient], memory=True),
        batch.vjp([gradient], memory=True),
        batch.rollout_vjp([batch.ctrl], [[gradient]], memory=True),
    ):
        np.testing.assert_allclose(np.ravel(found[0]), expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def test_only_a_contact_that_touches_has_derivatives() -> None:
    sim = clench.Sim(ball())
    for height, touches in ((0.1001, False), (0.0999, True)):
        sim.reset()
        sim.qpos[2] = height
        assert (sim.linearize().A[sim.model.nv + 2, 2] != 0.0) == touches


def test_the_state_that_was_written_is_linearized_and_stays() -> None:
    sim, other = moving("quadruped", "crouching", 300), clench.Sim(example("quadruped"), EXACT)
    before = sim.state
    expected = sim.linearize()
    assert sim.state == before
    other.state = before
    found = other.linearize()
    np.testing.assert_array_equal(found.A, expected.A)
    np.testing.assert_array_equal(found.B, expected.B)


def test_environments_of_a_batch() -> None:
    batch = clench.Batch(example("quadruped"), 3, threads=2)
    batch.qvel[:] = np.random.default_rng(0).normal(size=batch.qvel.shape)
    stacked = batch.linearize(["subtree_com"], {"body_mass": [1]})
    assert len(stacked.switching) == 3
    for env in range(3):
        alone = batch.sim(env).linearize(["subtree_com"], {"body_mass": [1]})
        for name in "ABCD":
            np.testing.assert_array_equal(getattr(stacked, name)[env], getattr(alone, name))
        np.testing.assert_array_equal(stacked.parameters["body_mass"][env], alone.parameters["body_mass"])


def test_each_constraint_row_has_its_distance_from_a_switch() -> None:
    sim = moving("quadruped", "crouching", 300)
    switching = sim.linearize().switching
    sim.forward()
    assert switching.shape == (len(sim.constraints),)
    assert (switching >= 0.0).all()


@pytest.mark.parametrize("cone", ["pyramidal", "elliptic"])
def test_errors_of_a_coarse_solve_are_within_their_bounds(cone: Any) -> None:
    exact = moving("quadruped", "crouching", 300)
    state, rows = exact.state, slice(-exact.model.nv, None)
    state.qacc_warmstart = np.zeros(exact.model.nv)
    coarse: dict[str, Any] = {"constraint_solver": "CG", "tolerance": 1e-2, "friction_cone": cone}
    precise: dict[str, Any] = {"tolerance": 0, "iterations": 200, "friction_cone": cone}
    found: list[Any] = []
    expected: list[Any] = []
    for options, kept in ((coarse, found), (precise, expected)):
        sim = clench.Sim(exact.model, clench.RigidOptions(**options))
        sim.state = state
        linear = sim.linearize(["qacc"], {"gravity": [2]}, errors=True)
        by_gravity = linear.output_parameters["gravity"]
        kept += [linear, np.hstack([linear.C, linear.D, by_gravity])[rows], np.array(sim.output("qacc"))]
    bound, scale = found[0].error, np.abs(expected[1]).max()
    difference = np.abs(found[1] - expected[1])
    assert bound.shape == difference.shape and difference.max() > 1e-6 * scale
    assert (difference <= bound + 1e-10 * scale).all()
    assert (np.abs(found[2] - expected[2]) <= found[0].qacc_error).all()
    assert found[0].reach.shape == found[0].switching.shape
    assert expected[0].error.max() < 1e-10 * scale and bound.max() < 1e3 * difference.max()


def test_bounds_are_stacked_on_demand() -> None:
    batch = clench.Batch(example("quadruped"), 3)
    linear = batch.linearize(errors=True)
    assert linear.error is not None and linear.qacc_error is not None
    nv, columns = batch.model.nv, linear.A.shape[2] + linear.B.shape[2]
    assert linear.error.shape == (3, nv, columns) and linear.qacc_error.shape == (3, nv) and len(linear.reach) == 3
    linear = batch.linearize()
    assert linear.error is None and linear.qacc_error is None and linear.reach is None


def test_single_precision() -> None:
    single, double = (clench.Sim(ball(), precision=bits) for bits in ("32", "64"))
    np.testing.assert_allclose(single.linearize().A, double.linearize().A, rtol=1e-6)
    batch = clench.Batch(example("quadruped"), 3, precision="32", threads=2)
    batch.qvel[:] = np.random.default_rng(0).normal(size=batch.qvel.shape)
    batch.randomize("body_mass", np.linspace(0.9, 1.1, 3)[:, None] * batch.param("body_mass"))
    stacked = batch.linearize(["subtree_com"], {"body_mass": [1]})
    for env in range(3):
        alone = batch.sim(env).linearize(["subtree_com"], {"body_mass": [1]})
        for name in "ABCD":
            np.testing.assert_array_equal(getattr(stacked, name)[env], getattr(alone, name))


def test_invalid_requests() -> None:
    sim = clench.Sim(ball())
    with pytest.raises(ValueError, match="body_mass"):
        sim.linearize(parameters=["body_mas"])
    with pytest.raises(ValueError, match="body_subtreemass"):
        sim.linearize(parameters=["body_subtreemass"])
    with pytest.raises(ValueError, match="xpos"):
        sim.linearize(["xposs"])
    with pytest.raises(IndexError, match="body_mass has 2 numbers"):
        sim.linearize(parameters={"body_mass": [2]})
    with pytest.raises(ValueError, match=r"x has shape \(2,\), but must have \(12,\)"):
        sim.jvp([0, 1])
    with pytest.raises(ValueError, match=r"gravity has shape \(3,\), but must have \(3, 2\)"):
        sim.jvp(np.zeros((12, 2)), parameters={"gravity": [0, 0, 1]})
    with pytest.raises(ValueError, match="x is not finite"):
        sim.jvp(np.full(12, np.nan))
    with pytest.raises(ValueError, match="body_subtreemass"):
        sim.jvp(parameters={"body_subtreemass": [0, 1]})
    with pytest.raises(ValueError, match=r"x has shape \(2,\), but must have \(12,\)"):
        sim.vjp([0, 1])
    with pytest.raises(ValueError, match="x is not finite"):
        sim.vjp(np.full(12, np.inf))
    sim.qvel[0] = np.nan
    with pytest.raises(clench.SimulationError):
        sim.linearize()
    with pytest.raises(clench.SimulationError):
        sim.jvp()
