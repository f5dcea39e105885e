"""What a batch on a cluster answers by asking all of its workers, and the elements through which it can be read and set."""

from __future__ import annotations

from typing import Any, SupportsIndex

import numpy as np
from numpy.typing import NDArray

import clench

Array = NDArray[Any]


class Asked:
    """Questions whose answers are rows of environments, and views of elements."""

    model: clench.Model

    def _query(self, method: str, *arguments: Any) -> list[Any]:
        """What each worker answers."""
        raise NotImplementedError

    def _gather(self, method: str, *arguments: Any) -> Array:
        """The same as rows, those of one worker below those of the other."""
        return np.concatenate(self._query(method, *arguments))

    def param(self, field: str) -> Array:
        """The numbers of a parameter as each environment has them: a copy, after an axis over environments."""
        return self._gather("param", field)

    def output(self, name: str) -> Array:
        """A recorded output, with environments as first axis: a copy."""
        return self._gather("copied_output", name)

    def sensor(self, which: str | SupportsIndex) -> Array:
        """What one sensor measured in every environment, of ``sensordata``, which must be recorded: a copy."""
        sensor = self.model.sensor(which)
        return self.output("sensordata")[:, sensor.adr : sensor.adr + sensor.dim]

    def mass_matrix(self) -> Array:
        """Joint-space mass matrices (n, nv, nv)."""
        return self._gather("mass_matrix")

    def jacobian(self, **chosen: str | SupportsIndex) -> Array:
        """Jacobians of an object, (n, 2, 3, nv); see `clench.Batch.jacobian`."""
        return self._gather("jacobian", chosen)

    def subtree_jacobian(self, body: str | SupportsIndex) -> Array:
        """Jacobians of the centre of mass of a body and all below it, (n, 3, nv)."""
        return self._gather("subtree_jacobian", body)

    @property
    def status(self) -> NDArray[np.int8]:
        """Whether each environment runs (n), and if not why: codes of `clench.EnvStatus`."""
        return self._gather("all_status")

    @property
    def running(self) -> NDArray[np.bool_]:
        """Which environments run (n)."""
        running: NDArray[np.bool_] = self.status == clench.EnvStatus.RUNNING
        return running

    @property
    def resets(self) -> NDArray[np.int64]:
        """How often each environment started over from the initial state (n), with the option `autoreset`."""
        return self._gather("all_resets")

    @property
    def params(self) -> clench.Parameters:
        """All parameters by name, see `clench.Parameters`."""
        return clench.Parameters(self)  # type: ignore[arg-type]

    # Elements, with what belongs to each: see `clench.ElementView`. Parts of the state are live.

    def body(self, which: str | SupportsIndex) -> clench.BodyView:
        """A body, by name or index."""
        return clench.BodyView(self, which)  # type: ignore[arg-type]

    def joint(self, which: str | SupportsIndex) -> clench.JointView:
        """A joint, by name or index."""
        return clench.JointView(self, which)  # type: ignore[arg-type]

    def geom(self, which: str | SupportsIndex) -> clench.GeomView:
        """A geom, by name or index."""
        return clench.GeomView(self, which)  # type: ignore[arg-type]

    def site(self, which: str | SupportsIndex) -> clench.SiteView:
        """A site, by name or index."""
        return clench.SiteView(self, which)  # type: ignore[arg-type]

    def actuator(self, which: str | SupportsIndex) -> clench.ActuatorView:
        """An actuator, by name or index."""
        return clench.ActuatorView(self, which)  # type: ignore[arg-type]
