"""Joints of rigid bodies, with motors and limits."""

import pickle

import numpy as np
import pytest

import skerry as sk
from worlds import RUBBER


def rod_world(**settings: object) -> tuple[sk.World, sk.Body]:
    """A rigid rod along x, from the origin to x = 0.2 m."""
    world = sk.World(threads=1, **settings)  # type: ignore[arg-type]
    mesh = sk.Mesh.box((0.2, 0.02, 0.02), (4, 1, 1))
    return world, world.add_body(mesh, RUBBER, position=(0.1, 0, 0), dynamics="rigid", name="rod")


def test_a_rod_on_a_hinge_swings_about_it() -> None:
    world, rod = rod_world()
    hinge = world.add_joint("hinge", rod, point=(0, 0, 0), axis=(0, 1, 0))
    assert world.joints == [hinge]
    assert repr(hinge) == "<skerry.Joint: hinge joint of body 'rod' and the world>"
    world.advance(0.1)
    state = hinge.state
    assert state.first == rod and state.second is None and state.kind == "hinge"
    assert np.linalg.norm(rod.center_of_mass) == pytest.approx(0.1, abs=1e-3)
    assert state.coordinate == hinge.coordinate > 0 and state.speed == hinge.speed > 0
    assert state.error < 1e-4
    assert np.allclose(state.axis, (0, 1, 0))


def test_a_joint_in_equilibrium_carries_the_weight() -> None:
    world, rod = rod_world(tolerance=1e-9)
    joint = world.add_joint("fixed", rod, point=(0, 0, 0))
    world.advance(0.1)
    weight = 9.81 * rod.mass
    assert joint.state.force == pytest.approx((0, 0, weight), abs=1e-7 * weight)
    assert joint.state.moment == pytest.approx((0, -0.1 * weight, 0), abs=1e-7 * weight)


def test_a_motor_reaches_its_speed_and_can_be_removed() -> None:
    world, rod = rod_world(gravity=(0, 0, 0))
    hinge = world.add_joint("hinge", rod, axis=(0, 0, 1), motor=sk.Motor(speed=3.0, strength=10.0))
    world.advance(0.2)
    assert hinge.speed == pytest.approx(3.0, rel=1e-3)
    hinge.set_motor(sk.Motor(speed=-1.0, strength=10.0))
    world.advance(0.2)
    assert hinge.speed == pytest.approx(-1.0, rel=1e-3)
    hinge.set_motor(None)
    world.advance(0.1)
    assert hinge.speed == pytest.approx(-1.0, rel=1e-3) and hinge.state.motor == 0


def test_a_motor_follows_its_keys() -> None:
    world, rod = rod_world(gravity=(0, 0, 0))
    keys = [sk.MotorKey(time=0, position=0), sk.MotorKey(time=1, position=1)]
    slider = world.add_joint("slider", rod, axis=(1, 0, 0), motor=sk.Motor(keys=keys, strength=100))
    world.advance(0.5)
    assert slider.coordinate == pytest.approx(0.5, abs=0.02)


def test_limits_stop_a_joint() -> None:
    world, rod = rod_world()
    hinge = world.add_joint("hinge", rod, axis=(0, 1, 0), lower=-0.1, upper=0.3)
    world.advance(1.0)
    assert hinge.coordinate == pytest.approx(0.3, abs=0.02)
    hinge.set_limits(upper=0.6)
    world.advance(1.0)
    assert hinge.coordinate == pytest.approx(0.6, abs=0.02)
    hinge.set_limits()
    world.advance(1.0)
    assert hinge.coordinate > 0.65
    with pytest.raises(sk.SceneError, match="lower|upper|limits"):
        hinge.set_limits(lower=2, upper=1)


def test_a_joint_goes_with_its_body() -> None:
    world, rod = rod_world()
    other = world.add_body(sk.Sphere(radius=0.01), RUBBER, position=(0.25, 0, 0), name="bob")
    joint = world.add_joint("ball", rod, other, point=(0.22, 0, 0))
    assert repr(joint) == "<skerry.Joint: ball joint of body 'rod' and body 'bob'>"
    assert joint.state.second == other
    other.remove()
    assert not joint.alive and world.joints == []
    with pytest.raises(sk.SceneError, match="^ball joint of body 'rod' and body 'bob' was removed$"):
        joint.set_motor(None)


def test_a_joint_can_be_removed_and_pickled() -> None:
    world, rod = rod_world()
    joint = world.add_joint("ball", rod)
    again = pickle.loads(pickle.dumps(joint))
    assert again.alive and again.world.state_hash == world.state_hash and again != joint
    joint.remove()
    assert not joint.alive and again.alive
    world.advance(0.05)
    again.world.advance(0.05)
    assert rod.center_of_mass[2] < again.world.bodies[rod].center_of_mass[2]


