"""Bodies: arrays, assignment, selection, removal."""

from typing import Any

import numpy as np
import pytest

import skerry as sk
from worlds import RUBBER, ball_world


def test_arrays_have_the_shapes_that_their_descriptions_name() -> None:
    world, ball, _ = ball_world()
    world.advance(0.06)
    n, m = ball.node_count, len(ball.tetrahedra)
    shapes: dict[str, tuple[Any, tuple[int, ...]]] = {
        "positions": (ball.positions, (n, 3)),
        "velocities": (ball.velocities, (n, 3)),
        "tetrahedra": (ball.tetrahedra, (m, 4)),
        "stress": (ball.stress(), (m, 3, 3)),
        "stress at nodes": (ball.stress("nodes"), (n, 3, 3)),
        "strain": (ball.strain(), (m, 3, 3)),
        "strain at nodes": (ball.strain("nodes"), (n, 3, 3)),
        "von_mises": (ball.von_mises(), (m,)),
        "von_mises at nodes": (ball.von_mises("nodes"), (n,)),
        "principal_stresses": (ball.principal_stresses(), (n, 3)),
        "tetrahedron_steps": (ball.tetrahedron_steps, (m,)),
        "center_of_mass": (ball.center_of_mass, (3,)),
    }
    for name, (array, shape) in shapes.items():
        assert array.shape == shape, name
        assert array.dtype == (np.int32 if name == "tetrahedra" else np.float64), name
    assert ball.surface.shape[1] == 3 and ball.surface.dtype == np.int32


def test_stresses_agree_with_each_other() -> None:
    world, ball, _ = ball_world()
    assert ball.tetrahedron_steps.min() == pytest.approx(world.stable_step, rel=1e-9)
    world.advance(0.06)
    stress = ball.stress("nodes")
    assert np.allclose(stress, stress.transpose(0, 2, 1), rtol=1e-12, atol=1e-9 * np.abs(stress).max())
    deviator = stress - np.trace(stress, axis1=1, axis2=2)[:, None, None] * np.eye(3) / 3
    von_mises = np.sqrt(1.5 * (deviator**2).sum(axis=(1, 2)))
    assert np.allclose(ball.von_mises("nodes"), von_mises, rtol=1e-9)
    assert np.allclose(ball.principal_stresses(), np.linalg.eigvalsh(stress)[:, ::-1], atol=1e-9 * von_mises.max())
    assert np.array_equal(ball.stress(nodes=[5, 0]), stress[[5, 0]])
    assert 0.9 * world.stable_step < ball.tetrahedron_steps.min() < (1 + 1e-9) * world.stable_step


def test_masses_and_names_of_a_body() -> None:
    world, ball, _ = ball_world()
    assert ball.mass == pytest.approx(1000 * sk.Mesh.ball(0.05, 4).volume, rel=1e-12)
    assert ball.name == "ball" and ball.world is world and ball.alive
    assert (ball.dynamics, ball.dynamics_choice.reason) == ("explicit", "strain")
    assert ball.element == "edge_node_smoothed"
    assert 0 < ball.contact_distance == pytest.approx(0.02 * ball.mean_edge)
    assert not ball.asleep
    assert repr(ball).startswith("<skerry.Body 'ball' deformable, ")
    assert np.allclose(ball.pose.position, (0, 0, 0.06)) and ball.pose.rotation == (0, 0, 0)


def test_arrays_are_copies() -> None:
    world, ball, _ = ball_world()
    before = ball.positions
    before[:] = 7
    assert not (ball.positions == 7).any()
    with pytest.raises(ValueError, match="read-only"):
        ball.surface[0, 0] = 3
    with pytest.raises(ValueError, match="read-only"):
        ball.tetrahedra[0, 0] = 3


def test_assigned_positions_and_velocities_are_those_of_the_body() -> None:
    world, ball, _ = ball_world()
    x = ball.positions + (0.1, 0, 0)
    v = np.full_like(x, 0.25)
    ball.positions, ball.velocities = x, v
    assert np.array_equal(ball.positions, x) and np.array_equal(ball.velocities, v)
    ball.positions = x.tolist()
    ball.positions = x.astype(np.float32)
    ball.positions = np.asfortranarray(x)
    assert np.array_equal(ball.positions, x)


