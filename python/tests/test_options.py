"""Options: their values, valid ranges, and error messages."""

from __future__ import annotations

import copy
import inspect
import pickle
from typing import Any

import clench
import numpy as np
import pytest
from clench import RigidOptions
from stubs import OPTIONS

# A value of each type that an option has.
EXAMPLES: dict[str, Any] = {
    "int": 7,
    "float": 0.5,
    "bool": True,
    'bool or "auto"': False,
    'int or "auto"': 12,
    '{"Newton", "CG"}': "CG",
    '{"pyramidal", "elliptic"}': "elliptic",
    '{"convex", "coulomb"}': "coulomb",
}
VALUES = {name: EXAMPLES[kind] for name, kind in OPTIONS}


def of_type(*kinds: str) -> list[str]:
    return [name for name, kind in OPTIONS if kind in kinds]


COUNTS = of_type("int", 'int or "auto"')
BOOLEANS = of_type("bool")
SWITCHES = of_type('bool or "auto"')
NOT_NEGATIVE = ["tolerance", "ls_tolerance", "noslip_tolerance", "constraint_timeconst", "ccd_tolerance"]


def test_what_is_set_is_kept_and_nothing_else() -> None:
    for name, value in VALUES.items():
        options = RigidOptions(**{name: value})
        for other in VALUES:
            assert getattr(options, other) == (value if other == name else None), (name, other)
        assert type(getattr(options, name)) is type(value)
    assert list(inspect.signature(RigidOptions).parameters) == list(VALUES)


def test_text_says_what_is_set() -> None:
    assert repr(RigidOptions()) == "RigidOptions()"
    text = "RigidOptions(constraint_solver='CG', iterations=3, sparse_solve='auto', warmstart=True)"
    options = RigidOptions(warmstart=True, iterations=3, constraint_solver="CG", sparse_solve="auto")
    assert repr(options) == text
    everything = RigidOptions(**VALUES)
    assert eval(repr(everything)) == everything


def test_equality_and_copies() -> None:
    everything = RigidOptions(**VALUES)
    assert everything == RigidOptions(**VALUES)
    assert RigidOptions() != RigidOptions(iterations=50) != RigidOptions(iterations=51)
    others: list[object] = [None, {}, "RigidOptions()"]
    assert RigidOptions() not in others
    for again in [pickle.loads(pickle.dumps(everything)), copy.copy(everything), copy.deepcopy(everything)]:
        assert again == everything
    assert pickle.loads(pickle.dumps(RigidOptions())) == RigidOptions()


def test_options_cannot_be_changed() -> None:
    options = RigidOptions(iterations=3)
    with pytest.raises(AttributeError):
        options.iterations = 4  # type: ignore[misc]
    with pytest.raises(TypeError):
        RigidOptions(3)  # type: ignore[call-arg, arg-type]
    with pytest.raises(TypeError, match="foo"):
        RigidOptions(foo=1)  # type: ignore[call-arg]


def test_numbers_of_numpy_are_numbers() -> None:
    options = RigidOptions(iterations=np.int32(4), tolerance=np.float32(0.5), islands=np.bool_(True), impratio=2)
    assert (options.iterations, options.tolerance, options.islands, options.impratio) == (4, 0.5, True, 2.0)


def refused(name: str, value: Any) -> str:
    with pytest.raises(ValueError) as raised:
        RigidOptions(**{name: value})
    text = str(raised.value)
    assert text.startswith(f"option {name} is {value!r}, but must be "), text
    return text


def mistyped(name: str, value: Any) -> None:
    with pytest.raises(TypeError, match=f"^option {name} must be .*, not {type(value).__name__}$"):
        RigidOptions(**{name: value})


def test_numbers_out_of_range() -> None:
    for name in COUNTS:
        for value in [-1, 2**31, 2**200, -(2**200)]:
            assert refused(name, value).endswith("from 0 to 2147483647")
    for name in NOT_NEGATIVE:
        for number in [-1e-9, float("nan"), float("inf"), -float("inf")]:
            assert refused(name, number).endswith("finite and not negative")
    for number in [0.0, -1.0, float("nan"), float("inf")]:
        assert refused("impratio", number).endswith("finite and positive")
    refused("tolerance", 10**400)
    # The limits themselves are valid.
    assert RigidOptions(iterations=0, tolerance=0.0, max_contacts=2**31 - 1).max_contacts == 2**31 - 1


def test_words_that_mean_nothing() -> None:
    assert refused("constraint_solver", "newton").endswith('"Newton" or "CG"')
    assert refused("friction_cone", "").endswith('"pyramidal" or "elliptic"')
    for name in SWITCHES:
        assert refused(name, "on").endswith('must be a bool or "auto"')
    assert refused("max_contacts", "all").endswith('must be an integer or "auto"')


def test_wrong_types() -> None:
    for name in COUNTS:
        for value in [1.0, True, [1], b"auto"]:
            mistyped(name, value)
    for name in [*NOT_NEGATIVE, "impratio"]:
        for value in ["1", True, [1.0], 1j]:
            mistyped(name, value)
    for name in [*BOOLEANS, *SWITCHES]:
        for value in [0, 1.0, np.array([True])]:
            mistyped(name, value)
    for name in ["constraint_solver", "friction_cone", "contact_model"]:
        for value in [0, b"CG", ["CG"]]:
            mistyped(name, value)


def test_a_number_whose_conversion_fails_says_so_itself() -> None:
    class Broken:
        def __index__(self) -> int:
            raise RuntimeError("no index today")

    with pytest.raises(RuntimeError, match="no index today"):
        RigidOptions(iterations=Broken())


@pytest.mark.parametrize("of_file", ["enable", "disable"])
@pytest.mark.parametrize("of_user", [None, False, True])
def test_what_a_user_sets_wins_over_the_file(of_file: str, of_user: bool | None) -> None:
    model = clench.Model.from_xml(
        f"""<mujoco>
              <option><flag constraint="{of_file}"/></option>
              <worldbody>
                <geom type="plane" size="1 1 1"/>
                <body pos="0 0 0.1"><freejoint/><geom size="0.1"/></body>
              </worldbody>
            </mujoco>"""
    )
    sim = clench.Sim(model, RigidOptions(disable_constraint=of_user))
    assert sim.options.disable_constraint is of_user
    sim.step(100)
    falls = of_file == "disable" if of_user is None else of_user
    assert (sim.qpos[2] < 0.0) == falls
