"""The viewer from the side of browsers: over HTTP, and over a WebSocket that is implemented here."""

from __future__ import annotations

import base64
import json
import os
import re
import socket
import struct
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import clench
import numpy as np
import pytest
from scenes import ball, example

PATIENCE = 60  # seconds


@pytest.fixture(autouse=True)
def page() -> None:
    """Skips the tests if the package was built without a page, and none can be built."""
    try:
        clench.Viewer(clench.Sim(ball())).close()
    except clench.ClenchError as error:
        assert "npm" in str(error)
        pytest.skip(str(error))


class Page:
    """A page in a browser, without drawing."""

    def __init__(self, url: str) -> None:
        place = urlsplit(url)
        assert place.hostname and place.port
        self.socket = socket.create_connection((place.hostname, place.port), PATIENCE)
        head = (
            f"GET /socket?{place.query} HTTP/1.1\r\nHost: {place.netloc}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {base64.b64encode(bytes(16)).decode()}\r\n\r\n"
        )
        self.socket.sendall(head.encode())
        self.stream = self.socket.makefile("rb")
        assert b" 101 " in self.stream.readline()
        while self.stream.readline() != b"\r\n":
            pass
        self.scene: dict[str, Any] = json.loads(self.receive())
        self.errors: list[str] = []

    def receive(self) -> bytes:
        _, size = self.stream.read(2)
        if size == 126:
            (size,) = struct.unpack(">H", self.stream.read(2))
        elif size == 127:
            (size,) = struct.unpack(">Q", self.stream.read(8))
        return self.stream.read(size)

    def say(self, **what: Any) -> None:
        text = json.dumps(what).encode()
        # Browsers mask what they send; a mask of zeros does not change it.
        head = bytes([0x81, 0x80 | len(text)]) if len(text) < 126 else struct.pack(">BBH", 0x81, 0x80 | 126, len(text))
        self.socket.sendall(head + bytes(4) + text)

    def frame(self) -> dict[str, Any]:
        """Returns the next frame: its sections by name, and its time and flags."""
        self.say(do="next")
        data = self.receive()
        while not data.startswith(b"CLNF"):
            self.errors.append(json.loads(data)["error"])
            data = self.receive()
        flags, time, count = struct.unpack_from("<IdI", data, 4)
        counts = struct.unpack_from(f"<{count}I", data, 20)
        at = 20 + 4 * count
        frame: dict[str, Any] = {"time": time, "paused": bool(flags & 1)}
        for section, rows in zip(self.scene["sections"], counts, strict=True):
            size = rows * section["width"]
            frame[section["name"]] = np.frombuffer(data, "<f4", size, at).reshape(rows, section["width"])
            at += 4 * size
        assert at == len(data)
        return frame

    def close(self) -> None:
        self.stream.close()
        self.socket.close()


@pytest.fixture
def opened() -> Iterator[Callable[[clench.Viewer], Page]]:
    pages = []

    def connect(viewer: clench.Viewer) -> Page:
        pages.append(Page(viewer.url))
        return pages[-1]

    yield connect
    for page in pages:
        page.close()


Open = Callable[[clench.Viewer], Page]


def until(
    viewer: clench.Viewer,
    page: Page,
    holds: Callable[[dict[str, Any]], bool],
    loop: Callable[[], object] = lambda: None,
) -> dict[str, Any]:
    """Repeats a loop until a frame satisfies a condition, and returns the frame."""
    for _ in range(2000):
        loop()
        viewer.sync(block=False)
        frame = page.frame()
        if holds(frame):
            return frame
    raise AssertionError("in vain")


def view(target: clench.Sim | clench.Batch, **arguments: Any) -> clench.Viewer:
    return clench.view(target, open_browser=False, speed=0, **arguments)


def test_page_needs_token() -> None:
    with view(clench.Sim(ball())) as viewer:
        with urllib.request.urlopen(viewer.url, timeout=PATIENCE) as reply:
            assert b"<title>Clench</title>" in reply.read()
        for url, headers in [
            (re.sub("token=.*", "token=" + 32 * "0", viewer.url), {}),
            (viewer.url, {"Origin": "http://evil.example"}),
            (viewer.url, {"Host": "evil.example"}),
        ]:
            with pytest.raises(urllib.error.HTTPError, match="403"):
                urllib.request.urlopen(urllib.request.Request(url, headers=headers), timeout=PATIENCE)
        url = viewer.url
    assert viewer.closed
    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(url, timeout=PATIENCE)


def test_loop_shows_its_states(opened: Open) -> None:
    sim = clench.Sim(ball())
    with view(sim) as viewer:
        page = opened(viewer)
        assert page.scene["active"] and not page.scene["rewinds"]
        assert page.frame()["time"] == 0
        frame = until(viewer, page, lambda frame: frame["time"] >= 0.1, sim.step)
        np.testing.assert_allclose(frame["bodies"][1, 2], sim.qpos[2], atol=0.1)
        assert viewer.clients >= 1


