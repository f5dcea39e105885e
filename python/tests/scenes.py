"""Models and states for the tests: the example models, a few small ones, and states during motion."""

from __future__ import annotations

import dataclasses
import functools
from typing import Any

import clench
import numpy as np
from models import ROOT as ROOT
from numpy.typing import NDArray

# A ball of 2 kg that rests on a floor.
BALL = """
<mujoco model="ball">
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body name="ball" pos="0 0 0.1">
      <freejoint/>
      <geom name="ball" size="0.1" mass="2"/>
    </body>
  </worldbody>
</mujoco>"""

# Features that the examples lack: activations, a welded mocap body, an inactive equality, a tendon.
PUPPET = """
<mujoco model="puppet">
  <option timestep="0.002"/>
  <worldbody>
    <geom name="floor" type="plane" size="2 2 1"/>
    <body name="hand" mocap="true" pos="0 0 1.2"/>
    <body name="torso" pos="0 0 1">
      <freejoint/>
      <geom name="torso" type="capsule" size="0.05" fromto="0 0 -0.1 0 0 0.1"/>
      <site name="top" pos="0 0 0.15"/>
      <body name="arm" pos="0 0 0.1">
        <joint name="shoulder" axis="0 1 0" range="-60 60" damping="0.1"/>
        <geom name="arm" size="0.03" type="capsule" fromto="0 0 0 0.3 0 0"/>
        <body name="forearm" pos="0.3 0 0">
          <joint name="elbow" axis="0 1 0" range="-60 60" damping="0.1" frictionloss="0.02"/>
          <geom name="forearm" size="0.03" type="capsule" fromto="0.06 0 0 0.3 0 0"/>
        </body>
      </body>
    </body>
  </worldbody>
  <tendon>
    <fixed name="string"><joint joint="shoulder" coef="1"/><joint joint="elbow" coef="-0.5"/></fixed>
  </tendon>
  <equality>
    <weld name="held" body1="hand" body2="torso" relpose="0 0 -0.2 1 0 0 0"/>
    <joint name="coupled" joint1="shoulder" joint2="elbow" active="false"/>
  </equality>
  <actuator>
    <general name="slow" joint="elbow" dyntype="filter" dynprm="0.05" gainprm="2"/>
    <motor name="pull" tendon="string" gear="0.5" nsample="2" delay="0.003" interp="linear"/>
  </actuator>
  <keyframe>
    <key name="bent" time="1" qpos="0 0 0.9 1 0 0 0 0.3 -0.4" qvel="0 0 0 0 0 0 0.1 0.2" act="0.5" ctrl="0.2 -0.3"
         mpos="0.1 0 1.3"/>
  </keyframe>
</mujoco>"""


@functools.cache
def example(name: str) -> clench.Model:
    """Returns a model of the folder `models`."""
    return clench.Model.from_file(ROOT / "models" / f"{name}.xml")


@functools.cache
def ball() -> clench.Model:
    return clench.Model.from_xml(BALL)


@functools.cache
def puppet() -> clench.Model:
    return clench.Model.from_xml(PUPPET)


NUMBERS = (
    "time",
    "qpos",
    "qvel",
    "act",
    "history",
    "ctrl",
    "qfrc_applied",
    "xfrc_applied",
    "mocap_pos",
    "mocap_quat",
    "qacc_warmstart",
)
FIELDS = tuple(field.name for field in dataclasses.fields(clench.State))


def same_bits(a: NDArray[Any], b: NDArray[Any]) -> bool:
    """Returns True if two arrays are bitwise equal, including the signs of zeros and NaN."""
    a, b = np.ascontiguousarray(a), np.ascontiguousarray(b)
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()


def same_state(a: clench.State, b: clench.State) -> bool:
    return all(same_bits(getattr(a, name), getattr(b, name)) for name in FIELDS)


def address(array: NDArray[Any]) -> int:
    return int(array.__array_interface__["data"][0])


def moving(kind: str, precision: Any = "64", model: Any = None) -> Any:
    """Returns a simulation or batch during motion, with non-default values in every field."""
    model = model or puppet()
    own = clench.Sim(model, precision=precision) if kind == "sim" else clench.Batch(model, 3, precision)
    own.reset(keyframe="bent")
    own.eq_active[..., 1] = True
    own.qfrc_applied[..., 2] = 0.3
    own.xfrc_applied[..., 1, 4] = 0.2
    own.mocap_quat[..., 0, :] = [0.8, 0, 0.6, 0]
    if kind == "batch":
        own.qvel += np.arange(3)[:, None]
    own.step(50)
    return own


def poisoned(n: int = 5, failing: tuple[int, ...] = (1, 3)) -> clench.Batch:
    """Returns a batch with some failed environments."""
    batch = clench.Batch(example("quadruped"), n, record=["xpos"])
    batch.step(3)
    batch.qvel[list(failing), 2] = np.nan
    assert batch.step() == len(failing)
    return batch
