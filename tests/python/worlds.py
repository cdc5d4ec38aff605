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
from pathlib import Path
from typing import Any

import pytest

import skerry as sk

RUBBER = sk.Material(young_modulus=2e5, poisson_ratio=0.4, density=1000, friction=0.5)


def ball_world(**settings: Any) -> tuple[sk.World, sk.Body, sk.Collider]:
    """A rubber ball that touches a plane after 45 ms."""
    world = sk.World(**{"threads": 1, **settings})
    floor = world.add_collider(sk.Plane(), name="floor")
    ball = world.add_body(sk.Mesh.ball(0.05, 4), RUBBER, position=(0, 0, 0.06), name="ball")
    return world, ball, floor


def skip_without_live_view() -> None:
    """Skips the tests of a module if this build has no live view."""
    try:
        sk.view(sk.World(threads=1), open=False).close()
    except sk.SceneError as error:
        if "SKERRY_LIVE=OFF" not in str(error):
            raise
        pytest.skip("this build has no live view", allow_module_level=True)


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


def wait_until_busy(world: sk.World) -> None:
    """Returns as soon as another thread uses the world."""
    with contextlib.suppress(sk.BusyError):
        while True:
            _ = world.time


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


OBJ = """mtllib skin.mtl
v -0.04 -0.04 0
v 0.04 -0.04 0
v 0.04 0.04 0
v -0.04 0.04 0
vt 0 0
vt 1 0
vt 1 1
usemtl red skin
f 1 2 3
usemtl picture
f 1/1 3/3 4/2
"""
MTL = "newmtl red skin\nKd 1 0.5 0.25\nd 0.5\nnewmtl picture\nmap_Kd picture.png\n"
LINEAR = [1, 0.2140411, 0.0508761]  # the colour of "red skin", which is sRGB
PNG = bytes.fromhex(  # one red pixel
    "89504e470d0a1a0a0000000d4948445200000001000000010802000000907753de0000000c4944415408d763f8cfc0000003010100"
    "18dd8db00000000049454e44ae426082"
)


def painted_world(folder: Path) -> sk.World:
    """A ball that falls freely, drawn as a square with two materials."""
    (folder / "skin.obj").write_text(OBJ)
    (folder / "skin.mtl").write_text(MTL)
    (folder / "picture.png").write_bytes(PNG)
    scene = {
        "settings": {"threads": 1},
        "materials": {"rubber": {"E": 2e5, "nu": 0.4, "rho": 1000}},
        "bodies": [{"name": "ball", "mesh": {"ball": {"radius": 0.05, "resolution": 4}}, "material": "rubber"}],
    }
    scene["bodies"][0].update(position=[0, 0, 1], visual="skin.obj")  # type: ignore[index]
    return sk.load_scene(scene, folder=folder).world
