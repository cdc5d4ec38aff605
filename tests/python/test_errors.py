"""Errors: their classes, parts, notes and copies."""

import pathlib
import pickle
import re
import traceback
from collections.abc import Callable

import numpy as np
import pytest

import skerry as sk
from worlds import RUBBER, ball_world


def test_a_scene_error_has_the_parts_of_its_message() -> None:
    world = sk.World(threads=1)
    with pytest.raises(sk.SceneError) as caught:
        world.add_material(density=-1.0)
    error = caught.value
    assert isinstance(error, ValueError)
    assert error.field == "density" and error.found.startswith("-1") and error.expected
    assert error.object in str(error) and error.field in str(error)
    assert f"found {error.found}, expected {error.expected}" in str(error)


def test_a_hint_is_a_note() -> None:
    world, ball, _ = ball_world()
    other, _, floor = ball_world()
    with pytest.raises(sk.SceneError) as caught:
        world.set_collision(ball, floor, False)
    error = caught.value
    assert error.hint and error.hint not in str(error)
    assert error.__notes__ == [error.hint]
    assert error.hint in "".join(traceback.format_exception(error))


def test_a_value_of_the_wrong_type_names_object_and_field() -> None:
    world = sk.World(threads=1)
    with pytest.raises(sk.SceneError, match="body 'body 0': dynamics: found 'soft', expected one of"):
        world.add_body(sk.Mesh.ball(0.05, 4), RUBBER, dynamics="soft")  # type: ignore[arg-type]
    assert len(world.bodies) == 0


WRONG: dict[str, Callable[[sk.World, sk.Body, sk.Collider], object]] = {
    "dt: found '1', expected a number": lambda world, ball, floor: world.advance("1"),  # type: ignore[arg-type]
    "settings: found 3, expected a Settings": lambda world, ball, floor: sk.World(3),  # type: ignore[arg-type]
    "saved: found 3, expected a World": lambda world, ball, floor: world.reset(3),  # type: ignore[arg-type]
    "observe: found 3, expected a function": lambda world, ball, floor: world.watch_steps(3),  # type: ignore[arg-type]
    "first: found <skerry.Collider 'floor' Plane>, expected a Body": lambda world, ball, floor: world.add_joint(
        "ball",
        floor,  # type: ignore[arg-type]
    ),
    "removed: found 'ball', expected a Body or a Collider or an Attachment": lambda world, ball, floor: world.remove(
        "ball"  # type: ignore[arg-type]
    ),
    "motion: found 1, expected a Motion": lambda world, ball, floor: ball.attach(
        [0],
        motion=1,  # type: ignore[arg-type]
    ),
    "pose: found 1, expected a Pose": lambda world, ball, floor: ball.reset(1),  # type: ignore[arg-type]
    "dynamics: found 1, expected a str": lambda world, ball, floor: ball.set_dynamics(1),  # type: ignore[arg-type]
    "mask: found 1.5, expected a whole number from 0": lambda world, ball, floor: ball.set_collision_groups(
        mask=1.5  # type: ignore[arg-type]
    ),
    "on: found 'off', expected True or False": lambda world, ball, floor: world.set_collision(
        ball,
        floor,
        "off",  # type: ignore[arg-type]
    ),
    "label: found numbers of the type float64": lambda world, ball, floor: world.add_body(
        sk.Mesh.ball(0.05, 4),
        RUBBER,
        materials={1.5: RUBBER},  # type: ignore[dict-item]
    ),
}


@pytest.mark.parametrize("message", WRONG)
def test_an_argument_of_another_class_is_refused_by_name(message: str) -> None:
    world, ball, floor = ball_world()
    state = world.state_hash
    with pytest.raises(TypeError, match=re.escape(message)):
        WRONG[message](world, ball, floor)
    assert world.state_hash == state and len(world.bodies) == 1


def test_a_scene_error_can_be_pickled() -> None:
    error = sk.SceneError("a: b: found c, expected d", file="a", object="b", found="c", expected="d", hint="e")
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error) and vars(again) == vars(error)


def failing_world() -> tuple[sk.World, sk.Body]:
    """A world whose next step has velocities that are not finite numbers within one element."""
    world, ball, _ = ball_world()
    velocities = ball.velocities
    velocities[0] = (1e100, 0, 0)
    ball.velocities = velocities
    return world, ball


