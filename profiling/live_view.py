#!/usr/bin/env python3
"""Frames of the live view in a headless browser, and the cost of the view to the simulation; PYTHONPATH names the
package.

live_view.py [TRIANGLES]...    numbers of surface triangles; default: 20000 and 100000"""

from __future__ import annotations

import json
import multiprocessing
import pathlib
import sys
import time
from multiprocessing.synchronize import Event
from urllib.parse import urlsplit

import skerry as sk

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tests/python"))

from browser import open_browser  # noqa: E402

SECONDS = 10.0  # duration of each measurement [s]

# Notes the times at which the page acknowledges frames, and the sizes of the frames.
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


def measure_browser(triangles: int) -> None:
    """Prints frames per second, the longest time between two frames, and the bytes of a frame."""
    world = spinning_balls(triangles)
    with sk.view(world, open=False) as view, open_browser((1280, 800)) as tab:
        tab.call("Page.enable")
        tab.call("Page.addScriptToEvaluateOnNewDocument", source=WATCH)
        tab.open(view.address)
        begun, warm = time.monotonic(), 3.0
        while time.monotonic() < begun + warm + SECONDS:
            if time.monotonic() < begun + warm:
                start = None
            elif start is None:
                start = world.time, view.frames_sent, view.frames_dropped
            world.advance(1 / 60)
            view.sync()
            time.sleep(max(0, begun + world.time - time.monotonic()))
        watched = json.loads(tab.evaluate("JSON.stringify(window.watched)"))
    drawn = [at for at in watched["drawn"] if at > watched["drawn"][-1] - 1000 * SECONDS]
    gaps = [after - before for before, after in zip(drawn, drawn[1:], strict=False)]
    count = sum(len(body.surface) for body in world.bodies.values())
    rate = 1000 * len(gaps) / (drawn[-1] - drawn[0])
    sizes = sorted(watched["bytes"])
    print(
        f"{count:7,} triangles: {rate:5.1f} frames/s, longest gap {max(gaps):4.0f} ms, "
        f"{sizes[len(sizes) // 2] / 1000:.0f} kB per frame",
        flush=True,
    )


def read_frames(address: str, fields: list[str], ready: Event, done: Event) -> None:
    """A client that reads and acknowledges frames until `done`."""
    from websockets.sync.client import connect

    parts = urlsplit(address)
    with connect(
        f"ws://{parts.netloc}/live?{parts.fragment}", origin=f"http://{parts.netloc}", max_size=None, compression=None
    ) as socket:
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


def cpu_seconds(world: sk.World, view: sk.View | None, calls: int) -> float:
    """CPU time of the thread that advances the world [s]."""
    begun = time.thread_time()
    for _ in range(calls):
        world.advance(1 / 480)
        if view:
            view.sync()
    return time.thread_time() - begun


def measure_cost(triangles: int, fields: list[str]) -> None:
    """Prints the CPU time that the view adds to the simulation: without a client, and with one. Runs with and without
    the view alternate, and the least time of each counts."""
    world = swinging_sheet(triangles)
    calls = 1
    while (one := cpu_seconds(world, None, calls)) < SECONDS / 10:
        calls *= 2
    times: dict[str, list[float]] = {"alone": [one], "view": [], "client": []}
    context = multiprocessing.get_context("spawn")
    with sk.view(world, open=False) as view:
        for _ in range(5):
            times["alone"].append(cpu_seconds(world, None, calls))
            times["view"].append(cpu_seconds(world, view, calls))
            ready, done = context.Event(), context.Event()
            client = context.Process(target=read_frames, args=(view.address, fields, ready, done))
            client.start()
            while not ready.is_set():
                view.sync()
                time.sleep(0.01)
            sent, begun = view.frames_sent, time.monotonic()
            times["client"].append(cpu_seconds(world, view, calls))
            rate = (view.frames_sent - sent) / (time.monotonic() - begun)
            done.set()
            client.join()
            while view.client_count:
                view.sync()
                time.sleep(0.01)
    added = {name: min(times[name]) / min(times["alone"]) - 1 for name in times}
    print(
        f"{len(world.bodies['sheet'].surface):7,} triangles, {' and '.join(fields) or 'speed'}: cost of the view "
        f"without a client {added['view']:+.2%}, with a client {added['client']:+.2%} at {rate:.0f} frames/s",
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
