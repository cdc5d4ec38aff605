"""Control of a running world: colliders, attachments, collisions, materials."""

import dataclasses

import numpy as np
import pytest

import skerry as sk
from worlds import RUBBER, ball_world


class Turn:
    """A rotation by a right angle about z, as SciPy represents it."""

    def as_rotvec(self) -> list[float]:
        return [0, 0, np.pi / 2]


def test_a_collider_moves_to_a_pose_in_the_given_time() -> None:
    world = sk.World(threads=1)
    box = world.add_collider(sk.Box(size=(0.1, 0.1, 0.1)), rotation=Turn(), name="box")
    assert box.pose == sk.Pose(rotation=(0, 0, np.pi / 2)) and box.shape == sk.Box(size=(0.1, 0.1, 0.1))
    box.move_to(sk.Pose(position=(1, 0, 0), rotation=(0, 0, 1)), 0.5)
    world.advance(0.25)
    assert box.pose.position == pytest.approx((0.5, 0, 0))
    world.advance(0.75)
    assert box.pose.position == pytest.approx((1, 0, 0)) and box.pose.rotation == pytest.approx((0, 0, 1))
    box.set_velocity((0, 2, 0), (0, 0, 1))
    world.advance(0.5)
    assert box.pose.position == pytest.approx((1, 1, 0)) and box.pose.rotation == pytest.approx((0, 0, 1.5))
    box.pose = sk.Pose(position=(3, 0, 0))
    assert box.pose.position == (3, 0, 0)


def test_a_collider_follows_its_keys() -> None:
    world = sk.World(threads=1)
    motion = sk.Motion(keys=[sk.MotionKey(time=0), sk.MotionKey(time=1, position=(0, 0, 2))])
    box = world.add_collider(sk.Box(), motion=motion)
    world.advance(0.5)
    assert box.pose.position == pytest.approx((0, 0, 1))


def test_a_pose_of_another_class_is_refused() -> None:
    world, ball, floor = ball_world()
    with pytest.raises(TypeError, match=r"pose: found \(1, 0, 0\), expected a Pose"):
        floor.move_to((1, 0, 0), 1)  # type: ignore[arg-type]
    with pytest.raises(sk.SceneError, match="duration|seconds"):
        floor.move_to(sk.Pose(), 0)


def test_attached_nodes_stay_and_follow_their_frame() -> None:
    world, ball, _ = ball_world(gravity=(0, 0, 0))
    top = ball.select(above=0.09)
    rest = ball.positions[top]
    held = ball.attach(top)
    assert held.body == ball and held.pose == sk.Pose()
    assert repr(held) == f"<skerry.Attachment of body 'ball', {len(top)} nodes>"
    held.move_to(sk.Pose(position=(0, 0, 0.01)), 0.01)
    world.advance(0.02)
    assert np.allclose(ball.positions[top], rest + (0, 0, 0.01), atol=1e-12)
    held.set_velocity((0.1, 0, 0))
    world.advance(0.01)
    assert np.allclose(ball.positions[top], rest + (0.001, 0, 0.01), atol=1e-12)
    held.remove()
    assert not held.alive and repr(held) == "<skerry.Attachment: attachment of body 'ball', removed>"
    with pytest.raises(sk.SceneError, match="^attachment of body 'ball' was removed$"):
        held.set_velocity((0, 0, 0))


def test_attached_nodes_turn_about_the_pivot() -> None:
    world, ball, _ = ball_world(gravity=(0, 0, 0))
    x = ball.positions
    ball.attach(
        np.ones(len(x), dtype=bool), motion=sk.Motion(angular_velocity=(0, 0, np.pi)), pivot=np.array([0.1, 0, 0])
    )
    world.advance(0.5)
    turned = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    assert np.allclose(ball.positions, (x - (0.1, 0, 0)) @ turned.T + (0.1, 0, 0), atol=1e-9)


def test_attaching_a_node_that_does_not_exist_is_refused() -> None:
    world, ball, _ = ball_world()
    with pytest.raises(sk.SceneError, match=r"attach: nodes: found node 10000, expected"):
        ball.attach([10_000])
    with pytest.raises(sk.SceneError, match="attach: nodes: found no nodes, expected at least one"):
        ball.attach([])


