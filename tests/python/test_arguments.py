"""Arguments of wrong types, wrong values, and objects of other worlds."""

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import skerry as sk
from worlds import RUBBER, ball_world

Call = Callable[[Any, Any, Any], object]

BALL = sk.Mesh.ball(0.05, 4)

WRONG_TYPES: dict[str, Call] = {
    "shape: found None, expected a Plane or": lambda world, ball, floor: world.add_collider(None),
    "colliders: found the key slice(0, 2, None), expected a name": lambda world, ball, floor: world.colliders[0:2],
    "attachment: found <skerry.Body 'ball'": lambda world, ball, floor: world.forces.by(ball),
    "on: found 'ball', expected a Body or a Collider": lambda world, ball, floor: world.forces.on("ball"),
    "by: found <skerry.Collider 'floor' Plane>, expected a Body": lambda world, ball, floor: world.forces.on(
        floor, by=floor
    ),
    "probes: found [EnergyProbe()], expected a mapping": lambda world, ball, floor: world.recorder([sk.EnergyProbe()]),
    "name of a probe: found 1, expected a text": lambda world, ball, floor: world.recorder({1: sk.EnergyProbe()}),
    "probe 'b': body: found 'ball', expected a Body": lambda world, ball, floor: world.recorder(
        {"b": sk.BodyProbe("ball")}  # type: ignore[arg-type]
    ),
    "max_distance: found 'a', expected a number": lambda world, ball, floor: world.cast_ray(
        (0, 0, 1),
        (0, 0, -1),
        "a",
    ),
    "bodies: found 'no', expected True or False": lambda world, ball, floor: world.cast_ray(
        (0, 0, 1),
        (0, 0, -1),
        bodies="no",
    ),
    "but: found <skerry.Body 'ball'": lambda world, ball, floor: world.cast_ray((0, 0, 1), (0, 0, -1), but=ball),
    "every: found 1.5, expected a whole number": lambda world, ball, floor: world.contact_problems(every=1.5),
    "on: found 'no', expected True or False": lambda world, ball, floor: world.measure_forces(on="no"),
    "name: found 3, expected a text": lambda world, ball, floor: world.add_collider(sk.Plane(), name=3),
    "world: found None, expected a World": lambda world, ball, floor: ball.in_copy(None),
    "loads: found 'abc', expected numbers of the shape (": lambda world, ball, floor: ball.set_loads("abc"),
    "below: found 'a', expected a number": lambda world, ball, floor: ball.select(below="a"),
    "sphere: found 3, expected a centre and a radius": lambda world, ball, floor: ball.select(sphere=3),
    "self_contact: found 'yes', expected True or False": lambda world, ball, floor: world.add_body(
        BALL,
        RUBBER,
        self_contact="yes",
    ),
    "velocity: found an array of the shape (), expected (3,)": lambda world, ball, floor: ball.set_velocity(3.0),
    "velocity: found ['1', '2', '3'], expected numbers": lambda world, ball, floor: ball.set_velocity(["1", "2", "3"]),
    "velocity: found [1, 2, 3j], expected numbers": lambda world, ball, floor: ball.set_velocity([1, 2, 3j]),
    "velocity: found a masked array": lambda world, ball, floor: ball.set_velocity(
        np.ma.masked_array([1.0, 2.0, 3.0], [0, 0, 1])
    ),
    "nodes: found a masked array": lambda world, ball, floor: ball.attach(np.ma.masked_array([1, 2, 3], [0, 0, 1])),
}

WRONG_VALUES: dict[str, Call] = {
    "groups: found -1, expected a whole number from 0": lambda world, ball, floor: world.cast_ray(
        (0, 0, 1), (0, 0, -1), groups=-1
    ),
    "name: found '\\udc80', expected a text": lambda world, ball, floor: world.add_collider(sk.Plane(), name="\udc80"),
    "name: found '', expected a text": lambda world, ball, floor: world.add_collider(sk.Plane(), name=""),
    "name: found 'a\\nb', expected a text": lambda world, ball, floor: world.add_body(BALL, RUBBER, name="a\nb"),
    "run: dt: found 1e-320, expected a time >=": lambda world, ball, floor: world.run(1, dt=1e-320),
    "run: seconds: found inf, expected a finite time >= 0": lambda world, ball, floor: world.run(float("inf")),
    "advance: dt: found inf, expected a finite time >= 0": lambda world, ball, floor: world.advance(float("inf")),
    "recorder: every: found -1.0, expected a finite time": lambda world, ball, floor: world.recorder({}, every=-1),
    "record: every: found nan, expected a finite time": lambda world, ball, floor: world.record(every=float("nan")),
    "body 'b': dynamics: found 3, expected one of": lambda world, ball, floor: world.add_body(
        BALL,
        RUBBER,
        name="b",
        dynamics=3,
    ),
    "collider 'c': friction: found 'a', expected a number": lambda world, ball, floor: world.add_collider(
        sk.Plane(),
        name="c",
        friction="a",
    ),
    "joint: kind: found 'glue', expected one of": lambda world, ball, floor: world.add_joint("glue", ball),
}


