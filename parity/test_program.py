"""The program's summaries, records, help and toggled equalities."""

import json
import re
import subprocess

import mujoco
import numpy as np
import pytest

import program

EXAMPLES = sorted((program.ROOT / "models").glob("*.xml"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.stem)
def test_examples_simulate(path):
    done = program.run("simulate", path, "--steps", 500)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip(), "a summary was promised"


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.stem)
def test_examples_inspect(path):
    done = program.run("inspect", path, "--steps", 100)
    assert done.returncode == 0, done.stderr
    assert "nv" in done.stdout


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.stem)
def test_a_model_is_described_as_json(path):
    described = json.loads(program.run("inspect", path, "--json").stdout)
    model = mujoco.MjModel.from_xml_path(str(path))
    for size in ("nq", "nv", "nu", "na", "nsensordata"):
        assert described[size] == getattr(model, size), size
    for kind, count in (("bodies", model.nbody), ("joints", model.njnt), ("geoms", model.ngeom), ("actuators", model.nu)):
        one = {"bodies": model.body, "joints": model.joint, "geoms": model.geom, "actuators": model.actuator}[kind]
        assert [element["name"] for element in described[kind]] == [one(k).name for k in range(count)]
    assert [joint["qposadr"] for joint in described["joints"]] == model.jnt_qposadr.tolist()
    ranges = [joint["range"] for joint in described["joints"]]
    assert [found is not None for found in ranges] == model.jnt_limited.astype(bool).tolist()
    assert all(np.allclose(found, model.jnt_range[k]) for k, found in enumerate(ranges) if found is not None)


def test_contacts_are_listed():
    """The listed contacts are those that `forward` returns for that state."""
    path = program.ROOT / "models/box_stack.xml"
    listed = program.run("inspect", path, "--steps", 500, "--contacts").stdout.partition("\ncontacts at ")[2]
    heading, columns, *lines = listed.splitlines()
    assert columns.split()[:2] == ["geoms", "distance"]
    with program.Forward(path) as forward:
        state, _ = program.simulate(path, "--steps", 500, "--every", 500)
        result = forward({"qpos": list(state["qpos"][-1]), "qvel": list(state["qvel"][-1])})
    assert heading.endswith(f": {len(lines)}") and len(lines) == len(result["contacts"]) > 0
    for line, contact in zip(lines, result["contacts"]):
        _, *cells = re.split("  +", line.strip())
        numbers = [float(word) for cell in cells for word in cell.split()]
        expected = [contact["dist"], *contact["pos"], *np.ravel(contact["frame"])[:6], *contact["force"]]
        assert np.allclose(numbers, expected, rtol=1e-4, atol=2e-5)


def test_what_is_supported_is_listed():
    def listed(element):
        lines = program.run("mjcf", element).stdout.splitlines()
        assert lines[0] == element and all(line.startswith("  ") for line in lines[1:])
        return {line.split()[0]: line.split()[1:] for line in lines[1:]}

    words = listed("spatial")
    assert words.keys() == {"children", "read", "ignored"}
    assert "range" in words["read"] and "springyield" in words["read"]
    assert "speculative=disable" in listed("flag")["refused"]
    assert len(program.run("mjcf").stdout.splitlines()) > 100


def test_forward_returns_the_next_state():
    """The next state is that of `simulate` after one step."""
    path = program.ROOT / "models/quadruped.xml"
    record, _ = program.simulate(path, "--steps", 1)
    with program.Forward(path, "--step") as forward:
        result = forward({})
    for name in ("time", "qpos", "qvel"):
        assert np.array_equal(result["next"][name], record[name][-1])
    assert result["time"] == 0, "the result is that of the state given"