def test_a_body_falls_through_a_floor_that_it_may_not_touch() -> None:
    for way in ("pair", "groups"):
        world, ball, floor = ball_world()
        assert world.may_collide(ball, floor) and world.may_collide(floor, ball)
        if way == "pair":
            world.set_collision(floor, ball, False)
        else:
            ball.set_collision_groups(group=2)
            floor.set_collision_groups(mask=1)
        assert not world.may_collide(ball, floor)
        world.advance(0.2)
        assert ball.center_of_mass[2] < 0
    with pytest.raises(TypeError, match="one of two objects: found <skerry.Collider .floor. Plane>, expected a Body"):
        world.may_collide(floor, floor)


def test_two_bodies_pass_each_other_if_their_pair_is_off() -> None:
    world, ball, _ = ball_world()
    other = world.add_body(sk.Sphere(radius=0.05), RUBBER, position=(1, 0, 0.1))
    assert world.may_collide(ball, other)
    world.set_collision(ball, other, False)
    assert not world.may_collide(other, ball)


def test_a_body_slides_when_its_friction_is_taken_away() -> None:
    world = sk.World(threads=1, gravity=(3, 0, -9.81))
    world.add_collider(sk.Plane(), name="floor")
    box = world.add_body(sk.Mesh.box((0.1, 0.1, 0.1), (2, 2, 2)), RUBBER, position=(0, 0, 0.0501), dynamics="rigid")
    world.advance(0.5)
    assert np.abs(box.velocities[:, 0]).max() < 0.01
    before = box.velocity[0]
    box.set_surface(friction=0.0)
    world.advance(0.5)
    assert box.velocity[0] == pytest.approx(before + 1.5, rel=1e-6)
    box.set_surface(sk.Surface(friction=0.0), restitution=0.5)
    with pytest.raises(sk.SceneError, match="friction"):
        box.set_surface(friction=-1.0)


def test_gravity_can_be_set() -> None:
    world, ball, _ = ball_world()
    world.set_gravity([1, 0, 0])
    assert world.settings.gravity == (1, 0, 0)
    world.advance(0.01)
    assert ball.velocity[0] == pytest.approx(0.01, rel=1e-9)


def test_a_material_is_read_and_changed_for_all_its_bodies() -> None:
    world = sk.World(threads=1)
    rubber = world.add_material(RUBBER, density=500)
    bodies = [world.add_body(sk.Mesh.ball(0.05, 4), rubber, position=(x, 0, 0)) for x in (0, 1)]
    assert rubber.settings == dataclasses.replace(RUBBER, density=500)
    masses = [body.mass for body in bodies]
    rubber.change(density=1000)
    assert [body.mass for body in bodies] == pytest.approx([2 * mass for mass in masses])
    rubber.change(sk.Material(young_modulus=1e6))
    assert rubber.settings == sk.Material(young_modulus=1e6)
    with pytest.raises(sk.SceneError, match="density"):
        rubber.change(density=-1)
    assert rubber.settings == sk.Material(young_modulus=1e6)
    assert "young_modulus=1000000.0" in repr(rubber)


def test_the_record_of_a_changed_material_stands_for_a_new_one() -> None:
    world = sk.World(threads=1)
    first = world.add_body(sk.Mesh.ball(0.05, 4), RUBBER)
    handle = sk.MaterialHandle(world, world._materials[RUBBER])
    handle.change(density=2000)
    second = world.add_body(sk.Mesh.ball(0.05, 4), RUBBER, position=(1, 0, 0))
    assert first.mass == pytest.approx(2 * second.mass)


def test_labels_of_a_mesh_choose_materials() -> None:
    world = sk.World(threads=1)
    box = sk.Mesh.box((0.1, 0.1, 0.1), (2, 2, 2))
    mesh = sk.Mesh(box.nodes, box.tetrahedra, labels=np.arange(len(box.tetrahedra)) % 2)
    heavy = dataclasses.replace(RUBBER, density=3000)
    body = world.add_body(mesh, RUBBER, materials={1: heavy})
    assert body.mass == pytest.approx(2000 * 0.1**3)
    with pytest.raises(sk.SceneError, match="7"):
        world.add_body(mesh, RUBBER, materials={7: heavy}, position=(1, 0, 0))


