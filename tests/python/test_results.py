"""Contacts, forces and queries."""

from pathlib import Path

import numpy as np
import pytest

import skerry as sk
from worlds import RUBBER, ball_world

G = 9.81


def resting_world() -> tuple[sk.World, sk.Body, sk.Collider]:
    """A ball that has come to rest on a plane, with its forces."""
    world, ball, floor = ball_world(sleep=False)
    world.measure_forces()
    world.run(3.0, dt=0.5)
    return world, ball, floor


def test_the_rows_of_contacts_have_the_layout_of_the_engine() -> None:
    world, ball, _ = ball_world()
    assert world.contacts.dtype == sk.contact_dtype and len(world.contacts) == 0
    world.run(0.05)  # in the first impact
    contacts = world.contacts
    assert len(contacts) > 0
    assert set(contacts["first"]) == {0} and set(contacts["second"]) == {-1} and set(contacts["collider"]) == {0}
    assert np.allclose(contacts["normal"], (0, 0, 1))
    np.testing.assert_allclose(contacts["weight"].sum(axis=1), 1)
    nodes, weights = contacts["node"], contacts["weight"]
    assert np.all(nodes[weights == 0] == -1) and nodes.max() < ball.node_count
    touching = contacts["seconds"] > 0
    np.testing.assert_allclose(
        contacts["force"][touching] * contacts["seconds"][touching, None], contacts["impulse"][touching]
    )
    height = ball.positions[nodes[:, 0], 2] * weights[:, 0]
    np.testing.assert_allclose(contacts["point"][:, :2], ball.positions[nodes[:, 0], :2], atol=1e-3)
    assert np.all(height < 2e-3)


def test_contacts_of_two_bodies_name_both() -> None:
    world = sk.World(gravity=(0, 0, 0), threads=1)
    world.add_collider(sk.Plane(point=(0, 0, -5)), name="far")
    lower = world.add_body(sk.Mesh.box((0.1, 0.1, 0.1), 2), RUBBER, name="lower")
    upper = world.add_body(
        sk.Mesh.box((0.1, 0.1, 0.1), 2), RUBBER, position=(0, 0, 0.102), velocity=(0, 0, -1), name="upper"
    )
    world.measure_forces()
    world.advance(0.01)
    contacts = world.contacts
    assert len(contacts) > 0
    for contact in contacts:
        assert {int(contact["first"]), int(contact["second"])} == {0, 1} and contact["collider"] == -1
    for body, sign in ((lower, -1), (upper, 1)):
        assert np.sign(world.forces.on(body).impulse[2]) == sign
    [pair] = world.forces.pairs()
    assert {pair.first, pair.second} == {lower, upper}
    np.testing.assert_array_equal(pair.on_first.impulse, -world.forces.on(pair.second).impulse)


def test_every_contact_is_in_one_region() -> None:
    world, _, _ = ball_world()
    world.add_body(sk.Mesh.ball(0.05, 4), RUBBER, position=(1, 0, 0.06), name="other")
    world.run(0.05)
    contacts, regions = world.contacts, world.regions
    assert len(regions) == 2
    assert sorted(np.concatenate(regions).tolist()) == np.flatnonzero(contacts["region"] >= 0).tolist()
    for number, members in enumerate(regions):
        assert set(contacts["region"][members]) == {number}
        assert len(set(contacts["first"][members])) == 1


def test_contacts_of_sleeping_bodies_are_in_no_region() -> None:
    world = sk.World(threads=1)
    world.add_collider(sk.Plane())
    block = world.add_body(sk.Mesh.box((0.1, 0.1, 0.1), 1), RUBBER, position=(0, 0, 0.05), dynamics="rigid")
    while not block.asleep and world.time < 5:
        world.advance(0.5)
    assert block.asleep and set(world.contacts["region"]) == {-1} and world.regions == []
    world.add_body(sk.Mesh.ball(0.05, 4), RUBBER, position=(1, 0, 0.06), name="other")
    world.run(0.05)
    [members] = world.regions
    assert block.asleep and set(world.contacts["first"][members]) == {1}


