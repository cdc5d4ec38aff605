"""Settings records: defaults, conversion of arguments, copies and errors."""

import dataclasses
import pickle
from typing import Any

import numpy as np
import pytest

import skerry as sk
from skerry import _core, _settings

CLASSES = [
    _settings.Settings,
    _settings.Material,
    _settings.OrthotropicModuli,
    _settings.Surface,
    _settings.Pose,
    _settings.MotionKey,
    _settings.Motion,
    _settings.JointPassive,
    _settings.MotorKey,
    _settings.Motor,
    _settings.Gas,
    _settings.Liquid,
    _settings.ProblemSettings,
    _settings.Plane,
    _settings.Sphere,
    _settings.Box,
    _settings.Capsule,
    _settings.Cylinder,
    _settings.Bucket,
    _settings.SurfaceMesh,
]


def test_the_defaults_are_those_of_the_engine() -> None:
    defaults = _core.defaults()
    assert set(defaults) == {kind.__name__ for kind in CLASSES if kind is not sk.SurfaceMesh}
    for kind in CLASSES:
        if kind is sk.SurfaceMesh:
            continue
        record = kind()
        assert {field.name: getattr(record, field.name) for field in dataclasses.fields(record)} == defaults[
            kind.__name__
        ]


@pytest.mark.parametrize("kind", CLASSES)
def test_a_record_equals_its_copies_and_can_be_pickled(kind: Any) -> None:
    record = kind()
    for copy in (kind(), dataclasses.replace(record), pickle.loads(pickle.dumps(record))):
        assert copy == record
        assert hash(copy) == hash(record)


def test_a_record_cannot_be_changed() -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        sk.Sphere().radius = 2.0  # type: ignore[misc]


def test_a_replaced_setting_leaves_the_others() -> None:
    material = dataclasses.replace(sk.Material(density=500.0), friction=0.1)
    assert material == sk.Material(density=500.0, friction=0.1)


def test_vectors_may_be_lists_and_arrays() -> None:
    assert sk.Plane(normal=[0, 1, 0]) == sk.Plane(normal=np.array([0, 1, 0])) == sk.Plane(normal=(0.0, 1.0, 0.0))


def test_a_vector_of_another_shape_is_refused_with_both_shapes() -> None:
    with pytest.raises(TypeError, match=r"Box\.size: found an array of the shape \(2,\), expected \(3,\)"):
        sk.Box(size=(1, 2))
    with pytest.raises(TypeError, match=r"SurfaceMesh\.nodes: .*\(1, 2\), expected \(n, 3\)"):
        sk.SurfaceMesh(nodes=[[0, 1]], triangles=[[0, 1, 2]])


def test_a_vector_of_words_is_refused() -> None:
    with pytest.raises(TypeError, match="Plane.point: found 'up', expected numbers"):
        sk.Plane(point="up")  # type: ignore[arg-type]


class Turn:
    def as_rotvec(self) -> Any:
        return np.array([0, 0, 1.5])


def test_a_rotation_may_be_an_object_with_as_rotvec() -> None:
    assert sk.Pose(rotation=Turn()).rotation == (0, 0, 1.5)
    assert sk.Motion(keys=[sk.MotionKey(rotation=Turn())]) == sk.Motion(keys=[sk.MotionKey(rotation=(0, 0, 1.5))])


def test_keys_of_another_class_are_refused() -> None:
    with pytest.raises(TypeError, match=r"Motion\.keys\[0\]: found \(0, 1\), expected a MotionKey"):
        sk.Motion(keys=[(0, 1)])  # type: ignore[list-item]


def test_the_arrays_of_a_surface_are_read_only_copies() -> None:
    nodes = np.eye(3)
    surface = sk.SurfaceMesh(nodes=nodes, triangles=np.array([[0, 1, 2]], dtype=np.int32))
    nodes[0] = 7
    assert surface.nodes[0, 0] == 1
    again = pickle.loads(pickle.dumps(surface))
    assert again == surface and hash(again) == hash(surface)
    for copy in (surface, again):
        with pytest.raises(ValueError, match="read-only"):
            copy.nodes[0] = 7


def test_a_value_of_another_type_is_refused_by_the_engine_with_its_field() -> None:
    with pytest.raises(sk.SceneError, match="Settings: integrator: found 'rk4', expected one of 'symplectic_euler'"):
        _core.World(sk.Settings(integrator="rk4"))  # type: ignore[arg-type]
    with pytest.raises(sk.SceneError, match="Settings: threads: found 'two', expected a whole number"):
        _core.World(sk.Settings(threads="two"))  # type: ignore[arg-type]


def test_the_sizes_of_a_shape_may_be_given_by_position() -> None:
    assert sk.Sphere(0.1) == sk.Sphere(radius=0.1)
    assert sk.Plane((0, 1, 0), (0, 2, 0)) == sk.Plane(normal=(0, 1, 0), point=(0, 2, 0))
    assert sk.Box((1, 2, 3)) == sk.Box(size=(1, 2, 3))
    assert sk.Capsule(0.1, 2) == sk.Capsule(radius=0.1, length=2)
    assert sk.Cylinder(0.1, 2) == sk.Cylinder(radius=0.1, height=2)
    assert sk.Bucket(0.1, 2, 0.01) == sk.Bucket(radius=0.1, height=2, thickness=0.01)
    assert sk.SurfaceMesh(np.eye(3), [[0, 1, 2]]) == sk.SurfaceMesh(nodes=np.eye(3), triangles=[[0, 1, 2]])