@pytest.mark.parametrize("message", WRONG_TYPES)
def test_an_argument_of_a_wrong_type_is_refused_by_name(message: str) -> None:
    world, ball, floor = ball_world()
    world.measure_forces()
    state = world.state_hash
    with pytest.raises(TypeError, match=re.escape(message)):
        WRONG_TYPES[message](world, ball, floor)
    assert world.state_hash == state and (len(world.bodies), len(world.colliders)) == (1, 1)


@pytest.mark.parametrize("message", WRONG_VALUES)
def test_an_argument_out_of_range_is_refused_by_name(message: str) -> None:
    world, ball, floor = ball_world()
    state = world.state_hash
    with pytest.raises(sk.SceneError, match=re.escape(message)):
        WRONG_VALUES[message](world, ball, floor)
    assert world.state_hash == state and (len(world.bodies), len(world.colliders)) == (1, 1)


def test_truth_values_of_numpy_are_accepted() -> None:
    world, _, _ = ball_world()
    body = world.add_body(BALL, RUBBER, position=(1, 0, 1), self_contact=np.bool_(True))
    assert world.may_collide(body, body)
    world.set_collision(body, body, np.bool_(False))
    assert not world.may_collide(body, body)


def other_objects() -> tuple[sk.World, dict[str, Call]]:
    """A world, and calls that give it objects of its copy."""
    world, ball, floor = ball_world()
    rod = world.add_body(BALL, RUBBER, position=(1, 0, 1), dynamics="rigid", name="rod")
    held = ball.attach([0])
    joint = world.add_joint("ball", rod)
    material = world.add_material(RUBBER)
    world.measure_forces()
    copy = world.copy()
    b, f, r, a, j = ball.in_copy(copy), floor.in_copy(copy), rod.in_copy(copy), held.in_copy(copy), joint.in_copy(copy)
    m = material.in_copy(copy)
    return world, {
        "remove body": lambda *_: world.remove(b),
        "remove collider": lambda *_: world.remove(f),
        "remove attachment": lambda *_: world.remove(a),
        "remove joint": lambda *_: world.remove(j),
        "set_collision first": lambda *_: world.set_collision(b, floor, False),
        "set_collision second": lambda *_: world.set_collision(ball, f, False),
        "may_collide": lambda *_: world.may_collide(b, floor),
        "add_joint first": lambda *_: world.add_joint("hinge", r),
        "add_joint second": lambda *_: world.add_joint("hinge", rod, r),
        "add_body": lambda *_: world.add_body(BALL, m),
        "forces on": lambda *_: world.forces.on(b),
        "forces on by": lambda *_: world.forces.on(ball, by=f),
        "forces by": lambda *_: world.forces.by(a),
        "cast_ray": lambda *_: world.cast_ray((0, 0, 1), (0, 0, -1), but=[b]),
        "nearest_point": lambda *_: world.nearest_point((0, 0, 1), but=[f]),
        "recorder": lambda *_: world.recorder({"b": sk.BodyProbe(b)}),
        "recorder by": lambda *_: world.recorder({"b": sk.ForceProbe(ball, by=f)}),
        "recorder joint": lambda *_: world.recorder({"j": sk.JointProbe(j)}),
    }


@pytest.mark.parametrize("call", other_objects()[1])
def test_an_object_of_a_copy_is_refused(call: str) -> None:
    world, calls = other_objects()
    state = world.state_hash
    with pytest.raises(sk.SceneError, match="which belongs to another world, expected an object of this world"):
        calls[call](world, None, None)
    assert world.state_hash == state and len(world.joints) == 1
