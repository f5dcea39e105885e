"""Bad input causes a message with location and reason and exit code 2, never a panic."""

import json
import math
import re

import numpy as np
import pytest

import program

GOOD = """<mujoco>
  <worldbody>
    <body name="arm" pos="0 0 1">
      <joint name="elbow" type="hinge"/>
      <geom name="rod" type="capsule" size="0.02 0.1"/>
    </body>
  </worldbody>
  <actuator>
    <motor name="drive" joint="elbow"/>
  </actuator>
</mujoco>
"""

# Name, text to replace in GOOD, its replacement, and the line and words (ignoring case) that the message contains.
BAD_FILES = [
    ("broken xml", "    </body>\n", "", 6, ["body", "worldbody"]),
    ("unknown element", "<joint ", "<joynt ", 4, ["joynt"]),
    ("misplaced element", "<geom ", "<motor ", 5, ["motor", "body"]),
    ("unknown attribute", 'type="hinge"', 'typo="hinge"', 4, ["typo", "joint"]),
    ("unknown keyword", 'type="hinge"', 'type="hinged"', 4, ["hinged", "type"]),
    ("bad number", 'pos="0 0 1"', 'pos="0 zero 1"', 3, ["zero", "pos"]),
    ("not a finite number", 'pos="0 0 1"', 'pos="0 nan 1"', 3, ["nan", "pos"]),
    ("too few numbers", 'pos="0 0 1"', 'pos="0 0"', 3, ["pos", "3"]),
    ("too many numbers", 'pos="0 0 1"', 'pos="0 0 1 2"', 3, ["pos", "3"]),
    ("dangling joint", 'joint="elbow"', 'joint="knee"', 9, ["knee", "drive"]),
    ("dangling class", 'type="hinge"', 'class="soft"', 4, ["soft"]),
    ("dangling body", "</mujoco>", '<equality><weld body1="leg"/></equality></mujoco>', 11, ["leg", "equality"]),
    ("dangling geom", "</mujoco>", '<contact><pair geom1="rod" geom2="wall"/></contact></mujoco>', 11, ["wall"]),
    ("duplicate name", 'name="rod"', 'name="rod" size="0.1"/><geom name="rod"', 5, ["rod"]),
    ("moving body without mass", 'type="capsule"', 'mass="0" type="capsule"', 3, ["mass", "arm"]),
    ("zero size", 'size="0.02 0.1"', 'size="0 0.1"', 5, ["size", "geom"]),
    ("missing size", 'size="0.02 0.1"', "", 5, ["size", "geom"]),
    ("reversed range", 'type="hinge"', 'type="hinge" limited="true" range="1 -1"', 4, ["range", "elbow"]),
    ("free joint inside the tree", "<geom ", '<body><freejoint/><geom size="1"/></body><geom ', 5, ["free"]),
    ("unsupported feature", "<actuator>", "<deformable><flex/></deformable><actuator>", 8, ["deformable"]),
    ("wrong root", "mujoco>", "scene>", 1, ["scene", "mujoco"]),
    ("wrong keyframe length", "</mujoco>", '<keyframe><key qpos="1 2 3"/></keyframe></mujoco>', 11, ["qpos", "key"]),
    ("impossible time step", "<worldbody>", '<option timestep="0"/><worldbody>', 2, ["timestep"]),
    ("include that is missing", "<worldbody>", '<include file="gone.xml"/><worldbody>', 2, ["gone.xml", "include"]),
    ("include of itself", "<worldbody>", '<include file="bad.xml"/><worldbody>', 2, ["bad.xml", "include"]),
]


def refused(done, *words):
    """Checks that the run ended with exit code 2 and a message with all the words, without a panic."""
    assert done.returncode == 2, f"exit code {done.returncode}\n{done.stderr}"
    assert "panicked" not in done.stderr and "RUST_BACKTRACE" not in done.stderr, done.stderr
    for word in words:
        assert word.lower() in done.stderr.lower(), f"`{word}` is not in: {done.stderr}"
    return done.stderr


def test_the_good_file_is_good(tmp_path):
    (tmp_path / "good.xml").write_text(GOOD)
    done = program.run("simulate", tmp_path / "good.xml", "--steps", 10)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(("old", "new", "line", "words"), [c[1:] for c in BAD_FILES], ids=[c[0] for c in BAD_FILES])
def test_model_file(tmp_path, old, new, line, words):
    assert old in GOOD
    (tmp_path / "bad.xml").write_text(GOOD.replace(old, new))
    for command in ("simulate", "forward", "inspect"):
        message = refused(program.run(command, tmp_path / "bad.xml"), "bad.xml", *words)
        assert re.search(rf"\b{line}\b", message), f"line {line} is not in: {message}"


def test_error_inside_an_include_names_the_included_file(tmp_path):
    (tmp_path / "main.xml").write_text(GOOD.replace("<worldbody>", '<include file="part.xml"/><worldbody>'))
    (tmp_path / "part.xml").write_text('<mujoco>\n  <option\n    gravitas="1 2 3"/>\n</mujoco>\n')
    message = refused(program.run("inspect", tmp_path / "main.xml"), "part.xml", "gravitas")
    assert re.search(r"\b[23]\b", message), message


