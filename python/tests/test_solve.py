"""The convex problem: its solutions are optimal for costs that these tests implement from their definitions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from threading import Thread
from typing import Any

import clench
import numpy as np
import pytest
from clench import Block, RigidOptions, solve

Array = np.ndarray[Any, np.dtype[np.float64]]

COSTS = ["quadratic", "one_sided", "huber", "pyramid", "elliptic"]


def cost(block: Block, qacc: Array) -> float:
    """Returns the cost of a block by the definitions in `Block`."""
    y = block.jacobian @ qacc - block.aref
    d, shape = 1.0 / block.R, block.shape
    if block.cost == "quadratic":
        return float(np.sum(d * y**2) / 2)
    if block.cost == "one_sided":
        return float(np.sum(d * np.minimum(y, 0.0) ** 2) / 2)
    assert shape is not None
    if block.cost == "huber":
        bound = shape * block.R
        return float(np.sum(np.where(np.abs(y) < bound, d * y**2 / 2, shape * np.abs(y) - shape * bound / 2)))
    if block.cost == "pyramid":
        edges = y[0] + np.outer([1.0, -1.0], shape[1:] * y[1:])
        return float(d[0] * np.sum(np.minimum(edges, 0.0) ** 2) / 2)
    # Elliptic: the squared distance to the polar of a cone that is circular after scaling.
    mu = shape[0]
    normal, tangent = mu * y[0], float(np.linalg.norm(shape[1:] * y[1:]))
    if normal >= mu * tangent:
        return 0.0
    if mu * normal + tangent <= 0.0:
        return float(np.sum(d * y**2) / 2)
    return float(d[0] / (mu**2 * (1 + mu**2)) * (normal - mu * tangent) ** 2 / 2)


def total(mass: Array, a_unc: Array, blocks: Sequence[Block], qacc: Array) -> float:
    away = qacc - a_unc
    return float(away @ mass @ away) / 2 + sum(cost(block, qacc) for block in blocks)


def random_block(rng: np.random.Generator, kind: str, nv: int) -> Block:
    dim = int(rng.integers(2, 7)) if kind in ("pyramid", "elliptic") else int(rng.integers(1, 7))
    softness = float(rng.uniform(0.05, 0.5))
    r: Array = np.full(dim, softness)
    shape: Array | None = None
    if kind in ("huber", "pyramid"):
        shape = rng.uniform(0.2, 1.5, dim)
    elif kind == "elliptic":
        friction, ratio = rng.uniform(0.2, 1.5, dim - 1), float(rng.uniform(0.5, 2.0))
        shape = np.concatenate(([friction[0] * np.sqrt(ratio)], friction))
        r[1:] = softness * (shape[0] / friction) ** 2
    else:
        r = rng.uniform(0.05, 0.5, dim)
    return Block(kind, rng.normal(size=(dim, nv)), rng.normal(size=dim), r, shape)  # type: ignore[arg-type]


def random_problem(seed: int, nv: int, kinds: Sequence[str]) -> tuple[Array, Array, list[Block]]:
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(nv, nv))
    mass = root @ root.T + np.eye(nv)
    return (mass + mass.T) / 2, 3.0 * rng.normal(size=nv), [random_block(rng, kind, nv) for kind in kinds]


def gradient(function: Callable[[Array], float], at: Array) -> Array:
    """Returns the gradient by central differences."""
    step = 1e-6
    return np.array([(function(at + step * e) - function(at - step * e)) / (2 * step) for e in np.eye(len(at))])


def lowest(function: Callable[[Array], float], around: Array) -> float:
    """Returns the minimum of a convex function of two numbers, by successively finer grids."""
    best, width = around, 20.0
    while width > 1e-7:
        offsets = np.linspace(-width, width, 13)
        points = [best + np.array([x, y]) for x in offsets for y in offsets]
        best = min(points, key=function)
        width /= 3.0
    return function(best)


@pytest.mark.parametrize("kind", COSTS)
@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("algorithm", ["Newton", "CG"])
def test_solutions_are_optimal(kind: str, seed: int, algorithm: Any) -> None:
    mass, a_unc, blocks = random_problem(seed, 7, [kind, kind, "quadratic", kind])
    options = RigidOptions(constraint_solver=algorithm, iterations=1000, tolerance=0.0)
    solution = solve(mass, a_unc, blocks, options)
    assert solution.status in ("no_progress", "converged") and solution.stats.status == solution.status
    assert solution.certificate == solution.stats.gap

    # Forces are negative gradients of costs and balance the inertial forces.
    for block, force in zip(blocks, solution.forces, strict=True):
        rows = Block(block.cost, np.eye(block.dim), 0.0, block.R, block.shape)
        y = block.jacobian @ solution.qacc - block.aref
        np.testing.assert_allclose(force, -gradient(lambda y: cost(rows, y), y), atol=1e-6)
    total_force = sum(block.jacobian.T @ force for block, force in zip(blocks, solution.forces, strict=True))
    np.testing.assert_allclose(solution.qfrc_constraint, total_force, atol=1e-11)
    np.testing.assert_allclose(mass @ (solution.qacc - a_unc), total_force, atol=1e-9)
    assert 0.0 <= solution.certificate < 1e-18

    # The cost increases in every direction.
    least = total(mass, a_unc, blocks, solution.qacc)
    for direction in np.random.default_rng(seed).normal(size=(20, 7)):
        assert total(mass, a_unc, blocks, solution.qacc + 1e-3 * direction) > least


@pytest.mark.parametrize("kind", COSTS)
@pytest.mark.parametrize("iterations", [0, 1, 2, 50])
def test_the_certificate_bounds_what_is_missing(kind: str, iterations: int) -> None:
    for seed in range(3):
        mass, a_unc, blocks = random_problem(seed, 2, [kind, kind])
        solution = solve(mass, a_unc, blocks, RigidOptions(iterations=iterations))
        least = lowest(lambda qacc: total(mass, a_unc, blocks, qacc), solution.qacc)
        assert total(mass, a_unc, blocks, solution.qacc) - least <= solution.certificate + 1e-12
        # The search without derivatives and the solver find the same minimum.
        assert least == pytest.approx(total(mass, a_unc, blocks, solve(mass, a_unc, blocks).qacc), rel=1e-9)
        if iterations == 50:
            assert solution.certificate < 1e-12
        elif solution.status == "iteration_limit":
            assert solution.certificate > 0.0
    if iterations == 0:
        assert (solution.status, solution.stats.iterations) == ("iteration_limit", 0)


def test_without_constraints_nothing_changes() -> None:
    mass, a_unc, _ = random_problem(3, 5, [])
    solution = solve(mass, a_unc, [])
    np.testing.assert_array_equal(solution.qacc, a_unc)
    assert (solution.status, solution.certificate, solution.forces) == ("unconstrained", 0.0, [])
    # An inactive limit has no effect.
    limit = Block("one_sided", np.ones(5), aref=a_unc.sum() - 1.0, R=0.1)
    solution = solve(mass, a_unc, [limit])
    np.testing.assert_array_equal(solution.qacc, a_unc)
    np.testing.assert_array_equal(solution.forces[0], [0.0])
    # Without degrees of freedom there is nothing to solve.
    empty = solve(np.zeros((0, 0)), [], [])
    assert empty.qacc.shape == (0,) and empty.status == "unconstrained"


@pytest.mark.parametrize("push", [-9.0, -0.5, 0.0, 0.5, 9.0])
def test_dry_friction_sticks_or_slips(push: float) -> None:
    mass, softness, loss = 2.0, 0.01, 3.0
    solution = solve([[mass]], [push / mass], [Block("huber", [1.0], 0.0, softness, loss)])
    sticking = push / (mass + 1.0 / softness)
    slipping = (push - np.sign(push) * loss) / mass
    sticks = abs(sticking / softness) <= loss
    assert sticks == (abs(push) < 3.0)
    np.testing.assert_allclose(solution.qacc, [sticking if sticks else slipping], rtol=1e-12, atol=1e-15)
    force = -sticking / softness if sticks else -np.sign(push) * loss
    np.testing.assert_allclose(solution.forces[0], [force], rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("kind", ["pyramid", "elliptic"])
@pytest.mark.parametrize(("push", "slips"), [(1.0, False), (30.0, True)])
def test_contacts_hold_until_friction_is_overcome(kind: Any, push: float, slips: bool) -> None:
    # A unit mass is pressed on a floor with 10 and pushed along it.
    friction, softness = 0.5, 0.01
    contact = Block(kind, np.eye(2), 0.0, softness, [friction, friction])
    solution = solve(np.eye(2), [-10.0, push], [contact])
    normal, tangent = solution.forces[0]
    assert normal > 0.0 > tangent
    if slips:
        assert tangent == pytest.approx(-friction * normal, rel=1e-9)
        assert solution.qacc[1] == pytest.approx(push - friction * normal, rel=1e-9)
    else:
        assert -tangent < friction * normal
        assert abs(solution.qacc[1]) < 0.1 * push


def test_inputs_are_converted_as_numpy_would() -> None:
    mass, a_unc, blocks = random_problem(5, 4, ["one_sided", "quadratic"])
    mass, a_unc = np.round(mass), np.round(a_unc)
    expected = solve(mass, a_unc, blocks).qacc
    backwards = np.ascontiguousarray(a_unc[::-1])[::-1]
    read_only = mass.copy()
    read_only.flags.writeable = False
    unaligned = np.frombuffer(b"x" + mass.tobytes(), dtype=np.uint8)[1:].view(np.float64).reshape(4, 4)
    inputs: list[tuple[Any, Any]] = [
        (np.asfortranarray(mass), backwards),
        (mass.astype(">f8"), a_unc.astype(np.float32)),
        (mass.astype(int), a_unc.astype(np.int8)),
        (mass.tolist(), tuple(a_unc)),
        (read_only, a_unc.astype(np.longdouble)),
        (unaligned, a_unc),
    ]
    for m, a in inputs:
        np.testing.assert_array_equal(solve(m, a, iter(blocks)).qacc, expected)
    np.testing.assert_array_equal(solve(np.eye(2), [True, False], []).qacc, [1.0, 0.0])


def test_blocks_keep_what_they_were_given() -> None:
    jacobian = np.arange(6.0).reshape(2, 3)
    block = Block("huber", jacobian, 1, [0.1, 0.2], shape=3)
    jacobian[:] = 0.0
    np.testing.assert_array_equal(block.jacobian, np.arange(6.0).reshape(2, 3))
    np.testing.assert_array_equal(block.aref, [1.0, 1.0])
    np.testing.assert_array_equal(block.R, [0.1, 0.2])
    np.testing.assert_array_equal(block.shape, [3.0, 3.0])
    assert (block.cost, block.dim, repr(block)) == ("huber", 2, "Block(cost='huber', dim=2, nv=3)")
    assert Block("quadratic", [1.0], 0, 1).shape is None


EYE = np.eye(2)
# Without types, since type checkers would refuse these arguments too.
any_block: Any = Block
any_solve: Any = solve


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: any_solve(EYE, [0.0, np.nan], []), ValueError, "a_unc is not finite: number 1 is NaN"),
        (lambda: any_solve([[np.inf, 0], [0, 1]], [0, 0], []), ValueError, "M is not finite: number 0 is inf"),
        (lambda: any_solve(EYE, [0, 0, 0], []), ValueError, "M has shape (2, 2), but a_unc has 3 numbers"),
        (lambda: any_solve([0.0, 0.0], [0, 0], []), ValueError, "M has shape (2,)"),
        (lambda: any_solve(EYE, [[0, 0]], []), ValueError, "a_unc has shape (1, 2), but must have (2,)"),
        (lambda: any_solve(EYE, 0.0, []), ValueError, "a_unc has shape (), but must have (1,)"),
        (lambda: any_solve([[1, 0.1], [0, 1]], [0, 0], []), ValueError, "M is not symmetric: M[1, 0] is 0, M[0, 1]"),
        (lambda: any_solve(-EYE, [0, 0], []), ValueError, "M is not positive definite"),
        (lambda: any_solve(np.ones((2, 2)), [0, 0], []), ValueError, "M is not positive definite"),
        (lambda: any_solve([[1, 2], [3]], [0, 0], []), ValueError, "inhomogeneous"),
        (lambda: any_solve(EYE * 1j, [0, 0], []), TypeError, "M must be numbers, not of dtype complex128"),
        (lambda: any_solve(EYE, ["0", "0"], []), TypeError, "a_unc must be numbers, not of dtype <U1"),
        (lambda: any_solve(EYE, None, []), TypeError, "a_unc must be numbers, not of dtype object"),
        (lambda: any_solve(EYE, np.zeros(2, "M8[s]"), []), TypeError, "a_unc must be numbers"),
        (lambda: any_solve(EYE, [0, 0], 3), TypeError, "not iterable"),
        (lambda: any_solve(EYE, [0, 0], [3]), TypeError, "blocks[0] must be a Block, not int"),
        (lambda: any_solve(EYE, [0, 0], [], {}), TypeError, "RigidOptions"),
        (lambda: any_block("quadratc", [1], 0, 1), ValueError, '"quadratc"; did you mean "quadratic"?'),
        (lambda: any_block(3, [1], 0, 1), TypeError, "str"),
        (lambda: any_block("quadratic", 1.0, 0, 1), ValueError, "jacobian has shape (), but must have (dim, nv)"),
        (lambda: any_block("quadratic", np.ones((1, 1, 1)), 0, 1), ValueError, "jacobian has shape (1, 1, 1)"),
        (lambda: any_block("quadratic", [np.inf], 0, 1), ValueError, "jacobian is not finite"),
        (lambda: any_block("quadratic", EYE, [0], 1), ValueError, "aref has shape (1,), but must have (2,)"),
        (lambda: any_block("quadratic", EYE, 0, [[1, 1]]), ValueError, "R has shape (1, 2), but must have (2,)"),
        (lambda: any_block("quadratic", [1], 0, 0), ValueError, "R has 0e0, but must be positive"),
        (lambda: any_block("quadratic", [1], 0, -1), ValueError, "R has -1e0, but must be positive"),
        (lambda: any_block("quadratic", [1], 0, 1e-310), ValueError, "its inverse finite"),
        (lambda: any_block("quadratic", [1], 0, 1, 1), ValueError, "a quadratic cost has no shape"),
        (lambda: any_block("huber", [1], 0, 1), ValueError, '"huber" needs a shape'),
        (lambda: any_block("quadratic", [1], 0), TypeError, "R"),
    ],
)
def test_mistakes(call: Callable[[], object], error: type[Exception], words: str) -> None:
    with pytest.raises(error) as raised:
        call()
    assert words in str(raised.value)


@pytest.mark.parametrize(
    ("block", "words"),
    [
        (any_block("quadratic", [1], 0, 1), "blocks[0] has a jacobian of 1 columns, but a_unc has 2 numbers"),
        (any_block("quadratic", np.ones((7, 2)), 0, 1), "blocks[0]: a block has 1 to 6 rows"),
        (any_block("quadratic", np.ones((0, 2)), 0, 1), "blocks[0]: a block has 1 to 6 rows"),
        (any_block("pyramid", [1, 0], 0, 1, 1), "blocks[0]: a cone has 2 to 6 rows"),
        (any_block("pyramid", EYE, 0, [1, 2], 1), "blocks[0]: the rows of a pyramid need the same D"),
        (any_block("elliptic", EYE, 0, [1, 2], 1), "blocks[0]: the rows of an elliptic cone need D_j = D_0 (mu_j / mu)²"),
        (any_block("pyramid", EYE, 0, 1, 0), "blocks[0]: a friction coefficient is not positive"),
        (any_block("huber", [1, 0], 0, 1, -1), "blocks[0]: a friction loss is negative"),
    ],
)
def test_blocks_that_make_no_sense(block: Block, words: str) -> None:
    with pytest.raises(ValueError) as raised:
        solve(EYE, [0, 0], [block])
    assert str(raised.value) == words


def test_numbers_too_large_to_solve_with_are_reported() -> None:
    solution = solve(EYE * 1e300, [1e300, 1.0], [Block("quadratic", EYE * 1e300, 1e300, 1e-300)])
    assert solution.status == "non_finite"


def test_strange_numbers_never_crash() -> None:
    rng = np.random.default_rng(0)
    scales = [0.0, 1e-300, 1e-30, 1e-9, 1.0, 1e9, 1e30, 1e300]
    solved = 0
    for _ in range(2000):
        nv = int(rng.integers(0, 4))
        kinds = rng.choice(COSTS, rng.integers(0, 4)).tolist()
        mass, a_unc, blocks = random_problem(int(rng.integers(1000)), nv, kinds)
        strange = [
            Block(b.cost, b.jacobian * rng.choice(scales), b.aref * rng.choice(scales), b.R, b.shape) for b in blocks
        ]
        try:
            solution = solve(mass * rng.choice(scales), a_unc * rng.choice(scales), strange)
        except ValueError:
            continue
        solved += solution.status != "non_finite"
        assert np.isfinite(solution.qacc).all() or solution.status == "non_finite"
    assert solved > 500


def test_many_threads_solve_at_once() -> None:
    problem = random_problem(1, 30, COSTS * 3)
    expected = solve(*problem).qacc
    results: list[Array] = []

    def work() -> None:
        results.extend(solve(*problem).qacc for _ in range(50))

    threads = [Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 200
    for qacc in results:
        np.testing.assert_array_equal(qacc, expected)


def test_solutions_say_how_they_are() -> None:
    limit = clench.Block("one_sided", [0.0, 1.0], aref=0.0, R=0.25)
    solution = clench.solve([[1.0, 0.0], [0.0, 1.0]], [-1.0, -1.0], [limit])
    np.testing.assert_allclose(solution.qacc, [-1.0, -0.2], rtol=1e-15)
    assert repr(solution).startswith("Solution(status='converged', certificate=")
    assert repr(solution.stats).startswith("SolverStats(status='converged', iterations=1, ")