def test_viewer_changes_no_number() -> None:
    sims = [clench.Sim(example("humanoid")) for _ in range(2)]
    with view(sims[0]) as viewer:
        for _ in range(50):
            sims[0].step()
            viewer.sync()
    sims[1].step(50)
    np.testing.assert_array_equal(sims[0].qpos, sims[1].qpos)


def test_page_lets_the_loop_wait_and_take_a_step(opened: Open) -> None:
    sim = clench.Sim(ball())
    with view(sim, paused=True) as viewer:
        page = opened(viewer)

        def loop() -> None:
            for _ in range(3):
                viewer.sync()
                sim.step()

        thread = threading.Thread(target=loop, daemon=True)
        thread.start()
        thread.join(0.2)
        assert thread.is_alive() and sim.time == 0
        page.say(do="step", count=2)
        while page.frame()["time"] < 0.003:
            pass
        assert thread.is_alive() and sim.time == pytest.approx(0.004)
        page.say(do="pause", on=False)
        thread.join(PATIENCE)
        assert not thread.is_alive() and sim.time == pytest.approx(0.006)


def test_loop_keeps_real_time() -> None:
    sim = clench.Sim(ball())
    with clench.view(sim, open_browser=False, speed=2) as viewer:
        begin = time.monotonic()
        while sim.time < 0.4:
            sim.step()
            viewer.sync()
        assert time.monotonic() - begin > 0.19


@pytest.mark.parametrize("precision", ["64", "32"])
def test_page_pulls_a_body(opened: Open, precision: Any) -> None:
    sim = clench.Sim(ball(), precision=precision)
    with view(sim) as viewer:
        page = opened(viewer)
        page.say(do="drag", body=1, point=[0, 0, 0], target=[0, 0, 3])
        frame = until(viewer, page, lambda frame: frame["bodies"][1, 2] > 1, sim.step)
        assert len(frame["drag"]) == 1 and sim.xfrc_applied[1].any()
        page.say(do="release")
        until(viewer, page, lambda frame: len(frame["drag"]) == 0, sim.step)
        assert not sim.xfrc_applied.any()


def test_what_a_loop_cannot_do_is_said(opened: Open) -> None:
    sim = clench.Sim(ball())
    with view(sim) as viewer:
        page = opened(viewer)
        for command in [{"do": "rewind", "seconds": 1}, {"do": "keyframe", "index": 7}, {"do": "control", "index": 0, "value": 1}]:
            page.say(**command)
            page.errors.clear()
            until(viewer, page, lambda _: bool(page.errors))


def test_what_a_program_draws_is_seen_for_its_lifetime(opened: Open) -> None:
    sim = clench.Sim(ball())
    with view(sim) as viewer:
        page = opened(viewer)
        viewer.draw_sphere([1, 2, 3], 0.5, rgba=[1, 0, 0, 0.5], lifetime=np.inf)
        viewer.draw_line([0, 0, 0], [1, 0, 0])
        viewer.draw_arrow([0, 0, 0], [0, 0, 1], lifetime=0.01)
        viewer.draw_text([0, 0, 1], "héllo", lifetime=np.inf)
        frame = until(viewer, page, lambda frame: len(frame["marks"]) > 0)
        assert set(frame["marks"][:, 0]) >= {0, 2, 3}
        np.testing.assert_allclose(frame["marks"][0], [0, 1, 2, 3, 1, 2, 3, 0.5, 1, 0, 0, 0.5])
        text = "".join(chr(int(code)) for code in frame["letters"][:, 0])
        assert text == "héllo"
        sim.step(20)
        frame = until(viewer, page, lambda frame: len(frame["marks"]) == 2)
        viewer.clear_draws()
        until(viewer, page, lambda frame: len(frame["marks"]) == 0)
        draws: list[Callable[[], object]] = [
            lambda: viewer.draw_sphere([1, 2], 0.1),
            lambda: viewer.draw_sphere([1, 2, np.nan], 0.1),
            lambda: viewer.draw_sphere([1, 2, 3], -1),
            lambda: viewer.draw_line([1, 2, 3], [1, 2, 3], rgba=[1, 0, 0]),
            lambda: viewer.draw_line([1, 2, 3], [1, 2, 3], rgba=[1, 0, 0, 2]),
            lambda: viewer.draw_text([1, 2, 3], 201 * "x"),
            lambda: viewer.draw_text([1, 2, 3], "x", lifetime=-1),
        ]
        for draw in draws:
            with pytest.raises(ValueError):
                draw()