@pytest.mark.parametrize("content", [b"", b"\x00\xff\xfe garbage", b"just words"], ids=["empty", "binary", "text"])
def test_file_that_is_no_model(tmp_path, content):
    (tmp_path / "bad.xml").write_bytes(content)
    refused(program.run("simulate", tmp_path / "bad.xml"), "bad.xml")


def test_missing_model(tmp_path):
    refused(program.run("simulate", tmp_path / "nowhere.xml"), "nowhere.xml")
    refused(program.run("simulate", tmp_path), tmp_path.name)


CONTACT = {
    "geom": [0, 0], "dist": -0.01, "pos": [0, 0, 0], "frame": [0, 0, 1, 1, 0, 0, 0, 1, 0], "includemargin": 0,
    "friction": [1, 1, 0.1, 0.1, 0.1], "solref": [0.02, 1], "solreffriction": [0, 0],
    "solimp": [0.9, 0.95, 0.001, 0.5, 2], "dim": 3, "exclude": 0,
}  # fmt: skip

BAD_STATES = [
    ("not json", "{", []),
    ("not an object", "[1, 2]", []),
    ("unknown field", {"qposs": [0.0]}, ["qposs"]),
    ("too long", {"qpos": [0.0, 1.0]}, ["qpos", "1", "2"]),
    ("too short", {"qvel": []}, ["qvel"]),
    ("wrong type", {"ctrl": "full"}, ["ctrl"]),
    ("ragged", {"xfrc_applied": [[0, 0, 0], [0, 0, 0, 0, 0, 0]]}, ["xfrc_applied"]),
    ("nan", {"qpos": [math.nan]}, []),
    ("infinite", '{"qvel": [1e999]}', []),
    ("null", {"qvel": [None]}, ["qvel"]),
    ("no such geom", {"contacts": [{**CONTACT, "geom": [0, 7]}]}, ["geom", "7"]),
    ("impossible dimension", {"contacts": [{**CONTACT, "dim": 2}]}, ["dim", "2"]),
    ("contact without fields", {"contacts": [{"geom": [0, 0]}]}, ["contact"]),
]


@pytest.mark.parametrize(("state", "words"), [c[1:] for c in BAD_STATES], ids=[c[0] for c in BAD_STATES])
def test_state(tmp_path, state, words):
    """If the second line of input is bad, the first is answered, and the message gives the line number."""
    (tmp_path / "good.xml").write_text(GOOD)
    line = state if isinstance(state, str) else json.dumps(state)
    done = program.run("forward", tmp_path / "good.xml", stdin=f"{{}}\n{line}\n")
    refused(done, "line 2", *words)
    assert len(done.stdout.splitlines()) == 1


@pytest.mark.parametrize("change", [{"dist": -1e308}, {"pos": [1e308] * 3}, {"solref": [-1e308] * 2}], ids=str)
def test_a_contact_beyond_all_numbers(change):
    """Finite input with infinite forces is an error; otherwise the result would contain nulls."""
    line = json.dumps({"contacts": [{**CONTACT, "geom": [0, 1], **change}]})
    refused(program.run("forward", program.ROOT / "models/rolling_sphere.xml", stdin=line), "line 1", "diverged")


def test_controls(tmp_path):
    (tmp_path / "good.xml").write_text(GOOD)
    simulate = lambda *flags: program.run("simulate", tmp_path / "good.xml", "--steps", 5, *flags)
    refused(simulate("--ctrl", tmp_path / "gone.npy"), "gone.npy")
    np.save(tmp_path / "wide.npy", np.zeros((5, 3)))
    refused(simulate("--ctrl", tmp_path / "wide.npy"), "wide.npy", "3", "1")
    np.save(tmp_path / "nan.npy", np.array([[0.0], [np.nan]]))
    refused(simulate("--ctrl", tmp_path / "nan.npy"), "nan.npy")
    whole = (tmp_path / "wide.npy").read_bytes()
    short, endless = whole.replace(b"(5, 3)", b"(5, 1)")[:-100], whole.replace(b"(5, 3), }" + 8 * b" ", b"(999999999, 1), }")
    for name, content in (("short.npy", short), ("endless.npy", endless)):
        assert content != whole
        (tmp_path / name).write_bytes(content)
        refused(simulate("--ctrl", tmp_path / name), name)
    (tmp_path / "text.npy").write_text("no array")
    refused(simulate("--ctrl", tmp_path / "text.npy"), "text.npy")


def test_flags(tmp_path):
    (tmp_path / "good.xml").write_text(GOOD)
    simulate = lambda *flags: program.run("simulate", tmp_path / "good.xml", *flags)
    refused(simulate("--solver", "magic"), "magic", "newton")
    refused(simulate("--steps", "-3"))
    refused(simulate("--timestep", "0"), "timestep")
    refused(simulate("--tolerance", "nan"), "tolerance")
    refused(simulate("--keyframe", "nowhere"), "nowhere")
    refused(simulate("--steps", 2, "--record", tmp_path / "no/such/folder/out.npz"), "out.npz")
    refused(simulate("--frobnicate"), "frobnicate")
    refused(program.run("dance"), "dance")
