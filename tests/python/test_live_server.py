"""The server of the live view: clients that hang or break the protocol, ports, and the end of a view."""

from __future__ import annotations

import contextlib
import os
import random
import resource
import socket
import struct
import threading
import time
from typing import Any

import pytest

import skerry as sk
from live_client import advance, answer_to, connect, place_of, status_of, upgrade
from worlds import RUBBER, ball_world, run_program, skip_without_live_view

skip_without_live_view()


def frame_of(payload: bytes, opcode: int, *, length: int | None = None) -> bytes:
    """A frame of a client as bytes (RFC 6455, 5.2). length: the length that it claims."""
    count = len(payload) if length is None else length
    size = bytes([0x80 | count]) if count < 126 else struct.pack(">BQ", 0x80 | 127, count)
    return bytes([0x80 | opcode]) + size + b"\0\0\0\0" + payload


def connection_of(view: sk.View) -> socket.socket:
    """A socket after a good handshake."""
    port, token = place_of(view)
    connection = socket.create_connection(("127.0.0.1", port), timeout=10)
    connection.sendall("".join(line + "\r\n" for line in [*upgrade(port, token), ""]).encode())
    head = b""
    while b"\r\n\r\n" not in head:
        head += connection.recv(1)
    assert status_of(head) == 101
    return connection


def wait_for_clients(view: sk.View, count: int) -> None:
    end = time.monotonic() + 20
    while view.client_count != count:
        assert time.monotonic() < end, f"{view.client_count} clients, expected {count}"
        view.sync()
        time.sleep(0.005)


BREACHES = [
    frame_of(b"x" * (1 << 20), 1),
    frame_of(b"x", 1, length=1 << 40),
    frame_of(b"x", 1, length=(1 << 64) - 1),
    frame_of(b"\xff\xfe", 1),
    frame_of(b"", 2),
    bytes([0x81, 0x05]) + b"hello",
    bytes(range(256)) * 40,
]


def test_a_client_that_breaks_the_protocol_hurts_only_itself(view: sk.View) -> None:
    with connect(view) as client:
        client.wait(lambda: client.frames)
        for data in BREACHES:
            with connection_of(view) as bad, contextlib.suppress(BrokenPipeError, ConnectionResetError):
                bad.sendall(data)
                advance(client)
        wait_for_clients(view, 1)
        advance(client)


def test_a_client_that_leaves_in_the_middle_of_a_frame_is_forgotten(view: sk.View) -> None:
    with connect(view) as client:
        client.wait(lambda: client.frames)
        for cut in (1, 3, 7, 12):
            bad = connection_of(view)
            bad.sendall(frame_of(b'{"do":"pause"}', 1)[:cut])
            bad.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # ends by a reset
            bad.close()
        wait_for_clients(view, 1)
        advance(client)
        assert view.playing


def test_a_client_that_hangs_slows_nothing_and_keeps_no_memory() -> None:
    world = sk.World(threads=1, gravity=(0, 0, 0))
    for place in range(16):
        spin = {"position": (place, 0, 0), "angular_velocity": (0, 0, 3)}
        world.add_body(sk.Mesh.ball(0.1, 12), RUBBER, dynamics="rigid", **spin)
    with sk.view(world, open=False) as view, connection_of(view):  # does not read
        wait_for_clients(view, 1)
        with connect(view) as client:
            for _ in range(20):
                advance(client)
            before, count = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, len(client.frames)
            while len(client.frames) < count + 30:
                world.advance(0.001)
                view.sync()
                client.take(0)
            grown = 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
            assert view.frames_dropped > 0 and view.client_count == 2
            if "libasan" not in os.environ.get("LD_PRELOAD", ""):  # which keeps freed memory for a while
                # The client here keeps each frame once; the server must not keep them, too.
                assert grown < 1.5 * sum(map(len, client.frames[count:])), f"{grown} bytes more"


