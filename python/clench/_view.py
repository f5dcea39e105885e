"""Display of viewers and recordings: in a browser, and in a Jupyter notebook."""

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
    """Returns true in a Jupyter kernel, which displays the last value of a cell."""
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
    """Shows a simulation in the browser, while a Python loop steps it.

    >>> with clench.view(sim) as viewer:  # doctest: +SKIP
    ...     while not viewer.closed:
    ...         sim.step()
    ...         viewer.sync()

    Parameters
    ----------
    target : Sim or Batch
        The simulation or batch to show.
    env : int
        The environment of a batch that is shown initially; `Viewer.env` and the page can change it.
    host : str
        Address to listen on. Other addresses than the default admit other machines that have the token.
    port : int
        Port to listen on; 0 for any free port.
    open_browser : bool, optional
        True to open a browser. By default one is opened, except in a Jupyter notebook, where the last value of a cell
        displays the viewer.
    paused : bool
        True if the loop is paused initially.
    speed : float
        The ratio of simulated to real time that `Viewer.sync` maintains; 0 for as fast as possible.

    Returns
    -------
    Viewer
        The viewer. Close it after use; a ``with`` block does so.

    Raises
    ------
    IndexError
        If there is no such environment.
    ValueError
        If `port` or `speed` is out of range.
    OSError
        If the address or port is not available.
    ClenchError
        If the package was built without the viewer's page; the message says what to do.
    """
    viewer = Viewer(target, env=env, host=host, port=port, paused=paused, speed=speed)
    wanted = not _in_notebook() if open_browser is None else open_browser
    if wanted and not webbrowser.open(viewer.url):
        print(f"no browser could be opened; open {viewer.url}", file=sys.stderr)
    return viewer


def _frame(url: str) -> str:
    """Returns an HTML frame of a page, for a cell."""
    style = f"width:100%;height:{_HEIGHT}px;border:0"
    return f'<iframe src="{html.escape(url)}" style="{style}"></iframe>'


def _frame_of_html(page: str) -> str:
    """Returns an HTML frame of a document, for a cell."""
    style = f"width:100%;height:{_HEIGHT}px;border:0"
    return f'<iframe srcdoc="{html.escape(page)}" style="{style}"></iframe>'


def _show(page: str) -> None:
    """Shows a document: in the current cell, else in a browser."""
    if _in_notebook():
        display = importlib.import_module("IPython.display")
        display.display(display.HTML(_frame_of_html(page)))
        return
    # The browser reads the file after this process has ended, so it is not removed.
    handle, path = tempfile.mkstemp(prefix="clench-", suffix=".html")
    with os.fdopen(handle, "w", encoding="utf-8") as file:
        file.write(page)
    if not webbrowser.open(f"file://{path}"):
        print(f"no browser could be opened; open {path}", file=sys.stderr)
