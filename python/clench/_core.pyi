"""Types of the compiled part of :mod:`clench`."""

from collections.abc import Iterator, Sequence
from os import PathLike
from typing import Any, Literal, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from clench._state import State

_Precision: TypeAlias = Literal["64", "32"]

__version__: str
OUTPUTS: tuple[str, ...]
PARAMETERS: tuple[str, ...]

@final
class Model:
    @staticmethod
    def from_file(path: str | PathLike[str]) -> Model: ...
    @staticmethod
    def from_xml(text: str) -> Model: ...
    @property
    def name(self) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def nq(self) -> int: ...
    @property
    def nv(self) -> int: ...
    @property
    def nu(self) -> int: ...
    @property
    def na(self) -> int: ...
    @property
    def nbody(self) -> int: ...
    @property
    def njnt(self) -> int: ...
    @property
    def ngeom(self) -> int: ...
    @property
    def nsite(self) -> int: ...
    @property
    def ntendon(self) -> int: ...
    @property
    def neq(self) -> int: ...
    @property
    def nkey(self) -> int: ...
    @property
    def nmocap(self) -> int: ...
    @property
    def npair(self) -> int: ...
    def names(self, kind: str) -> list[str]: ...
    def body(self, which: str | int) -> Element: ...
    def joint(self, which: str | int) -> Element: ...
    def geom(self, which: str | int) -> Element: ...
    def site(self, which: str | int) -> Element: ...
    def tendon(self, which: str | int) -> Element: ...
    def actuator(self, which: str | int) -> Element: ...
    def equality(self, which: str | int) -> Element: ...
    def keyframe(self, which: str | int) -> Element: ...
    # Fields by their names, such as `body_mass` (nbody,), `geom_size` (ngeom, 3), `jnt_type`, `timestep` ().
    def __getattr__(self, field: str) -> NDArray[Any]: ...

@final
class Element:
    @property
    def kind(self) -> str: ...
    @property
    def id(self) -> int: ...
    @property
    def name(self) -> str: ...
    def __getattr__(self, field: str) -> Any: ...

@final
class RigidOptions:
    def __init__(
        self,
        *,
        constraint_solver: Literal["Newton", "CG"] | None = None,
        iterations: int | None = None,
        tolerance: float | None = None,
        ls_iterations: int | None = None,
        ls_tolerance: float | None = None,
        constraint_timeconst: float | None = None,
        enable_joint_limit: bool | None = None,
        disable_constraint: bool | None = None,
        sparse_solve: bool | Literal["auto"] | None = None,
        noslip_iterations: int | None = None,
        noslip_tolerance: float | None = None,
        max_contacts: int | Literal["auto"] | None = None,
        friction_cone: Literal["pyramidal", "elliptic"] | None = None,
        impratio: float | None = None,
        islands: bool | Literal["auto"] | None = None,
        warmstart: bool | None = None,
    ) -> None: ...
    # one read-only property an option; None where it was not set

class StateViews:
    """The arrays of a state, live: what Sim and Batch share. In a batch each has the environments as first axis."""

    @property
    def qpos(self) -> NDArray[Any]: ...
    # likewise qvel, act, ctrl, qfrc_applied, xfrc_applied (nbody, 6), mocap_pos (nmocap, 3), mocap_quat (nmocap, 4),
    # eq_active (bool), qacc_warmstart; each also settable (copies values in)

@final
class Sim(StateViews):
    def __init__(self, model: Model, options: RigidOptions | None = None, *, precision: _Precision = "64") -> None: ...
    model: Model
    options: RigidOptions
    precision: _Precision
    time: float  # settable
    state: State  # a copy; settable
    def step(self, n: int = 1) -> None: ...
    def forward(self) -> None: ...
    def reset(self, keyframe: str | int | None = None) -> None: ...
    def set_equality(self, which: str | int, active: bool) -> None: ...
    def set_param(self, field: str, values: ArrayLike) -> None: ...
    def param(self, field: str) -> NDArray[Any]: ...
    def output(self, name: str) -> NDArray[Any]: ...  # a copy; also by attribute: sim.xpos
    contacts: Contacts
    constraints: Constraints
    solver_stats: SolverStats
    contact_overflow: bool
    def mass_matrix(self) -> NDArray[Any]: ...

@final
class Batch(StateViews):
    def __init__(
        self,
        model: Model,
        n_envs: int,
        precision: _Precision = "64",
        threads: int | None = None,
        *,
        options: RigidOptions | None = None,
        record: Sequence[str] = (),
    ) -> None: ...
    model: Model
    options: RigidOptions
    n_envs: int
    precision: _Precision
    threads: int
    lanes: int
    bytes_per_env: int
    time: NDArray[Any]  # (n,) live view; settable
    state: State  # a copy; settable: all environments run
    def step(self, n: int = 1) -> int: ...  # how many environments failed in this call
    def forward(self, mask: ArrayLike | None = None) -> int: ...
    def reset(self, mask: ArrayLike | None = None, keyframe: str | int | None = None) -> None: ...
    def revive(self, mask: ArrayLike | None = None) -> None: ...
    status: NDArray[np.int8]  # (n,), codes of clench.EnvStatus
    running: NDArray[np.bool_]  # (n,)
    def fault(self, env: int) -> str | None: ...
    def randomize(self, field: str, values: ArrayLike, envs: ArrayLike | None = None) -> None: ...
    def param(self, field: str) -> NDArray[Any]: ...  # (n, ...) a copy
    def record(self, *names: str) -> None: ...  # adds to what is kept, as of the last forward pass
    outputs: tuple[str, ...]
    def output(self, name: str) -> NDArray[Any]: ...  # live read-only view; also by attribute: batch.cvel
    def rollout(
        self,
        initial: ArrayLike | None = None,  # (n, 1 + nq + nv + na): time, qpos, qvel, act
        ctrl: ArrayLike | None = None,  # (steps, nu) for all or (n, steps, nu)
        record: Sequence[str] = ("qpos", "qvel"),
        steps: int | None = None,
    ) -> dict[str, NDArray[Any]]: ...  # each (n, steps, ...)
    def sim(self, env: int) -> Sim: ...

@final
class Contacts:
    """Arrays over contacts: geom (ncon, 2), dim, dist, pos (ncon, 3), frame (ncon, 3, 3), includemargin, friction (ncon, 5),
    force (ncon, 6) in the contact frame, wrench (ncon, 6) world axes at pos, on the second geom; len(); geom_names."""

@final
class Constraints:
    """Arrays over rows: kind, id, name (lists), pos, margin, vel, aref, D, impedance, frictionloss, force, J (nefc, nv); len()."""

@final
class SolverStats:
    """status, iterations, gradient, improvement, gap, piece_changes, ls_evaluations, factorizations, updates,
    noslip_iterations, islands."""

@final
class Block:
    def __init__(self, cost: str, jacobian: ArrayLike, aref: ArrayLike, R: ArrayLike, shape: ArrayLike | None = None) -> None: ...

@final
class Solution:
    """qacc (nv,), forces: list of (dim,), qfrc_constraint (nv,), status, certificate (the duality gap), stats."""

def solve(M: ArrayLike, a_unc: ArrayLike, blocks: Sequence[Block], options: RigidOptions | None = None) -> Solution: ...
