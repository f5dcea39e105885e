"""Batches of environments in the program: bitwise equal to single environments, with reports of failures."""

import json
import resource

import mujoco
import numpy as np
import pytest

import program

MODELS = program.ROOT / "models"
STEPS = 150
SAME = ["iterations_mean", "contacts_mean", "contacts_max", "gap_max", "penetration_max", "unconverged_steps", "status"]


def controls(model, steps, folder):
    """Writes random controls to a file and returns its path."""
    path = folder / "ctrl.npy"
    np.save(path, np.random.default_rng(3).uniform(-0.3, 0.3, (steps, model.nu)))
    return path


def summary(done):
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.parametrize("precision", [64, 32])
def test_every_environment_is_as_if_alone(precision, tmp_path):
    """Each environment equals a separate run, with noise, controls, partly filled SIMD lanes and two threads."""
    path, envs = MODELS / "quadruped.xml", 11
    model = mujoco.MjModel.from_xml_path(str(path))
    flags = ("--steps", STEPS, "--ctrl", controls(model, STEPS, tmp_path), "--precision", precision)
    start, _ = program.simulate(path, "--steps", 1, "--timestep", 1e-300, "--envs", envs, "--noise", 0.1)
    states = np.concatenate([start["qpos"][:, 0], start["qvel"][:, 0]], axis=1)
    np.save(tmp_path / "all.npy", states)
    batch, figures = program.simulate(path, *flags, "--states", tmp_path / "all.npy", "--envs", envs, "--threads", 2)
    assert (figures["envs"], figures["threads"], figures["precision"]) == (envs, 2, precision)
    assert batch["qpos"].shape == (envs, STEPS, model.nq) and batch["contacts"].shape == (envs, STEPS)
    assert len(np.unique(batch["qpos"][:, -1], axis=0)) == envs
    for env in range(envs):
        np.save(tmp_path / "one.npy", states[env : env + 1])
        alone, _ = program.simulate(path, *flags, "--states", tmp_path / "one.npy")
        for name in batch:
            assert np.array_equal(batch[name][env], alone[name]), f"{name} of environment {env}"


@pytest.mark.parametrize("name", ["humanoid", "pinch", "box_stack"])
def test_the_summary_of_one_is_that_of_a_batch_of_one(name):
    flags = ("--steps", STEPS, "--noise", 0.01, "--json")
    alone = summary(program.run("simulate", MODELS / f"{name}.xml", *flags))
    batch = summary(program.run("simulate", MODELS / f"{name}.xml", *flags, "--envs", 1))
    assert alone.keys() <= batch.keys()
    assert {key: batch[key] for key in SAME} == {key: alone[key] for key in SAME}
    assert batch["bytes_per_env"] > 0 and batch["scratch_bytes_per_thread"] > 0


def test_energy_drift_of_a_batch_is_the_largest(tmp_path):
    free = tmp_path / "free.xml"
    free.write_text(
        '<mujoco><worldbody><body><joint type="ball"/><geom size="0.1 0.2 0.3" type="box" pos="0 0 1"/></body>'
        '</worldbody></mujoco>'
    )  # fmt: skip
    flags = ("--steps", 100, "--noise", 2, "--json")
    drift = summary(program.run("simulate", free, *flags, "--envs", 6))["energy_drift"]
    start, _ = program.simulate(free, "--steps", 1, "--timestep", 1e-300, "--envs", 6, "--noise", 2)
    states = np.concatenate([start["qpos"][:, 0], start["qvel"][:, 0]], axis=1)
    alone = []
    for row in states:
        np.save(tmp_path / "one.npy", row[None])
        run = program.run("simulate", free, "--steps", 100, "--json", "--states", tmp_path / "one.npy")
        alone.append(summary(run)["energy_drift"])
    assert drift == max(alone, key=abs) != 0


