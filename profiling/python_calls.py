#!/usr/bin/env python3
"""Cost of calls of the Python package beside the work of the engine; PYTHONPATH names the package."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable

import skerry as sk


def cpu_seconds(call: Callable[[], object], calls: int, repeats: int = 9) -> float:
    """Least CPU time of one call in several repeats [s]."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        for _ in range(calls):
            call()
        times.append((time.process_time() - start) / calls)
    return min(times)


def falling_ball() -> tuple[sk.World, sk.Body]:
    """A ball of 540 tetrahedra above a floor, and its world."""
    world = sk.World(threads=1, sleep=False)
    world.add_collider(sk.Plane())
    return world, world.add_body(sk.Mesh.ball(0.05, 6), sk.Material(young_modulus=2e5), position=(0, 0, 0.06))


def run_seconds(estimates: bool) -> float:
    """CPU time of a run of 20 s [s]."""
    world, _ = falling_ball()
    start = time.process_time()
    with world.error_estimator() if estimates else contextlib.nullcontext():
        for _ in range(1200):
            world.advance(1 / 60)
    return time.process_time() - start


def main() -> None:
    """Prints the cost of each call, its share in a loop that advances a ball, and the share of error estimates."""
    empty = sk.World(threads=1)
    world, ball = falling_ball()
    beside = cpu_seconds(lambda: empty.advance(0.0), 10_000)  # the engine has nothing to do: 0.02 us of it are C++
    whole = cpu_seconds(lambda: world.advance(1 / 240), 240)
    print(f"advance beside its steps   {1e6 * beside:7.2f} us, {100 * beside / whole:.1f} % of {1e6 * whole:.0f} us")
    print(f"positions of {ball.node_count} nodes     {1e6 * cpu_seconds(lambda: ball.positions, 10_000):7.2f} us")
    pairs = [(run_seconds(False), run_seconds(True)) for _ in range(5)]
    without, estimated = (min(times) for times in zip(*pairs, strict=True))
    print(f"error estimates            {100 * (estimated / without - 1):.1f} % of a run")
    print(f"time                       {1e6 * cpu_seconds(lambda: world.time, 10_000):7.2f} us")


if __name__ == "__main__":
    main()
