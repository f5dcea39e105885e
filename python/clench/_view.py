"""Viewers and recordings where Python shows them: in a browser, and in a Jupyter notebook."""

from __future__ import annotations

import html
import importlib
import os
import sys
import tempfile
import webbrowser
from typing import SupportsIndex

from clench._core import Batch, Sim, Viewer

__all__ = ["view"]

_HEIGHT = 560  # pixels of a cell


def _in_notebook() -> bool:
    """Whether this runs in a kernel of Jupyter, whose cells show what they end with."""
    shell = sys.modules.get("IPython")
    if shell is None:
        return False
    running = shell.get_ipython()
    return running is not None and running.has_trait("kernel")


def view(
    target: Sim | Batch,
    *,
    env: SupportsIndex = 0,
    host: str = "127.0.0.1",
    port: SupportsIndex = 0,
    open_browser: bool | None = None,
    paused: bool = False,
    speed: float = 1.0,
) -> Viewer:
    """Shows a simulation in the browser, while a loop of one's own steps it.

    >>> with clench.view(sim) as viewer:  # doctest: +SKIP
    ...     while not viewer.closed:
    ...         sim.step()
    ...         viewer.sync()

    Parameters
    ----------
    target : Sim or Batch
        What to show.
    env : int
        Which environment of a batch at first; `Viewer.env` and the page choose another.
    host : str
        Address to listen at. Another than this lets other machines in that know the token.
    port : int
        Port to listen at; 0 for any that is free.
    open_browser : bool, optional
        Whether to open a browser. By default one is opened, but in a Jupyter notebook, where the viewer is seen in the cell that
        ends with it.
    paused : bool
        Whether the loop stands still at first.
    speed : float
        Simulated over real time, which `Viewer.sync` holds the loop to; 0 for as fast as it goes.

    Returns
    -------
    Viewer
        To be closed; a ``with`` block does that.

    Raises
    ------
    OSError
        An address or port where one cannot listen.
    ClenchError
        A package that was built without the viewer's page, and what to do.
    """
    viewer = Viewer(target, env=env, host=host, port=port, paused=paused, speed=speed)
    wanted = not _in_notebook() if open_browser is None else open_browser
    if wanted and not webbrowser.open(viewer.url):
        print(f"no browser could be opened; open {viewer.url}", file=sys.stderr)
    return viewer


def _frame(url: str) -> str:
    """A page in a cell."""
    style = f"width:100%;height:{_HEIGHT}px;border:0"
    return f'<iframe src="{html.escape(url)}" style="{style}"></iframe>'


def _frame_of_html(page: str) -> str:
    """A document in a cell."""
    style = f"width:100%;height:{_HEIGHT}px;border:0"
    return f'<iframe srcdoc="{html.escape(page)}" style="{style}"></iframe>'


def _show(page: str) -> None:
    """Shows a document: in the cell that runs, else in a browser."""
    if _in_notebook():
        display = importlib.import_module("IPython.display")
        display.display(display.HTML(_frame_of_html(page)))
        return
    # The browser reads it after this has ended, so it stays.
    handle, path = tempfile.mkstemp(prefix="clench-", suffix=".html")
    with os.fdopen(handle, "w", encoding="utf-8") as file:
        file.write(page)
    if not webbrowser.open(f"file://{path}"):
        print(f"no browser could be opened; open {path}", file=sys.stderr)
