"""Friction and restitution by pair of materials and by place on a body."""

from __future__ import annotations

import dataclasses
from typing import Any, Unpack

from numpy.typing import ArrayLike

from .._arrays import Vector, VectorLike, checked, index_array, optional_name, real, vector
from .._settings import Surface
from .body import Body, Indices
from .building import Building
from .changes import SurfaceChanges, SurfaceSetChanges
from .material import MaterialHandle
from .objects import NamedObject, ObjectList, changed_surface


class SurfaceSet(NamedObject):
    """A part of the surface of a body with its own friction and restitution: faces with their edges and nodes, and
    nodes with the edges and faces between them. Removing a body removes its sets."""

    __slots__ = ()

    @property
    def body(self) -> Body:
        """Body of the set."""
        return self._world._body(self._values["body"])

    @property
    def nodes(self) -> Indices:
        """Numbers of the given nodes, shape (j,)."""
        nodes: Indices = self._values["nodes"]
        return nodes

    @property
    def faces(self) -> Indices:
        """Nodes of the given faces, shape (k, 3)."""
        faces: Indices = self._values["faces"]
        return faces

    @property
    def surface_values(self) -> Surface:
        """Friction and restitution that were set. None means the value of the body. With `direction`, the
        friction applies along it."""
        surface: Surface = self._values["surface"]
        return surface

    @property
    def friction_across(self) -> float | None:
        """Friction coefficient of sliding contacts across `direction`; None: the same in all directions."""
        across: float | None = self._values["friction_across"]
        return across

    @property
    def direction(self) -> Vector | None:
        """Direction in the frame of the mesh, which moves with the faces; None: there is none."""
        direction: Vector | None = self._values["direction"]
        return direction

    def set_surface(self, surface: Surface | None = None, /, **values: Unpack[SurfaceSetChanges]) -> None:
        """Replaces `surface_values` or some of them, and `friction_across` if it is given, and wakes the body:
        set_surface(friction=0.3). A new `friction` replaces the static and the dynamic friction."""
        across = values.pop("friction_across", self.friction_across)
        given = changed_surface(self.surface_values, surface, values)
        self._core.set_set_surface(self._handle, given, None if across is None else real(across, "friction_across"))

    @property
    def _values(self) -> dict[str, Any]:
        values: dict[str, Any] = self._core.surface_set(self._handle)
        return values


class SurfaceRules(Building):
    """The part of World that sets friction and restitution by pair of materials and by place."""

    __slots__ = ()

    def set_pair(
        self,
        first: MaterialHandle,
        second: MaterialHandle,
        surface: Surface | None = None,
        /,
        **values: Unpack[SurfaceChanges],
    ) -> None:
        """Sets the properties of contacts between two materials, in either order, and wakes their bodies:
        set_pair(rubber, steel, friction=0.8). Properties that are not given follow the general rule. They take
        precedence over the values of materials, bodies and colliders. A body has its material of add_body() here, a
        collider its `material`."""
        given = dataclasses.replace(checked(surface or Surface(), "surface", Surface), **values)
        one, other = self._own(first, "first", MaterialHandle), self._own(second, "second", MaterialHandle)
        self._core.set_pair(one, other, given)

    def pair(self, first: MaterialHandle, second: MaterialHandle) -> Surface | None:
        """Properties of the contacts between two materials; None: the general rule applies."""
        one, other = self._own(first, "first", MaterialHandle), self._own(second, "second", MaterialHandle)
        surface: Surface | None = self._core.pair(one, other)
        return surface

    def remove_pair(self, first: MaterialHandle, second: MaterialHandle) -> None:
        """Removes the properties of a pair of materials."""
        one, other = self._own(first, "first", MaterialHandle), self._own(second, "second", MaterialHandle)
        self._core.remove_pair(one, other)

    @property
    def pairs(self) -> list[tuple[MaterialHandle, MaterialHandle, Surface]]:
        """The pairs of materials with properties of their own."""
        return [
            (MaterialHandle(self._self, first), MaterialHandle(self._self, second), surface)
            for first, second, surface in self._core.pairs()
        ]

    def add_surface_set(
        self,
        body: Body,
        surface: Surface | None = None,
        /,
        *,
        nodes: ArrayLike = (),
        faces: ArrayLike = (),
        friction_across: float | None = None,
        direction: VectorLike | None = None,
        name: str | None = None,
        **values: Unpack[SurfaceChanges],
    ) -> SurfaceSet:
        """Gives a part of the surface of a body its own friction and restitution, and returns the part.

        nodes: numbers within the body (j,), or a truth value for each node (n,).
        faces: nodes (k, 3) of faces of the surface.
        friction_across: friction coefficient of sliding contacts across the direction; the friction in `surface` then
            applies along it.
        direction: direction (3,) in the frame of the mesh.
        name: see SurfaceSet.name. Where sets overlap, the last one applies.
        SceneError: a face is not on the surface, or a value is out of range."""
        name = optional_name(name)
        given = dataclasses.replace(checked(surface or Surface(), "surface", Surface), **values)
        handle = self._core.add_surface_set(
            self._own(body, "body", Body),
            body._node_numbers(nodes).tolist(),
            index_array(faces, "faces", ("k", 3)).tolist(),
            given,
            None if friction_across is None else real(friction_across, "friction_across"),
            None if direction is None else vector(direction, "direction"),
        )
        return self._surface_set(handle)._named(name)

    @property
    def surface_sets(self) -> ObjectList[SurfaceSet]:
        """The surface sets in the order added."""
        return ObjectList(self._surface_set(handle) for handle in self._core.surface_sets())

    def _surface_set(self, handle: Any) -> SurfaceSet:
        body = self._core.name(self._core.surface_set(handle)["body"])
        return SurfaceSet(self._self, handle, f"surface set of body '{body}'")
