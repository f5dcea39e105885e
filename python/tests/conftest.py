"""Settings of all tests: a test that hangs prints its traceback and ends the run."""

from __future__ import annotations

import faulthandler
import os
import signal
from collections.abc import Iterator
from typing import TextIO

import pytest

DEADLINE = 300  # seconds, for any test on a slow machine
STDERR = pytest.StashKey[TextIO]()


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "long: takes long; `cargo xtask test --quick` leaves it out")
    # A copy of stderr, since the captured output of a test would be lost at the end of the run.
    config.stash[STDERR] = open(os.dup(2), "w", encoding="utf-8")
    # Background jobs of a shell ignore Ctrl-C, which would break the tests of it.
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_unconfigure(config: pytest.Config) -> None:
    config.stash[STDERR].close()


@pytest.fixture(autouse=True)
def deadline(request: pytest.FixtureRequest) -> Iterator[None]:
    faulthandler.dump_traceback_later(DEADLINE, exit=True, file=request.config.stash[STDERR])
    yield
    faulthandler.cancel_dump_traceback_later()
