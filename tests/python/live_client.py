"""A client of the live view that behaves like a page, and requests that a page would not make."""

from __future__ import annotations

import json
import re
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any
from urllib.parse import urlsplit

import pytest

import skerry as sk

websockets = pytest.importorskip("websockets.sync.client")


def place_of(view: sk.View) -> tuple[int, str]:
    """Port and token of a view."""
    parts = urlsplit(view.address)
    assert parts.scheme == "http" and parts.hostname == "127.0.0.1" and parts.port is not None
    assert parts.fragment.startswith("token=")
    return parts.port, parts.fragment.removeprefix("token=")


def answer_to(port: int, *lines: str, seconds: float = 10) -> bytes:
    """Answer of the server to a request of these lines, up to the end of the connection or its first 64 kB."""
    with socket.create_connection(("127.0.0.1", port), timeout=seconds) as connection:
        connection.sendall("".join(line + "\r\n" for line in [*lines, ""]).encode("latin-1"))
        answer = b""
        while len(answer) < 1 << 16:
            try:
                part = connection.recv(4096)
            except (TimeoutError, ConnectionResetError):
                break
            if not part:
                break
            answer += part
        return answer


def upgrade(port: int, token: str | None, **changes: str | None) -> list[str]:
    """Lines of a request to connect as the page does. changes: other values of headers, None for none."""
    headers: dict[str, str | None] = {
        "Host": f"127.0.0.1:{port}",
        "Origin": f"http://127.0.0.1:{port}",
        "Upgrade": "websocket",
        "Connection": "Upgrade",
        "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
        "Sec-WebSocket-Version": "13",
        **changes,
    }
    target = "/live" if token is None else f"/live?token={token}"
    return [f"GET {target} HTTP/1.1", *(f"{name}: {value}" for name, value in headers.items() if value is not None)]


class Client:
    """A client that acknowledges frames."""

    def __init__(self, view: sk.View, connection: Any) -> None:
        self.view, self.connection = view, connection
        self.frames: list[bytes] = []
        self.messages: list[dict[str, Any]] = []

    def send(self, do: str, **values: Any) -> None:
        self.connection.send(json.dumps({"do": do, **values}))

    def settle(self) -> None:
        """Waits until the server has received all commands so far. The last one is refused at once."""
        count = len(self.of_type("problem"))
        self.send("answer")
        self.wait(lambda: len(self.of_type("problem")) > count, sync=False)

    def take(self, seconds: float = 0.005) -> bool:
        """Takes the next message, if one comes within that time, and acknowledges a frame."""
        try:
            message = self.connection.recv(timeout=seconds)
        except TimeoutError:
            return False
        if isinstance(message, bytes):
            self.frames.append(message)
            self.send("seen", number=self.rows[-1]["number"])
        else:
            self.messages.append(json.loads(message))
        return True

    def of_type(self, kind: str) -> list[dict[str, Any]]:
        return [message for message in self.messages if message["type"] == kind]

    @property
    def rows(self) -> list[dict[str, Any]]:
        return self.of_type("row")

    @property
    def state(self) -> dict[str, Any]:
        """The last state that the server has sent."""
        states = [message.get("state", message) for message in self.messages if message["type"] in ("begin", "state")]
        return states[-1] if states else {}

    def wait(self, condition: Any, *, sync: bool = True, seconds: float = 20) -> None:
        """Takes messages, and calls View.sync() in between, until the condition holds."""
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end, f"messages: {self.messages[-3:]}"
            if sync:
                self.view.sync()
            self.take()


@contextmanager
def open_socket(address: str) -> Iterator[Any]:
    """A WebSocket to the view with this address."""
    parts = urlsplit(address)
    stream, origin = f"ws://{parts.netloc}/live?{parts.fragment}", f"http://{parts.netloc}"
    with websockets.connect(stream, origin=origin, max_size=None, compression=None) as connection:
        yield connection


@contextmanager
def connect(view: sk.View) -> Iterator[Client]:
    """A client of the view with the right token."""
    with open_socket(view.address) as connection:
        yield Client(view, connection)


def status_of(answer: bytes) -> int:
    found = re.match(rb"HTTP/1\.[01] (\d+) ", answer)
    assert found, answer[:200]
    return int(found[1])


def advance(client: Client, dt: float = 0.01) -> None:
    """Advances by dt and waits for a frame of the new state. One of the state before may still come."""
    world, count = client.view.world, len(client.frames)
    world.advance(dt)
    client.wait(
        lambda: count < len(client.frames) == len(client.rows) and abs(client.rows[-1]["time"] - world.time) < 1e-9
    )
