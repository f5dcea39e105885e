"""The examples that learn with PyTorch run, repeat themselves, and improve."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from test_examples import run

pytest.importorskip("torch", reason="PyTorch is not installed")
pytestmark = pytest.mark.long


def rewards(printed: str) -> list[float]:
    """Returns the reward of each iteration."""
    return [float(value) for value in re.findall(r"reward +(-?[\d.]+) a second,", printed)]


def test_walk_saves_records_and_repeats(tmp_path: Path) -> None:
    policy, record, plot = tmp_path / "walk.pt", tmp_path / "walk.html", tmp_path / "walk.png"
    first = rewards(run("walk", "--save", str(policy), "--record", str(record), "--plot", str(plot)))
    assert len(first) == 4
    assert rewards(run("walk")) == first
    assert rewards(run("walk", "--seed", "1")) != first
    assert b"<html" in record.read_bytes()
    assert plot.read_bytes().startswith(b"\x89PNG")
    # Four iterations teach nobody to walk, and the evaluation says so.
    failed = run("walk", "--load", str(policy), "--evaluate", status=1)
    assert "m/s forward" in failed


def test_walk_learns(tmp_path: Path) -> None:
    curve = rewards(run("walk", "--envs", "256", "--iterations", "80"))
    # It begins at -0.3 and stands at 0.3; more is walking.
    assert curve[0] < 0.0
    assert sum(curve[-5:]) / 5 > 0.5


def test_walk_learns_in_mujoco() -> None:
    pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    # The first steps are the same in both simulators, but for the precision.
    ours, theirs = rewards(run("walk", "--iterations", "1")), rewards(run("walk", "--iterations", "1", "--mujoco"))
    assert ours == pytest.approx(theirs, abs=0.05)


def test_walk_writes_scalars(tmp_path: Path) -> None:
    pytest.importorskip("tensorboard", reason="TensorBoard is not installed")
    run("walk", "--tensorboard", str(tmp_path))
    assert list(tmp_path.glob("events.*"))


def test_reach_learns_from_pictures(tmp_path: Path) -> None:
    plot = tmp_path / "plot.png"
    printed = run("reach", "--plot", str(plot))
    assert plot.read_bytes().startswith(b"\x89PNG")
    assert len(rewards(printed)) == 3 and "end within 3 cm" in printed
    curve = rewards(run("reach", "--envs", "128", "--iterations", "25"))
    # It begins at -1.5, and stays there if it sees nothing.
    assert sum(curve[-5:]) / 5 > sum(curve[:5]) / 5 + 0.2


def test_learner_is_fed(tmp_path: Path) -> None:
    plot = tmp_path / "plot.png"
    printed = run("feed_learner", "--plot", str(plot))
    assert re.search(r"^overlap: 3 iterations", printed, re.MULTILINE)
    assert plot.read_bytes().startswith(b"\x89PNG")
