"""States that can be kept: in memory, or as bytes that survive a restart."""

from __future__ import annotations

import io
import zipfile
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["State"]

# What the bytes hold is said by this number: readers refuse what is newer than they know.
_VERSION = 1


@dataclass(kw_only=True, eq=False, repr=False)
class State:
    """A copy of everything that the next step depends on, parameters apart.

    `Sim.state` and `Batch.state` make one, and assigning it brings the simulation back there, to the bit. The arrays are the
    same as those of the simulation, with the environments as first axis for a `Batch`; they can be changed freely.

    Parameters
    ----------
    time, qpos, qvel, act, ctrl, qfrc_applied, xfrc_applied, mocap_pos, mocap_quat, qacc_warmstart : numpy.ndarray
        Numbers, all float64 or all float32.
    eq_active : numpy.ndarray
        Switches of equality constraints, bool.

    Raises
    ------
    TypeError
        Arrays of other types.
    """

    time: NDArray[Any]
    qpos: NDArray[Any]
    qvel: NDArray[Any]
    act: NDArray[Any]
    ctrl: NDArray[Any]
    qfrc_applied: NDArray[Any]
    xfrc_applied: NDArray[Any]
    mocap_pos: NDArray[Any]
    mocap_quat: NDArray[Any]
    eq_active: NDArray[np.bool_]
    qacc_warmstart: NDArray[Any]

    def __post_init__(self) -> None:
        """Check the types."""
        numbers = np.dtype(np.float32 if getattr(self.qpos, "dtype", None) == np.float32 else np.float64)
        for name, array in vars(self).items():
            wanted = np.dtype(np.bool_) if name == "eq_active" else numbers
            found = getattr(array, "dtype", type(array).__name__)
            if not isinstance(array, np.ndarray) or found != wanted:
                raise TypeError(f"{name} of a state must be an array of {wanted}, not {found}")

    def to_bytes(self) -> bytes:
        """Pack the state into bytes.

        Returns
        -------
        bytes
            A NumPy ``.npz`` archive with an array a field and the number of its format, ``version``.
        """
        buffer = io.BytesIO()
        np.savez(buffer, version=np.int64(_VERSION), **vars(self))
        return buffer.getvalue()

    @staticmethod
    def from_bytes(data: bytes) -> State:
        """Unpack what `to_bytes` packed, in this or an earlier version.

        Parameters
        ----------
        data : bytes
            What `to_bytes` returned.

        Returns
        -------
        State
            The same state, to the bit.

        Raises
        ------
        ValueError
            Bytes that are damaged, of something else, or of a later version.
        """
        try:
            with np.load(io.BytesIO(data), allow_pickle=False) as archive:
                arrays = dict(archive)
            version = int(arrays.pop("version"))
        except (AttributeError, EOFError, KeyError, OSError, TypeError, ValueError, zipfile.BadZipFile) as error:
            raise ValueError(f"these bytes hold no state: {error}") from error
        if version > _VERSION:
            raise ValueError(f"this state has version {version}, and this clench reads versions up to {_VERSION}")
        try:
            return State(**arrays)
        except TypeError as error:
            raise ValueError(f"these bytes hold no whole state: {error}") from error

    def __repr__(self) -> str:
        envs = "" if self.qpos.ndim == 1 else f" of {len(self.qpos)} environments"
        return f"<clench.State{envs}, {self.qpos.dtype}>"
