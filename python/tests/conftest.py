"""A test that hangs shows where, and ends the run."""

import faulthandler

import pytest

DEADLINE = 300  # seconds, for any test on a slow machine


@pytest.fixture(autouse=True)
def deadline():
    faulthandler.dump_traceback_later(DEADLINE, exit=True)
    yield
    faulthandler.cancel_dump_traceback_later()
