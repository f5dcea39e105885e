"""States for comparisons: seeded rollouts in MuJoCo under random controls, sampled every half second.

Half of the states have applied forces, every third toggles an equality, and mocap bodies are displaced. A state is a
dictionary in the format that `clench forward` reads.
"""

import functools

import mujoco
import numpy as np

ROLLOUTS, SAMPLES = 5, 4
SPACING, CONTROL_HOLD = 0.5, 0.05  # seconds


@functools.lru_cache(maxsize=None)
def sample(path, rollouts=ROLLOUTS, samples=SAMPLES, may_be_unstable=False):
    """Returns rollouts × samples states of the model at `path`; they are reproducible."""
    model = mujoco.MjModel.from_xml_path(str(path))
    rng = np.random.default_rng(2024)
    found = [state for k in range(rollouts) for state in rollout(model, k, samples, rng)]
    if len(found) < rollouts * samples and not may_be_unstable:
        raise RuntimeError("MuJoCo's rollout is unstable: these states would compare nothing")
    return found


def rollout(model, index, samples, rng):
    """Yields states of a rollout from the default state or a keyframe, as long as MuJoCo is stable."""
    data = mujoco.MjData(model)
    start = index % (model.nkey + 1) - 1
    if start >= 0:
        mujoco.mj_resetDataKeyframe(model, data, start)
    data.qvel += 0.1 * rng.standard_normal(model.nv)
    strength = (1.0, 0.1)[index % 2]  # strong controls, or weak ones under which gravity dominates
    per_control = max(1, round(CONTROL_HOLD / model.opt.timestep))
    per_sample = max(1, round(SPACING / model.opt.timestep))
    for sample_index in range(samples):
        for step in range(per_sample):
            if step % per_control == 0:
                data.ctrl[:] = strength * controls(model, rng)
            mujoco.mj_step(model, data)
        if any(w.number for w in data.warning):
            return
        yield disturbed(model, data, rng, index + sample_index)


def controls(model, rng):
    """Returns controls, uniform over each control's range, or over [-1, 1] if it has none."""
    limited = model.actuator_ctrllimited.astype(bool)
    low = np.where(limited, model.actuator_ctrlrange[:, 0], -1.0)
    high = np.where(limited, model.actuator_ctrlrange[:, 1], 1.0)
    return rng.uniform(low, high)


def disturbed(model, data, rng, number):
    """Returns the current state as a dictionary, with applied forces, toggled equalities and displaced mocap bodies."""
    qfrc_applied, xfrc_applied = np.zeros(model.nv), np.zeros((model.nbody, 6))
    if number % 2 == 1:
        inertia = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, inertia)
        qfrc_applied = np.diag(inertia) * rng.standard_normal(model.nv)
        xfrc_applied[1:] = model.body_mass[1:, None] * rng.standard_normal((model.nbody - 1, 6))
        xfrc_applied[1:, 3:] *= 0.1  # metres: the lever of the force
    eq_active = data.eq_active.astype(bool)
    if number % 3 == 2 and model.neq > 0:
        eq_active[rng.integers(model.neq)] ^= True
    mocap_quat = data.mocap_quat + 0.05 * rng.standard_normal(data.mocap_quat.shape)
    mocap_quat /= np.linalg.norm(mocap_quat, axis=1, keepdims=True)
    state = {
        "time": data.time,
        "qpos": data.qpos,
        "qvel": data.qvel,
        "act": data.act,
        "plastic": data.plastic,
        "ctrl": data.ctrl,
        "qfrc_applied": qfrc_applied,
        "xfrc_applied": xfrc_applied,
        "mocap_pos": data.mocap_pos + 0.02 * rng.standard_normal(data.mocap_pos.shape),
        "mocap_quat": mocap_quat,
        "eq_active": eq_active,
    }
    return {name: np.asarray(value).tolist() for name, value in state.items()}
