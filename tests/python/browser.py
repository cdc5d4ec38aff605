"""A headless Chromium that tests drive through its DevTools protocol, with the mouse and keys of a user."""

from __future__ import annotations

import base64
import itertools
import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

PROGRAM = next(filter(None, map(shutil.which, ["chromium", "chromium-browser", "google-chrome"])), None)
ARGUMENTS = [
    "--headless",
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--hide-scrollbars",
    "--remote-debugging-port=0",
]


class Tab:
    """A tab of the browser."""

    def __init__(self, socket: Any, session: int) -> None:
        self._socket = socket
        self.session = session  # number of the session of all processes of the browser
        self._numbers = itertools.count(1)

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Result of a method of the DevTools protocol."""
        number = next(self._numbers)
        self._socket.send(json.dumps({"id": number, "method": method, "params": parameters}))
        while True:
            answer = json.loads(self._socket.recv(timeout=60))
            if answer.get("id") == number:  # others are events
                assert "error" not in answer, f"{method}: {answer['error']}"
                result: dict[str, Any] = answer["result"]
                return result

    def open(self, address: str) -> None:
        self.call("Page.navigate", url=address)
        self.wait("document.documentElement && document.readyState === 'complete'")

    def evaluate(self, script: str) -> Any:
        """Value of an expression in JavaScript. Waits for a promise."""
        found = self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in found, f"{script}: {found['exceptionDetails']}"
        return found["result"].get("value")

    def wait(self, condition: str, seconds: float = 30) -> Any:
        """Value of the expression as soon as it is true."""
        end = time.monotonic() + seconds
        while not (value := self.evaluate(condition)):
            assert time.monotonic() < end, f"not true after {seconds:g} s: {condition}; {self.marks()}"
            time.sleep(0.02)
        return value

    def marks(self) -> dict[str, str]:
        """Marks that the page leaves at its root element."""
        marks: dict[str, str] = self.evaluate("({...document.documentElement.dataset})")
        return marks

    def click(self, selector: str) -> None:
        """Clicks into the middle of the first element of a CSS selector."""
        script = "(({x, y, width, height}) => [x + width / 2, y + height / 2])"
        place = self.evaluate(f"{script}(document.querySelector({json.dumps(selector)}).getBoundingClientRect())")
        self.mouse("Pressed", *place)
        self.mouse("Released", *place)

    def mouse(self, kind: str, x: float, y: float) -> None:
        """Event of the mouse with its left button: "Pressed", "Moved" or "Released"."""
        parameters = {
            "button": "left",
            "buttons": 0 if kind == "Released" else 1,
            "clickCount": 1,
            "pointerType": "mouse",
        }
        self.call("Input.dispatchMouseEvent", type=f"mouse{kind}", x=x, y=y, **parameters)

    def press(self, key: str) -> None:
        """Presses a key, such as "a" or "Home"."""
        self.call("Input.dispatchKeyEvent", type="keyDown", key=key, **({"text": key} if len(key) == 1 else {}))
        self.call("Input.dispatchKeyEvent", type="keyUp", key=key)

    def picture(self, file: Path) -> None:
        """Writes a picture of the window as a PNG file."""
        file.write_bytes(base64.b64decode(self.call("Page.captureScreenshot")["data"]))


@contextmanager
def open_browser(size: tuple[int, int] = (900, 700)) -> Iterator[Tab]:
    """A tab of a new browser, which ends with the block. Skips the test if there is no Chromium."""
    if PROGRAM is None:
        pytest.skip("no Chromium is installed; Debian: apt-get install chromium")
    client = pytest.importorskip("websockets.sync.client")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        command = [PROGRAM, *ARGUMENTS, f"--user-data-dir={profile}", f"--window-size={size[0]},{size[1]}"]
        process = subprocess.Popen(
            [*command, "about:blank"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            env={**os.environ, "HOME": profile},
        )
        try:
            port = Path(profile) / "DevToolsActivePort"
            end = time.monotonic() + 30
            while not (port.exists() and "\n" in port.read_text()):
                assert process.poll() is None and time.monotonic() < end, "Chromium did not start"
                time.sleep(0.02)
            with urllib.request.urlopen(f"http://127.0.0.1:{port.read_text().split()[0]}/json/list") as answer:
                pages = [target for target in json.load(answer) if target["type"] == "page"]
            with client.connect(pages[0]["webSocketDebuggerUrl"], max_size=None) as socket:
                yield Tab(socket, process.pid)
        finally:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
