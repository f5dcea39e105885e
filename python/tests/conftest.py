"""A test that hangs shows where, and ends the run."""

from __future__ import annotations

import faulthandler
from collections.abc import Iterator

import pytest

DEADLINE = 300  # seconds, for any test on a slow machine


@pytest.fixture(autouse=True)
def deadline() -> Iterator[None]:
    faulthandler.dump_traceback_later(DEADLINE, exit=True)
    yield
    faulthandler.cancel_dump_traceback_later()