def test_positions_that_invert_an_element_change_nothing() -> None:
    world, ball, _ = ball_world()
    before, state = ball.positions, world.state_hash
    with pytest.raises(sk.SceneError, match="ball"):
        ball.positions = -before
    assert np.array_equal(ball.positions, before) and world.state_hash == state


def test_arrays_of_another_shape_are_refused_with_both_shapes() -> None:
    world, ball, _ = ball_world()
    n = ball.node_count
    for name in ("positions", "velocities"):
        with pytest.raises(TypeError, match=rf"{name}: found an array of the shape \(2, 3\), expected \({n}, 3\)"):
            setattr(ball, name, np.zeros((2, 3)))
    with pytest.raises(TypeError, match=r"velocity: found an array of the shape \(2,\), expected \(3,\)"):
        ball.set_velocity((1, 2))
    with pytest.raises(TypeError, match=rf"nodes: found an array of the shape \(3,\), expected \({n},\)"):
        ball.attach(np.ones(3, dtype=bool))
    with pytest.raises(TypeError, match="whole numbers"):
        ball.attach([0.5])
    with pytest.raises(ValueError, match="expected 'tetrahedra' or 'nodes'"):
        ball.stress("faces")  # type: ignore[arg-type]


def test_nodes_are_selected_by_place_and_condition() -> None:
    world, ball, _ = ball_world()
    x = ball.positions
    assert len(ball.select()) == ball.node_count and ball.select().dtype == np.int32
    assert set(ball.select(below=0.06)) == set(np.flatnonzero(x[:, 2] <= 0.06))
    assert set(ball.select(above=0.06, surface=True)) == set(np.flatnonzero(x[:, 2] >= 0.06)) & set(ball.surface.flat)
    assert set(ball.select(box=((-1, -1, 0.05), (0, 1, 0.08)))) == set(
        np.flatnonzero((x[:, 0] <= 0) & (x[:, 2] >= 0.05) & (x[:, 2] <= 0.08))
    )
    assert list(ball.select(sphere=(x[3], 1e-9))) == [3]
    assert set(ball.select(where=lambda x: x[:, 1] > 0)) == set(ball.select(where=x[:, 1] > 0))
    assert set(ball.select(where=x[:, 1] > 0)) == set(np.flatnonzero(x[:, 1] > 0))
    with pytest.raises(TypeError, match=r"where: found an array of the shape \(1,\)"):
        ball.select(where=[True])
    with pytest.raises(TypeError, match="where: found values of the type float64, expected truth values"):
        ball.select(where=lambda x: x[:, 1])


def test_loads_accelerate_a_body() -> None:
    world, ball, _ = ball_world(gravity=(0, 0, 0))
    ball.set_loads((ball.mass / ball.node_count, 0, 0))
    world.advance(0.01)
    momentum = world.report().momentum
    assert momentum[0] == pytest.approx(0.01 * ball.mass, rel=0.05)
    ball.set_loads(np.zeros((ball.node_count, 3)))
    world.advance(0.01)
    assert world.report().momentum[0] == pytest.approx(momentum[0], rel=0.05)


def test_a_reset_body_has_its_first_shape_at_the_given_pose() -> None:
    world, ball, _ = ball_world()
    first = ball.positions
    world.advance(0.08)
    ball.reset()
    assert np.allclose(ball.positions, first, atol=1e-12)
    ball.reset(sk.Pose(position=(0, 0, 0.2)))
    assert np.allclose(ball.positions, first + (0, 0, 0.14), atol=1e-12)
    ball.pose = sk.Pose(position=(1, 0, 0.06))
    assert np.allclose(ball.positions, first + (1, 0, 0), atol=1e-12)


def test_a_body_can_become_rigid_and_explicit_again() -> None:
    world, ball, _ = ball_world()
    ball.set_dynamics("rigid")
    assert str(ball.dynamics) == "rigid" and "rigid" in repr(ball)
    world.advance(0.01)
    ball.set_dynamics("explicit")
    assert ball.dynamics == "explicit"
    with pytest.raises(sk.SceneError, match="dynamics: found 'stiff', expected 'explicit', 'implicit' or 'rigid'"):
        ball.set_dynamics("stiff")  # type: ignore[arg-type]


