"""Public models stay finite over 2000 steps under random controls with own contacts, if they do in MuJoCo.

The motions are not compared, since they amplify rounding.
"""

import mujoco
import numpy as np
import pytest

import conftest
import program
import public

STEPS, PERIOD = 2000, 20  # Controls change every PERIOD steps.
MODELS = [public.path(name) for name in public.compared()] + sorted(conftest.GYMNASIUM.glob("*.xml"))
BAD = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)


def diverges(model, controls):
    """Returns True if MuJoCo warns of an unstable motion."""
    data = mujoco.MjData(model)
    for control in controls:
        data.ctrl[:] = control
        mujoco.mj_step(model, data)
        if any(data.warning[int(kind)].number for kind in BAD):
            return True
    return False


@pytest.mark.long
@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_motion_stays_finite(path, tmp_path):
    model = mujoco.MjModel.from_xml_path(str(path))
    limited = model.actuator_ctrllimited.astype(bool)
    low, high = np.where(limited, model.actuator_ctrlrange.T, [[-1.0], [1.0]])
    drawn = np.random.default_rng(0).uniform(low, high, (STEPS // PERIOD, model.nu))
    np.save(tmp_path / "ctrl.npy", np.repeat(drawn, PERIOD, axis=0))
    flags = ("--ctrl", tmp_path / "ctrl.npy") if model.nu else ()
    done = program.run("simulate", path, "--steps", STEPS, *flags)
    assert done.returncode == 0 or diverges(model, np.repeat(drawn, PERIOD, axis=0)), done.stderr
