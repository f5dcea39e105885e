"""`clench.Sim`: one environment."""

from __future__ import annotations

from typing import Any, cast

import clench
import numpy as np
import pytest
from numpy.typing import NDArray
from scenes import FIELDS, ROOT, ball, example, puppet, same_bits, same_state


def outputs(sim: clench.Sim) -> dict[str, NDArray[Any]]:
    return {name: np.array(sim.output(name)) for name in clench.OUTPUTS}


def driven(sim: clench.Sim, steps: int, seed: int = 0) -> None:
    """Steps with a new random control each time."""
    rng = np.random.default_rng(seed)
    for _ in range(steps):
        sim.ctrl[:] = rng.uniform(-1, 1, sim.ctrl.shape)
        sim.step()


@pytest.mark.parametrize("name", ["quadruped", "humanoid"])
def test_moves_as_mujoco(name: str) -> None:
    mujoco = pytest.importorskip("mujoco")
    exact = clench.RigidOptions(tolerance=0, iterations=200, ls_iterations=200, ls_tolerance=1e-10)
    model = example(name)
    sim = clench.Sim(model, exact)
    theirs = mujoco.MjModel.from_xml_path(str(ROOT / "models" / f"{name}.xml"))
    theirs.opt.tolerance, theirs.opt.iterations = 0, 200
    theirs.opt.ls_tolerance, theirs.opt.ls_iterations = 1e-10, 200
    data = mujoco.MjData(theirs)
    rng = np.random.default_rng(1)
    for _ in range(50):
        data.ctrl[:] = sim.ctrl[:] = rng.uniform(-0.3, 0.3, model.nu)
        mujoco.mj_step(theirs, data)
        sim.step()
        scale = 1 + np.abs(data.qvel)
        np.testing.assert_array_less(np.abs(sim.qvel - data.qvel) / scale, 1e-7)
        np.testing.assert_array_less(np.abs(sim.qpos - data.qpos), 1e-8)
    assert sim.time == pytest.approx(data.time, abs=1e-12)
    np.testing.assert_allclose(sim.xpos, data.xpos, atol=1e-8)
    np.testing.assert_allclose(sim.cvel, data.cvel, atol=1e-6)
    assert len(sim.contacts) == data.ncon


def test_state_arrays_are_the_state() -> None:
    model = puppet()
    sim = clench.Sim(model)
    shapes = {
        "qpos": (model.nq,),
        "qvel": (model.nv,),
        "act": (model.na,),
        "history": (model.nhistory,),
        "ctrl": (model.nu,),
        "qfrc_applied": (model.nv,),
        "xfrc_applied": (model.nbody, 6),
        "mocap_pos": (model.nmocap, 3),
        "mocap_quat": (model.nmocap, 4),
        "eq_active": (model.neq,),
        "qacc_warmstart": (model.nv,),
    }
    for name, shape in shapes.items():
        array = getattr(sim, name)
        assert array.shape == shape, name
        assert array.dtype == (bool if name == "eq_active" else np.float64), name
        assert array is getattr(sim, name), name
        assert array.flags.writeable and array.flags.c_contiguous and not array.flags.owndata, name
    assert min(min(shape) for shape in shapes.values()) > 0
    np.testing.assert_array_equal(sim.qpos, model.qpos0)
    np.testing.assert_array_equal(sim.eq_active, [True, False])
    np.testing.assert_array_equal(sim.mocap_pos, [[0, 0, 1.2]])
    np.testing.assert_array_equal(sim.mocap_quat, [[1, 0, 0, 0]])


def test_writes_take_effect_and_steps_show() -> None:
    sim = clench.Sim(example("pendulum"))
    qpos, qvel = sim.qpos, sim.qvel
    qpos[0], qvel[0] = 0.3, 2.0
    sim.step()
    assert qvel[0] != 2.0
    assert qpos[0] == pytest.approx(0.3 + qvel[0] * sim.model.timestep, abs=1e-15)

    pushed, free = clench.Sim(example("pendulum")), clench.Sim(example("pendulum"))
    pushed.ctrl = [4.0]
    pushed.step()
    free.qfrc_applied = [4.0]
    free.step()
    assert pushed.qvel[0] == free.qvel[0] != 0


