"""A suction gripper picks a box up, carries it, and lets it go.

What it grips is decided while it runs: a weld is added between the cup and the body that the cup touches, and removed again. Here one
simulation; `Batch.add_weld` does the same in chosen environments.

    python python/examples/suction_gripper.py
"""

from __future__ import annotations

import argparse
import pathlib

import clench

MODELS = pathlib.Path(__file__).resolve().parents[2] / "models"


def go(sim: clench.Sim, x: float, z: float, seconds: float) -> None:
    """Drive the gantry to a place, and give it time."""
    sim.actuator("x").ctrl = x
    sim.actuator("z").ctrl = z
    sim.step(round(seconds / sim.model.timestep))


def touched(sim: clench.Sim) -> int | None:
    """The body that the cup touches."""
    for contact in sim.contacts.of_geom("cup"):
        (other,) = set(contact.body) - {sim.body("cup").id}
        return other
    return None


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--model", type=pathlib.Path, default=MODELS / "suction_gripper.xml")
    sim = clench.Sim(clench.Model.from_file(parser.parse_args().model))
    box = sim.body("box")

    go(sim, 0.3, -0.475, 1.5)
    found = touched(sim)
    if found is None:
        raise SystemExit("the cup touches nothing")
    grip = sim.add_weld("cup", found)
    print(f"gripped {sim.body(found).name} at z = {box.xpos[2]:.3f} m")
    go(sim, 0.3, 0.0, 1.5)
    print(f"lifted it to z = {box.xpos[2]:.3f} m")
    go(sim, -0.3, 0.0, 2.0)
    print(f"carried it to x = {box.xpos[0]:.3f} m")
    sim.remove(grip)
    sim.step(1000)
    print(f"let go: it lies at x = {box.xpos[0]:.3f} m, z = {box.xpos[2]:.3f} m")


if __name__ == "__main__":
    main()