def test_a_slow_handshake_blocks_nobody(view: sk.View) -> None:
    port, _ = place_of(view)
    with socket.create_connection(("127.0.0.1", port)) as slow, socket.create_connection(("127.0.0.1", port)):
        slow.sendall(b"GET / HT")
        with connect(view) as client:
            client.wait(lambda: client.frames)


@pytest.mark.skipif("SKERRY_FULL" not in os.environ, reason="SKERRY_FULL is not set")
def test_slow_handshakes_on_all_threads_are_ended(view: sk.View) -> None:
    port, _ = place_of(view)
    threads = 12
    with contextlib.ExitStack() as slow:
        for _ in range(threads + 1):
            slow.enter_context(socket.create_connection(("127.0.0.1", port))).sendall(b"GET / HT")
        answer = answer_to(port, "GET / HTTP/1.1", f"Host: 127.0.0.1:{port}", "Connection: close", seconds=20)
    assert status_of(answer) == 200


def test_a_port_in_use_is_an_error() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(sk.SceneError, match=rf"port: found {port}, which cannot be opened"):
            sk.view(ball_world()[0], port=port, open=False)


def test_a_long_step_does_not_close_a_view_with_a_page(view: sk.View, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("skerry._live._RELOAD", 0.05)
    with connect(view) as client:
        client.wait(lambda: client.frames)
        time.sleep(0.1)  # as long as a step could take
        assert view.is_open
    wait_for_clients(view, 0)
    time.sleep(0.1)
    assert not view.is_open


def test_a_step_that_is_refused_pauses_run() -> None:
    world = sk.World(threads=1, start_overlaps="refuse")
    for x in (0, 0.01):
        world.add_body(sk.Mesh.ball(0.05, 4), RUBBER, position=(x, 0, 0))
    with sk.view(world, open=False) as view, connect(view) as client:
        thread = threading.Thread(target=view.run)
        thread.start()
        client.wait(lambda: client.state.get("playing") is False, sync=False)
        assert view.is_open and client.of_type("problem")
        view.close()
        thread.join()


@pytest.mark.skipif("libasan" in os.environ.get("LD_PRELOAD", ""), reason="its allocator can lock up after a fork")
def test_a_forked_process_ends_and_leaves_the_server() -> None:
    run_program(
        """
        import os, signal, sys, warnings
        import skerry as sk
        from worlds import ball_world

        view = sk.view(ball_world()[0], open=False)
        warnings.simplefilter("ignore", DeprecationWarning)  # Python 3.12 warns of forks beside threads
        for closes in (True, False):
            child = os.fork()
            if child == 0:
                signal.alarm(20)  # ends a child that waits for ever
                if closes:
                    view.close()
                    os._exit(0)
                sys.exit(0)
            assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
        view.sync()
        view.close()
        """
    )


def test_a_view_that_is_closed_frees_its_port(view: sk.View) -> None:
    port, _ = place_of(view)
    view.close()
    assert not view.is_open
    view.close()
    with sk.view(view.world, port=port, open=False) as again:
        assert place_of(again)[0] == port and again.address != view.address


@pytest.mark.skipif("SKERRY_FULL" not in os.environ, reason="SKERRY_FULL is not set")
def test_random_bytes_do_no_harm(view: sk.View) -> None:
    seed = random.randrange(1 << 32)
    draw, port = random.Random(seed), place_of(view)[0]
    print(f"seed {seed}")
    with connect(view) as client:
        end = time.monotonic() + 10
        while time.monotonic() < end:
            start: Any = draw.choice([connection_of, lambda _: socket.create_connection(("127.0.0.1", port))])
            with start(view) as bad:
                try:
                    for _ in range(draw.randrange(1, 20)):
                        noise = draw.randbytes(draw.randrange(1, 400))
                        bad.sendall(draw.choice([noise, frame_of(noise[:100], draw.randrange(16))]))
                except (BrokenPipeError, ConnectionResetError):
                    pass
            view.sync()
            client.take(0)
        advance(client)
