"""Queries of the model: sizes, names, addresses and default values. Arrays are copies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from unisim import SimBackend
from unisim.backend.base import MocapPoseBinding, PublicStateWidths, RootStateLayout

from clench import Batch, Model

Array = NDArray[Any]

FLOAT = np.float32  # Numbers of UniSim, whatever the precision of the simulation.

_FREE, _SLIDE, _HINGE = 0, 2, 3  # Codes of `jnt_type`.
_JOINT_TRANSMISSIONS = (0, 1)  # Codes of `actuator_trntype`: a joint, and one in the parent's frame.


class ModelQueries(SimBackend):
    """The part of the contract that the model answers, without stepping.

    The contract describes methods that have no docstring, here and in the derived classes.

    Attributes
    ----------
    nq, nv : int
        Numbers of position coordinates and of degrees of freedom.
    """

    backend_type = "clench"

    _model: Model
    _num_envs: int
    _scene: Any

    @property
    def batch(self) -> Batch:
        """The simulation."""
        raise NotImplementedError

    @property
    def num_envs(self) -> int:
        return self._num_envs

    @property
    def model(self) -> Model:
        """The `clench.Model`."""
        return self._model

    @property
    def num_actuators(self) -> int:
        """Number of controls."""
        return self._model.nu

    @property
    def nq(self) -> int:
        return self._model.nq

    @property
    def nv(self) -> int:
        return self._model.nv

    @property
    def _root_widths(self) -> tuple[int, int]:
        floating = self._model.njnt > 0 and self._model.jnt_type[0] == _FREE
        return (7, 6) if floating else (0, 0)

    @property
    def num_dof_vel(self) -> int:
        return self.nv - self._root_widths[1]

    def get_public_state_widths(self) -> Any:
        return PublicStateWidths(nq=self.nq, nv=self.nv)

    def get_scene_model_file(self) -> str | None:
        return str(self._scene.model_file)

    def get_scene_visual_model_file(self) -> str | None:
        return str(self._scene.visual_model_file or self._scene.model_file)

    # Names.

    def _ids(self, kind: Any, names: Sequence[str]) -> NDArray[np.int32]:
        known = {name: index for index, name in enumerate(self._model.names(kind)) if name}
        if isinstance(names, (str, bytes)):
            raise TypeError(f"names must be a sequence of names, not the text {names!r}")
        for name in names:
            if name not in known:
                raise ValueError(f"the model has no {kind} {name!r}; it has {', '.join(known) or 'none with a name'}")
        return np.array([known[name] for name in names], dtype=np.int32)

    def get_body_ids(self, names: Sequence[str]) -> NDArray[np.int32]:
        return self._ids("body", names)

    def get_motion_body_ids(self, names: Sequence[str]) -> NDArray[np.int32]:
        return self._ids("body", names)

    def get_geom_id(self, name: str) -> int:
        return int(self._ids("geom", [name])[0])

    def get_site_ids(self, names: Sequence[str]) -> NDArray[np.int32]:
        return self._ids("site", names)

    def get_geom_names(self) -> tuple[str, ...]:
        return tuple(self._model.names("geom"))

    def get_actuator_names(self) -> tuple[str, ...]:
        return tuple(name or f"#{index}" for index, name in enumerate(self._model.names("actuator")))

    def get_actuator_joint_names(self) -> tuple[str, ...]:
        joints = self._model.names("joint")
        names = []
        for actuator, title in enumerate(self.get_actuator_names()):
            joint = int(self._model.actuator_trnid[actuator, 0])
            if self._model.actuator_trntype[actuator] not in _JOINT_TRANSMISSIONS or joint < 0:
                raise NotImplementedError(f"actuator {title!r} does not act on a joint")
            if self._model.jnt_type[joint] not in (_SLIDE, _HINGE):
                raise NotImplementedError(f"actuator {title!r} acts on a joint with more than one degree of freedom")
            if not joints[joint]:
                raise NotImplementedError(f"actuator {title!r} acts on joint {joint}, which has no name")
            names.append(joints[joint])
        return tuple(names)

    def get_body_subtree_ids(self, root_body_id: int) -> NDArray[np.int32]:
        root = int(root_body_id)
        if not 0 <= root < self._model.nbody:
            raise ValueError(f"body {root} is not in [0, {self._model.nbody})")
        below = np.zeros(self._model.nbody, dtype=bool)
        below[root] = True
        for body in range(root + 1, self._model.nbody):  # Parents precede their children.
            below[body] = below[self._model.body_parentid[body]]
        return np.flatnonzero(below).astype(np.int32)

    # Addresses in qpos and qvel.

    def _single_joints(self, names: Sequence[str]) -> NDArray[np.int32]:
        joints = self._ids("joint", names)
        for name, joint in zip(names, joints, strict=True):
            if self._model.jnt_type[joint] not in (_SLIDE, _HINGE):
                raise ValueError(f"joint {name!r} is no hinge or slide joint")
        return joints

    def get_joint_dof_indices(self, names: Sequence[str]) -> NDArray[np.int32]:
        return self._model.jnt_dofadr[self._ids("joint", names)].astype(np.int32)

    def get_joint_state_qpos_indices(self, names: Sequence[str]) -> NDArray[np.int32]:
        return self._model.jnt_qposadr[self._single_joints(names)].astype(np.int32)

    def get_joint_state_qvel_indices(self, names: Sequence[str]) -> NDArray[np.int32]:
        return self._model.jnt_dofadr[self._single_joints(names)].astype(np.int32)

    def get_joint_dof_pos_indices(self, names: Sequence[str]) -> NDArray[np.int32]:
        return self.get_joint_state_qpos_indices(names) - np.int32(self._root_widths[0])

    def get_joint_dof_vel_indices(self, names: Sequence[str]) -> NDArray[np.int32]:
        return self.get_joint_dof_indices(names) - np.int32(self._root_widths[1])

    def get_root_state_layout(self, root_body_name: str) -> Any:
        body = int(self._ids("body", [root_body_name])[0])
        joint = int(self._model.body_jntadr[body])
        if joint < 0 or self._model.jnt_type[joint] != _FREE:
            raise NotImplementedError(f"body {root_body_name!r} has no free joint, so it is no floating root")
        qpos, qvel = int(self._model.jnt_qposadr[joint]), int(self._model.jnt_dofadr[joint])
        return RootStateLayout(qpos_indices=tuple(range(qpos, qpos + 7)), qvel_indices=tuple(range(qvel, qvel + 6)))

    # Values.

    def get_actuator_ctrl_range(self) -> Array:
        return self._model.actuator_ctrlrange.astype(FLOAT)

    def get_joint_range(self, *, names: Sequence[str] | None = None) -> Array:
        if names is None:
            return np.asarray(self._model.jnt_range[self._model.jnt_type != _FREE], dtype=FLOAT)
        joints = self._single_joints(names)
        limits = np.where(self._model.jnt_limited[joints, None], self._model.jnt_range[joints], [-np.inf, np.inf])
        return limits.astype(FLOAT)

    def get_keyframe_qpos(self, name: str) -> Array:
        return np.array(self._model.key_qpos[self._ids("keyframe", [name])[0]], dtype=FLOAT)

    def get_default_qpos(self) -> Array:
        return self._model.qpos0.copy()

    def get_default_dof_pos(self) -> Array:
        return self._model.qpos0[self._root_widths[0] :].astype(FLOAT)

    def get_init_qvel(self) -> Array:
        return np.zeros(self.nv, dtype=FLOAT)

    def get_gravity(self) -> Array:
        return self._model.gravity.copy()

    def get_body_mass(self) -> Array:
        return self._model.body_mass.copy()

    def get_body_ipos(self, env_ids: Sequence[int] | Array | None = None) -> Array:
        if env_ids is None:
            return self._model.body_ipos.copy()
        return np.asarray(self.batch.param("body_ipos")[self._validate_env_ids(env_ids)], dtype=np.float64)

    def get_dof_armature(self) -> Array:
        return self._model.dof_armature.copy()

    def get_dof_damping(self) -> Array:
        return self._model.dof_damping.copy()

    def get_dof_frictionloss(self) -> Array:
        return self._model.dof_frictionloss.copy()

    def get_geom_size(self, name: str) -> Array:
        return np.array(self._model.geom_size[self.get_geom_id(name)])

    def get_default_geom_sizes(self) -> Array:
        return self._model.geom_size.copy()

    def get_geom_solref(self) -> Array:
        return self._model.geom_solref.copy()

    def get_geom_solimp(self) -> Array:
        return self._model.geom_solimp.copy()

    def get_geom_friction(self) -> Array:
        return self._model.geom_friction.copy()

    def get_geom_body_ids(self) -> NDArray[np.int32]:
        return self._model.geom_bodyid.astype(np.int32)

    def get_geom_contact_masks(self) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        return self._model.geom_contype.astype(np.int32), self._model.geom_conaffinity.astype(np.int32)

    def get_actuator_gains(self) -> tuple[Array, Array]:
        return self._model.actuator_gainprm[:, 0].copy(), -self._model.actuator_biasprm[:, 2]

    # Mocap bodies.

    def bind_mocap_pose(self, body_name: str) -> Any:
        body = int(self._ids("body", [body_name])[0])
        mocap = int(self._model.body_mocapid[body])
        if mocap < 0:
            raise ValueError(f"body {body_name!r} is no mocap body")

        def read() -> Array:
            return np.concatenate([self.batch.mocap_pos[:, mocap], self.batch.mocap_quat[:, mocap]], axis=1)

        def write(envs: Array, poses: Array) -> None:
            self.batch.mocap_pos[envs, mocap] = poses[:, :3]
            self.batch.mocap_quat[envs, mocap] = poses[:, 3:]
            self._refresh(envs)

        pose = np.concatenate([self._model.body_pos[body], self._model.body_quat[body]])
        return MocapPoseBinding(self.backend_type, body_name, self._num_envs, pose, read, write)

    def _refresh(self, envs: Array | None = None) -> None:
        """Computes outputs from the present states of some environments, or of all."""
        raise NotImplementedError
