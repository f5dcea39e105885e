"""Calls the whole API of the package with random arguments: `python fuzz.py SEED CALLS`.

Calls may raise only documented exception classes and must end in time. Objects that were not misused must still work.
A crash ends the process, and the fault handler ends a hang, so run it in a separate process, as `test_fuzz.py` does.
"""

from __future__ import annotations

import contextlib
import copy
import faulthandler
import functools
import pickle
import sys
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np

import clench
from junk import TEXTS, Junk, Odd
from scenes import BALL, FIELDS, PUPPET, ROOT, ball, example, puppet, same_bits

ALLOWED = (
    KeyError,  # of custom numbers, texts and tuples that a file does not have
    *(ValueError, TypeError, IndexError, AttributeError, OverflowError, MemoryError, clench.ClenchError, Odd),
    pickle.PicklingError,
)
# The maximum seconds of one call on a slow and busy machine. Most take less than a millisecond.
LONGEST = 10.0

# Few iterations, so that a solve with an arbitrarily coarse line search ends soon.
OPTIONS = {
    "constraint_solver": ("Newton", "CG"),
    "iterations": (0, 1, 5, 50, 1000),
    "tolerance": (0, 1e-8, 1e300),
    "ls_iterations": (0, 1, 50, 2**31 - 1),
    "ls_tolerance": (0, 0.01, 1e300),
    "constraint_timeconst": (0, 0.01, 1e300),
    "enable_joint_limit": (True, False),
    "disable_constraint": (True, False),
    "sparse_solve": (True, False, "auto"),
    "noslip_iterations": (0, 3),
    "noslip_tolerance": (0, 1e-6),
    "max_contacts": (0, 1, 5, 2**31 - 1, "auto"),
    "friction_cone": ("pyramidal", "elliptic"),
    "impratio": (1e-300, 1, 10, 1e300),
    "islands": (True, False, "auto"),
    "warmstart": (True, False),
    "ccd_iterations": (0, 1, 35, 2**31 - 1),
    "ccd_tolerance": (0, 1e-6, 1e300),
    "autoreset": (True, False),
}
COSTS = ("quadratic", "one_sided", "huber", "pyramid", "elliptic")
KINDS = ("body", "joint", "geom", "site", "camera", "tendon", "actuator", "sensor", "equality", "keyframe", "pair", "mesh", "hfield")
OBJECTS = ("body", "body_com", "geom", "site", "camera", "nothing")
KEYS = ("bent", "dropped", "struck", "raised", 0, 1, -1, None)
PATHS = (ROOT / "models/pendulum.xml", str(ROOT / "models/pinch.xml"), ROOT, ROOT / "README.md", "", "none.xml", "\0")


