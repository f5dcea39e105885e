"""Custom tasks."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ResetNeeded
from gymnasium.spaces import Box
from numpy.typing import NDArray
from tasks_of_tests import CART, Cart

from clench import Model, Sim, State
from clench.gymnasium import BatchEnv


class Short(BatchEnv):
    frame_skip = 2

    def observe(self) -> Any:
        return self.batch.qpos

    def reward(self, action: Any) -> Any:
        return self.batch.qvel[:, 0]


def test_ten_lines() -> None:
    """A model and two methods are enough."""
    envs = Short(num_envs=3, model=CART)
    assert envs.single_observation_space == Box(-np.inf, np.inf, (2,), np.float64)
    assert envs.observation_space.shape == (3, 2)
    assert envs.action_space.shape == (3, 2)
    assert envs.dt == 0.02
    observations, infos = envs.reset(seed=0)
    assert infos == {}
    np.testing.assert_array_equal(observations, np.zeros((3, 2)))
    observations, rewards, terminations, truncations, infos = envs.step(np.tile([1.0, 0.0], (3, 1)))
    assert (rewards > 0).all() and not terminations.any() and not truncations.any()


def test_ways_to_say_the_model(tmp_path: Path) -> None:
    path = tmp_path / "cart.xml"
    path.write_text(CART)
    actions = np.ones((2, 2))
    results = []
    for model in (CART, "  \n" + CART, path, str(path), Model.from_xml(CART)):
        envs = Short(2, model=model)
        envs.reset(seed=0)
        results.append(envs.step(actions)[0])
    for result in results[1:]:
        np.testing.assert_array_equal(result, results[0])
    with pytest.raises(TypeError, match="Short needs a model"):
        Short(2)


def test_models_change_from_episode_to_episode() -> None:
    """Each environment starts in the initial state of its own model, which the task chooses."""
    carts = [CART, CART.replace("<worldbody>", '<worldbody><geom type="box" size=".1 .1 .1" pos="9 0 0"/>', 1)]

    class Varied(Short):
        model = carts
        max_episode_steps = 2

        def choose_models(self, envs: NDArray[np.intp]) -> Any:
            return [self.generator(env).integers(2) for env in envs.tolist()]

    envs = Varied(40)
    envs.reset(seed=0)
    first = envs.batch.env_model
    assert 5 < first.sum() < 35
    for _ in range(3):
        envs.step(np.zeros((40, 2)))
    assert (envs.batch.env_model != first).any()
    np.testing.assert_array_equal(envs.batch.sim(0).model.ngeom, envs.batch.models[envs.batch.env_model[0]].ngeom)
    kept = Short(3, model=carts)
    kept.reset(seed=0)
    assert kept.batch.env_model.tolist() == [0, 1, 0]


def test_action_space() -> None:
    """The action space has the ranges of the controls, and no bounds for controls without range."""
    space = Cart(2).single_action_space
    assert isinstance(space, Box)
    np.testing.assert_array_equal(space.low, np.array([-3.0, -np.inf], dtype=np.float32))
    np.testing.assert_array_equal(space.high, np.array([3.0, np.inf], dtype=np.float32))


def test_nothing_is_shared() -> None:
    """Results of a step do not change later, even if observe() and info() return views."""

    class Views(Short):
        def info(self) -> Any:
            return {"qvel": self.batch.qvel}

    envs = Views(2, model=CART)
    envs.reset(seed=0)
    first = envs.step(np.ones((2, 2)))
    kept = first[0].copy(), first[1].copy(), first[4]["qvel"].copy()
    envs.step(np.ones((2, 2)))
    envs.reset()
    for now, then in zip((first[0], first[1], first[4]["qvel"]), kept, strict=True):
        np.testing.assert_array_equal(now, then)


def test_attributes_and_arguments() -> None:
    """Arguments of an environment override class attributes and do not change the class."""
    assert Cart(1).frame_skip == 2
    assert Cart(1, frame_skip=5).frame_skip == 5
    assert Cart.frame_skip == 2
    assert Cart(1, outputs=("xpos", "energy")).batch.energy.shape == (1, 2)
    assert Cart(2, precision="32").reset(seed=0)[0].dtype == np.float32


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"num_envs": 0}, "num_envs must be at least 1"),
        ({"num_envs": -3}, "num_envs must be at least 1"),
        ({"frame_skip": 0}, "frame_skip must be at least 1"),
        ({"max_episode_steps": 0}, "max_episode_steps must be at least 1"),
        ({"outputs": ("xpso",)}, "xpos"),
        ({"precision": "16"}, "precision"),
        ({"threads": 0}, "threads"),
        ({"autoreset_mode": "never"}, "never"),
        ({"model": "<mujoco"}, "XML"),
        ({"model": "no_such_file.xml"}, "no_such_file.xml"),
    ],
)
def test_wrong_arguments(wrong: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Cart(**wrong)


def test_truncation() -> None:
    envs = Short(3, model=CART, max_episode_steps=4)
    envs.reset(seed=0)
    envs.reset(options={"reset_mask": np.array([True, False, False])})
    ends = np.array([envs.step(np.zeros((3, 2)))[3] for _ in range(9)])
    np.testing.assert_array_equal(np.flatnonzero(ends[:, 0]), [3, 8])
    for unlimited in (None, -1):
        envs = Short(1, model=CART, max_episode_steps=unlimited)
        envs.reset()
        assert not any(envs.step(np.zeros((1, 2)))[3] for _ in range(9))


def test_setting_up_in_any_order() -> None:
    """observe() may use attributes that the constructor sets after that of the base class."""

    class Scaled(Short):
        def __init__(self, num_envs: int, scale: float) -> None:
            super().__init__(num_envs, model=CART, outputs=("xpos",))
            self.scale = scale

        def observe(self) -> Any:
            return self.batch.xpos * self.scale

    assert Scaled(2, 2.0).observation_space.shape == (2, 3, 3)
    envs = Scaled(2, 2.0)
    np.testing.assert_array_equal(envs.reset()[0][:, 2, 2], 0.2)


def test_registered() -> None:
    gymnasium.register(
        id="test/Cart-v0",
        entry_point="tasks_of_tests:CartEnv",
        vector_entry_point="tasks_of_tests:Cart",
        max_episode_steps=7,
    )
    envs: Any = gymnasium.make_vec("test/Cart-v0", num_envs=3)
    assert envs.spec is not None and envs.unwrapped.max_episode_steps == 7
    assert repr(envs) == "Cart(test/Cart-v0, num_envs=3)"
    with pytest.raises(ResetNeeded, match="test/Cart-v0"):
        envs.step(envs.action_space.sample())
    env = gymnasium.make("test/Cart-v0")
    np.testing.assert_array_equal(env.reset(seed=4)[0], envs.reset(seed=4)[0][0])


@pytest.mark.parametrize(
    ("method", "value", "message"),
    [
        ("observe", np.zeros(3), r"observe\(\) must give each environment an array"),
        ("observe", np.zeros((2, 2)), r"observe\(\) is an array of shape \(2, 2\)"),
        ("reward", 1.0, r"reward\(\) is an array of shape \(\), expected \(3,\)"),
        ("reward", np.zeros((3, 1)), r"reward\(\) is an array of shape \(3, 1\)"),
        ("terminated", np.zeros(2, dtype=bool), r"terminated\(\) is an array of shape \(2,\)"),
        ("info", {"x": np.zeros(2)}, r"info `x` is an array of shape \(2,\), expected \(3, ...\)"),
    ],
)
def test_wrong_shapes(method: str, value: Any, message: str) -> None:
    wrong = type("Wrong", (Short,), {method: lambda self, *_: value})
    envs = wrong(3, model=CART)
    with pytest.raises(ValueError, match=f"Wrong: {message}"):
        envs.reset()
        envs.step(np.zeros((3, 2)))


def test_what_is_missing() -> None:
    for method, call in (("observe", lambda e: e.reset()), ("reward", lambda e: (e.reset(), e.step(np.zeros((1, 2)))))):
        missing = type("Missing", (Short,), {method: getattr(BatchEnv, method)})
        with pytest.raises(NotImplementedError, match=f"Missing must define {method}"):
            call(missing(1, model=CART))


class Carrier(BatchEnv):
    """An action of shape (2, 1) drives the gantry; each episode has its own goal and weld."""

    model = Path(__file__).resolve().parents[3] / "models/suction_gripper.xml"
    frame_skip = 5
    outputs = ("xpos",)
    single_action_space = Box(-1, 1, (2, 1))

    def __init__(self, num_envs: int, **options: Any) -> None:
        super().__init__(num_envs, **options)
        self.goal = np.zeros(num_envs)
        self.resets: list[list[int]] = []

    def observe(self) -> NDArray[Any]:
        return np.column_stack([self.batch.qpos, self.goal])

    def control(self, action: NDArray[Any]) -> NDArray[Any]:
        return action[:, :, 0] * [0.8, 0.6]

    def reward(self, action: NDArray[Any]) -> NDArray[Any]:
        assert action.shape == (self.num_envs, 2, 1)
        return np.asarray(-np.abs(self.batch.body("box").xpos[:, 0] - self.goal))

    def on_reset(self, mask: NDArray[Any]) -> None:
        envs = np.flatnonzero(mask)
        self.resets.append(envs.tolist())
        for env in envs:
            self.goal[env] = self.generator(env).uniform(-0.5, 0.5)
        self.batch.joint("box").qpos[mask, 2] = 0.6
        self.batch.add_weld("cup", "box", envs)


def test_resets_can_set_goals_and_welds_and_actions_have_any_shape() -> None:
    envs = Carrier(3)
    observations, _ = envs.reset(seed=1)
    assert envs.resets == [[0, 1, 2]] and len(set(envs.goal)) == 3
    np.testing.assert_array_equal(observations[:, -1], envs.goal)
    assert (envs.batch.dynamic_kind[:, 0] == 2).all()
    action = np.broadcast_to([[0.5], [0.0]], (3, 2, 1))
    for _ in range(20):
        envs.step(action)
    np.testing.assert_allclose(envs.batch.ctrl, [[0.4, 0]] * 3)
    assert (envs.batch.qpos[:, 4] > 0.5).all()
    envs.reset(options={"reset_mask": np.array([False, True, False])})
    assert envs.resets == [[0, 1, 2], [1]] and (envs.batch.dynamic_kind[:, 0] == 2).all()
    with pytest.raises(ValueError, match=r"an action of shape \(3, 2\), expected \(3, 2, 1\)"):
        envs.step(np.zeros((3, 2)))


def test_episodes_start_in_a_state() -> None:
    """Episodes start in a whole state, given for one environment or for many."""
    sim = Sim(Model.from_xml(CART))
    sim.ctrl[0] = 1.0
    sim.step(20)

    class One(Short):
        def initial_state(self, rng: np.random.Generator) -> State:
            return sim.state

    class All(Short):
        def initial_states(self, envs: NDArray[np.intp]) -> State:
            return sim.state

    for task in (One, All):
        envs = task(num_envs=3, model=CART)
        observations, _ = envs.reset(seed=0)
        np.testing.assert_array_equal(observations, np.tile(sim.qpos, (3, 1)))
        np.testing.assert_array_equal(envs.batch.ctrl, np.tile(sim.ctrl, (3, 1)))
        assert (envs.batch.time == sim.time).all()
