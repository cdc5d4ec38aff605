"""Rollouts of many worlds."""

import signal
import threading
from typing import Any

import numpy as np
import pytest

import skerry as sk
from worlds import RUBBER

B, T, DT = 4, 5, 0.01


def pushing_world(**settings: Any) -> sk.World:
    """A ball between a floor and a finger that can push it, and a wheel with a motor."""
    world = sk.World(threads=1, **settings)
    world.add_collider(sk.Plane(), name="floor")
    world.add_collider(sk.Sphere(radius=0.02), position=(-0.08, 0, 0.05), name="finger")
    world.add_body(sk.Mesh.ball(0.05, 4), RUBBER, position=(0, 0, 0.051), name="ball")
    wheel = world.add_body(sk.Cylinder(radius=0.05, height=0.02), RUBBER, position=(0, 0.5, 0.5), name="wheel")
    world.add_joint("hinge", wheel, point=(0, 0.5, 0.5), motor=sk.Motor(speed=0.0, strength=1.0))
    return world


def poses() -> Any:
    """Poses of the finger, which moves along x at another speed in each world."""
    values = np.zeros((B, T, 6))
    values[:, :, 0] = -0.08 + np.linspace(0, 2, B)[:, None] * DT * np.arange(1, T + 1)
    values[:, :, 2] = 0.05
    return values


@pytest.mark.parametrize("threads", [1, 3])
def test_a_rollout_equals_a_loop_bit_by_bit(threads: int) -> None:
    world = pushing_world()
    before, ball = world.state_hash, world.bodies["ball"]
    speeds = np.linspace(1, 4, B * T).reshape(B, T)
    record: dict[str, sk.Probe] = {
        "tip": ball.probe((0, 0, 0.1)),
        "nodes": sk.NodesProbe(ball),
        "push": sk.ForceProbe(ball),
        "energy": sk.EnergyProbe(),
    }
    controls: Any = {"finger": poses(), sk.MotorSpeedControl(world.joints[0]): speeds}
    out = sk.rollout(world, controls, dt=DT, record=record, threads=threads, keep_worlds=True)
    assert world.state_hash == before and out["ok"].tolist() == [True] * B and set(out["message"]) == {""}
    assert out["tip.position"].shape == (B, T, 3) and out["nodes.position"].shape == (B, T, ball.node_count, 3)
    assert out["energy.kinetic"].shape == (B, T) and len(out.worlds) == B
    for number in range(B):
        single = world.copy()
        finger, joint, body = single.colliders["finger"], single.joints[0], single.bodies["ball"]
        probes = {name: getattr(sk, type(probe).__name__)(body) for name, probe in record.items() if name == "nodes"}
        with single.recorder({**probes, "push": sk.ForceProbe(body)}) as recorder:
            for step in range(T):
                pose = poses()[number, step]
                finger.move_to(sk.Pose(position=pose[:3], rotation=pose[3:]), DT)
                joint.set_motor(sk.Motor(speed=speeds[number, step], strength=1.0))
                single.advance(DT)
                np.testing.assert_array_equal(out["nodes.position"][number, step], body.positions)
        assert out.worlds[number].state_hash == single.state_hash
        assert out["time"][number, -1] == single.time
        assert out["energy.kinetic"][number, -1] == single.energy.kinetic
        np.testing.assert_array_equal(out["push.force"][number, :, 0], recorder.table()["push.force_x"][1:])
    # The finger pushed the ball in the last worlds only.
    assert out["nodes.position"][-1, -1, :, 0].mean() > out["nodes.position"][0, -1, :, 0].mean() + 1e-3


def test_worlds_may_differ() -> None:
    world = pushing_world()
    worlds = [world.copy() for _ in range(3)]
    for number, one in enumerate(worlds):
        one.set_gravity((0, 0, -number))
    out = sk.rollout(worlds, {}, dt=DT, steps=2, record={"wheel": sk.PoseProbe(world.bodies["ball"])})
    heights = out["wheel.position"][:, -1, 2]
    assert heights[0] > heights[1] > heights[2] and out.worlds == []


