#!/usr/bin/env python3
"""Frames of the live view in a headless browser, and the cost of the view to the simulation; PYTHONPATH names the
package.

live_view.py [TRIANGLES]...    numbers of surface triangles; default: 20000 and 100000"""

from __future__ import annotations

import contextlib
import itertools
import json
import multiprocessing
import os
import pathlib
import statistics
import sys
import time
from multiprocessing.synchronize import Event

import skerry as sk

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tests/python"))

from browser import open_browser  # noqa: E402
from live_client import open_socket  # noqa: E402

WARM_UP, SECONDS = 5.0, 10.0  # duration before a measurement, and of a measurement [s]

# Records the times at which the page acknowledges frames, and the sizes of the frames.
WATCH = """
(() => {
  const Plain = window.WebSocket;
  window.watched = { drawn: [], bytes: [] };
  window.WebSocket = class extends Plain {
    constructor(...given) {
      super(...given);
      this.addEventListener("message", ({ data }) => {
        if (typeof data !== "string") window.watched.bytes.push(data.byteLength ?? data.size);
      });
    }
    send(text) {
      if (JSON.parse(text).do === "seen") window.watched.drawn.push(performance.now());
      super.send(text);
    }
  };
})();
"""


def spinning_balls(triangles: int) -> sk.World:
    """Rigid balls that turn, so that each vertex moves in each frame, and the simulation costs little."""
    world = sk.World(threads=1, gravity=(0, 0, 0), sleep=False)
    mesh = sk.Mesh.ball(0.1, 20)
    count = max(1, round(triangles / len(mesh.boundary().triangles)))
    side = max(1, round(count**0.5))
    for number in range(count):
        place = (0.3 * (number % side), 0.3 * (number // side), 0)
        world.add_body(mesh, sk.Material(), dynamics="rigid", position=place, angular_velocity=(0.3, 0, 1))
    return world


def swinging_sheet(triangles: int) -> sk.World:
    """A soft sheet that is held at one edge."""
    world = sk.World(threads=1, sleep=False)
    cells = round((triangles / 4) ** 0.5)
    mesh = sk.Mesh.box((1, 1, 0.02), (cells, cells, 1))
    sheet = world.add_body(mesh, sk.Material(young_modulus=1e5, density=1000), name="sheet")
    sheet.attach(sheet.select(where=lambda x: x[:, 0] < -0.499))
    return world


def cpu_of_session(session: int) -> float:
    """CPU time of all processes of a session so far [s]."""
    ticks = 0
    for file in pathlib.Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            fields = file.read_text().rpartition(")")[2].split()
            ticks += int(fields[11]) + int(fields[12]) if int(fields[3]) == session else 0
    return ticks / os.sysconf("SC_CLK_TCK")


def measure_browser(triangles: int) -> None:
    """Prints frames per second, the longest time between two frames, and CPU time of the browser and bytes per
    frame."""
    world = spinning_balls(triangles)
    with sk.view(world, open=False) as view, open_browser((1280, 800)) as tab:
        tab.call("Page.enable")
        tab.call("Page.addScriptToEvaluateOnNewDocument", source=WATCH)
        tab.open(view.address)
        begun, start = time.monotonic(), 0.0
        while time.monotonic() < begun + WARM_UP + SECONDS:
            if not start and time.monotonic() > begun + WARM_UP:
                start, cpu = tab.evaluate("performance.now()"), cpu_of_session(tab.session)
            world.advance(1 / 60)
            view.sync()
            time.sleep(max(0, begun + world.time - time.monotonic()))
        cpu = cpu_of_session(tab.session) - cpu
        watched = json.loads(tab.evaluate("JSON.stringify(window.watched)"))
    drawn = [at for at in watched["drawn"] if at > start]
    gaps = [after - before for before, after in itertools.pairwise(drawn)]
    count = sum(len(body.surface) for body in world.bodies.values())
    rate, size = 1000 * len(gaps) / (drawn[-1] - drawn[0]), statistics.median(watched["bytes"])
    print(
        f"{count:7,} triangles: {rate:.1f} frames/s, longest gap {max(gaps):.0f} ms, {1000 * cpu / len(drawn):.0f} ms "
        f"of CPU time and {size / 1000:.0f} kB per frame",
        flush=True,
    )


def read_frames(address: str, fields: list[str], ready: Event, done: Event) -> None:
    """A client that reads and acknowledges frames until `done`."""
    with open_socket(address) as socket:
        socket.send(json.dumps({"do": "fields", "names": fields}))
        number = 0
        while not done.is_set():
            try:
                message = socket.recv(timeout=0.1)
            except TimeoutError:
                continue
            if isinstance(message, bytes):
                socket.send(json.dumps({"do": "seen", "number": number}))
                ready.set()
            elif (row := json.loads(message))["type"] == "row":
                number = row["number"]


def sync_seconds(world: sk.World, view: sk.View, calls: int) -> float:
    """CPU time of calls of View.sync() on the thread that advances the world [s]."""
    total = 0.0
    for _ in range(calls):
        world.advance(1 / 480)
        begun = time.thread_time()
        view.sync()
        total += time.thread_time() - begun
    return total


def measure_cost(triangles: int, fields: list[str]) -> None:
    """Prints the CPU time that the view takes from the simulation, without a client and with one that takes each
    frame. The encoding of frames runs on another thread and is not counted."""
    world = swinging_sheet(triangles)
    context = multiprocessing.get_context("spawn")
    with sk.view(world, open=False) as view:
        alone = sync_seconds(world, view, 100) / 100
        ready, done = context.Event(), context.Event()
        client = context.Process(target=read_frames, args=(view.address, fields, ready, done))
        client.start()
        while not ready.is_set():
            view.sync()
            time.sleep(0.01)
        sent, cost, begun, end = view.frames_sent, 0.0, time.thread_time(), time.monotonic() + SECONDS
        while time.monotonic() < end:
            cost += sync_seconds(world, view, 10)
        frame, share = cost / (view.frames_sent - sent), cost / (time.thread_time() - begun)
        done.set()
        client.join()
    print(
        f"{len(world.bodies['sheet'].surface):7,} triangles, colours by {' and '.join(fields) or 'speed'}: a call of "
        f"sync() takes {1e6 * alone:.1f} us without a client; a frame takes {1000 * frame:.2f} ms, and the view "
        f"{share:.1%} of the simulation",
        flush=True,
    )


def main() -> None:
    """Prints all measurements."""
    for triangles in [int(text) for text in sys.argv[1:]] or [20_000, 100_000]:
        measure_browser(triangles)
        measure_cost(triangles, [])
        measure_cost(triangles, ["stress"])


if __name__ == "__main__":
    main()