def test_noise():
    """Noise is within its bounds in the tangent space and depends on the seed, not on the number of environments."""
    path, scale = MODELS / "quadruped.xml", 0.2
    model = mujoco.MjModel.from_xml_path(str(path))
    frozen = ("--steps", 1, "--timestep", 1e-300, "--noise", scale)
    many, _ = program.simulate(path, *frozen, "--envs", 40)
    few, _ = program.simulate(path, *frozen, "--envs", 3)
    other, _ = program.simulate(path, *frozen, "--envs", 3, "--seed", 1)
    alone, _ = program.simulate(path, *frozen)
    for name in ("qpos", "qvel"):
        assert np.array_equal(many[name][:3], few[name]) and np.array_equal(many[name][0], alone[name])
        assert not np.any(few[name] == other[name])
    start = mujoco.MjData(model).qpos
    shift = np.zeros((40, model.nv))
    for env in range(40):
        mujoco.mj_differentiatePos(model, shift[env], 1, start, many["qpos"][env, 0])
    for moved in (shift, many["qvel"][:, 0]):
        assert np.abs(moved).max() < scale * (1 + 1e-9)
        assert np.abs(moved.mean()) < 0.05 * scale and np.isclose(moved.std(), scale / np.sqrt(3), rtol=0.05)


def test_precision():
    double, _ = program.simulate(MODELS / "humanoid.xml", "--steps", 20, "--noise", 0.01)
    single, figures = program.simulate(MODELS / "humanoid.xml", "--steps", 20, "--noise", 0.01, "--precision", 32)
    assert figures["precision"] == 32
    error = np.abs(single["qpos"] - double["qpos"]).max()
    assert 0 < error < 1e-4
    assert np.array_equal(single["qpos"], single["qpos"].astype(np.float32))


def test_an_environment_that_fails_is_reported_and_disturbs_no_other(tmp_path):
    path, envs, bad = MODELS / "humanoid.xml", 6, [1, 4]
    model = mujoco.MjModel.from_xml_path(str(path))
    states = np.tile(np.concatenate([model.qpos0, np.zeros(model.nv)]), (envs, 1))
    states[:, 2] += 0.05 * np.arange(envs)
    np.save(tmp_path / "good.npy", states)
    states[bad, model.nq :] = 1e200
    np.save(tmp_path / "bad.npy", states)
    flags = ("--steps", STEPS, "--envs", envs, "--json", "--record")
    good = program.run("simulate", path, *flags, tmp_path / "good.npz", "--states", tmp_path / "good.npy")
    poor = program.run("simulate", path, *flags, tmp_path / "poor.npz", "--states", tmp_path / "bad.npy")
    assert good.returncode == 0, good.stderr
    assert poor.returncode == 2 and f"{len(bad)} of {envs}" in poor.stderr and "environment 1" in poor.stderr
    figures = summary(poor)
    assert figures["status"] == "failed" and figures["failed_envs"] == len(bad)
    assert [failure["env"] for failure in figures["failures"]] == bad
    assert all("diverged" in failure["reason"] for failure in figures["failures"])
    assert figures["steps"] == STEPS
    with np.load(tmp_path / "good.npz") as healthy, np.load(tmp_path / "poor.npz") as ill:
        for env in set(range(envs)) - set(bad):
            assert np.array_equal(healthy["qpos"][env], ill["qpos"][env])
        for env in bad:
            assert np.all(ill["time"][env] == 0) and np.all(ill["qvel"][env] == 1e200)
    text = program.run("simulate", path, "--steps", 3, "--envs", envs, "--states", tmp_path / "bad.npy")
    assert "environment 4: the simulation diverged" in text.stdout


def test_an_environment_with_too_many_contacts_fails():
    done = program.run("simulate", MODELS / "box_stack.xml", "--steps", 5, "--envs", 3, "--max-contacts", 1, "--json")
    assert done.returncode == 2 and summary(done)["failed_envs"] == 3 and "contacts" in done.stderr


