"""Threads, signals, processes and memory."""

import concurrent.futures
import contextlib
import multiprocessing
import os
import sys
import threading
import time
from typing import Any

import numpy as np
import pytest

import skerry as sk
from skerry import _core
from worlds import RUBBER, ball_world, busy, run_program

READS = {
    "time": lambda world, ball: world.time,
    "positions": lambda world, ball: ball.positions,
    "mass": lambda world, ball: ball.mass,
    "alive": lambda world, ball: ball.alive,
    "bodies": lambda world, ball: world.bodies["ball"],
    "report": lambda world, ball: world.report(),
    "state_hash": lambda world, ball: world.state_hash,
    "stress": lambda world, ball: ball.stress(),
    "views": lambda world, ball: ball.views().__enter__(),
    "copy": lambda world, ball: world.copy(),
    "to_bytes": lambda world, ball: world.to_bytes(),
    "advance": lambda world, ball: world.advance(1e-4),
    "set_gravity": lambda world, ball: world.set_gravity((0, 0, -9.81)),
    "joints": lambda world, ball: world.joints,
    "watch_steps": lambda world, ball: world.watch_steps(None),
}


@pytest.mark.parametrize("read", READS)
def test_a_world_that_another_thread_advances_is_busy(read: str) -> None:
    world, ball, _ = ball_world()
    with busy(world), pytest.raises(sk.BusyError, match="in use by another thread"):
        READS[read](world, ball)
    READS[read](world, ball)


def test_texts_of_busy_objects_say_so() -> None:
    world, ball, floor = ball_world()
    with busy(world):
        assert repr(world) == "<skerry.World in use by another thread>"
        assert world._repr_html_() == "&lt;skerry.World in use by another thread&gt;"
        assert repr(ball) == "<skerry.Body: body 'ball', in use by another thread>"
        assert repr(floor) == "<skerry.Collider: collider 'floor', in use by another thread>"


def test_every_method_of_the_extension_module_can_be_busy() -> None:
    world, ball, floor = ball_world()
    handles = {"body": ball._handle, "collider": floor._handle, "attachment": ball.attach([0])._handle}
    settings = (sk.Pose(position=(0, 0, 1)), sk.Surface(), np.zeros(3), np.zeros((ball.node_count, 3)), "rigid", 1, 1.0)
    arguments: list[tuple[Any, ...]] = [(), (None,), (True,), (world.copy()._core,), (sk.Material(),), (np.zeros(3),)]
    for handle in handles.values():
        arguments += [(handle,), *((handle, value) for value in settings), (handle, handle), (handle, None)]
        arguments += [(handle, np.zeros(3), np.zeros(3)), (handle, 1, 1), (handle, sk.Pose(), 1.0)]
    called = set()
    with busy(world):
        for name in dir(_core.World):
            method = getattr(_core.World, name)
            if name.startswith("__") or name in ("load", "from_bytes"):
                continue
            for given in arguments:
                try:
                    method(world._core, *given)
                except sk.BusyError:
                    called.add(name)
                except TypeError:
                    pass
                else:
                    pytest.fail(f"{name} did not notice the other thread")
    assert len(called) > 50 and {"mass", "views", "move_to", "set_positions", "report"} <= called


def test_reads_of_a_second_thread_are_right_or_refused() -> None:
    # With a sleeping body or a short time, a call of advance() is so short that no read finds the world in use.
    world, ball, _ = ball_world(sleep=False)
    twin = world.copy()
    counts = {"right": 0, "busy": 0}
    advanced = threading.Event()

    def advance() -> None:
        while not advanced.wait(1e-3):
            with contextlib.suppress(sk.BusyError):
                world.advance(0.5)

    thread = threading.Thread(target=advance)
    thread.start()
    latest = time.monotonic() + 60
    while min(counts.values()) < 100 and time.monotonic() < latest:
        # While this thread reads, the other one may find the world in use whenever it gets the lock of the interpreter.
        time.sleep(1e-3)
        for read in ("time", "positions", "mass", "bodies", "report", "state_hash", "stress", "copy"):
            try:
                READS[read](world, ball)
                counts["right"] += 1
            except sk.BusyError:
                counts["busy"] += 1
    advanced.set()
    thread.join()
    assert min(counts.values()) >= 100
    for _ in range(round(world.time / 0.5)):
        twin.advance(0.5)
    assert twin.state_hash == world.state_hash


