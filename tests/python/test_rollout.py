"""Rollouts: the same bits as a loop over copies, controls and records, errors, Ctrl-C, and threads."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
import threading
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import skerry as sk
from skerry import _core
from worlds import run_program

WORLDS, STEPS, DT = 5, 10, 5e-3


class Bench:
    """A ball on a plane beside a finger, a held bar, and a lever on a hinge with a motor."""

    def __init__(self) -> None:
        self.world = sk.World()
        rubber = sk.Material(young_modulus=5e4, density=500, friction=0.8, damping=20)
        self.floor = self.world.add_collider(sk.Plane(), name="floor")
        self.ball = self.world.add_body(sk.Mesh.ball(0.05, 4), rubber, position=(0, 0, 0.052), name="ball")
        self.finger = self.world.add_collider(sk.Box(size=(0.02, 0.04, 0.04)), position=(0.065, 0, 0.05), name="finger")
        self.bar = self.world.add_body(
            sk.Mesh.box((0.2, 0.05, 0.05), (8, 2, 2)), rubber, position=(0, 0.5, 0.5), name="bar"
        )
        self.clamp = self.bar.attach(self.bar.select(where=lambda x: x[:, 0] < -0.099))
        self.lever = self.world.add_body(
            sk.Mesh.box((0.1, 0.02, 0.02), (2, 1, 1)), rubber, position=(0, -0.5, 0.5), dynamics="rigid", name="lever"
        )
        self.hinge = self.world.add_joint(
            "hinge", self.lever, point=(-0.05, -0.5, 0.5), axis=(0, 1, 0), motor=sk.Motor(speed=0, strength=5)
        )


def poses() -> NDArray[np.float64]:
    """Poses of the finger, which pushes the ball farther in each world and interval."""
    values = np.zeros((WORLDS, STEPS, 6))
    push = np.linspace(0, 0.02, STEPS) * np.linspace(0.5, 1, WORLDS)[:, None]
    values[:, :, :3] = (0.065, 0, 0.05)
    values[:, :, 0] -= push
    values[:, :, 5] = 0.2 * push
    return values


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_a_rollout_has_the_bits_of_a_loop_over_copies(threads: int) -> None:
    bench = Bench()
    bench.world.advance(0.05)
    path = poses()
    loads = np.zeros((WORLDS, STEPS, bench.bar.node_count, 3))
    loads[:, :, -1, 2] = np.linspace(-0.1, 0.1, WORLDS)[:, None]
    gravity = np.array([[0, 0, -9.81 + 0.1 * step] for step in range(STEPS)])
    out = sk.rollout(
        bench.world,
        {bench.finger: path, (bench.bar, "loads"): loads, (bench.world, "gravity"): gravity},
        dt=DT,
        record={"ball": sk.NodesProbe(bench.ball), "bar": sk.BodyProbe(bench.bar), "world": sk.EnergyProbe()},
        threads=threads,
        keep_worlds=True,
    )
    for number in range(WORLDS):
        world = bench.world.copy()
        ball, bar, finger = world.bodies["ball"], world.bodies["bar"], world.colliders["finger"]
        for step in range(STEPS):
            pose = path[number, step]
            finger.move_to(sk.Pose(position=pose[:3], rotation=pose[3:]), DT)
            bar.set_loads(loads[number, step])
            world.set_gravity(gravity[step])
            world.advance(DT)
            assert np.array_equal(out["ball.position"][number, step], ball.positions)
            assert np.array_equal(out["bar.position"][number, step], bar.center_of_mass)
            assert out["world.elastic"][number, step] == world.energy.elastic
            assert out["time"][number, step] == world.time
        assert out.worlds[number].state_hash == world.state_hash
    assert np.ptp(out["ball.position"][:, -1], axis=0).max() > 1e-3  # the worlds differ


def test_the_given_world_does_not_change() -> None:
    bench = Bench()
    before = bench.world.state_hash
    sk.rollout(bench.world, {"finger": poses()}, dt=DT)
    assert bench.world.state_hash == before


def test_records_have_the_shapes_of_their_quantities() -> None:
    bench = Bench()
    record: dict[str, sk.Probe] = {
        "nodes": sk.NodesProbe(bench.ball),
        "centre": sk.BodyProbe(bench.ball),
        "tip": bench.bar.probe((0.1, 1 / 2, 1 / 2)),
        "pose": sk.PoseProbe(bench.finger),
        "twist": sk.VelocityProbe(bench.ball),
        "floor": sk.ForceProbe(bench.floor, by=bench.ball),
        "stress": sk.StressProbe(bench.ball),
        "ratio": sk.VolumeProbe(bench.ball),
        "clamp": sk.ReactionProbe(bench.clamp),
        "hinge": sk.JointProbe(bench.hinge),
        "energy": sk.EnergyProbe(),
    }
    out = sk.rollout(bench.world, dt=DT, steps=3, record=record)
    vectors = {name for name, values in out.items() if values.shape == (1, 3, 3)}
    numbers = {name for name, values in out.items() if values.shape == (1, 3)}
    assert vectors >= {"centre.position", "centre.velocity", "tip.displacement", "pose.rotation", "floor.force"}
    assert vectors >= {"twist.velocity", "twist.angular_velocity", "clamp.force", "hinge.moment"}
    assert numbers >= {"floor.contacts", "stress.largest_von_mises", "ratio.smallest_volume_ratio", "hinge.angle"}
    assert numbers >= {"energy.kinetic", "energy.elastic", "energy.potential", "energy.dissipated"}
    assert set(out) - vectors - numbers == {"nodes.position", "message", "distrust", "ok"}
    assert out["nodes.position"].shape == (1, 3, bench.ball.node_count, 3)
    assert out["time"].shape == (1, 3)
    assert out["pose.position"][0, -1].tolist() == [0.065, 0, 0.05]
    assert np.allclose(out["ratio.smallest_volume_ratio"], 1, atol=0.1)
    assert repr(out).startswith("<skerry.RolloutResult of 1 worlds and 3 intervals: 'time' (1, 3), 'nodes.")


def test_a_rollout_has_the_numbers_of_a_recorder() -> None:
    bench = Bench()
    record: dict[str, sk.Probe] = {"tip": bench.bar.probe((0.1, 0.5, 0.5)), "clamp": sk.ReactionProbe(bench.clamp)}
    out = sk.rollout(bench.world, dt=DT, steps=4, record=record)
    recorder = bench.world.recorder(record)
    for _ in range(4):
        bench.world.advance(DT)
        recorder.sample()
    table = recorder.table()
    for axis, column in enumerate(("x", "y", "z")):
        assert np.array_equal(out["tip.position"][0, :, axis], table[f"tip.position_{column}"])
        assert np.array_equal(out["clamp.force"][0, :, axis], table[f"clamp.force_{column}"])


def test_the_held_end_carries_the_weight_of_the_bar() -> None:
    bench = Bench()
    out = sk.rollout(bench.world, dt=0.5, steps=3, record={"clamp": sk.ReactionProbe(bench.clamp)})
    weight = bench.bar.mass * 9.81
    assert out["clamp.force"][0, -1] == pytest.approx((0, 0, weight), abs=0.02 * weight)  # it still swings a little


def test_a_motor_follows_the_speeds_of_a_control() -> None:
    bench = Bench()
    speeds = np.linspace(0.5, 2, STEPS)
    out = sk.rollout(bench.world, {(bench.hinge, "speed"): speeds}, dt=DT, record={"hinge": sk.JointProbe(bench.hinge)})
    # The solver may miss the speed by its tolerance.
    assert np.diff(out["hinge.angle"][0]) == pytest.approx(speeds[1:] * DT, rel=sk.Settings().tolerance)


def test_a_motor_reaches_the_coordinates_of_a_control() -> None:
    bench = Bench()
    bench.hinge.set_motor(sk.Motor(position=0, strength=5, fastest=20))
    angles = np.linspace(0.01, 0.1, STEPS)
    out = sk.rollout(bench.world, {bench.hinge: angles}, dt=DT, record={"hinge": sk.JointProbe(bench.hinge)})
    assert out["hinge.angle"][0] == pytest.approx(angles, rel=sk.Settings().tolerance)


def test_every_control_moves_its_object() -> None:
    bench = Bench()
    twist, shift = np.zeros((STEPS, 6)), np.zeros((STEPS, 6))
    twist[:, 2], shift[:, 2] = 0.5, np.linspace(0.001, 0.01, STEPS)
    pull = np.zeros((STEPS, 3))
    pull[:, 0] = 1e-2
    free = bench.world.add_body(
        sk.Mesh.ball(0.05, 4), sk.Material(damping=0, loss_factor=0), position=(5, 0, 5), name="free"
    )
    out = sk.rollout(
        bench.world,
        {(bench.finger, "velocity"): twist, bench.clamp: shift, free: pull},
        dt=DT,
        record={
            "finger": sk.PoseProbe(bench.finger),
            "clamp": sk.PoseProbe(bench.clamp),
            "free": sk.BodyProbe(free),
        },
    )
    assert out["finger.position"][0, :, 2] == pytest.approx(0.05 + 0.5 * DT * np.arange(1, STEPS + 1))
    assert out["clamp.position"][0, :, 2] == pytest.approx(shift[:, 2])
    assert np.diff(out["free.velocity"][0, :, 0]) == pytest.approx(1e-2 / free.mass * DT, rel=1e-9)


def test_worlds_of_a_list_differ_and_keep_their_order() -> None:
    bench = Bench()
    worlds = [bench.world.copy() for _ in range(3)]
    for number, world in enumerate(worlds):
        world.bodies["ball"].set_velocity((0, 0, float(number)))
    out = sk.rollout(worlds, dt=DT, steps=2, record={"ball": sk.BodyProbe(bench.ball)})
    assert np.all(np.diff(out["ball.position"][:, -1, 2]) > 0.5 * DT)


def test_a_continued_rollout_has_the_bits_of_a_longer_one() -> None:
    bench = Bench()
    path, record = poses(), {"ball": sk.NodesProbe(bench.ball)}
    whole = sk.rollout(bench.world, {"finger": path}, dt=DT, record=record)
    half = STEPS // 2
    first = sk.rollout(bench.world, {"finger": path[:, :half]}, dt=DT, record=record, keep_worlds=True)
    second = sk.rollout(first.worlds, {"finger": path[:, half:]}, dt=DT, record=record)
    assert np.array_equal(
        np.concatenate([first["ball.position"], second["ball.position"]], axis=1), whole["ball.position"]
    )


def test_a_world_that_was_reset_rolls_out_as_before() -> None:
    bench = Bench()
    saved, record = bench.world.copy(), {"ball": sk.NodesProbe(bench.ball)}
    first = sk.rollout(bench.world, {"finger": poses()}, dt=DT, record=record)
    bench.world.advance(0.05)
    bench.world.reset(saved)
    second = sk.rollout(bench.world, {"finger": poses()}, dt=DT, record=record)
    assert np.array_equal(first["ball.position"], second["ball.position"])


def test_a_rollout_shows_its_progress(capfd: pytest.CaptureFixture[str]) -> None:
    bench = Bench()
    sk.rollout([bench.world] * 4, dt=0.05, steps=4, progress=True)
    shown = capfd.readouterr().err
    assert shown.startswith("\r") and shown.endswith("\r100 %\n")


def test_a_world_that_stops_warns_and_has_nan() -> None:
    bench = Bench()
    force = np.zeros((2, 3, 3))
    force[1, 1, 0] = 1e12  # tears the held bar of world 1 apart
    with pytest.warns(sk.Doubt, match="1 of 2 worlds stopped; world 1: .*'bar'"):
        out = sk.rollout(bench.world, {(bench.bar, "force"): force}, dt=DT, record={"ball": sk.BodyProbe(bench.ball)})
    assert out["ok"].tolist() == [True, False]
    assert out["message"][0] == "" and "'bar'" in out["message"][1]
    assert np.isfinite(out["ball.position"][0]).all() and np.isfinite(out["ball.position"][1, 0]).all()
    assert np.isnan(out["ball.position"][1, 1:]).all()


def test_arrays_of_the_wrong_shape_are_refused_with_both_shapes() -> None:
    bench = Bench()
    with pytest.raises(TypeError, match=r"pose of collider 'finger': .*shape \(4, 5\), expected \(T, 6\)"):
        sk.rollout(bench.world, {"finger": np.zeros((4, 5))}, dt=DT)
    with pytest.raises(TypeError, match=r"shape \(4, 2, 3\) with the number of intervals 2, expected 3"):
        sk.rollout(bench.world, {"finger": np.zeros((4, 3, 6)), (bench.ball, "force"): np.zeros((4, 2, 3))}, dt=DT)
    with pytest.raises(TypeError, match="with the number of worlds 4, expected 2"):
        sk.rollout([bench.world, bench.world], {"finger": np.zeros((4, 3, 6))}, dt=DT)


def test_wrong_names_quantities_and_settings_are_refused() -> None:
    bench = Bench()
    with pytest.raises(KeyError, match="'thumb'; the names are 'floor', 'finger', 'ball', 'bar', 'lever'"):
        sk.rollout(bench.world, {"thumb": np.zeros((3, 6))}, dt=DT)
    with pytest.raises(sk.SceneError, match="quantity: found 'colour', expected one of 'force', 'loads'"):
        sk.rollout(bench.world, {(bench.ball, "colour"): np.zeros((3, 3))}, dt=DT)
    with pytest.raises(TypeError, match="probe 'ball': found <skerry.Body"):
        sk.rollout(bench.world, dt=DT, steps=1, record={"ball": bench.ball})  # type: ignore[dict-item]
    for steps in (None, 0, -1):
        with pytest.raises(sk.SceneError, match=f"rollout: steps: found {steps}, expected a number"):
            sk.rollout(bench.world, dt=DT, steps=steps)
    with pytest.raises(sk.SceneError, match="worlds: found an empty list"):
        sk.rollout([], dt=DT, steps=1)
    with pytest.raises(TypeError, match="worlds: found 3, expected a World"):
        sk.rollout([bench.world, 3], dt=DT, steps=1)  # type: ignore[list-item]
    with pytest.raises(TypeError, match="pose of collider 'finger': found 'left'"):
        sk.rollout(bench.world, {"finger": "left"}, dt=DT)
    with pytest.raises(sk.SceneError, match="dt"):
        sk.rollout(bench.world, dt=0.0, steps=1)
    with pytest.raises(sk.SceneError, match="dt: found 1e-20, expected a longer time, because rounding would lose it"):
        bench.world.advance(0.01)
        sk.rollout(bench.world, dt=1e-20, steps=1)
    with pytest.raises(TypeError, match="dt: found 'a', expected a number"):
        sk.rollout(bench.world, dt="a", steps=1)  # type: ignore[arg-type]
    with pytest.raises(sk.SceneError, match="worlds: found a null pointer"):
        _core.rollout([None], [], [], DT, 1, 1, False, None)  # type: ignore[list-item]
    with pytest.raises(sk.SceneError, match="finger"):  # a NaN in a control
        sk.rollout(bench.world, {"finger": np.full((3, 6), np.nan)}, dt=DT)


def test_another_thread_finds_the_world_busy() -> None:
    bench = Bench()
    errors: list[sk.BusyError] = []

    def run() -> None:
        for _ in range(1000):  # the first ones may be over before this thread can look
            if not errors:
                sk.rollout([bench.world] * 2, dt=0.05, steps=20)

    thread = threading.Thread(target=run)
    thread.start()
    while thread.is_alive() and not errors:
        try:
            _ = bench.world.time
        except sk.BusyError as error:
            errors.append(error)
    thread.join()
    assert errors
    assert bench.world.time == 0


def test_a_signal_handler_cannot_change_the_worlds_of_a_rollout() -> None:
    run_program(
        """
        import os, signal
        import skerry as sk
        from worlds import ball_world

        world, ball, floor = ball_world()
        refused = []

        def handle(*_):
            try:
                world.advance(0.01)
            except sk.SceneError as error:
                refused.append(str(error))

        signal.signal(signal.SIGALRM, handle)
        signal.setitimer(signal.ITIMER_REAL, 0.01, 0.01)
        rows = 100
        while not refused:  # a fast machine may end before the first signal
            out = sk.rollout([world] * 8, dt=1e-3, steps=rows, record={"ball": sk.NodesProbe(ball)}, threads=2)
            rows *= 2
        signal.setitimer(signal.ITIMER_REAL, 0)
        assert "found a call during advance() or rollout()" in refused[0], refused
        assert (out["ball.position"] == out["ball.position"][0]).all()
        assert world.advance(0.01).ok
        """
    )


def test_ctrl_c_ends_a_rollout_and_leaves_the_world_whole() -> None:
    program = """
        import threading
        import skerry as sk
        from worlds import wait_until_busy
        world = sk.World()
        for i in range(4):
            world.add_body(sk.Mesh.ball(0.1, 6), sk.Material(young_modulus=1e6), position=(0, 0, 0.2 + 0.3 * i))
        world.add_collider(sk.Plane())
        before = world.state_hash

        def tell() -> None:
            wait_until_busy(world)
            print("running", flush=True)

        threading.Thread(target=tell).start()
        try:
            sk.rollout([world] * 8, dt=1.0, steps=100_000)  # would take hours
        except KeyboardInterrupt:
            assert world.state_hash == before
            world.advance(0.01)
            print("whole")
    """
    command, folder = [sys.executable, "-c", textwrap.dedent(program)], os.path.dirname(__file__)
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=folder)
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == "running\n"
        process.send_signal(signal.SIGINT)
        out, _ = process.communicate(timeout=60)
    finally:
        process.kill()
    assert (out, process.returncode) == ("whole\n", 0)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"threads": "a"}, "rollout: threads: found 'a', expected a whole number"),
        ({"steps": 1.5}, "rollout: steps: found 1.5, expected a whole number"),
        ({"keep_worlds": "no"}, "rollout: keep_worlds: found 'no', expected True or False"),
        ({"controls": [1]}, r"rollout: controls: found \[1\], expected a Mapping"),
        ({"controls": {"finger": [[1, 2], [1]]}}, r"pose of collider 'finger': found \[\[1, 2\], \[1\]\]"),
        ({"controls": {("finger", "pose", 1): 0}}, r"controls: found \('finger', 'pose', 1\), expected a name or"),
        ({"worlds": 3}, "rollout: worlds: found 3, expected a World"),
    ],
)
def test_an_argument_of_a_wrong_type_is_named(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(TypeError, match=message):
        sk.rollout(**{"worlds": Bench().world, "dt": DT, "steps": 2, **arguments})


def test_the_gravity_of_another_world_is_refused() -> None:
    worlds = [Bench().world, Bench().world]
    sk.rollout(worlds, {worlds[1]: np.zeros((2, 3))}, dt=DT)
    with pytest.raises(sk.SceneError, match="controls: gravity: found another world, expected one of the given worlds"):
        sk.rollout(worlds, {sk.World(threads=1): np.zeros((2, 3))}, dt=DT)


def test_a_force_on_a_body_is_divided_by_mass() -> None:
    free = sk.World(gravity=(0, 0, 0), threads=1)
    ball = free.add_body(sk.Mesh.ball(0.1, 4), sk.Material())
    out = sk.rollout(free, {ball: [(1, 0, 0)] * 3}, dt=0.01, record={"ball": sk.NodesProbe(ball)})
    moved = out["ball.position"][0, -1] - ball.positions
    assert moved == pytest.approx(np.broadcast_to(moved[0], moved.shape), abs=1e-12)  # all nodes move alike


def test_the_value_of_an_object_is_controlled_as_by_its_own_function() -> None:
    bench = Bench()
    tip = sk.Anchor(body=bench.ball, point=(0, 0, 0.052))
    spring = bench.world.add_spring(tip, sk.Anchor(point=(0, 0, 0.3)), stiffness=20)
    cable = bench.world.add_cable([tip, sk.Anchor(point=(0.3, 0, 0.1))], tension=0)
    cavity = bench.world.add_cavity(bench.bar, faces=bench.bar.surface[:4], pressure=0)
    load = bench.world.add_acceleration((0, 0, 1), scale=0)
    muscle = bench.world.add_fibres(bench.bar, (1, 0, 0))
    values = np.linspace(0.1, 0.2, STEPS)
    setters = {
        spring: lambda twin, x: twin.set_rest_length(x),
        cable: lambda twin, x: twin.set_drive(tension=x),
        cavity: lambda twin, x: twin.set_pressure(x),
        load: lambda twin, x: twin.set_scale(x),
        muscle: lambda twin, x: twin.set_tension(x),
    }
    rolled = sk.rollout(bench.world, dict.fromkeys(setters, values), dt=DT, keep_worlds=True).worlds[0]
    by_hand = bench.world.copy()
    for value in values:
        for item, apply in setters.items():
            apply(item.in_copy(by_hand), value)
        by_hand.advance(DT)
    assert rolled.state_hash == by_hand.state_hash