def test_json_summary_and_record():
    steps, every = 200, 10
    record, summary = program.simulate(program.ROOT / "models/quadruped.xml", "--steps", steps, "--every", every)
    assert {"seconds", "steps", "envs", "nv", "iterations_mean", "contacts_mean", "status"} <= summary.keys()
    assert (summary["steps"], summary["envs"], summary["nv"]) == (steps, 1, 18)
    assert summary["seconds"] > 0
    count = len(record["time"])
    assert count in (steps // every, steps // every + 1)
    assert record["qpos"].shape == (count, 19) and record["qvel"].shape == (count, 18)
    assert record["ctrl"].shape == (count, 12)
    assert np.isclose(record["time"][-1], steps * 0.002)


def test_the_same_run_twice_is_the_same_to_the_bit():
    one, _ = program.simulate(program.ROOT / "models/humanoid.xml", "--steps", 300)
    two, _ = program.simulate(program.ROOT / "models/humanoid.xml", "--steps", 300)
    assert np.array_equal(one["qpos"], two["qpos"]) and np.array_equal(one["qvel"], two["qvel"])


def test_a_toggled_weld_holds_its_crate():
    """In the lifted pose the weld carries the crate's weight if it is on, and nothing carries it if it is off."""
    with program.Forward(program.ROOT / "models/toggled_weld.xml") as forward:
        lifted = {"qpos": [0, -0.2, 0, 0, 0.479, 1, 0, 0, 0]}
        free, held = forward({**lifted, "eq_active": [False]}), forward({**lifted, "eq_active": [True]})
    assert np.isclose(free["qacc"][4], -9.81) and not free["constraints"]
    assert len(held["constraints"]) == 6 and held["qacc"][4] > -5


def test_omitted_contacts_are_reported():
    model, few = program.ROOT / "models/box_stack.xml", ("--max-contacts", 1)
    _, summary = program.simulate(model, "--steps", 10, *few)
    assert summary["status"] == "contact_overflow" and summary["overflow_steps"] == 10
    assert "omitted" in program.run("inspect", model, *few).stdout
    with program.Forward(model, *few) as forward:
        result = forward({})
    assert result["contact_overflow"] and len(result["contacts"]) == 1
    with program.Forward(model) as forward:
        assert "contact_overflow" not in forward({})


def test_a_whole_mjcontact_is_understood():
    """Every field of MuJoCo's contacts is accepted; derived fields have no effect."""
    model = mujoco.MjModel.from_xml_path(str(program.ROOT / "models/box_stack.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 20)
    mujoco.mj_forward(model, data)
    assert data.ncon > 0
    whole = [
        {name: np.asarray(getattr(c, name)).tolist() for name in dir(c) if not name.startswith("_")} for c in data.contact
    ]
    state = {"qpos": data.qpos.tolist(), "qvel": data.qvel.tolist()}
    with program.Forward(program.ROOT / "models/box_stack.xml") as forward:
        result = forward({**state, "contacts": whole})
        assert len(result["constraints"]) == data.nefc
        again = forward({**state, "contacts": [{**c, **r} for c, r in zip(whole, result["contacts"], strict=True)]})
        assert again["qacc"] == result["qacc"]


def test_time_limits_and_help():
    done = program.run("simulate", program.ROOT / "models/pendulum.xml", "--time", 0.5, "--json")
    assert done.returncode == 0 and json.loads(done.stdout.splitlines()[-1])["steps"] == 250
    for words in (["--help"], ["simulate", "--help"], ["forward", "--help"], ["inspect", "--help"]):
        done = program.run(*words)
        assert done.returncode == 0 and "--" in done.stdout


@pytest.mark.parametrize(
    "command, feature",
    [
        (["render", "MODEL", "--out", "picture.png"], "render"),
        (["devices"], "gpu"),
        (["simulate", "MODEL", "--envs", 2, "--device", "gpu"], "gpu"),
    ],
    ids=lambda value: value if isinstance(value, str) else value[0],
)
def test_missing_features_are_errors_with_advice(command, feature):
    model = program.ROOT / "models/pendulum.xml"
    done = program.run(*(model if word == "MODEL" else word for word in command))
    assert done.returncode == 2
    assert f"`cargo run --release --features {feature} -- ...`" in done.stderr
    assert re.search(rf"^  {command[0]}\b", program.run("--help").stdout, re.MULTILINE)


def test_a_line_search_cut_short_is_no_success():
    """One evaluation per line search cannot solve this scene; a summary with status ok would hide it."""
    done = program.run("simulate", program.ROOT / "models/pinch.xml", "--json", "--ls-iterations", 1)
    summary = json.loads(done.stdout.splitlines()[-1])
    assert summary["status"] == "iteration_limit" and summary["unconverged_steps"] > 0


STIFF = """
<mujoco>
  <option gravity="0 0 0"/>
  <worldbody>
    <body name="mass"><joint name="spring" type="slide" stiffness="1.7e6"/><geom size="0.1" mass="1"/></body>
    <body name="other" pos="9 0 0"><joint type="slide"/><geom size="0.1"/></body>
  </worldbody>
  <keyframe><key name="pulled" qpos="0.001 0" qvel="0 1"/></keyframe>
</mujoco>"""


def test_a_diverged_motion_is_reset_as_by_mujoco(tmp_path):
    path = tmp_path / "stiff.xml"
    path.write_text(STIFF)
    steps = ("--keyframe", "pulled", "--steps", 30)
    done = program.run("simulate", path, *steps, "--json")
    summary = json.loads(done.stdout.splitlines()[-1])
    assert summary["status"] == "failed"
    assert f'joint "spring" of body "mass" ({path}:5)' in summary["failure"]

    record, summary = program.simulate(path, *steps, "--autoreset")
    assert (summary["status"], summary["resets"]) == ("reset", 1)
    model = mujoco.MjModel.from_xml_string(STIFF)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    for step in range(30):
        mujoco.mj_step(model, data)
        assert record["time"][step] == pytest.approx(data.time, abs=1e-15)
        np.testing.assert_allclose(record["qpos"][step], data.qpos, rtol=1e-12, atol=1e-15)
    assert data.time < 0.05 and data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number == 1


@pytest.mark.parametrize("command", ["simulate", "inspect"])
def test_a_reader_that_leaves_is_no_error(command):
    """`clench inspect MODEL | true`."""
    words = [str(program.CLENCH), command, str(program.ROOT / "models/humanoid.xml")]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    process.stdout.close()
    assert (process.stderr.read(), process.wait(timeout=60)) == (b"", 0)
    process.stderr.close()


def test_an_address_that_cannot_be_printed_is_an_error():
    words = [str(program.CLENCH), "view", str(program.ROOT / "models/pendulum.xml"), "--no-open"]
    with open("/dev/full", "w") as full:
        done = subprocess.run(words, stdout=full, stderr=subprocess.PIPE, text=True, timeout=60)
    assert done.returncode == 2 and done.stderr.startswith("error: standard output: ")


def test_a_record_that_cannot_be_written_costs_no_run(tmp_path):
    path = tmp_path / "no such folder" / "out.npz"
    done = program.run("simulate", program.ROOT / "models/humanoid.xml", "--time", 1e6, "--record", path)
    assert done.returncode == 2 and str(path) in done.stderr