def test_other_threads_run_while_a_world_advances() -> None:
    world, _, _ = ball_world()
    started, ended = threading.Event(), threading.Event()
    busy = 0

    def advance() -> None:
        started.set()
        world.advance(2.0)
        ended.set()

    thread = threading.Thread(target=advance)
    thread.start()
    assert started.wait(60)
    while not ended.is_set():
        try:
            assert world.time >= 0
        except sk.BusyError:
            busy += 1
    thread.join()
    assert busy > 100


def test_worlds_advance_at_the_same_time_in_several_threads() -> None:
    worlds = [ball_world()[0] for _ in range(4)]
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda world: world.advance(0.1), worlds))
    assert len({world.state_hash for world in worlds}) == 1


@pytest.mark.parametrize("backend", ["automatic", "threads", "serial"])
@pytest.mark.parametrize("threads", [1, 3])
def test_the_bits_do_not_depend_on_the_threads(backend: Any, threads: int) -> None:
    def state(**settings: Any) -> int:
        world, _, _ = ball_world(**settings)
        for x in range(8):
            world.add_body(sk.Mesh.ball(0.04, 4), RUBBER, position=(0.1 * x, 0.2, 0.05))
        world.advance(0.08)
        return world.state_hash

    assert state(backend=backend, threads=threads) == state()


INTERRUPTED = """
    import os, signal, threading
    from worlds import ball_world, wait_until_busy

    world, ball, floor = ball_world()
    world.advance(0.001)

    def interrupt():
        wait_until_busy(world)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    thread.start()
    try:
        {call}
    except KeyboardInterrupt:
        assert world.time < 1e3
    else:
        raise SystemExit("the call was not interrupted")
    thread.join()
    steps, stop = world.report().steps, world.time
    twin, _, _ = ball_world()
    twin.advance(0.001)
    done = twin.report().steps
    twin.advance(1e3, check=lambda report: report.steps < steps - done)
    assert twin.report().steps == steps and twin.time == stop
    assert twin.state_hash == world.state_hash
    assert world.advance(0.01).ok
"""


@pytest.mark.parametrize("call", ["world.advance(1e3)", "world.advance(1e3, check=lambda report: True)"])
def test_an_interrupt_ends_advance_between_two_steps(call: str) -> None:
    run_program(INTERRUPTED.format(call=call))


def test_an_interrupt_ends_a_run() -> None:
    run_program(
        """
        import os, signal, threading
        from worlds import ball_world

        world, ball, floor = ball_world()
        begun = threading.Event()
        thread = threading.Thread(target=lambda: begun.wait() and os.kill(os.getpid(), signal.SIGINT))
        thread.start()
        try:
            world.run(1e5, each=lambda _: begun.set())
        except KeyboardInterrupt:
            pass
        thread.join()
        assert 0 < world.time < 1e5 and world.advance(0.01).ok
        """
    )


@pytest.mark.parametrize(
    "call",
    [
        "world.advance(1e4)",
        "world.advance(1e4, check=lambda report: True)",
        "sk.rollout([world] * 2, dt=1.0, steps=100_000)",
        "[world.advance(1e-3) for _ in iter(int, 1)]",
    ],
)
def test_python_ends_silently_while_a_daemon_thread_is_in_a_call(call: str) -> None:
    run_program(
        f"""
        import atexit, threading
        atexit.register(lambda: print(other.advance(0.01).ok))  # the thread that ends Python can still use worlds
        import skerry as sk
        from worlds import ball_world, wait_until_busy

        world, ball, floor = ball_world()
        other = world.copy()
        threading.Thread(target=lambda: {call}, daemon=True).start()
        wait_until_busy(world)
        """
    )