def test_environments_of_a_batch_are_seen_alone_and_side_by_side(opened: Open) -> None:
    batch = clench.Batch(ball(), 5)
    batch.qpos[:, 0] = np.arange(5)
    with view(batch, env=3) as viewer:
        page = opened(viewer)
        assert page.scene["envs"] == 5
        frame = page.frame()
        assert frame["bodies"][1, 0] == 3 and len(frame["poses"]) == 0
        page.say(do="show", env=1, first=1, count=9)
        frame = until(viewer, page, lambda frame: len(frame["poses"]) > 0, batch.step)
        assert viewer.env == 1 and frame["bodies"][1, 0] == 1
        np.testing.assert_allclose(frame["poses"].reshape(4, 2, 7)[:, 1, 0], [1, 2, 3, 4])
        page.say(do="drag", body=1, point=[0, 0, 0], target=[1, 0, 9])
        until(viewer, page, lambda frame: frame["bodies"][1, 2] > 2, batch.step)
        assert batch.xfrc_applied[1].any() and not batch.xfrc_applied[[0, 2, 3, 4]].any()
        batch.qpos[2, 2] = np.nan
        frame = until(viewer, page, lambda frame: frame["envs"][:, 1].any(), batch.step)
        np.testing.assert_array_equal(frame["envs"], [[1, 0], [2, 1], [3, 0], [4, 0]])
        assert "".join(chr(int(code)) for code in frame["letters"][:, 0]) == batch.fault(2)
        viewer.show_grid(1)
        viewer.env = 4
        until(viewer, page, lambda frame: frame["bodies"][1, 0] == 4)
        for count in [0, 65]:
            with pytest.raises(ValueError):
                viewer.show_grid(count)
        with pytest.raises(IndexError):
            viewer.env = 5


def test_bad_arguments_are_named() -> None:
    sim = clench.Sim(ball())
    with view(sim) as viewer, pytest.raises(OSError, match="port"):
        view(sim, port=urlsplit(viewer.url).port)
    with pytest.raises(TypeError, match="Sim or a Batch"):
        clench.view(3)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="speed"):
        clench.view(sim, speed=-1, open_browser=False)
    for port in (-1, 65536):
        with pytest.raises(ValueError, match="port is .* but must be 0 to 65535"):
            view(sim, port=port)
    with pytest.raises(IndexError):
        view(sim, env=1)
    with pytest.raises(clench.ClenchError, match="closed"):
        viewer.draw_sphere([0, 0, 0])
    viewer.sync()
    viewer.close()


def test_viewer_is_seen_in_a_cell() -> None:
    with view(clench.Sim(ball())) as viewer:
        assert f'<iframe src="{viewer.url}"' in viewer._repr_html_()
        assert viewer.url in repr(viewer)
    assert repr(viewer) == "<clench.Viewer, closed>"


def test_child_process_leaves_the_viewer_to_its_parent() -> None:
    with view(clench.Sim(ball())) as viewer:
        child = os.fork()
        if child == 0:
            try:
                viewer.close()
            finally:
                os._exit(0)
        _, status = os.waitpid(child, 0)
        assert status == 0
        with urllib.request.urlopen(viewer.url, timeout=PATIENCE) as reply:
            assert reply.status == 200


def test_recording_is_written_and_read(tmp_path: Path) -> None:
    sim = clench.Sim(ball())
    recording = clench.Recording()
    assert len(recording) == 0 and recording._repr_html_() is None
    with pytest.raises(ValueError, match="nothing"):
        recording.save(tmp_path / "none.html")
    for _ in range(4):
        recording.append(sim)
        sim.step(5)
    path = tmp_path / "fall.html"
    recording.save(path)
    assert 'id="recording"' in path.read_text()
    again = clench.Recording.load(path)
    np.testing.assert_allclose(again.times, [0, 0.01, 0.02, 0.03])
    again.append(sim)
    again.append(clench.Batch(sim.model, 2), env=1)
    assert len(again) == 6 and len(recording) == 4
    assert "srcdoc" in (recording._repr_html_() or "")
    with pytest.raises(ValueError, match="another model"):
        again.append(clench.Sim(example("humanoid")))
    with pytest.raises(MemoryError):
        clench.Recording(limit=100).append(sim)
    with pytest.raises(ValueError, match="exceeds the limit of 0.0001 MB"):
        clench.Recording.load(path, limit=100)
    with pytest.raises(OSError):
        recording.save(tmp_path / "no" / "such.html")
    text = path.read_text()
    for bad in ["", "<html><body></body></html>", text.replace("qpos", "pos"), text.replace('"frames":["', '"frames":["x')]:
        path.write_text(bad)
        with pytest.raises(ValueError, match="fall.html"):
            clench.Recording.load(path)
