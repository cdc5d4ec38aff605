#!/usr/bin/env python3
"""Cost of calls of the Python package beside the work of the engine; PYTHONPATH names the package."""

from __future__ import annotations

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


def main() -> None:
    """Prints the cost of each call, and its share in a loop that advances a ball of 540 tetrahedra."""
    empty = sk.World(threads=1)
    world = sk.World(threads=1, sleep=False)
    world.add_collider(sk.Plane())
    ball = world.add_body(sk.Mesh.ball(0.05, 6), sk.Material(young_modulus=2e5), position=(0, 0, 0.06))
    beside = cpu_seconds(lambda: empty.advance(0.0), 10_000)  # the engine has nothing to do: 0.02 us of it are C++
    whole = cpu_seconds(lambda: world.advance(1 / 240), 240)
    print(f"advance beside its steps   {1e6 * beside:7.2f} us, {100 * beside / whole:.1f} % of {1e6 * whole:.0f} us")
    print(f"positions of {ball.node_count} nodes     {1e6 * cpu_seconds(lambda: ball.positions, 10_000):7.2f} us")
    print(f"time                       {1e6 * cpu_seconds(lambda: world.time, 10_000):7.2f} us")


if __name__ == "__main__":
    main()