def test_forces_on_bodies_act_at_their_centres() -> None:
    sim = clench.Sim(ball())
    sim.qpos[2] = 1.0
    sim.xfrc_applied[1] = [1, 2, 3, 0, 0, 0]
    sim.forward()
    np.testing.assert_allclose(sim.qacc, [0.5, 1, 1.5 - 9.81, 0, 0, 0], atol=1e-12)


@pytest.mark.parametrize("precision", ["64", "32"])
def test_assignment_copies(precision: Any) -> None:
    sim = clench.Sim(example("quadruped"), precision=precision)
    array, values = sim.ctrl, np.linspace(-0.5, 0.5, 12)
    sim.ctrl = values
    values[:] = 0
    assert sim.ctrl is array
    np.testing.assert_array_equal(array, np.linspace(-0.5, 0.5, 12).astype(array.dtype))
    sim.ctrl = 0.25
    assert (array == array.dtype.type(0.25)).all()
    sim.ctrl = range(12)
    np.testing.assert_array_equal(array, range(12))
    sim.ctrl = array[::-1]
    np.testing.assert_array_equal(array, range(11, -1, -1))


@pytest.mark.parametrize(
    ("name", "values", "error"),
    [
        ("qpos", np.zeros(3), ValueError),
        ("qpos", np.zeros((2, 19)), ValueError),
        ("qpos", [[1, 2], [3]], ValueError),
        ("qvel", np.zeros(18, complex), TypeError),
        ("ctrl", "left", TypeError),
        ("ctrl", None, TypeError),
        ("ctrl", [object()] * 12, TypeError),
        ("xfrc_applied", np.zeros((14, 5)), ValueError),
        ("time", "now", TypeError),
        ("time", [1.0, 2.0], ValueError),
    ],
)
def test_assignments_that_make_no_sense(name: str, values: Any, error: type[Exception]) -> None:
    sim = clench.Sim(example("quadruped"))
    before = sim.state
    with pytest.raises(error):
        setattr(sim, name, values)
    assert same_state(sim.state, before)


def test_switches_take_nothing_but_booleans_and_integers() -> None:
    sim = clench.Sim(puppet())
    with pytest.raises(TypeError):
        sim.eq_active = [0.5, 0.5]
    sim.eq_active = [False, True]
    np.testing.assert_array_equal(sim.eq_active, [False, True])
    sim.eq_active = np.array([1, 0], np.uint8)
    np.testing.assert_array_equal(sim.eq_active, [True, False])


@pytest.mark.parametrize("name", ["qpos", "time", "model", "contacts", "xpos", "solver_stats", "nonsense"])
def test_attributes_stay(name: str) -> None:
    sim = clench.Sim(ball())
    with pytest.raises((AttributeError, TypeError)):
        delattr(sim, name)
    if name not in ("qpos", "time"):
        with pytest.raises(AttributeError):
            setattr(sim, name, 1)


def test_time_is_a_number() -> None:
    sim = clench.Sim(ball())
    sim.step(7)
    assert isinstance(sim.time, float)
    assert sim.time == pytest.approx(7 * sim.model.timestep)
    sim.time = 3
    sim.step()
    assert sim.time == pytest.approx(3 + sim.model.timestep)


def test_many_steps_are_steps() -> None:
    one, all_at_once = clench.Sim(example("humanoid")), clench.Sim(example("humanoid"))
    for sim in (one, all_at_once):
        sim.reset("falling")
    for _ in range(300):
        one.step()
    all_at_once.step(300)
    assert same_state(one.state, all_at_once.state)
    assert len(one.contacts) > 0
    for name, values in outputs(one).items():
        assert same_bits(values, np.array(all_at_once.output(name))), name


def test_no_steps_change_nothing() -> None:
    sim = clench.Sim(example("quadruped"))
    driven(sim, 5)
    before = sim.state
    sim.step(0)
    assert same_state(sim.state, before)


@pytest.mark.parametrize("n", [-1, 1.0, "2", None, 2**64, -(2**70)])
def test_counts_that_make_no_sense(n: Any) -> None:
    sim = clench.Sim(ball())
    with pytest.raises((TypeError, ValueError)):
        sim.step(n)
    assert sim.time == 0


