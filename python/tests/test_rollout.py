"""`Batch.rollout`: many steps in one call, recorded."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import clench
import numpy as np
import pytest
from numpy.typing import NDArray
from scenes import FIELDS, ball, example, puppet, same_bits, same_state

STEPS = 40


def start(batch: clench.Batch) -> NDArray[Any]:
    """Returns a state for each environment (n, 1 + nq + nv + na)."""
    rng = np.random.default_rng(5)
    n = batch.n_envs
    qvel = batch.qvel + rng.normal(0, 0.5, batch.qvel.shape)
    return np.hstack([rng.random((n, 1)), batch.qpos, qvel, np.full_like(batch.act, 0.3)])


def begin(batch: clench.Batch, initial: NDArray[Any]) -> None:
    """Sets the state of environments through their fields."""
    nq, nv = batch.model.nq, batch.model.nv
    batch.time = initial[:, 0].astype(batch.qpos.dtype)  # A rollout rounds it too.
    batch.qpos = initial[:, 1 : 1 + nq]
    batch.qvel = initial[:, 1 + nq : 1 + nq + nv]
    batch.act = initial[:, 1 + nq + nv :]
    batch.qacc_warmstart = 0
    batch.revive()


@pytest.mark.parametrize("precision", ["64", "32"])
@pytest.mark.parametrize("controls", ["held", "shared", "each"])
@pytest.mark.parametrize("make", [lambda: example("quadruped"), puppet], ids=["quadruped", "puppet"])
def test_as_stepping_by_hand(make: Callable[[], Any], controls: str, precision: Any) -> None:
    record = [name for name in clench.OUTPUTS if name != "energy"]
    batch, hand = (clench.Batch(make(), 5, precision, 2, record=record) for _ in range(2))
    rng, nu = np.random.default_rng(6), batch.model.nu
    batch.ctrl = hand.ctrl = rng.uniform(-0.2, 0.2, (5, nu))
    held = batch.ctrl.copy()
    shapes = {"held": None, "shared": (STEPS, nu), "each": (5, STEPS, nu)}
    shape = shapes[controls]
    ctrl = None if shape is None else rng.uniform(-0.5, 0.5, shape)
    initial = start(batch)
    recorded = batch.rollout(initial, ctrl, record, STEPS)
    assert list(recorded) == record

    begin(hand, initial)
    for step in range(STEPS):
        if ctrl is not None:
            hand.ctrl = ctrl[step] if controls == "shared" else ctrl[:, step]
        assert hand.step() == 0
        for name in record:
            assert same_bits(recorded[name][:, step], hand.output(name)), (name, step)
    for name in FIELDS:
        if name != "ctrl":
            assert same_bits(getattr(batch, name), getattr(hand, name)), name
    np.testing.assert_array_equal(batch.ctrl, held)
    for name in record:
        assert same_bits(batch.output(name), hand.output(name)), name
    for name, values in recorded.items():
        assert values.shape[:2] == (5, STEPS) and values.dtype == batch.qpos.dtype, name
        assert values.flags.writeable and values.flags.c_contiguous, name


def test_goes_on_from_where_environments_are() -> None:
    batch, other = clench.Batch(example("quadruped"), 3), clench.Batch(example("quadruped"), 3)
    batch.step(7)
    first = batch.rollout(steps=10)
    assert set(first) == {"qpos", "qvel"}
    second = batch.rollout(ctrl=np.zeros((5, 12)), record=["qpos"])
    other.step(7)
    both = other.rollout(steps=15)["qpos"]
    np.testing.assert_array_equal(np.concatenate([first["qpos"], second["qpos"]], axis=1), both)
    np.testing.assert_array_equal(both[:, -1], other.qpos)


def test_initial_states_make_earlier_steps_forgotten() -> None:
    fresh, used = clench.Batch(example("humanoid"), 2), clench.Batch(example("humanoid"), 2)
    used.step(50)
    used.qvel[0] = np.nan
    used.step()
    initial = start(fresh)
    a, b = fresh.rollout(initial, steps=20), used.rollout(initial, steps=20)
    for name in ("qpos", "qvel"):
        assert same_bits(a[name], b[name])
    assert used.running.all()


def test_failed_environments_record_nothing() -> None:
    batch = clench.Batch(ball(), 3)
    batch.qvel[1, 0] = np.nan
    batch.step()
    recorded = batch.rollout(steps=4, record=["qpos", "contact_count"])
    assert np.isnan(recorded["qpos"][1]).all() and np.isnan(recorded["contact_count"][1]).all()
    assert np.isfinite(recorded["qpos"][[0, 2]]).all()

    ctrl = np.zeros((3, 6, 12))
    ctrl[1, 2, 0] = np.nan
    batch = clench.Batch(example("quadruped"), 3)
    qpos = batch.rollout(ctrl=ctrl)["qpos"]
    assert np.isfinite(qpos[[0, 2]]).all() and np.isfinite(qpos[1, :2]).all()
    assert np.isnan(qpos[1, 2:]).all()
    np.testing.assert_array_equal(batch.running, [True, False, True])
    np.testing.assert_array_equal(batch.qpos[1], qpos[1, 1])


def test_what_is_recorded_lives_on() -> None:
    batch = clench.Batch(ball(), 3)
    first = batch.rollout(steps=5)["qpos"]
    kept = first.copy()
    batch.rollout(steps=5)
    np.testing.assert_array_equal(first, kept)
    del batch
    np.testing.assert_array_equal(first, kept)
    first[:] = 0


def test_nothing_to_do() -> None:
    batch = clench.Batch(example("quadruped"), 2)
    before = batch.state
    assert batch.rollout(steps=0)["qpos"].shape == (2, 0, 19)
    assert batch.rollout(ctrl=np.zeros((0, 12)))["qpos"].shape == (2, 0, 19)
    assert same_state(batch.state, before)
    assert batch.rollout(steps=3, record=[]) == {}
    assert (batch.time > 0).all()


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        ({}, ValueError),
        ({"steps": -1}, ValueError),
        ({"steps": 1.0}, TypeError),
        ({"steps": 2**50}, MemoryError),
        ({"steps": 2**64}, ValueError),
        ({"ctrl": np.zeros(12)}, ValueError),
        ({"ctrl": np.zeros((4, 11))}, ValueError),
        ({"ctrl": np.zeros((3, 4, 12))}, ValueError),
        ({"ctrl": np.zeros((2, 4, 12)), "steps": 5}, ValueError),
        ({"ctrl": np.zeros((2, 4, 12, 1))}, ValueError),
        ({"ctrl": "left"}, TypeError),
        ({"ctrl": np.zeros((4, 12), complex)}, TypeError),
        ({"initial": np.zeros((2, 37)), "steps": 2}, ValueError),
        ({"initial": np.zeros(37), "steps": 2}, ValueError),
        ({"initial": [[None] * 38] * 2, "steps": 2}, TypeError),
        ({"record": ["qpso"], "steps": 2}, ValueError),
        ({"record": "qpos", "steps": 2}, TypeError),
        ({"record": 3, "steps": 2}, TypeError),
    ],
)
def test_rollouts_that_make_no_sense(arguments: Any, error: type[Exception]) -> None:
    batch = clench.Batch(example("quadruped"), 2)
    batch.step(3)
    before = batch.state
    with pytest.raises(error):
        batch.rollout(**arguments)
    assert same_state(batch.state, before)


def test_controls_may_come_in_any_form() -> None:
    expected = clench.Batch(example("quadruped"), 2).rollout(ctrl=np.full((3, 12), 0.25))["qpos"]
    forms: list[Any] = [
        np.full((3, 12), 0.25, np.float32),
        np.full((3, 12), 0.25, ">f8"),
        np.full((12, 3), 0.25).T,
        np.full((6, 24), 0.25)[::2, ::2],
        [[0.25] * 12] * 3,
        np.broadcast_to(0.25, (3, 12)),
        np.frombuffer(b"\0" + np.full((3, 12), 0.25).tobytes(), np.uint8)[1:].view(np.float64).reshape(3, 12),
    ]
    for form in forms:
        np.testing.assert_array_equal(clench.Batch(example("quadruped"), 2).rollout(ctrl=form)["qpos"], expected)


def test_controls_are_those_of_the_call() -> None:
    """Other threads run meanwhile, and may reuse the input arrays."""
    steps, n = 20_000, 4

    def make() -> clench.Batch:
        return clench.Batch(example("quadruped"), n, threads=1)

    initial, ctrl = start(make()), np.zeros((steps, 12))
    expected = make().rollout(initial, ctrl, ["qpos"])["qpos"][:, -1]
    batch = make()
    found: dict[str, NDArray[Any]] = {}
    given, states = ctrl.copy(), initial.copy()
    thread = threading.Thread(target=lambda: found.update(batch.rollout(states, given, ["qpos"])))
    thread.start()
    while True:
        try:
            batch.status  # noqa: B018
        except clench.BusyError:
            break
        assert thread.is_alive(), "the rollout is over too soon"
    given[:] = 0.4
    states[:] = 0.0
    assert thread.is_alive(), "the rollout is over too soon"
    thread.join()
    np.testing.assert_array_equal(found["qpos"][:, -1], expected)


@pytest.mark.parametrize("shared", [True, False], ids=["shared", "each"])
def test_a_function_gives_the_controls_of_each_step(shared: bool) -> None:
    batch, hand = (clench.Batch(example("humanoid"), 3) for _ in range(2))
    initial = start(batch)
    times: list[Any] = []
    given: list[Any] = []

    def policy(step: int) -> Any:
        assert step == len(times)
        times.append(batch.time.copy())
        ctrl = -0.2 * batch.qvel[:, 6:] if not shared else np.full(batch.model.nu, 0.1 * np.sin(batch.qpos[0, 2]))
        given.append(np.broadcast_to(batch.ctrl if step == 4 else ctrl, batch.ctrl.shape))
        return None if step == 4 else ctrl

    rows = batch.rollout(initial, policy, ["qpos", "qacc"], 10)
    np.testing.assert_array_equal(times[0], initial[:, 0])
    again = hand.rollout(initial, np.stack(given, axis=1), ["qpos", "qacc"])
    for name, array in rows.items():
        assert np.isfinite(array).all()
        np.testing.assert_array_equal(array, again[name])


def test_a_function_needs_steps_and_may_fail() -> None:
    batch = clench.Batch(example("humanoid"), 2)
    with pytest.raises(ValueError, match="needs steps"):
        batch.rollout(ctrl=lambda _: None)
    with pytest.raises(ValueError, match="ctrl"):
        batch.rollout(ctrl=lambda _: np.zeros(3), steps=2)
    with pytest.raises(ValueError, match="ctrl has shape"):
        batch.rollout(ctrl=lambda _: 0.3, steps=2)

    def fails(step: int) -> None:
        raise ArithmeticError(step)

    with pytest.raises(ArithmeticError):
        batch.rollout(ctrl=fails, steps=2)
    assert batch.step() == 0


@pytest.mark.parametrize("ctrl", [None, lambda _: None], ids=["held", "function"])
def test_progress_is_reported(ctrl: Any, capsys: pytest.CaptureFixture[str]) -> None:
    batch = clench.Batch(ball(), 2)
    reported: list[tuple[int, int]] = []
    batch.rollout(None, ctrl, [], 10_000, progress=lambda done, steps: reported.append((done, steps)))
    assert len(reported) > 2
    assert reported == sorted(reported)
    assert reported[-1] == (10_000, 10_000)
    batch.rollout(None, ctrl, [], 100, progress=True)
    line = capsys.readouterr().err
    assert line.startswith("\rrollout: 100 of 100 steps")
    assert line.endswith("environment steps/s\n")
    batch.rollout(None, ctrl, [], 100, progress=False)
    assert capsys.readouterr().err == ""

    def stop(done: int, steps: int) -> None:
        raise ArithmeticError

    with pytest.raises(ArithmeticError):
        batch.rollout(None, ctrl, [], 10_000, progress=stop)
    with pytest.raises(TypeError, match="progress must be"):
        batch.rollout(None, ctrl, [], 1, progress="yes")  # type: ignore[arg-type]