def test_the_slip_is_the_velocity_along_the_surface() -> None:
    world = sk.World(threads=1)
    world.add_collider(sk.Plane(), friction=0.1)
    block = world.add_body(
        sk.Mesh.box((0.1, 0.1, 0.05), 1),
        RUBBER,
        position=(0, 0, 0.0251),
        velocity=(2, 0, 0),
        dynamics="rigid",
        name="block",
    )
    world.run(0.1)
    contacts = world.contacts
    assert len(contacts) > 0 and set(contacts["motion"]) == {sk.SLIDE}
    np.testing.assert_allclose(contacts["slip"], np.tile(block.velocities[0], (len(contacts), 1)), atol=1e-3)
    assert np.all(contacts["impulse"][:, 0] < 0) and np.all(contacts["impulse"][:, 2] > 0)


def test_there_are_no_regions_without_contacts() -> None:
    assert ball_world()[0].regions == []


def test_the_floor_carries_the_weight_of_a_resting_ball() -> None:
    world, ball, floor = resting_world()
    weight = ball.mass * G
    report = world.forces.on(ball, by=floor)
    # The ball still vibrates a little; its damping is that of rubber.
    assert report.force == pytest.approx([0, 0, weight], abs=0.05 * weight)
    assert report.pressing == pytest.approx(weight, rel=0.05)
    assert report.largest_force >= report.force[2] and report.contact_count > 0 and report.measured
    np.testing.assert_array_equal(world.forces.on(ball).impulse, report.impulse)
    np.testing.assert_array_equal(world.forces.on(floor, by=ball).impulse, -report.impulse)
    assert repr(report).startswith("<skerry.ForceReport force (")


def test_the_moment_about_another_point_has_the_arm_of_the_force() -> None:
    world, ball, floor = resting_world()
    report = world.forces.on(ball, by=floor)
    expected = report.moment + np.cross([-1, 0, 0], report.force)
    np.testing.assert_allclose(report.moment_about((1, 0, 0)), expected)
    assert expected[1] == pytest.approx(ball.mass * G, rel=0.1)


def test_an_attachment_carries_its_body() -> None:
    world = sk.World(threads=1)
    bar = world.add_body(sk.Mesh.box((0.05, 0.05, 0.1), (1, 1, 2)), RUBBER, name="bar")
    grip = bar.attach(bar.select(above=0.05))
    world.measure_forces()
    world.run(2.0, dt=0.5)
    assert world.forces.by(grip).force[2] == pytest.approx(bar.mass * G, rel=0.02)


def test_forces_that_were_not_measured_are_refused() -> None:
    world, ball, _ = ball_world()
    assert not world.measures_forces
    with pytest.raises(sk.SceneError, match="measure_forces"):
        world.forces.on(ball)
    world.measure_forces((0, 0, 1))
    assert world.measures_forces
    world.advance(0.001)
    report = world.forces.on(ball)
    assert report.moment_point.tolist() == [0, 0, 1] and report.force.tolist() == [0, 0, 0]
    world.measure_forces(on=False)
    assert not world.measures_forces


def test_two_colliders_have_no_forces() -> None:
    world, _, floor = ball_world()
    world.measure_forces()
    with pytest.raises(TypeError):
        world.forces.on(floor, by=floor)


def test_a_ray_finds_the_first_surface() -> None:
    world, ball, floor = ball_world()
    hit = world.cast_ray((0, 0, 1), (0, 0, -2))
    assert hit is not None and hit.body == ball and hit.collider is None
    assert hit.distance == pytest.approx(1 - 0.11, abs=2e-3)
    corners = ball.positions[ball.surface[hit.triangle]]
    np.testing.assert_allclose(np.dot(hit.barycentric, corners), hit.point, atol=1e-12)
    past = world.cast_ray((0, 0, 1), (0, 0, -1), but=[ball])
    assert past is not None and past.collider == floor and past.body is None and past.triangle == -1
    assert past.distance == pytest.approx(1) and past.normal == (0, 0, 1)
    assert world.cast_ray((0, 0, 1), (0, 0, -1), 0.5) is None
    assert world.cast_ray((0, 0, 1), (0, 0, -1), bodies=False, colliders=False) is None
    assert world.cast_ray((0, 0, 1), (0, 0, -1), groups=2) is None