class Fuzz:
    """Models, simulations and batches, and random calls to them."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        self.models = [ball(), puppet(), example("pendulum"), example("box_stack"), example("quadruped")]
        self.owners: list[Any] = [clench.Sim(model) for model in self.models]
        self.owners += [clench.Batch(model, 3, threads=2) for model in self.models]
        self.states = [owner.state for owner in self.owners]
        self.blocks: list[tuple[int, clench.Block]] = []
        self.options = [clench.RigidOptions()]
        self.results: list[Any] = []
        self.junk = Junk(self.rng, self.owners)
        self.outcomes: Counter[str] = Counter()
        self.slowest = (0.0, "nothing")

    # Arguments: mostly valid, sometimes arbitrary.

    def maybe(self, make: Callable[[], Any]) -> Any:
        return self.junk.any() if self.junk.chance(0.25) else make()

    def choose(self, values: Any) -> Any:
        return self.junk.choose(values)

    def count(self) -> Any:
        return self.maybe(lambda: int(self.rng.integers(0, 6)))

    def numbers(self, *shape: int) -> Any:
        return self.maybe(lambda: self.junk.array(shape) if self.junk.chance(0.3) else self.rng.normal(size=shape))

    def subset(self, n: int) -> Any:
        return self.maybe(lambda: self.rng.random(n) < 0.5)

    def names(self) -> Any:
        return self.maybe(lambda: [str(name) for name in self.rng.choice(clench.OUTPUTS, self.rng.integers(0, 4))])

    def key(self) -> Any:
        return self.maybe(lambda: self.choose(KEYS))

    def text(self) -> str:
        """Returns the XML of a model, possibly damaged."""
        text = self.choose((BALL, PUPPET, (ROOT / "models/box_stack.xml").read_text()))
        words = text.split('"')
        for _ in range(self.rng.integers(0, 4)):
            at = int(self.rng.integers(len(words)))
            words[at] = self.choose(("0", "-1", "nan", "1e308", "1 2 3", "x", "", "true", "<", "&", *TEXTS[:8], words[-at]))
        return '"'.join(words)

    def parameter(self, model: clench.Model, *more: int) -> tuple[Any, Any]:
        field = self.choose(clench.PARAMETERS)
        shape = np.shape(getattr(model, field))
        near = np.asarray(getattr(model, field)) * self.rng.uniform(0.5, 1.5, (*more, *shape))
        return self.maybe(lambda: field), near if self.junk.chance(0.4) else self.numbers(*more, *shape)

    # Calls, by object.

    def call_model(self) -> Any:
        model = self.choose(self.models)
        what = self.choose(("from_xml", "from_file", "names", "element", "field", "custom", "to_xml", "other"))
        if what == "from_xml":
            made = clench.Model.from_xml(self.maybe(self.text))
            if self.junk.chance(0.3):
                self.models[int(self.rng.integers(1, len(self.models)))] = made
            return made
        if what == "from_file":
            return clench.Model.from_file(self.maybe(lambda: self.choose(PATHS)))
        if what == "custom":
            kept = self.choose((model.numeric, model.text, model.custom_tuple))
            return kept(self.maybe(lambda: self.choose(("a", ""))))
        if what == "to_xml":
            return model.to_xml()
        if what == "names":
            return model.names(self.maybe(lambda: self.choose(KINDS)))
        if what == "element":
            element = getattr(model, self.choose(KINDS))(self.maybe(lambda: self.choose((0, 1, 2, "ball", "torso", -1, 99))))
            return [getattr(element, name) for name in dir(element)]
        if what == "field":
            return getattr(model, self.maybe(lambda: self.choose(dir(model))))
        return self.touch(model)

    def call_options(self) -> Any:
        chosen = dict.fromkeys(str(name) for name in self.rng.choice(list(OPTIONS), self.rng.integers(0, 5)))
        made = clench.RigidOptions(**{name: self.maybe(functools.partial(self.choose, OPTIONS[name])) for name in chosen})
        self.options[int(self.rng.integers(-1, 8)) :] = [made]
        return self.touch(made)

    def call_solve(self) -> Any:
        nv = int(self.rng.integers(0, 6))
        if self.junk.chance(0.6) or not self.blocks:
            cost, dim = self.choose(COSTS), int(self.rng.integers(1, 7))
            shape = None if cost in COSTS[:2] else np.full(dim, 0.7)
            jacobian = self.numbers(dim, nv) if self.junk.chance(0.7) else self.numbers(nv)
            arguments = [cost, jacobian, self.numbers(dim), np.full(dim, 0.1), shape]
            if self.junk.chance(0.3):
                arguments[int(self.rng.integers(5))] = self.junk.any()
            self.blocks[int(self.rng.integers(-1, 30)) :] = [(nv, clench.Block(*arguments))]
            return self.touch(self.blocks[-1][1])
        blocks = [block for of, block in self.blocks if of == nv or self.junk.chance(0.1)]
        factor = self.rng.normal(size=(nv, nv))
        mass = factor @ factor.T + np.eye(nv) * self.choose((0, 1e-9, 1))
        solution = clench.solve(
            self.maybe(lambda: mass), self.numbers(nv), self.maybe(lambda: blocks), self.maybe(lambda: self.choose(self.options))
        )
        return self.touch(solution)

    def call_new(self) -> Any:
        """Replaces a simulation or batch by a new one."""
        model, options = self.maybe(lambda: self.choose(self.models)), self.maybe(lambda: self.choose([None, *self.options]))
        precision = self.maybe(lambda: self.choose(("64", "32")))
        if self.junk.chance(0.4):
            made: Any = clench.Sim(model, options, precision=precision)
        else:
            threads = self.maybe(lambda: self.choose((None, 1, 2, 3)))
            # Two models of one file have one layout.
            models = self.maybe(lambda: self.choose((model, [model], [model, model])))
            made = clench.Batch(models, self.count(), precision, threads, options=options, record=self.names())
        self.owners[int(self.rng.integers(len(self.owners)))] = made
        return made

    def call_views(self) -> Any:
        owner = self.choose(self.owners)
        name = self.choose((*FIELDS, "state"))
        if name == "state":
            if self.junk.chance(0.5):
                self.states[int(self.rng.integers(len(self.states)))] = owner.state
            else:
                owner.state = self.maybe(lambda: self.choose(self.states))
            return None
        view = getattr(owner, name)
        if self.junk.chance(0.5):
            setattr(owner, name, self.numbers(*np.shape(view)))
        elif np.ndim(view):
            if self.junk.chance(0.1):
                view = view.view(np.uint8) if name == "eq_active" else view
                view[...] = self.choose((0, 1, 7, 255) if name == "eq_active" else (0, np.nan, np.inf, 1e300, -1e30))
            else:
                view[self.junk.any()] = self.junk.any()
        return None

    def call_state(self) -> Any:
        index = int(self.rng.integers(len(self.states)))
        state = self.states[index]
        what = self.rng.integers(4)
        if what == 0:
            fields = {name: getattr(state, name) for name in FIELDS}
            fields[self.choose(FIELDS)] = self.junk.any()
            self.states[index] = clench.State(**fields)
        elif what == 1:
            data = bytearray(state.to_bytes())
            for _ in range(self.rng.integers(0, 3)):
                data[int(self.rng.integers(len(data)))] = int(self.rng.integers(256))
            self.states[index] = clench.State.from_bytes(self.maybe(lambda: bytes(data)))
        elif what == 2:
            changed = copy.copy(state)
            setattr(changed, self.choose(FIELDS), self.junk.any())
            self.choose(self.owners).state = changed
        return self.touch(state)

    def call_owner(self) -> Any:
        """Calls methods that simulations and batches have in common."""
        owner = self.choose(self.owners)
        what = self.choose(("step", "step", "forward", "output", "param", "attribute", "touch"))
        if what == "step":
            return owner.step(self.count())
        if what == "forward":
            return owner.forward()
        if what == "output":
            return owner.output(self.maybe(lambda: self.choose(clench.OUTPUTS)))
        if what == "param":
            return owner.param(self.maybe(lambda: self.choose(clench.PARAMETERS)))
        if what == "attribute":
            name = self.maybe(lambda: self.choose(clench.OUTPUTS))
            change = self.choose((getattr, getattr, delattr, setattr))
            return change(owner, name, 1) if change is setattr else change(owner, name)
        return self.touch(owner)

    def call_sim(self) -> Any:
        sim = self.choose([owner for owner in self.owners if isinstance(owner, clench.Sim)] or [clench.Sim(ball())])
        views = ("contacts", "constraints", "solver_stats")
        what = self.choose(("reset", "set_equality", "set_param", "set_constants", "mass_matrix", "ray", "distance", *views))
        if what == "reset":
            return sim.reset(self.key())
        if what == "set_equality":
            which = self.maybe(lambda: self.choose((0, 1, "held", "grip")))
            return sim.set_equality(which, self.maybe(lambda: self.junk.chance(0.5)))
        if what == "set_param":
            return sim.set_param(*self.parameter(sim.model))
        if what in ("mass_matrix", "set_constants"):
            return getattr(sim, what)()
        if what == "ray":
            groups = self.maybe(lambda: self.choose((None, [0], [1, 5])))
            body = self.maybe(lambda: self.choose((None, 0, "ball")))
            fixed = self.maybe(lambda: self.junk.chance(0.5))
            hit = sim.ray(self.numbers(3), self.numbers(3), groups=groups, fixed=fixed, exclude_body=body)
            return self.touch(hit)
        if what == "distance":
            first, second = (self.maybe(lambda: self.choose((0, 1, "floor", "ball"))) for _ in range(2))
            return self.touch(sim.distance(first, second, self.maybe(lambda: self.choose((None, 1.0)))))
        return self.touch(getattr(sim, what))

    def call_batch(self) -> Any:
        batch = self.choose([owner for owner in self.owners if isinstance(owner, clench.Batch)] or [clench.Batch(ball(), 2)])
        n, model = batch.n_envs, batch.model
        changes = ("reset", "revive", "forward", "randomize", "set_constants", "record", "rollout", "set_state")
        what = self.choose((*changes, "fault", "sim", "status", "geoms_of"))
        if what == "reset":
            mask = self.choose((None, self.subset(n)))
            others = self.rng.integers(0, len(batch.models) + 1, self.rng.integers(0, n + 1))
            return batch.reset(mask, self.key(), env_model=self.maybe(lambda: self.choose((None, others))))
        if what == "geoms_of":
            return batch.env_model, batch.geoms_of(self.count())
        if what in ("revive", "forward", "set_constants"):
            return getattr(batch, what)(self.subset(n))
        if what in ("fault", "sim"):
            made = getattr(batch, what)(self.count())
            if what == "sim":
                self.owners[int(self.rng.integers(len(self.owners)))] = made
            return made
        if what == "randomize":
            envs = self.rng.integers(0, max(n, 1), self.rng.integers(0, n + 1))
            given = self.maybe(lambda: self.choose((None, envs)))
            count = n if given is None else np.size(envs)
            consistent = self.maybe(lambda: self.junk.chance(0.3))
            return batch.randomize(*self.parameter(model, count), given, consistent=consistent)
        if what == "set_state":
            envs = self.rng.integers(0, max(n, 1), self.rng.integers(0, n + 1))
            return batch.set_state(self.maybe(lambda: self.choose(self.states)), self.maybe(lambda: self.choose((None, envs))))
        if what == "record":
            names = self.names()
            return batch.record(*names) if isinstance(names, list) else batch.record(names)
        if what == "rollout":
            steps = int(self.rng.integers(0, 5))
            initial = self.numbers(n, 1 + model.nq + model.nv + model.na) * 1.0 if self.junk.chance(0.3) else self.choose((None, self.choose(self.states)))
            ctrl = self.choose((None, self.numbers(steps, model.nu), self.numbers(n, steps, model.nu), lambda step: self.numbers(model.nu)))
            progress = self.maybe(lambda: self.choose((None, False, lambda done, steps: None)))
            # A bar would be printed.
            progress = None if isinstance(progress, (bool, np.bool_)) else progress
            return batch.rollout(initial, ctrl, self.names(), self.maybe(lambda: self.choose((None, steps))), progress=progress)
        return batch.status, batch.running, batch.outputs, batch.bytes_per_env

    def call_question(self) -> Any:
        """Calls queries of simulations and batches, and constraints at run time."""
        owner = self.choose(self.owners)
        model, lead = owner.model, np.shape(owner.time)
        name = self.maybe(lambda: self.choose((0, 1, "ball", "torso", -1)))
        thing = {self.choose(OBJECTS): name} if self.junk.chance(0.8) else {}
        x, point = self.numbers(*lead, model.nv), self.numbers(3)
        qpos = [self.numbers(*lead, model.nq) for _ in range(2)]
        kind, sizes = self.choose(("rgb", "depth", "geom")), [self.maybe(lambda: 16), self.maybe(lambda: 12)]
        looks = {key: self.maybe(functools.partial(np.copy, own)) for key, own in model.appearance().items()}
        if isinstance(owner, clench.Batch):
            sizes.insert(0, self.count())
        asked: dict[str, Callable[[], Any]] = {
            "velocity": lambda: owner.velocity(**thing, local=self.maybe(lambda: True)),
            "acceleration": lambda: owner.acceleration(**thing),
            "jacobian": lambda: owner.jacobian(**thing, point=self.maybe(lambda: self.choose((None, point)))),
            "jacobian_rate": lambda: owner.jacobian_rate(**thing, point=self.maybe(lambda: self.choose((None, point)))),
            "subtree_jacobian": lambda: owner.subtree_jacobian(name),
            "joint_forces": lambda: owner.joint_forces(name, point, self.numbers(3), self.numbers(3)),
            "mul_mass": lambda: owner.mul_mass(x),
            "solve_mass": lambda: owner.solve_mass(x),
            "inverse": lambda: owner.inverse(x, discrete=self.maybe(lambda: None)),
            "integrate_pos": lambda: model.integrate_pos(qpos[0], x, self.maybe(lambda: 0.1)),
            "differentiate_pos": lambda: model.differentiate_pos(*qpos, self.maybe(lambda: 0.1)),
            "rays": lambda: owner.rays(self.numbers(2, 3), self.numbers(2, 3), **thing, groups=self.maybe(lambda: [0])),
            "heights": lambda: owner.heights(name, self.numbers(2, 2), **thing),
            "render": lambda: owner.render(*sizes, camera=self.maybe(lambda: None), kind=self.maybe(lambda: kind), groups=self.maybe(lambda: [0, 1]), device=self.maybe(lambda: self.choose((None, "cpu"))), appearance=self.maybe(lambda: self.choose((None, looks)))),
            "ik": lambda: owner.ik(self.maybe(lambda: [clench.FrameTarget(**thing, position=point), clench.ComTarget(point)])),
            "linearize": lambda: owner.linearize(self.maybe(lambda: ["xpos"]), self.maybe(lambda: {"body_mass": [1], "xfrc_applied": [6]}), memory=self.maybe(lambda: True), sensors=self.maybe(lambda: True), errors=self.maybe(lambda: True)),
            "jvp": lambda: owner.jvp(self.maybe(lambda: self.numbers(*lead, 2 * model.nv + model.na)), self.maybe(lambda: None), self.maybe(lambda: {"gravity": self.numbers(*lead, 3)})),
            "vjp": lambda: owner.vjp(self.maybe(lambda: self.numbers(*lead, 2 * model.nv + model.na)), self.maybe(lambda: None), self.maybe(lambda: ["gravity"]), memory=self.maybe(lambda: False)),
            "rollout_vjp": lambda: owner.rollout_vjp(self.numbers(2, *lead, model.nu), self.numbers(2, *lead, 2 * model.nv + model.na), memory=self.maybe(lambda: False)),
            "step1": lambda: owner.step1(),
            "step2": lambda: owner.step2(),
            "add_weld": lambda: owner.add_weld(name, self.maybe(lambda: 0)),
            "add_connect": lambda: owner.add_connect(name, self.maybe(lambda: 0), point),
            "weld_here": lambda: owner.weld_here(self.maybe(lambda: self.choose((0, "held", "grip")))),
            "remove": lambda: owner.remove(self.choose([*self.results, 0])),
        }
        return self.touch(self.choose(list(asked.values()))())

    def call_class(self) -> Any:
        """Calls classes, `__new__` and unbound methods with arbitrary arguments, and subclasses them."""
        offered = [getattr(clench, name) for name in clench.__all__ if name != "EnvStatus"]  # a Python enumeration
        keeper = type(self.owners[0].qpos.base)
        cls = self.choose([thing for thing in (*offered, keeper) if isinstance(thing, type)])
        what = self.rng.integers(4)
        arguments = [self.junk.any() for _ in range(self.rng.integers(0, 3))]
        if what == 0:
            return cls(*arguments)
        if what == 1:
            return self.choose((cls, object)).__new__(cls, *arguments)
        if what == 2:
            return getattr(cls, self.choose(dir(cls)))(*arguments)
        return type("Own", (cls,), {})(*arguments)

    def touch(self, thing: Any) -> Any:
        """Applies a random operation of Python to an object."""
        does: list[Callable[[], Any]] = [
            *(lambda: repr(thing), lambda: str(thing), lambda: dir(thing), lambda: hash(thing), lambda: len(thing)),
            *(lambda: copy.copy(thing), lambda: pickle.dumps(thing), lambda: thing == self.junk.any(), lambda: bool(thing)),
            *(lambda: iter(thing), lambda: thing[self.junk.any()], lambda: thing(), lambda: getattr(thing, self.junk.any())),
            *(lambda: setattr(thing, self.choose(TEXTS), 1), lambda: delattr(thing, self.choose(TEXTS))),
            lambda: [getattr(thing, name) for name in dir(thing) if not name.startswith("__")],
        ]
        return self.choose(does)()

    def one(self) -> None:
        """Makes a random call and records its outcome."""
        calls = [
            *(self.call_model, self.call_options, self.call_solve, self.call_new, self.call_views, self.call_state),
            *(self.call_owner, self.call_owner, self.call_sim, self.call_batch, self.call_batch, self.call_class),
            *(self.call_question, self.call_question),
        ]
        call, start = self.choose(calls), time.perf_counter()
        try:
            self.results[int(self.rng.integers(-1, 20)) :] = [call()]
            outcome = "returned"
        except ALLOWED as error:
            outcome = type(error).__name__
        took = time.perf_counter() - start
        self.slowest = max(self.slowest, (took, call.__name__))
        self.outcomes[outcome] += 1
        if took > LONGEST:
            raise TimeoutError(f"{call.__name__} took {took:.1f} s")

    def check(self) -> None:
        """Checks that objects can be reset and stepped, and that new batches agree with new simulations."""
        for owner in self.owners:
            owner.reset()
            with contextlib.suppress(clench.SimulationError):  # parameters may forbid it
                owner.step()
        batch, sim = clench.Batch(example("quadruped"), 9, threads=2), clench.Sim(example("quadruped"))
        if batch.step(50) != 0:
            raise AssertionError("a new batch fails")
        sim.step(50)
        for name in FIELDS:
            if not all(same_bits(row, np.asarray(getattr(sim, name))) for row in getattr(batch, name)):
                raise AssertionError(f"a new batch has another {name} than a new simulation")


def main(seed: int, calls: int) -> None:
    faulthandler.enable()
    warnings.simplefilter("ignore")
    np.seterr(all="ignore")
    fuzz = Fuzz(seed)
    unraisable: list[Any] = []
    sys.unraisablehook = unraisable.append
    for done in range(calls):
        if done % 200 == 0:
            faulthandler.dump_traceback_later(200 * LONGEST / 10, exit=True)
        try:
            fuzz.one()
            if unraisable:
                raise AssertionError(f"an exception got lost: {unraisable}")
        except BaseException:
            traceback.print_exc()
            sys.exit(f"call {done} of seed {seed} raised what it may not")
    faulthandler.dump_traceback_later(100, exit=True)
    fuzz.check()
    print(dict(fuzz.outcomes), "slowest: %.3f s, %s" % fuzz.slowest)


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]))
