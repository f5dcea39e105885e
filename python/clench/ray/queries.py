"""Queries of a batch on a cluster that involve all workers, and views of its elements."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, SupportsFloat, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

import clench
from clench._pickle import Target, target_fields
from clench.ray.results import IkResult, RayHits

Array = NDArray[Any]


class Queries:
    """Queries whose results are rows of environments, and views of elements."""

    model: clench.Model
    _parts: list[slice]

    def _query(self, method: str, *arguments: Any, **chosen: Any) -> list[Any]:
        """Returns the result of each worker."""
        raise NotImplementedError

    def _gather(self, method: str, *arguments: Any, **chosen: Any) -> Array:
        """Returns the concatenated rows of all workers' results."""
        return np.concatenate(self._query(method, *arguments, **chosen))

    def _query_each(self, method: str, arguments: Sequence[tuple[Any, ...]], chosen: dict[str, Any]) -> list[Any]:
        """Returns the result of each worker for its own arguments and shared keywords."""
        raise NotImplementedError

    def _split(self, values: ArrayLike | None, dimensions: int, name: str) -> list[Array | None]:
        """Splits rows among the workers if there is one per environment; else each worker gets the same."""
        raise NotImplementedError

    def param(self, field: str) -> Array:
        """Returns a copy of a parameter's values in every environment, after an axis of environments."""
        return self._gather("param", field)

    def mass_matrix(self) -> Array:
        """Computes joint-space mass matrices (n, nv, nv)."""
        return self._gather("mass_matrix")

    def jacobian(self, *, point: ArrayLike | None = None, **chosen: str | SupportsIndex) -> Array:
        """Computes Jacobians of an object, (n, 2, 3, nv); see `clench.Batch.jacobian`."""
        return self._at_point("jacobian", point, chosen)

    def jacobian_rate(self, *, point: ArrayLike | None = None, **chosen: str | SupportsIndex) -> Array:
        """Computes time derivatives of these Jacobians; see `clench.Batch.jacobian_rate`."""
        return self._at_point("jacobian_rate", point, chosen)

    def _at_point(self, method: str, point: ArrayLike | None, chosen: dict[str, str | SupportsIndex]) -> Array:
        """Returns the rows of a query of an object, or of a point of a body in each environment."""
        if point is None:
            return self._gather(method, **chosen)
        return self._gather_rows(f"{method}_at", [(point, 2, "point")], **chosen)

    def subtree_jacobian(self, body: str | SupportsIndex) -> Array:
        """Computes Jacobians of the centre of mass of a body's subtree, (n, 3, nv)."""
        return self._gather("subtree_jacobian", body)

    def velocity(self, *, local: bool = False, **chosen: str | SupportsIndex) -> Array:
        """Computes velocities of an object, (n, 2, 3), m/s and rad/s; see `clench.Batch.velocity`."""
        return self._gather("velocity", local=local, **chosen)

    def acceleration(self, *, local: bool = False, **chosen: str | SupportsIndex) -> Array:
        """Computes accelerations of an object, (n, 2, 3), m/s² and rad/s²; see `clench.Batch.acceleration`."""
        return self._gather("acceleration", local=local, **chosen)

    def mul_mass(self, x: ArrayLike) -> Array:
        """Computes products M x (n, nv) of the mass matrices with vectors (n, nv), or with one (nv,)."""
        return self._gather_rows("mul_mass", [(x, 2, "x")])

    def solve_mass(self, x: ArrayLike) -> Array:
        """Computes products M⁻¹ x (n, nv), of vectors (n, nv), or of one (nv,)."""
        return self._gather_rows("solve_mass", [(x, 2, "x")])

    def inverse(self, qacc: ArrayLike, *, discrete: bool | None = None) -> Array:
        """Computes forces along dofs (n, nv) that cause accelerations (n, nv); see `clench.Batch.inverse`."""
        return self._gather_rows("inverse", [(qacc, 2, "qacc")], discrete=discrete)

    def distance(
        self, geom1: str | SupportsIndex, geom2: str | SupportsIndex, limit: SupportsFloat | None = None
    ) -> Array:
        """Computes the distance of two geoms in each environment (n), m; see `clench.Batch.distance`."""
        return self._gather("distance", geom1, geom2, limit)

    def rays(self, origins: ArrayLike, directions: ArrayLike, **chosen: Any) -> RayHits:
        """Casts rays in each environment; see `clench.Batch.rays`.

        Parameters
        ----------
        origins, directions : array_like
            For all environments (k, 3), or for each (n, k, 3), m.
        **chosen
            The keywords of `clench.Batch.rays`.
        """
        rows = self._rows([(origins, 3, "origins"), (directions, 3, "directions")])
        return RayHits.joined(self._query_each("rays", rows, chosen))

    def heights(self, hfield: str | SupportsIndex, places: ArrayLike, **chosen: str | SupportsIndex) -> Array:
        """Computes heights of terrain (n, k), m, at places for all environments (k, 2) or each (n, k, 2); see
        `clench.Batch.heights`."""
        rows = [(hfield, *places) for places in self._rows([(places, 3, "places")])]
        return np.concatenate(self._query_each("heights", rows, dict(chosen)))

    def ik(self, targets: Iterable[Target], *, start: ArrayLike | None = None, **search: Any) -> IkResult:
        """Solves inverse kinematics in each environment; see `clench.Batch.ik`.

        Parameters
        ----------
        targets : iterable of FrameTarget, ComTarget or PostureTarget
            Goals, for all environments or each.
        start : array_like, optional
            Initial positions, for all (nq) or each (n, nq) environment; by default the current ones.
        **search
            The other keywords of `clench.Batch.ik`.
        """
        goals = [self._goals_of_parts(target) for target in targets]
        starts = self._split(start, 2, "start")
        rows = [([goal[part] for goal in goals], start) for part, start in enumerate(starts)]
        return IkResult.joined(self._query_each("ik", rows, search))

    def _goals_of_parts(self, target: Target) -> list[Target]:
        """Returns a target for each worker, with the rows of its environments."""
        fields = target_fields(target)
        of_environments = {name: fields[name] for name in ("position", "quat", "qpos") if fields.get(name) is not None}
        rows = {name: self._split(values, 2, name) for name, values in of_environments.items()}
        parts = range(len(self._parts))
        return [type(target)(**fields | {name: values[part] for name, values in rows.items()}) for part in parts]

    def _rows(self, arguments: Sequence[tuple[ArrayLike, int, str]]) -> list[tuple[Array | None, ...]]:
        """Returns arguments for each worker; each may have one row per environment."""
        return list(zip(*(self._split(*argument) for argument in arguments)))

    def _gather_rows(self, method: str, arguments: Sequence[tuple[ArrayLike, int, str]], **chosen: Any) -> Array:
        return np.concatenate(self._query_each(method, self._rows(arguments), chosen))

    # Queries about one environment, computed from its state on this machine.

    def sim(self, env: SupportsIndex) -> clench.Sim:
        """Returns a separate simulation of one environment, with its state and parameters."""
        raise NotImplementedError

    def contacts(self, env: SupportsIndex) -> clench.Contacts:
        """Computes the contacts of an environment in its current state; see `clench.Batch.contacts`."""
        return self._computed(env).contacts

    def constraints(self, env: SupportsIndex) -> clench.Constraints:
        """Computes the constraint rows of an environment in its current state; see `clench.Batch.constraints`."""
        return self._computed(env).constraints

    def render(self, env: SupportsIndex, width: SupportsIndex = 640, height: SupportsIndex = 480, **how: Any) -> Array:
        """Renders a picture of an environment in its current state; see `clench.Batch.render`."""
        return self.sim(env).render(width, height, **how)

    def _computed(self, env: SupportsIndex) -> clench.Sim:
        sim = self.sim(env)
        sim.forward()
        return sim

    @property
    def status(self) -> NDArray[np.int8]:
        """The status of each environment (n): codes of `clench.EnvStatus`."""
        return self._gather("all_status")

    @property
    def running(self) -> NDArray[np.bool_]:
        """True for each environment that is running (n)."""
        running: NDArray[np.bool_] = self.status == clench.EnvStatus.RUNNING
        return running

    @property
    def resets(self) -> NDArray[np.int64]:
        """The number of restarts of each environment from the initial state (n), with the option `autoreset`."""
        return self._gather("all_resets")

    @property
    def params(self) -> clench.Parameters:
        """All parameters by name; see `clench.Parameters`."""
        return clench.Parameters(self)  # type: ignore[arg-type]

    # Views of elements; see `clench.ElementView`. Parts of the state are live.

    def body(self, which: str | SupportsIndex) -> clench.BodyView:
        """Returns a body, by name or index."""
        return clench.BodyView(self, which)  # type: ignore[arg-type]

    def joint(self, which: str | SupportsIndex) -> clench.JointView:
        """Returns a joint, by name or index."""
        return clench.JointView(self, which)  # type: ignore[arg-type]

    def geom(self, which: str | SupportsIndex) -> clench.GeomView:
        """Returns a geom, by name or index."""
        return clench.GeomView(self, which)  # type: ignore[arg-type]

    def site(self, which: str | SupportsIndex) -> clench.SiteView:
        """Returns a site, by name or index."""
        return clench.SiteView(self, which)  # type: ignore[arg-type]

    def tendon(self, which: str | SupportsIndex) -> clench.TendonView:
        """Returns a tendon, by name or index."""
        return clench.TendonView(self, which)  # type: ignore[arg-type]

    def camera(self, which: str | SupportsIndex) -> clench.CameraView:
        """Returns a camera, by name or index."""
        return clench.CameraView(self, which)  # type: ignore[arg-type]

    def equality(self, which: str | SupportsIndex) -> clench.EqualityView:
        """Returns an equality, by name or index."""
        return clench.EqualityView(self, which)  # type: ignore[arg-type]

    def actuator(self, which: str | SupportsIndex) -> clench.ActuatorView:
        """Returns an actuator, by name or index."""
        return clench.ActuatorView(self, which)  # type: ignore[arg-type]