def test_a_step_error_names_the_body_and_leaves_the_world_whole() -> None:
    world, ball = failing_world()
    state = world.state_hash
    with pytest.raises(sk.StepError, match="ball") as caught:
        world.advance(0.01)
    error = caught.value
    assert isinstance(error, RuntimeError)
    assert error.report.status != "ok" and not error.report.ok and error.report.steps == 0
    assert error.body == ball and str(error) == error.report.message
    assert (error.node, error.element) == (error.report.node, error.report.element)
    assert world.state_hash == state and world.time == 0
    ball.velocities = np.zeros((ball.node_count, 3))
    assert world.advance(0.01).ok


def test_a_failed_step_is_reported_by_try_advance() -> None:
    world, ball = failing_world()
    report = world.try_advance(0.01)
    assert not report.ok and report.body == ball and report.body_name == "ball" and "ball" in report.message


def test_a_time_that_is_not_finite_is_refused() -> None:
    world, _, _ = ball_world()
    for dt in (-1.0, float("nan"), float("inf")):
        with pytest.raises(sk.SceneError, match="advance: dt"):
            world.advance(dt)
    with pytest.raises(TypeError):
        world.advance("0.1")  # type: ignore[arg-type]


def test_overlaps_can_be_refused_at_the_start() -> None:
    world, ball, _ = ball_world(start_overlaps="refuse")
    ball.positions = ball.positions - (0, 0, 0.02)
    with pytest.raises(sk.SceneError, match="ball.*floor"):
        world.advance(0.01)
    with pytest.raises(sk.SceneError, match="ball.*floor"):
        world.settle_start()


def test_bytes_that_hold_no_world_are_refused() -> None:
    world, _, _ = ball_world()
    data = world.to_bytes()
    for wrong in (b"", data[:-1], b"x" * len(data)):
        with pytest.raises(sk.SceneError):
            sk.World.from_bytes(wrong)
    assert sk.World.from_bytes(data).state_hash == world.state_hash


def test_surfaces_that_pass_through_each_other_raise_a_doubt() -> None:
    # One sweep of the solver cannot stop a falling stack of bodies, each almost twice as heavy as the one below.
    world = sk.World(threads=1, max_iterations=1, tolerance=1e-10)
    world.add_collider(sk.Plane())
    mesh = sk.Mesh.box((0.1, 0.1, 0.1), 1)
    for i in range(8):
        material = sk.Material(density=1000 * 10 ** (i / 4), friction=0.9)
        place = (0.01 * i, 0, 0.0501 + 0.1 * i)
        world.add_body(mesh, material, position=place, dynamics="rigid", velocity=(0, 0, -1))
    with pytest.warns(sk.Doubt, match="surfaces passed through each other") as caught:
        report = world.advance(0.3)
    assert len(caught) == 1 and caught[0].filename == __file__
    assert report.crossed > 0 and str(caught[0].message) == world.report().distrust


def test_a_run_in_which_a_surface_crosses_itself_raises_a_doubt() -> None:
    ball = sk.Mesh.ball(0.05, 4)
    n = len(ball.nodes)
    two = sk.Mesh(
        np.concatenate([ball.nodes, ball.nodes + (0.12, 0, 0)]), np.concatenate([ball.tetrahedra, ball.tetrahedra + n])
    )
    world = sk.World(threads=1, gravity=(0, 0, 0))
    pair = world.add_body(two, RUBBER, dynamics="explicit", name="pair")
    velocities = pair.velocities
    velocities[:n, 0] = 1
    pair.velocities = velocities
    with pytest.warns(sk.Doubt, match="the surface of body 'pair' crosses itself"):
        world.run(0.05)
    (crossing,) = world.report().self_crossings
    assert crossing.body == pair and crossing.last_places > 0


def test_a_pickled_step_error_leaves_its_world_behind() -> None:
    world, _ = failing_world()
    with pytest.raises(sk.StepError) as caught:
        world.advance(0.01)
    data = pickle.dumps(caught.value)
    again = pickle.loads(data)
    assert len(data) < 2000 and len(data) < len(world.to_bytes()) / 10
    assert again.body is None and again.report.body_name == "ball"
    assert (str(again), again.node, again.element) == (str(caught.value), caught.value.node, caught.value.element)
    assert caught.value.body is not None


def test_a_world_that_could_not_be_loaded_is_not_saved(tmp_path: pathlib.Path) -> None:
    world, ball, _ = ball_world()
    ball.set_velocity((1e200, 0, 0))
    world.try_advance(0.01)
    with pytest.raises(sk.SceneError, match="save: .*: found inf at row"):
        world.save(tmp_path / "world")
    assert not list(tmp_path.iterdir())
