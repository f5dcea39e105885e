"""Every example runs in its short form without a display, and the training example learns."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[1] / "examples"
HELPERS = ("plots", "ppo", "walk_mujoco")
EXAMPLES = sorted(path.stem for path in FOLDER.glob("*.py") if path.stem not in HELPERS)
APART = ("train_policy", "cluster_plan", "walk", "reach", "feed_learner")  # These have tests of their own.


def run(name: str, *arguments: str, status: int = 0) -> str:
    """Runs an example as users do and returns its output; warnings of NumPy are errors."""
    environment = {key: value for key, value in os.environ.items() if key not in ("DISPLAY", "WAYLAND_DISPLAY")}
    command = [sys.executable, "-W", "error::RuntimeWarning", str(FOLDER / f"{name}.py"), "--quick", *arguments]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300)
    assert done.returncode == status, done.stderr
    return done.stdout


@pytest.mark.long
@pytest.mark.parametrize("name", [name for name in EXAMPLES if name not in APART])
def test_example_runs_and_plots(name: str, tmp_path: Path) -> None:
    plot = tmp_path / "plot.png"
    printed = run(name, "--plot", str(plot))
    assert printed
    assert plot.read_bytes().startswith(b"\x89PNG")


@pytest.mark.long
def test_feedback_balances_a_humanoid_on_one_foot() -> None:
    heights = [float(height) for height in re.findall(r" s ([\d.]+)$", run("one_foot"), re.MULTILINE)]
    assert len(heights) == 2
    assert heights[0] > 1.3 and heights[1] < 0.5


@pytest.mark.long
def test_gradients_teach_a_hopper_to_leap() -> None:
    costs = dict(re.findall(r"^(\w+): cost (-?[\d.]+)", run("leap"), re.MULTILINE))
    # The untrained policy has a cost of 0.17. Without penalties the cost is minus the distance in metres.
    assert float(costs["gradients"]) < -1.2
    assert float(costs["evolution"]) < -0.3


@pytest.mark.long
def test_policy_learns(tmp_path: Path) -> None:
    plot = tmp_path / "curve.svg"
    printed = run("train_policy", "--plot", str(plot))
    curve = [float(value) for value in re.findall(r"return +(-?[\d.]+) ", printed)]
    # The return of a standing cheetah is 0. In these short episodes three seeds reached 480 to 550.
    assert len(curve) == 20
    assert abs(curve[0]) < 10.0
    assert min(curve[-3:]) > 200.0
    assert "<svg" in plot.read_text()


def test_all_examples_are_documented() -> None:
    readme = (FOLDER.parent / "README.md").read_text()
    assert EXAMPLES
    for name in EXAMPLES:
        assert f"examples/{name}.py" in readme
