"""Small worlds for the tests, a busy world, and a way to run a program in a process of its own."""

from __future__ import annotations

import concurrent.futures
import contextlib
import os
import subprocess
import sys
import textwrap
import threading
from collections.abc import Iterator
from typing import Any

import skerry as sk

RUBBER = sk.Material(young_modulus=2e5, poisson_ratio=0.4, density=1000, friction=0.5)


def ball_world(**settings: Any) -> tuple[sk.World, sk.Body, sk.Collider]:
    """A rubber ball that touches a plane after 45 ms."""
    world = sk.World(**{"threads": 1, **settings})
    floor = world.add_collider(sk.Plane(), name="floor")
    ball = world.add_body(sk.Mesh.ball(0.05, 4), RUBBER, position=(0, 0, 0.06), name="ball")
    return world, ball, floor


@contextlib.contextmanager
def busy(world: sk.World) -> Iterator[None]:
    """Another thread advances the world until the end of the scope."""
    inside, done = threading.Event(), threading.Event()

    def wait(report: sk.StepReport) -> None:
        inside.set()
        assert done.wait(60)

    world.watch_steps(wait)
    with concurrent.futures.ThreadPoolExecutor(1) as pool:
        advance = pool.submit(world.advance, 1e-9)
        assert inside.wait(60)
        try:
            yield
        finally:
            done.set()
            assert advance.result().ok
    world.watch_steps(None)


def run_program(program: str, *, check: bool = True, **options: Any) -> subprocess.CompletedProcess[str]:
    """Runs a Python program, which must end well and silently: nanobind reports leaks at the end of a program."""
    done = subprocess.run(
        [sys.executable, "-X", "dev", "-W", "error", "-c", textwrap.dedent(program)],
        capture_output=True,
        text=True,
        timeout=120,
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join([os.path.dirname(__file__), os.environ.get("PYTHONPATH", "")]),
        },
        **options,
    )
    if check:
        assert (done.returncode, done.stderr) == (0, ""), done.stdout + done.stderr
    return done
