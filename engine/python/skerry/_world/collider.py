"""Colliders."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .._settings import Shape
from .material import MaterialHandle
from .objects import MovedObject, TouchingObject

if TYPE_CHECKING:
    from .world import World


class Collider(TouchingObject, MovedObject):
    """A collider of a world: an object without mass that bodies cannot pass. For a plane, `pose` is the point of the
    plane and a rotation that takes +z to its normal. Every use of a removed collider raises SceneError, except `alive`,
    `name` and comparison."""

    __slots__ = ()

    def __init__(self, world: World, handle: Any, name: str) -> None:
        super().__init__(world, handle, f"collider '{name}'", name)

    @property
    def shape(self) -> Shape:
        """Shape of the collider in its own frame."""
        shape: Shape = self._core.shape(self._handle)
        return shape

    @property
    def material(self) -> MaterialHandle | None:
        """Material of the surface, for its friction, its restitution and World.set_pair(); None: no material."""
        handle = self._core.material_of_collider(self._handle)
        return None if handle is None else MaterialHandle(self._world, handle)

    @material.setter
    def material(self, material: MaterialHandle | None) -> None:
        handle = None if material is None else self._world._own(material, "material", MaterialHandle)
        self._core.set_material_of_collider(self._handle, handle)

    def _description(self) -> str:
        return f" '{self.name}' {type(self.shape).__name__}"