def test_outputs_by_name_and_attribute() -> None:
    sim = clench.Sim(puppet())
    sim.reset("bent")
    driven(sim, 20)
    live = set(FIELDS)
    for name in clench.OUTPUTS:
        output = sim.output(name)
        assert name in dir(sim)
        if name in live:
            np.testing.assert_array_equal(output, getattr(sim, name))
            continue
        assert np.array_equal(output, getattr(sim, name)), name
        if np.ndim(output):
            assert not output.flags.writeable, name
    model = sim.model
    assert sim.xpos.shape == (model.nbody, 3)
    assert sim.cinert.shape == (model.nbody, 10)
    assert sim.ten_length.shape == (model.ntendon,)
    assert isinstance(sim.contact_count, float)


def test_outputs_are_copies() -> None:
    sim = clench.Sim(ball())
    sim.step()
    before = sim.xpos
    kept = before.copy()
    sim.qpos[0] = 3
    sim.step()
    np.testing.assert_array_equal(before, kept)
    assert sim.xpos[1, 0] == 3


def test_outputs_that_there_are_not() -> None:
    sim = clench.Sim(ball())
    with pytest.raises(ValueError, match="xpos"):
        sim.output("xposs")
    with pytest.raises(AttributeError):
        getattr(sim, "xposs")
    assert not hasattr(sim, "eq_")


def test_forward_leaves_the_state() -> None:
    sim = clench.Sim(example("humanoid"))
    sim.reset("crouched")
    sim.step(50)
    sim.qvel += 0.1
    before = sim.state
    sim.forward()
    first = outputs(sim)
    sim.forward()
    assert same_state(sim.state, before)
    for name, values in outputs(sim).items():
        assert same_bits(values, first[name]), name
    # The equation of motion.
    force = sim.mass_matrix() @ sim.qacc
    np.testing.assert_allclose(force, sim.qfrc_smooth + sim.qfrc_constraint, atol=1e-6 * np.abs(force).max())


def test_mass_matrix() -> None:
    sim = clench.Sim(example("quadruped"))
    sim.forward()
    mass = sim.mass_matrix()
    assert mass.shape == (18, 18) and mass.dtype == np.float64
    np.testing.assert_array_equal(mass, mass.T)
    total = sim.model.body_mass.sum()
    np.testing.assert_allclose(np.diag(mass)[:3], total)
    sim.qvel = np.linspace(-1, 1, 18)
    assert sim.energy[1] == pytest.approx(0.5 * sim.qvel @ mass @ sim.qvel)
    assert np.linalg.eigvalsh(mass).min() > 0


def test_solver_stats() -> None:
    sim = clench.Sim(example("box_stack"))
    sim.step(100)
    stats = sim.solver_stats
    assert stats.status in ("converged", "proven", "no_progress")
    assert isinstance(stats.iterations, int) and isinstance(stats.gradient, float)
    assert stats.gap >= 0 and stats.gradient < 1e-6
    assert f"status='{stats.status}'" in repr(stats)
    limited = clench.Sim(example("box_stack"), clench.RigidOptions(iterations=1, tolerance=0, warmstart=False))
    limited.reset("struck")
    limited.step()
    assert (limited.solver_stats.status, limited.solver_stats.iterations) == ("iteration_limit", 1)
    free = clench.Sim(example("pendulum"), clench.RigidOptions(disable_constraint=True))
    free.step()
    assert free.solver_stats.status == "unconstrained"


def test_contact_overflow() -> None:
    sim = clench.Sim(example("box_stack"), clench.RigidOptions(max_contacts=3))
    sim.step()
    assert sim.contact_overflow and len(sim.contacts) == 3
    enough = clench.Sim(example("box_stack"), clench.RigidOptions(max_contacts=100))
    enough.step()
    assert not enough.contact_overflow