@pytest.mark.parametrize(
    ("control", "value", "column"),
    [
        (sk.GravityControl(), [3.0, 0, 0], "ball"),
        ("force", [3.0, 0, 0], "ball"),
        ("nodes", [0.01, 0, 0], "ball"),
        ("velocity", [0.5, 0, 0, 0, 0, 0], "finger"),
    ],
)
def test_every_control_moves_its_object(control: Any, value: Any, column: str) -> None:
    world = pushing_world()
    ball = world.bodies["ball"]
    shape: tuple[int, ...] = (T, len(value))
    if control == "force":
        control = sk.BodyForceControl(ball)
    elif control == "nodes":
        control, shape = sk.NodeForceControl(ball), (T, ball.node_count, 3)
    elif control == "velocity":
        control = sk.VelocityControl(world.colliders["finger"])
    record: dict[str, sk.Probe] = {
        "ball": sk.VelocityProbe(ball),
        "finger": sk.VelocityProbe(world.colliders["finger"]),
    }
    out = sk.rollout(world, {control: np.broadcast_to(value, shape)}, dt=DT, count=2, record=record)
    np.testing.assert_array_equal(out[f"{column}.velocity"][0], out[f"{column}.velocity"][1])
    assert np.all(np.diff([0, *out[f"{column}.velocity"][0, :, 0]])[0] > 1e-3)


def test_a_motor_reaches_its_positions() -> None:
    world = pushing_world()
    [joint] = world.joints
    joint.set_motor(sk.Motor(position=0.0, strength=5.0, fastest=20.0))
    angles = np.linspace(0.1, 0.5, T)
    out = sk.rollout(world, {sk.MotorPositionControl(joint): angles}, dt=DT, record={"joint": sk.JointProbe(joint)})
    np.testing.assert_allclose(out["joint.angle"], angles[None], atol=1e-6)


def test_a_world_that_cannot_go_on_stops_alone() -> None:
    world = pushing_world()
    force = np.zeros((2, T, 3))
    force[1, 2:] = 1e30
    out = sk.rollout(world, {sk.BodyForceControl(world.bodies["ball"]): force}, dt=DT, record={"e": sk.EnergyProbe()})
    assert out["ok"].tolist() == [True, False] and "ball" in out["message"][1]
    assert np.isfinite(out["e.kinetic"][0]).all() and np.isnan(out["e.kinetic"][1, -1])


def test_wrong_arguments_are_refused() -> None:
    world = pushing_world()
    with pytest.raises(TypeError, match=r"PoseControl.*shape \(4, 5, 3\), expected \(4, 5, 6\)"):
        sk.rollout(world, {"finger": np.zeros((B, T, 3))}, dt=DT)
    with pytest.raises(TypeError, match="steps: found neither a number nor an array"):
        sk.rollout(world, {}, dt=DT)
    with pytest.raises(TypeError, match="controls: found 3, expected the name of a collider"):
        sk.rollout(world, {3: np.zeros((B, T, 3))}, dt=DT)  # type: ignore[type-var]
    with pytest.raises(KeyError, match="hand"):
        sk.rollout(world, {"hand": poses()}, dt=DT)
    with pytest.raises(sk.SceneError, match="dt"):
        sk.rollout(world, {}, dt=-1, steps=2)
    with pytest.raises(sk.SceneError, match="worlds: found none"):
        sk.rollout([], {}, dt=DT, steps=2)
    with pytest.raises(sk.SceneError):
        sk.rollout([world, pushing_world()], {"finger": poses()[:2]}, dt=DT)


def test_an_interrupt_ends_a_rollout() -> None:
    world = pushing_world(sleep=False)
    threading.Timer(0.2, signal.raise_signal, [signal.SIGINT]).start()
    with pytest.raises(KeyboardInterrupt):
        # This takes an hour.
        sk.rollout(world, {}, dt=1e3, steps=1000, threads=1)
