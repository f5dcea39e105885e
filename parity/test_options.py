"""Options and flags of a file: each changes MuJoCo's results, and ours in the same way.

Each case is a model, options, and a flag. Accelerations are compared with own contacts. The flag, or the options if
there is none, must change MuJoCo's accelerations in some state, or the case would test nothing.
"""

import re

import mujoco
import numpy as np
import pytest

import oracle
import program
import states
from compare import assert_close

SOLVED = 1e-8

CASES = [
    *[("parity/models/joints", "", f"{flag}=disable") for flag in ("spring", "damper", "gravity", "limit")],
    ("parity/models/joints", "", "frictionloss=disable"),
    ("parity/models/joints", "", "constraint=disable"),
    ("parity/models/joints", "", "spring=disable damper=disable"),
    ("parity/models/joints", "timestep=0.02", "refsafe=disable"),
    ("parity/models/tendons", "", "equality=disable"),
    ("parity/models/tendons", "", "actuation=disable"),
    ("parity/models/actuators", "", "clampctrl=disable"),
    ("parity/models/activations", "actuatorgroupdisable='0 3'", ""),
    ("parity/models/contacts", "", "contact=disable"),
    ("parity/models/contacts", "gravity='1 0.5 -5'", ""),
    ("parity/models/contacts", "impratio=10", ""),
    *[(f"parity/models/{name}", "", "diagexact=enable") for name in ("contacts", "equalities", "joints", "tendons", "surfaces")],
    ("parity/models/contacts", "o_margin=0.01 o_solref='0.05 0.7' o_friction='0.3 0.4 0.1 0.1 0.1'", "override=enable"),
    ("parity/models/compiler", "density=1000 viscosity=0.9 wind='0.1 0.2 0.3'", ""),
    ("models/humanoid", "", "filterparent=disable"),
]


def with_options(path, base, options, flags):
    """Writes a file that includes the base model and adds the options and flags to it; returns its path."""
    quoted = lambda text: re.sub(r"=([^' ]+)", r"='\1'", text)
    include = f"<include file='{program.ROOT / base}.xml'/>"
    option = f"<option {quoted(options)}><flag {quoted(flags)}/></option>"
    path.write_text(f"<mujoco>\n  {include}\n  {option}\n</mujoco>\n")
    return path


@pytest.mark.parametrize(("base", "options", "flags"), CASES, ids=[" ".join(filter(None, c)) for c in CASES])
def test_option(tmp_path, base, options, flags, cone):
    changed = with_options(tmp_path / "changed.xml", base, options, flags)
    plain = with_options(tmp_path / "plain.xml", base, options if flags else "", "")
    model, plain_model = oracle.load(changed, cone), oracle.load(plain, cone)
    effect = 0.0
    with program.Forward(changed, "--cone", cone, "--iterations", 300, *program.EXACT) as forward:
        for k, state in enumerate(states.sample(plain)):
            state = {**state, "ctrl": [2 * c for c in state["ctrl"]]}  # beyond its range, for clampctrl
            ours, theirs = forward(state), oracle.reference(model, state)
            scale = oracle.acceleration_scale(theirs)
            assert_close(f"state {k}: qacc", ours["qacc"], theirs.qacc, SOLVED, scale)
            effect = max(effect, np.abs(theirs.qacc - oracle.reference(plain_model, state).qacc).max() / scale)
    assert effect > 1e-3, f"the option changes accelerations by {effect:.0e} only"


def test_eulerdamp(tmp_path):
    """Positions after 100 steps are MuJoCo's; the flag affects only steps."""
    base = "parity/models/joints"
    changed = with_options(tmp_path / "changed.xml", base, "", "eulerdamp=disable")
    plain = with_options(tmp_path / "plain.xml", base, "", "")
    record, _ = program.simulate(changed, "--steps", 100, "--iterations", 300, *program.EXACT)
    expected = qpos_after_steps(changed)
    assert_close("qpos", record["qpos"][-1], expected, 1e-8, 1.0)
    assert np.abs(expected - qpos_after_steps(plain)).max() > 1e-4, "the flag changes nothing here"


def qpos_after_steps(path):
    model = oracle.load(path)
    data = mujoco.MjData(model)
    for _ in range(100):
        mujoco.mj_step(model, data)
    return data.qpos
