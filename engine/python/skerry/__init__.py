"""Skerry: deformable bodies in frictional contact."""

from ._errors import BusyError, SceneError
from ._settings import (
    Box,
    Bucket,
    Capsule,
    Cylinder,
    Material,
    Motion,
    MotionKey,
    Motor,
    MotorKey,
    Plane,
    Pose,
    Settings,
    Sphere,
    Surface,
    SurfaceMesh,
)

__all__ = [
    "Box",
    "Bucket",
    "BusyError",
    "Capsule",
    "Cylinder",
    "Material",
    "Motion",
    "MotionKey",
    "Motor",
    "MotorKey",
    "Plane",
    "Pose",
    "SceneError",
    "Settings",
    "Sphere",
    "Surface",
    "SurfaceMesh",
]