def test_a_sleeping_body_wakes_when_told() -> None:
    world = sk.World(threads=1, sleep_time=0.1)
    world.add_collider(sk.Plane())
    box = world.add_body(sk.Mesh.box((0.1, 0.1, 0.1), (1, 1, 1)), RUBBER, position=(0, 0, 0.0501), dynamics="rigid")
    world.advance(1.0)
    assert box.asleep and world.report().asleep == 1
    assert "asleep" in world._repr_html_()
    box.wake()
    assert not box.asleep


def test_surface_values_that_are_not_given_stay() -> None:
    world, ball, floor = ball_world()
    assert ball.surface_values == floor.surface_values == sk.Surface()
    ball.set_surface(friction=0)
    ball.set_surface(restitution=0.5)
    assert ball.surface_values == sk.Surface(friction=0, restitution=0.5)
    ball.set_surface(static_friction=0.75)
    assert ball.surface_values == sk.Surface(static_friction=0.75, dynamic_friction=0, restitution=0.5)
    ball.set_surface(friction=0.25)
    assert ball.surface_values == sk.Surface(friction=0.25, restitution=0.5)
    ball.set_surface(friction=None)
    assert ball.surface_values == sk.Surface(restitution=0.5)
    ball.set_surface(sk.Surface(friction=1))
    assert ball.surface_values == sk.Surface(friction=1)
    floor.set_surface(dynamic_friction=0.25)
    floor.set_surface(static_friction=0.5)
    assert floor.surface_values == sk.Surface(static_friction=0.5, dynamic_friction=0.25)


def test_all_objects_and_values_of_a_loaded_world_can_be_read() -> None:
    world, ball, floor = ball_world(gravity=(0, 0, 0))
    steel = world.add_material(density=7800.0, young_modulus=2e11)
    box = world.add_body(
        sk.Mesh.box((0.1, 0.1, 0.1), 1), steel, position=(1, 0, 1), velocity=(1, 0, 0), angular_velocity=(0, 2, 0)
    )
    held = ball.attach([4, 2, 7])
    box.set_loads((0, 0, 3))
    floor.set_surface(friction=0.25)
    floor.set_collision_groups(group=2, mask=7)
    floor.set_velocity((1, 0, 0), (0, 0, 3))
    np.testing.assert_allclose(box.velocity, (1, 0, 0), atol=1e-12)
    np.testing.assert_allclose(box.angular_velocity, (0, 2, 0), atol=1e-9)
    world.advance(1e-4)
    loaded = sk.World.from_bytes(world.to_bytes())
    (attachment,) = loaded.attachments
    ball, box, floor = loaded.bodies["ball"], loaded.bodies[1], loaded.colliders["floor"]
    assert attachment == held.in_copy(loaded) and attachment.body == ball
    assert attachment.nodes.tolist() == [4, 2, 7] and repr(attachment) == repr(held)
    assert ball.attachments == [attachment] and box.attachments == []
    assert loaded.materials == [ball.material, box.material]
    assert box.material == steel.in_copy(loaded) and box.material.settings.density == 7800
    np.testing.assert_array_equal(box.loads, np.tile((0, 0, 3), (box.node_count, 1)))
    assert floor.surface_values.friction == 0.25
    assert floor.collision_groups == (2, 7) and ball.collision_groups == (1, 0xFFFFFFFF)
    np.testing.assert_array_equal((floor.velocity, floor.angular_velocity), ((1, 0, 0), (0, 0, 3)))
    np.testing.assert_array_equal(attachment.velocity, (0, 0, 0))
    attachment.remove()
    assert loaded.attachments == []


@pytest.mark.parametrize("triangle", [(0, 1, 2), (0, 2, 1)])
def test_a_collider_of_one_triangle_stops_bodies_from_both_sides(triangle: tuple[int, int, int]) -> None:
    world = sk.World(threads=1)
    world.add_collider(sk.SurfaceMesh(nodes=[(-2, -2, 0), (2, -2, 0), (0, 2, 0)], triangles=[triangle]))
    ball = world.add_body(sk.Mesh.ball(0.05, 4), RUBBER, position=(0, 0, 0.06))
    world.run(0.3)
    assert ball.center_of_mass[2] > 0.045 and world.contacts["normal"][:, 2].min() > 0.9
