"""Parameters of a single simulation."""

from __future__ import annotations

from typing import Any

import clench
import numpy as np
import pytest
from scenes import ball, puppet, same_bits, same_state


def test_parameters_of_its_own() -> None:
    heavy, light = clench.Sim(ball()), clench.Sim(ball())
    mass = heavy.param("body_mass")
    np.testing.assert_array_equal(mass, heavy.model.body_mass)
    heavy.set_param("body_mass", mass * 3)
    np.testing.assert_array_equal(heavy.param("body_mass"), [0, 6])
    np.testing.assert_array_equal(light.param("body_mass"), [0, 2])
    np.testing.assert_array_equal(heavy.model.body_mass, [0, 2])
    np.testing.assert_array_equal(heavy.param("body_subtreemass"), [6, 6])
    heavy.set_param("timestep", 0.001)
    assert heavy.param("timestep").shape == ()
    heavy.step()
    light.step()
    assert (heavy.time, light.time) == (0.001, 0.002)
    heavy.set_param("gravity", [0, 0, -1])
    heavy.reset()
    heavy.qpos[2] = 1
    heavy.forward()
    assert heavy.qacc[2] == pytest.approx(-1)


@pytest.mark.parametrize("field", clench.PARAMETERS)
def test_every_parameter_can_be_read(field: str) -> None:
    sim = clench.Sim(puppet())
    values = sim.param(field)
    np.testing.assert_array_equal(values, getattr(sim.model, field))
    values += 1
    np.testing.assert_array_equal(sim.param(field), getattr(sim.model, field))


@pytest.mark.parametrize(
    ("field", "values", "error"),
    [
        ("body_mas", [0, 1], ValueError),
        ("body_mass", [1], ValueError),
        ("body_mass", [[0, 1]], ValueError),
        ("body_mass", [0, -1], ValueError),
        ("body_mass", [0, np.nan], ValueError),
        ("body_mass", [0, np.inf], ValueError),
        ("body_mass", ["0", "1"], TypeError),
        ("body_mass", [0, 1j], TypeError),
        ("body_mass", None, TypeError),
        ("body_subtreemass", [1, 1], ValueError),
        ("geom_size", np.zeros((2, 3)), ValueError),
        ("timestep", 0, ValueError),
        ("timestep", [0.1], ValueError),
    ],
)
def test_parameters_that_make_no_sense(field: str, values: Any, error: type[Exception]) -> None:
    sim, other = clench.Sim(ball()), clench.Sim(ball())
    with pytest.raises(error):
        sim.set_param(field, values)
    for name in clench.PARAMETERS:
        assert same_bits(sim.param(name), other.param(name)), name
    sim.step(3)
    other.step(3)
    assert same_state(sim.state, other.state)
