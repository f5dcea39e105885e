"""Small tasks for the tests."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from clench.gymnasium import BatchEnv, SingleEnv

CART = """
<mujoco>
  <option timestep="0.01"/>
  <worldbody>
    <body name="cart">
      <joint name="slide" type="slide" axis="1 0 0" damping="0.5"/>
      <geom size="0.1" mass="1"/>
      <body name="pole" pos="0 0 0.1">
        <joint name="hinge" type="hinge" axis="0 1 0"/>
        <geom type="capsule" size="0.02" fromto="0 0 0 0 0 0.6" mass="0.2"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor name="push" joint="slide" ctrlrange="-3 3"/>
    <motor name="twist" joint="hinge"/>
  </actuator>
</mujoco>
"""


class Cart(BatchEnv):
    """A cart with a leaning pole. The second motor has no limit, so that a control can make the simulation fail."""

    model = CART
    frame_skip = 2
    outputs = ("xpos",)
    failure_reward = -5.0

    def observe(self) -> NDArray[Any]:
        return np.concatenate([self.batch.qpos, self.batch.qvel], axis=1)

    def reward(self, action: NDArray[Any]) -> NDArray[Any]:
        value: NDArray[Any] = 1.0 - self.batch.qpos[:, 1] ** 2
        return value

    def terminated(self) -> NDArray[Any]:
        leans: NDArray[Any] = np.abs(self.batch.qpos[:, 1]) > 0.5
        return leans

    def info(self) -> dict[str, NDArray[Any]]:
        return {"pole": self.batch.xpos[:, 2]}

    def initial_state(self, rng: np.random.Generator) -> tuple[NDArray[Any], NDArray[Any]]:
        return self.init_qpos + rng.normal(0.0, 0.02, self.init_qpos.shape), self.init_qvel


class CartEnv(SingleEnv):
    """A single `Cart`."""

    task = Cart