def test_many_rays_give_the_hits_of_one_ray_each() -> None:
    world, _, _ = ball_world()
    origins = np.random.default_rng(1).uniform(-0.1, 0.1, (50, 3)) + [0, 0, 1]
    rows = world.cast_rays(origins, (0, 0, -1))
    assert rows.dtype == sk.hit_dtype and len(rows) == 50
    assert set(rows["body"]) == {-1, 0}
    for origin, row in zip(origins, rows, strict=True):
        hit = world.cast_ray(origin, (0, 0, -1))
        assert hit is not None and hit.point == tuple(row["point"]) and hit.distance == row["distance"]
    assert np.isinf(world.cast_rays(origins, (0, 0, 1))["distance"]).all()
    both = world.cast_rays((0, 0, 1), np.tile([0.0, 0.0, -1.0], (3, 1)))
    assert len(both) == 3 and len(set(both["distance"])) == 1


def test_nearest_points_are_as_far_as_they_say() -> None:
    world, ball, _ = ball_world()
    points = np.random.default_rng(2).uniform(-0.2, 0.2, (50, 3)) + [0, 0, 0.2]
    rows = world.nearest_points(points, colliders=False)
    np.testing.assert_allclose(np.linalg.norm(rows["point"] - points, axis=1), rows["distance"], atol=1e-12)
    hit = world.nearest_point((0, 0, 0.3))
    assert hit is not None and hit.body == ball and hit.distance == pytest.approx(0.19, abs=2e-3)
    assert world.nearest_point((0, 0, 0.3), 0.1) is None


def test_arguments_of_queries_are_checked() -> None:
    world, _, _ = ball_world()
    with pytest.raises(TypeError, match=r"direction: found an array of the shape \(2,\), expected \(3,\)"):
        world.cast_ray((0, 0, 1), (0, 1))
    with pytest.raises(TypeError, match=r"directions: found an array of the shape \(3, 3\), expected \(2, 3\)"):
        world.cast_rays(np.zeros((2, 3)), np.ones((3, 3)))
    with pytest.raises(TypeError, match="directions: found 1 rows, expected 2, one for each origin"):
        world._core.cast_rays(np.zeros((2, 3)), np.ones((1, 3)), 1.0, True, True, 1, [])
    with pytest.raises(sk.SceneError, match="expected a call of measure_forces before that of advance"):
        world.forces.on(world.bodies["ball"])
    assert repr(world.forces) == f"<skerry.Forces of {world!r}>"
    with pytest.raises(TypeError, match=r"points: found an array of the shape \(3,\), expected \(n, 3\)"):
        world.nearest_points((0, 0, 1))
    with pytest.raises(TypeError, match="but: found 7, expected a Body or a Collider"):
        world.cast_ray((0, 0, 1), (0, 0, -1), but=[7])  # type: ignore[list-item]
    with pytest.raises(sk.SceneError, match="direction"):
        world.cast_ray((0, 0, 1), (0, 0, 0))
    with pytest.raises(sk.SceneError, match="max_distance"):
        world.cast_ray((0, 0, 1), (0, 0, 1), -1)


def test_the_problems_of_steps_have_the_contacts_of_the_world() -> None:
    world, _, _ = ball_world()
    world.run(0.05)
    with world.contact_problems() as problems:
        world.advance(2 * world.stable_step)
    assert len(problems) >= 2 and problems[1].step == problems[0].step + 1
    last, contacts = problems[-1], world.contacts
    assert len(last.problem) == len(last.contact) == len(last.region)
    norms = np.linalg.norm(contacts["impulse"][last.contact], axis=1)
    np.testing.assert_allclose(np.linalg.norm(last.impulse, axis=1), norms, rtol=1e-9, atol=1e-12)
    solution = sk.solve(last.problem, tolerance=1e-8)
    np.testing.assert_allclose(solution.reaction.sum(axis=0)[0], last.impulse.sum(axis=0)[0], rtol=1e-2)
    world.advance(world.stable_step)
    assert problems[-1] is last


def test_contacts_survive_the_world(tmp_path: Path) -> None:
    world, _, _ = ball_world()
    world.run(0.05)
    contacts = world.contacts
    before = contacts.copy()
    world.advance(0.05)
    np.testing.assert_array_equal(contacts, before)
    np.save(tmp_path / "contacts.npy", contacts)
    np.testing.assert_array_equal(np.load(tmp_path / "contacts.npy"), before)
