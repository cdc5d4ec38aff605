"""Materials of a world."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any, Unpack

from .._arrays import checked
from .._errors import SceneError
from .._settings import Material
from .changes import MaterialChanges
from .objects import WorldObject

if TYPE_CHECKING:
    from .world import World


class MaterialHandle(WorldObject):
    """A material of a world. Changing it changes all bodies that are made of it."""

    __slots__ = ()

    def __init__(self, world: World, handle: Any) -> None:
        super().__init__(world, handle, "material")

    @property
    def alive(self) -> bool:
        """False if World.reset() went back to a copy without the material."""
        try:
            self._core.material(self._given_handle)
        except SceneError:
            return False
        return True

    @property
    def settings(self) -> Material:
        """The material as a record."""
        return Material(**self._core.material(self._handle))

    def change(self, material: Material | None = None, /, **changes: Unpack[MaterialChanges]) -> None:
        """Replaces the material, or some of its fields: handle.change(density=900). Bodies keep shapes and velocities,
        and get new masses and stable steps. SceneError: the model would change, or a body has no stable step with the
        new values. Nothing is changed then."""
        changed = dataclasses.replace(checked(material or self.settings, "material", Material), **changes)
        self._core.set_material(self._handle, changed)
        self._world._forget_material(self._given_handle)

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self), (self._world, self._given_handle))

    def _description(self) -> str:
        return f" {self.settings!r}"
