"""Arrays without copies: body.views()."""

import gc
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import skerry as sk
from worlds import RUBBER, ball_world


@pytest.mark.parametrize("dynamics", ["explicit", "implicit", "rigid"])
def test_views_show_the_present_state(dynamics: Any) -> None:
    world = sk.World(threads=1)
    world.add_collider(sk.Plane())
    world.add_body(sk.Mesh.ball(0.05, 4), RUBBER, position=(1, 0, 1), name="first", dynamics=dynamics)
    ball = world.add_body(sk.Mesh.ball(0.05, 4), RUBBER, position=(0, 0, 0.06), name="ball", dynamics=dynamics)
    with ball.views() as (x, v):
        for _ in range(20):
            world.advance(0.01)
            assert np.array_equal(x, ball.positions) and np.array_equal(v, ball.velocities)
        ball.positions = ball.positions + (0, 0, 0.01)
        ball.pose = sk.Pose(position=(0, 0, 1))
        ball.reset()
        world.reset()
        assert np.array_equal(x, ball.positions) and np.array_equal(v, ball.velocities)


def test_changes_of_other_data_leave_the_memory_in_place() -> None:
    world = sk.World(threads=1, sleep_time=0.05)
    floor = world.add_collider(sk.Plane())
    material = world.add_material(RUBBER)
    mesh = sk.Mesh.ball(0.05, 4)
    ball = world.add_body(mesh, material, position=(0, 0, 0.05), name="ball")
    rod = world.add_body(mesh, material, position=(1, 0, 1), dynamics="rigid", name="rod")
    held = ball.attach(ball.select(above=0.09))
    with ball.views() as (x, v), rod.views() as (y, w):
        changes: list[Callable[[], object]] = [
            lambda: material.change(density=2000, young_modulus=1e6),
            lambda: world.add_material(density=3),
            lambda: world.add_joint("hinge", rod, point=(1, 0, 1)),
            lambda: ball.set_surface(friction=0.1),
            lambda: world.set_collision(ball, floor, False),
            lambda: held.move_to(sk.Pose(position=(0, 0, 0.01)), 0.1),
            lambda: ball.set_loads((0, 0, 1e-4)),
            lambda: rod.set_velocity((0, 0, 1)),
            lambda: world.joints[0].remove(),
            lambda: world.report(),
            lambda: world.advance(0.3),
            lambda: (world.copy(), world.to_bytes()),
        ]
        for change in changes:
            change()
            world.advance(0.01)
            with ball.views() as (x_now, v_now), rod.views() as (y_now, w_now):
                for old, new in ((x, x_now), (v, v_now), (y, y_now), (w, w_now)):
                    assert old.ctypes.data == new.ctypes.data
            assert np.array_equal(x, ball.positions) and np.array_equal(w, rod.velocities)


def test_views_are_read_only_and_no_copies() -> None:
    world, ball, _ = ball_world()
    with ball.views() as (x, v):
        assert x.shape == v.shape == (ball.node_count, 3) and x.dtype == np.float64
        assert x.flags.c_contiguous and not x.flags.owndata and not x.flags.writeable
        with ball.views() as (again, _):
            assert again.ctypes.data == x.ctypes.data
        for array in (x, v):
            with pytest.raises(ValueError, match="read-only"):
                array[0, 0] = 1
            with pytest.raises(ValueError, match="WRITEABLE"):
                array.flags.writeable = True


MOVES = {
    "add_body": lambda world, ball, start: world.add_body(sk.Mesh.ball(0.01, 2), RUBBER, position=(1, 1, 1)),
    "add_body of a sphere": lambda world, ball, start: world.add_body(sk.Sphere(), RUBBER, position=(3, 0, 2)),
    "add_collider": lambda world, ball, start: world.add_collider(sk.Sphere(), position=(3, 0, 0)),
    "remove": lambda world, ball, start: world.remove(world.colliders[0]),
    "attach": lambda world, ball, start: ball.attach([0]),
    "set_dynamics": lambda world, ball, start: ball.set_dynamics("rigid"),
    "reset": lambda world, ball, start: world.reset(start),
}


@pytest.mark.parametrize("move", MOVES)
def test_calls_that_could_move_the_memory_are_refused_while_a_part_of_a_view_exists(move: str) -> None:
    world, ball, _ = ball_world()
    start, state = world.copy(), world.state_hash
    refusal = rf"^{move.split()[0]}: .*\((\d) of body 'ball'\)"
    with ball.views() as (x, v):
        part = x[2:5, 1].T
        del x
        for count in ("2", "1"):
            with pytest.raises(BufferError, match=refusal) as caught:
                MOVES[move](world, ball, start)
            assert f"({count} of" in str(caught.value)
            if count == "2":
                del v
    assert world.state_hash == state
    del part
    MOVES[move](world, ball, start)


def test_the_error_names_all_bodies_with_views() -> None:
    world, ball, _ = ball_world()
    other = world.add_body(sk.Sphere(radius=0.1), RUBBER, position=(1, 0, 1), name="other")
    with ball.views() as first, other.views() as second:
        with pytest.raises(BufferError, match=r"2 of body 'ball', 2 of body 'other'"):
            ball.remove()
        del first, second


def test_a_view_keeps_its_world_alive() -> None:
    world, ball, _ = ball_world()
    world.advance(0.03)
    expected = ball.positions
    with ball.views() as (x, v):
        del world, ball, _, v
        gc.collect()
        assert np.array_equal(x, expected)


def test_views_of_a_copy_do_not_lock_the_original() -> None:
    world, ball, _ = ball_world()
    with world.copy().bodies[ball].views() as (x, v):
        ball.attach([0])
        ball.remove()
        assert x.shape == v.shape


def test_a_removal_before_the_view_does_not_disturb_it() -> None:
    world, ball, _ = ball_world()
    last = world.add_body(sk.Sphere(radius=0.1), RUBBER, position=(1, 0, 1), name="last")
    ball.remove()
    with last.views() as (x, v):
        world.advance(0.05)
        assert np.array_equal(x, last.positions) and np.array_equal(v, last.velocities)