FORKED = """
    import os, warnings
    import skerry as sk
    from worlds import ball_world

    world, ball, floor = ball_world(backend="{backend}", threads=2)
    world.advance(0.01)
    calls = [lambda: world.time, lambda: world.advance(0.01), lambda: sk.World(), lambda: ball.positions]
    warnings.simplefilter("ignore", DeprecationWarning)  # Python 3.12 warns of forks beside threads
    child = os.fork()
    if child == 0:
        try:
            for call in calls:
                try:
                    call()
                except RuntimeError as error:
                    assert "made by fork()" in str(error) and "spawn" in str(error), error
                else:
                    os._exit(3)
            del world, ball, floor, calls, call
            os._exit(0)
        except BaseException:
            os._exit(4)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    assert world.advance(0.01).ok
"""


@pytest.mark.parametrize("backend", ["automatic", "threads"])
def test_a_forked_process_is_told_to_use_spawn(backend: str) -> None:
    run_program(FORKED.format(backend=backend))


def test_a_process_may_fork_before_threads_start() -> None:
    run_program(
        """
        import os
        from worlds import ball_world

        world, ball, floor = ball_world(threads=1)
        world.advance(0.01)
        child = os.fork()
        if child == 0:
            os._exit(0 if world.advance(0.01).ok and ball_world()[0].advance(0.01).ok else 3)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
        """
    )


def steps_of(world: sk.World) -> int:
    world.advance(0.05)
    return world.state_hash


def test_worlds_are_sent_to_processes_by_spawn() -> None:
    world, _, _ = ball_world()
    with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        found = pool.submit(steps_of, world).result()
    assert found == steps_of(world)


def test_objects_leave_nothing_behind() -> None:
    run_program(
        """
        import copy, pickle
        import skerry as sk
        from worlds import RUBBER, ball_world

        world, ball, floor = ball_world()
        world.watch_steps(lambda report: world.time)
        held = ball.attach(ball.select(below=0.03))
        rod = world.add_body(sk.Sphere(radius=0.1), RUBBER, position=(1, 0, 1))
        joint = world.add_joint("hinge", rod)
        block = world.contact_problems()
        block.__enter__().extend([world, block])  # keeps the world by a cycle of references
        world.run(0.02)
        kept = [copy.copy(world), pickle.loads(pickle.dumps(ball)), world.report(), joint.state, held.pose]
        try:
            world.advance(-1)
        except sk.SceneError as error:
            kept.append(error)
        with ball.views() as views:
            kept.append(views)
        ball_again = world.bodies["ball"]
        """
    )


def test_dropped_worlds_free_their_memory() -> None:
    def resident() -> int:
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1])

    def make(count: int) -> None:
        for _ in range(count):
            world, ball, floor = ball_world()
            world.advance(1e-3)
            with ball.views() as (x, v):
                del x, v
            assert len(ball.surface) and world.report().steps

    if not sys.platform.startswith("linux"):
        pytest.skip("/proc is found on Linux only")
    if "libasan" in os.environ.get("LD_PRELOAD", ""):
        pytest.skip("the address sanitizer keeps freed memory for a while")
    make(50)
    before = resident()
    make(200)
    # one leaked world has more than 20 pages
    assert resident() - before < 200


def test_a_callback_on_another_thread_may_use_another_world() -> None:
    world, _, _ = ball_world()
    other, _, _ = ball_world()
    world.watch_steps(lambda report: other.advance(1e-4))
    report = world.advance(5e-3)
    assert other.time == pytest.approx(report.steps * 1e-4)


def test_calls_of_advance_alternate_between_threads() -> None:
    world, _, _ = ball_world()
    twin = world.copy()
    for _ in range(5):
        thread = threading.Thread(target=world.advance, args=(0.01,))
        thread.start()
        thread.join()
        world.advance(0.01)
        twin.advance(0.01)
        twin.advance(0.01)
    assert world.state_hash == twin.state_hash
