"""The command line and plots of all examples."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MODELS = Path(__file__).resolve().parents[2] / "models"


def parser(doc: str | None) -> argparse.ArgumentParser:
    """Return a parser with the options of every example; the first line of ``doc`` describes it."""
    options = argparse.ArgumentParser(description=(doc or "").partition("\n")[0])
    options.add_argument("--quick", action="store_true", help="run the short form that the tests use")
    options.add_argument("--plot", metavar="FILE", help="write a plot to FILE (.png, .svg or .pdf)")
    options.add_argument("--show", action="store_true", help="show the plot in a window")
    return options


def finish(options: argparse.Namespace, draw: Callable[[Axes], None]) -> None:
    """Draw the plot, if a file or a window was requested."""
    if options.plot is None and not options.show:
        return
    try:
        import matplotlib
    except ImportError as error:
        raise SystemExit("plots need matplotlib: pip install matplotlib") from error
    if not options.show:
        matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(7, 4.5), layout="constrained")
    draw(axes)
    if options.plot is not None:
        figure.savefig(options.plot, dpi=150)
        print(f"plot in {options.plot}")
    if options.show:
        pyplot.show()
