"""The fuzz target of `clench.State.from_bytes`: `python fuzz/state_bytes.py [-max_total_time=3600] FOLDER...`, with atheris.

`read` is its body, which `python/tests/test_state_corpus.py` replays over `fuzz/seeds/state_bytes` and
`fuzz/regressions/state_bytes`. States are read by Python alone, so the compiled module is not needed.
"""

from __future__ import annotations

import importlib.util
import inspect
import pathlib
import struct
import sys
import zipfile
import zlib
from typing import Any

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent


def _state_class() -> Any:
    spec = importlib.util.spec_from_file_location("clench_state", ROOT / "python/clench/_state.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module.State


State: Any = _state_class()


def mend(data: bytes) -> bytes:
    """The archive with the checksum of each entry made right, so that changed bytes get past them."""
    out = bytearray(data)
    at = data.find(b"PK\x01\x02")
    while 0 <= at <= len(data) - 46:
        size, _, name, extra, comment = struct.unpack_from("<IIHHH", data, at + 20)
        (local,) = struct.unpack_from("<I", data, at + 42)
        if local <= len(data) - 30:
            begin = local + 30 + sum(struct.unpack_from("<HH", data, local + 26))
            checksum = zlib.crc32(data[begin : begin + size])
            struct.pack_into("<I", out, at + 16, checksum)
            struct.pack_into("<I", out, local + 14, checksum)
        at = data.find(b"PK\x01\x02", at + 46 + name + extra + comment)
    return bytes(out)


def read(data: bytes) -> bool:
    """Whether the bytes are accepted; what is accepted must survive being packed again."""
    try:
        state = State.from_bytes(mend(data))
    except ValueError:
        return False
    again = State.from_bytes(state.to_bytes())
    for name in ("time", "qpos", "eq_active", "qacc_warmstart"):
        one, other = getattr(state, name), getattr(again, name)
        assert one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes(), name
    repr(state)
    return True


def main() -> None:
    import atheris  # type: ignore[import-untyped]

    # What reads is instrumented where it is: our module, and what it calls of others.
    module = sys.modules[State.__module__]
    header = sys.modules[np.lib.format.read_array_header_1_0.__module__]
    places: list[tuple[Any, list[str]]] = [
        (module, [name for name, thing in vars(module).items() if inspect.isfunction(thing)]),
        (header, ["_read_array_header", "_read_bytes", "descr_to_dtype", "read_magic"]),
        (zipfile.ZipFile, ["_RealGetContents", "open"]),
    ]
    for place, names in places:
        for name in names:
            if hasattr(place, name):
                setattr(place, name, atheris.instrument_func(getattr(place, name)))
    State.from_bytes = staticmethod(atheris.instrument_func(State.from_bytes))
    atheris.Setup(sys.argv, lambda data: (read(data), None)[1])
    atheris.Fuzz()


if __name__ == "__main__":
    main()
