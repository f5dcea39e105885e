"""Pinches a block between two fingers, and shows it in the browser.

The viewer shows contact forces. The loop draws its own objects, and may continue without the viewer::

    python python/examples/pinch_viewer.py
    python python/examples/pinch_viewer.py --quick --plot pinch.png
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np
import plots

import clench

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def main() -> None:
    """Run the example."""
    options = plots.parser(__doc__).parse_args()
    sim = clench.Sim(clench.Model.from_file(plots.MODELS / "pinch.xml"))
    weight = -float(sim.model.gravity[2]) * float(sim.body("block").mass)
    times: list[float] = []
    shares: list[float] = []
    with clench.view(sim, open_browser=not options.quick) as viewer:
        print(f"open {viewer.url}; close the page to end")
        begin = time.monotonic()
        while sim.time < (0.2 if options.quick else 60) and not viewer.closed:
            # The fingers press harder and harder, then relax a little.
            sim.joint("left").qfrc_applied = 10 * (1 - np.cos(sim.time))
            sim.joint("right").qfrc_applied = -10 * (1 - np.cos(sim.time))
            sim.step()
            friction = sum(np.linalg.norm(contact.force[1:3]) for contact in sim.contacts.of_body("block"))
            times.append(sim.time)
            shares.append(float(friction / weight))
            viewer.draw_text(sim.body("block").xpos + [0, 0, 0.1], f"friction carries {shares[-1]:.2f} of the weight")
            viewer.sync()
        print(f"{sim.time:.2f} s in {time.monotonic() - begin:.2f} s; the block sank by {1e3 * (0.5 - sim.body('block').xpos[2]):.3f} mm")

    def draw(axes: Axes) -> None:
        axes.plot(times, shares)
        axes.set(xlabel="time, s", ylabel="friction over weight", title="A block is pinched")

    plots.finish(options, draw)


if __name__ == "__main__":
    main()
