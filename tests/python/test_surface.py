"""Friction and restitution by pair of materials and by place on a body."""

import math
import pickle

import numpy as np
import pytest

import skerry as sk

SLOPE = math.radians(20)
GRAVITY = (9.81 * math.sin(SLOPE), 0, -9.81 * math.cos(SLOPE))
BLOCK = sk.Mesh.box((0.1, 0.1, 0.05), (2, 2, 1))


def slope_world(**settings: object) -> tuple[sk.World, sk.Body, sk.MaterialHandle, sk.MaterialHandle]:
    """A rigid wooden block on an incline of steel."""
    world = sk.World(threads=1, gravity=GRAVITY, tolerance=1e-9, **settings)  # type: ignore[arg-type]
    wood, steel = world.add_material(friction=0.9), world.add_material(friction=0.9)
    world.add_collider(sk.Plane(), material=steel, name="slope")
    body = world.add_body(BLOCK, wood, position=(0, 0, 0.025), contact_distance=0, dynamics="rigid", name="block")
    return world, body, wood, steel


def test_a_pair_of_materials_decides_whether_a_block_slides() -> None:
    world, body, wood, steel = slope_world()
    assert world.colliders["slope"].material == steel
    world.set_pair(steel, wood, friction=0.2)
    assert world.pair(wood, steel) == sk.Surface(friction=0.2)
    assert [(one, other) for one, other, _ in world.pairs] == [(wood, steel)]
    world.advance(0.2)
    contacts = world.contacts
    assert len(contacts) > 0
    assert np.allclose(contacts["dynamic_friction"], 0.2)
    assert np.allclose(contacts["friction_direction"], 0)
    gain = 9.81 * (math.sin(SLOPE) - 0.2 * math.cos(SLOPE))
    assert body.velocity[0] == pytest.approx(0.2 * gain, rel=0.02)
    world.remove_pair(wood, steel)
    assert world.pairs == [] and world.pair(wood, steel) is None
    world.advance(0.2)
    assert np.allclose(world.contacts["static_friction"], 0.9)


def test_the_material_of_a_collider_can_change() -> None:
    world, _, wood, steel = slope_world()
    world.set_pair(wood, steel, friction=0.1)
    slope = world.colliders["slope"]
    slope.material = None
    assert slope.material is None
    world.advance(0.02)
    assert np.allclose(world.contacts["dynamic_friction"], 0.9)
    slope.material = steel
    world.advance(0.02)
    assert np.allclose(world.contacts["dynamic_friction"], 0.1)


def test_a_set_has_its_own_friction_in_two_directions() -> None:
    world, body, _, steel = slope_world()
    world.colliders["slope"].material = None
    bottom = np.flatnonzero(BLOCK.nodes[:, 2] < 0)
    ski = world.add_surface_set(body, sk.Surface(friction=0.1), nodes=bottom, friction_across=0.4, direction=(1, 1, 0))
    assert world.surface_sets == [ski] and ski.body == body and ski.alive
    assert ski.nodes.tolist() == bottom.tolist() and ski.faces.shape == (0, 3)
    assert ski.surface_values == sk.Surface(friction=0.1)
    assert ski.friction_across == pytest.approx(0.4)
    assert ski.direction == pytest.approx((math.sqrt(0.5), math.sqrt(0.5), 0))
    world.advance(0.1)
    contacts = world.contacts
    assert np.allclose(contacts["dynamic_friction"], 0.4) and np.allclose(contacts["friction_across"], 0.1)
    assert np.allclose(np.abs(contacts["friction_direction"] @ (1, -1, 0)), math.sqrt(2), rtol=1e-6)
    assert body.velocity[1] > 0.1 * body.velocity[0] > 0
    twin = pickle.loads(pickle.dumps(world))
    assert ski.in_copy(twin).friction_across == pytest.approx(0.4)
    twin.advance(0.05)
    world.advance(0.05)
    assert twin.state_hash == world.state_hash
    ski.set_surface(restitution=0.2)
    assert ski.surface_values == sk.Surface(friction=0.1, restitution=0.2)
    assert ski.friction_across == pytest.approx(0.4)
    ski.set_surface(friction_across=0.5)
    assert ski.surface_values.friction == 0.1 and ski.friction_across == pytest.approx(0.5)
    ski.set_surface(friction=0.3, friction_across=None)
    assert ski.surface_values.friction == 0.3 and ski.friction_across is None
    world.advance(0.01)
    assert np.allclose(world.contacts["dynamic_friction"], 0.3)
    ski.remove()
    assert not ski.alive and world.surface_sets == []


def test_the_faces_of_a_set_are_an_array() -> None:
    world, body, _, _ = slope_world()
    part = world.add_surface_set(body, faces=body.surface[2:4], friction=0.1)
    assert part.faces.tolist() == body.surface[2:4].tolist() and part.faces.dtype == np.int32
    assert part.nodes.shape == (0,)


def test_errors_name_the_set_and_the_value() -> None:
    world, body, wood, _ = slope_world()
    with pytest.raises(sk.SceneError, match=r"block.*faces\[0\]"):
        world.add_surface_set(body, faces=[(0, 1, 17)], friction=0.1)
    with pytest.raises(sk.SceneError, match="friction_across"):
        world.add_surface_set(body, nodes=[0], friction=0.1, friction_across=0.2)
    other = sk.World()
    with pytest.raises(sk.SceneError, match="second: .*another world"):
        world.set_pair(wood, other.add_material(), friction=0.1)
