"""Skerry: deformable bodies in frictional contact."""

from ._errors import BusyError, SceneError

__all__ = ["BusyError", "SceneError"]