@pytest.mark.parametrize("shape", [sk.Sphere(radius=0.1), sk.Capsule(radius=0.1), sk.Cylinder(radius=0.1, height=0.2)])
def test_round_bodies_are_rigid(shape: Any) -> None:
    world, _, _ = ball_world()
    body = world.add_body(shape, RUBBER, position=(2, 0, 2))
    assert body.dynamics == "rigid"
    world.advance(0.01)
    assert body.center_of_mass[2] < 2


def test_a_shape_without_mass_is_no_body() -> None:
    world, _, _ = ball_world()
    with pytest.raises(TypeError, match="mesh: found Plane.*expected a Mesh, SurfaceMesh, Sphere, Capsule or Cylinder"):
        world.add_body(sk.Plane(), RUBBER)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="material: found 3, expected a Material"):
        world.add_body(sk.Sphere(), 3)  # type: ignore[arg-type]


def test_bodies_are_equal_if_they_are_the_same_body() -> None:
    world, ball, floor = ball_world()
    again = world.bodies["ball"]
    assert again == ball and again is not ball and hash(again) == hash(ball) and {ball: 1}[again] == 1
    assert ball != floor and ball != "ball"


def test_a_removed_body_is_named_in_every_error() -> None:
    world, ball, _ = ball_world()
    twin = world.copy().bodies[ball]
    ball.remove()
    assert not ball.alive and twin.alive and ball.name == "ball"
    assert repr(ball) == "<skerry.Body: body 'ball', removed>"
    calls: list[Any] = [
        lambda: ball.positions,
        lambda: ball.mass,
        lambda: ball.surface,
        lambda: ball.stress(),
        lambda: setattr(ball, "positions", np.zeros((1, 3))),
        lambda: ball.set_loads((0, 0, 0)),
        lambda: ball.attach([0]),
        lambda: ball.remove(),
        lambda: world.set_collision(ball, world.colliders["floor"], False),
        lambda: ball.views().__enter__(),
    ]
    for call in calls:
        with pytest.raises(sk.SceneError, match="^body 'ball' was removed$") as caught:
            call()
        assert caught.value.object == "body 'ball'"


def test_a_body_of_another_world_is_refused() -> None:
    world, ball, _ = ball_world()
    other, _, floor = ball_world()
    with pytest.raises(sk.SceneError, match="belongs to another world"):
        world.set_collision(ball, floor, False)
    with pytest.raises(KeyError, match="no body 'ball'"):
        other.bodies[ball]


def test_a_rigid_body_has_a_surface_and_given_mass_properties() -> None:
    world = sk.World(threads=1, gravity=(0, 0, 0))
    box = sk.Mesh.box((0.1, 0.2, 0.3), (1, 1, 1)).boundary()
    plain = world.add_body(box, sk.Material(density=500), dynamics="rigid")
    assert plain.mass == pytest.approx(500 * 0.006) and len(plain.tetrahedra) == 0
    inertia = np.diag([0.02, 0.03, 0.04])
    given = world.add_body(
        box,
        sk.Material(),
        dynamics="rigid",
        mass=2,
        center_of_mass=(0, 0, 0.5),
        inertia=inertia,
        position=(1, 0, 0),
        angular_velocity=(0, 0, 2),
    )
    assert given.mass == pytest.approx(2) and given.center_of_mass == pytest.approx((1, 0, 0.5))
    assert world.report().angular_momentum[2] == pytest.approx(0.08)
    with pytest.raises(sk.SceneError, match="dynamics.*automatic.*rigid"):
        world.add_body(box, sk.Material())
    with pytest.raises(sk.SceneError, match="inertia.*sum of the other two"):
        world.add_body(
            box, sk.Material(), dynamics="rigid", mass=1, center_of_mass=(0, 0, 0), inertia=np.diag([1, 1, 3])
        )
    with pytest.raises(TypeError, match=r"inertia: found an array of the shape \(3,\), expected \(3, 3\)"):
        world.add_body(box, sk.Material(), dynamics="rigid", mass=1, inertia=[1, 1, 1])