@pytest.mark.parametrize("flags", [(), ("--envs", 40, "--threads", 1), ("--envs", 40, "--threads", 2)], ids=str)
def test_profile(flags):
    """The stages sum to the time of stepping; none is missing."""
    done = program.run("simulate", MODELS / "humanoid.xml", "--steps", 200, "--profile", "--json", *flags)
    figures = summary(done)
    stages = {stage["stage"]: stage for stage in figures["profile"]}
    wanted = ["kinematics", "inertia", "collision broad", "collision narrow", "assembly", "hessian", "factorization"]
    assert all(stages[name]["microseconds"] > 0 for name in [*wanted, "line search", "integration", "rows and checks"])
    assert np.isclose(sum(stage["percent"] for stage in stages.values()), 100)
    total = sum(stage["microseconds"] for stage in stages.values())
    assert np.isclose(total, 1e6 * figures["seconds"] * figures["threads"] / (figures["envs"] * 200), rtol=1e-3)
    if figures["threads"] == 1:  # several threads may wait for each other
        assert 0 < stages["elsewhere"]["percent"] < 20, "what no stage counts should be little, but not nothing"
    assert "kinematics" in program.run("simulate", MODELS / "humanoid.xml", "--steps", 5, "--profile", *flags).stdout


BAD_FLAGS = [
    (["--envs", 0], ["envs"]),
    (["--envs", -1], []),
    (["--envs", 10**12], ["envs"]),
    (["--precision", 16], ["16", "32", "64"]),
    (["--envs", 2, "--threads", 0], ["threads"]),
    (["--envs", 2, "--threads", 10**6], ["threads"]),
    (["--instructions", "scalar"], ["envs"]),
    (["--envs", 2, "--instructions", "mmx"], ["mmx", "avx2"]),
    (["--no-grouping"], ["envs"]),
    (["--noise", "nan"], ["noise"]),
    (["--noise=-1"], ["noise"]),
    (["--noise", 1e308, "--precision", 32], ["qpos"]),
    (["--seed", 0.5], ["0.5"]),
    (["--envs", 2, "--every", 0], ["every"]),
    (["--envs", 2, "--states", "gone.npy"], ["gone.npy"]),
]


@pytest.mark.parametrize(("flags", "words"), BAD_FLAGS, ids=[" ".join(map(str, f)) for f, _ in BAD_FLAGS])
def test_bad_flags(flags, words):
    done = program.run("simulate", MODELS / "pendulum.xml", "--steps", 1, *flags)
    assert done.returncode == 2 and "panicked" not in done.stderr, done.stderr
    assert all(word in done.stderr for word in words), done.stderr


def test_states_that_do_not_fit(tmp_path):
    simulate = lambda *flags: program.run("simulate", MODELS / "pendulum.xml", "--steps", 1, *flags)
    np.save(tmp_path / "three.npy", np.zeros((3, 2)))
    assert simulate("--envs", 3, "--states", tmp_path / "three.npy").returncode == 0
    for flags in (["--envs", 2], []):
        done = simulate(*flags, "--states", tmp_path / "three.npy")
        assert done.returncode == 2 and "3 rows" in done.stderr
    np.save(tmp_path / "wide.npy", np.zeros((3, 5)))
    done = simulate("--envs", 3, "--states", tmp_path / "wide.npy")
    assert done.returncode == 2 and "wide.npy" in done.stderr and "(N, 2)" in done.stderr


def test_more_environments_than_memory_holds():
    """With an address space of a gigabyte, the program reports that memory is insufficient."""
    limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))
    done = program.run("simulate", MODELS / "humanoid.xml", "--envs", 4 * 10**9, "--threads", 1, preexec_fn=limit)
    assert done.returncode == 2 and "memory" in done.stderr, done.stderr


def test_a_record_larger_than_memory_costs_no_run(tmp_path):
    limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))
    flags = ("--envs", 1000, "--threads", 1, "--steps", 10**9, "--record", tmp_path / "out.npz")
    done = program.run("simulate", MODELS / "humanoid.xml", *flags, preexec_fn=limit)
    assert done.returncode == 2 and "out.npz" in done.stderr and "memory" in done.stderr, done.stderr