def test_equalities_switch() -> None:
    sim = clench.Sim(example("toggled_weld"))
    sim.reset("lifting")
    sim.step(500)
    assert sim.qpos[4] < 0.11
    sim.reset("touching")
    sim.set_equality("grip", True)
    np.testing.assert_array_equal(sim.eq_active, [True])
    sim.ctrl = [0.5, 0]
    sim.step(500)
    assert sim.qpos[4] > 0.3
    sim.set_equality(0, False)
    sim.step(500)
    assert sim.qpos[4] < 0.11
    with pytest.raises(ValueError, match="grip"):
        sim.set_equality("grap", True)
    with pytest.raises(IndexError):
        sim.set_equality(1, True)
    with pytest.raises(TypeError):
        sim.set_equality("grip", cast(bool, "yes"))


def test_reset_and_keyframes() -> None:
    sim = clench.Sim(puppet())
    initial = sim.state
    sim.reset("bent")
    np.testing.assert_allclose(sim.qpos[-2:], [0.3, -0.4])
    np.testing.assert_array_equal(sim.act, [0.5])
    np.testing.assert_array_equal(sim.ctrl, [0.2, -0.3])
    np.testing.assert_array_equal(sim.mocap_pos, [[0.1, 0, 1.3]])
    assert sim.time == 1
    bent = sim.state
    sim.xfrc_applied[1, 2] = 5
    sim.eq_active[:] = False
    sim.step(10)
    sim.reset(0)
    assert same_state(sim.state, bent)
    sim.reset()
    assert same_state(sim.state, initial)
    cases: list[tuple[Any, type[Exception]]] = [("bend", ValueError), (1, IndexError), (-1, IndexError), (1.5, TypeError)]
    for bad, error in cases:
        with pytest.raises(error):
            sim.reset(bad)
    assert same_state(sim.state, initial)


def test_single_precision() -> None:
    single, double = clench.Sim(example("quadruped"), precision="32"), clench.Sim(example("quadruped"))
    assert (single.precision, double.precision) == ("32", "64")
    for name in FIELDS:
        if name not in ("eq_active", "tree_asleep", "time", "dynamic_kind", "dynamic_body1", "dynamic_body2", "dynamic_serial"):
            assert getattr(single, name).dtype == np.float32, name
    for sim in (single, double):
        sim.reset("crouching")
        sim.step(50)
    assert single.xpos.dtype == single.output("qpos").dtype == np.float32
    assert single.contacts.force.dtype == single.mass_matrix().dtype == np.float64
    np.testing.assert_allclose(single.qpos, double.qpos, atol=1e-4)
    cases: list[tuple[Any, type[Exception]]] = [("16", ValueError), (64, TypeError), (None, TypeError)]
    for bad, error in cases:
        with pytest.raises(error):
            clench.Sim(ball(), precision=bad)


def test_queries_see_the_present_where_nothing_is_known() -> None:
    new, forwarded = (clench.Sim(example("quadruped")) for _ in range(2))
    forwarded.forward()
    np.testing.assert_array_equal(new.mass_matrix(), forwarded.mass_matrix())
    for name in clench.OUTPUTS:
        new = clench.Sim(example("quadruped"))
        assert same_bits(new.output(name), forwarded.output(name)), name
    assert len(clench.Sim(example("box_stack")).contacts) > 0
    # After a step outputs are those of its start; after a write they take it into account.
    new.step(2)
    before = new.qpos.copy()
    new.step()
    np.testing.assert_array_equal(new.xpos[1], before[:3])
    new.ctrl[0] = 0.1
    np.testing.assert_array_equal(new.xpos[1], before[:3])
    new.qpos[2] = 7
    np.testing.assert_array_equal(new.xpos[1], new.qpos[:3])
    new.reset()
    np.testing.assert_array_equal(new.xpos[1], new.qpos[:3])


def test_what_it_is_made_of() -> None:
    model, options = ball(), clench.RigidOptions(iterations=7)
    sim = clench.Sim(model, options)
    assert sim.model is model
    assert sim.options == options
    assert repr(sim) == '<clench.Sim of "ball", 64 bits>'
    wrong: list[Any] = [{}, {"iterations": 7}, 7, "auto"]
    for bad in wrong:
        with pytest.raises(TypeError):
            clench.Sim(model, bad)
        with pytest.raises(TypeError):
            clench.Sim(bad)