def test_joints_of_deformable_bodies_are_refused() -> None:
    world, _ = rod_world()
    soft = world.add_body(sk.Mesh.ball(0.05, 4), RUBBER, position=(1, 0, 0), name="soft")
    with pytest.raises(sk.SceneError, match="soft"):
        world.add_joint("ball", soft)
    with pytest.raises(sk.SceneError, match="kind: found 'weld', expected one of 'ball', 'hinge'"):
        world.add_joint("weld", soft)  # type: ignore[arg-type]


def test_passive_forces_hold_and_slow_a_joint() -> None:
    world, rod = rod_world(gravity=(0, 0, 0))
    passive = sk.JointPassive(stiffness=2.0, rest=0.3, damping=0.1)
    hinge = world.add_joint("hinge", rod, axis=(0, 0, 1), lower=-1.0, passive=passive)
    assert hinge.passive == passive and hinge.limits == (-1.0, None) and hinge.motor is None
    world.advance(3.0)
    assert hinge.coordinate == pytest.approx(0.3, rel=1e-3)
    hinge.set_passive(sk.JointPassive(friction=0.5))
    hinge.set_motor(sk.Motor(keys=[sk.MotorKey(time=0, speed=1.0)], strength=0.25))
    assert hinge.motor == sk.Motor(keys=[sk.MotorKey(time=0, speed=1.0)], strength=0.25)
    world.advance(0.5)
    assert hinge.speed == pytest.approx(0, abs=1e-9)
    assert hinge.state.motor + hinge.state.passive == pytest.approx(0, abs=1e-9)
    with pytest.raises(sk.SceneError, match=r"passive.friction.*-1"):
        hinge.set_passive(sk.JointPassive(friction=-1.0))


def test_a_joint_mimics_another_one() -> None:
    world, rod = rod_world(gravity=(0, 0, 0), tolerance=1e-10)
    drum = world.add_body(sk.Mesh.box((0.1, 0.1, 0.1), (1, 1, 1)), RUBBER, position=(0, 1, 0), dynamics="rigid")
    hinge = world.add_joint("hinge", rod, point=(0, 0, 0), axis=(0, 1, 0), coordinate=0.3)
    leader = world.add_joint("hinge", drum, point=(0, 1, 0), motor=sk.Motor(speed=2.0, strength=10))
    assert hinge.coordinate == pytest.approx(0.3) and hinge.mimic is None
    hinge.set_mimic(leader, ratio=-0.5, offset=0.3)
    assert hinge.mimic == (leader, -0.5, 0.3)
    world.advance(0.1)
    assert leader.coordinate == pytest.approx(0.2)
    assert hinge.coordinate == pytest.approx(0.2, abs=1e-6)
    with pytest.raises(sk.SceneError, match=r"mimic.ratio: found 0"):
        hinge.set_mimic(leader, ratio=0)
    hinge.set_mimic(None)
    assert hinge.mimic is None and hinge.state.mimic == 0


def test_the_error_of_a_joint_without_load_is_relative_to_the_weight() -> None:
    world = sk.World(threads=1)
    first, second = (
        world.add_body(sk.Sphere(0.05), sk.Material(), position=(0, 0, z), dynamics="rigid") for z in (1.0, 1.3)
    )
    world.add_joint("ball", first, second, point=(0, 0, 1.3))
    world.advance(0.3)
    assert world.report().worst_error < 1e-6
    assert world.report().unconverged == 0


def test_settings_of_a_joint_add_an_equal_one() -> None:
    world, rod = rod_world(gravity=(0, 0, 0))
    drum = world.add_body(sk.Sphere(radius=0.05), RUBBER, position=(-0.06, 0, 0), name="drum")
    motor, passive = sk.Motor(speed=2.0, strength=1.0), sk.JointPassive(damping=0.01)
    arguments = {"lower": -1.0, "upper": 9.0, "motor": motor, "passive": passive, "bodies_touch": True}
    hinge = world.add_joint("hinge", rod, drum, axis=(0, 0, 1), coordinate=4.0, **arguments)
    world.advance(0.1)
    found, state = hinge.settings, hinge.state
    assert {name: found[name] for name in arguments} == arguments
    hinge.remove()
    again = world.add_joint(**found)
    for name in ("kind", "first", "second", "point", "axis", "coordinate", "speed"):
        assert getattr(again.state, name) == pytest.approx(getattr(state, name), abs=1e-12), name
    again.remove()
    fixed = world.add_joint("fixed", rod, drum)
    assert not fixed.settings["bodies_touch"]
    world.add_joint(**fixed.settings)


def test_reset_restores_the_revolutions_of_a_hinge() -> None:
    world, rod = rod_world(gravity=(0, 0, 0))
    motor = sk.Motor(speed=20.0, strength=1.0)
    hinge = world.add_joint("hinge", rod, axis=(0, 0, 1), coordinate=4.0, motor=motor)
    world.advance(0.5)
    assert hinge.coordinate > 11
    world.reset()
    assert hinge.coordinate == pytest.approx(4.0)
