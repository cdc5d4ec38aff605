"""Friction and restitution by pair of materials and by place on a body."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any, Unpack

from numpy.typing import ArrayLike

from .._arrays import Vector, VectorLike, checked, index_array, real, vector
from .._settings import Surface
from .body import Body
from .building import Building
from .changes import SurfaceChanges
from .material import MaterialHandle
from .objects import WorldObject

if TYPE_CHECKING:
    from .world import World


class SurfaceSet(WorldObject):
    """A part of the surface of a body with its own friction and restitution: faces with their edges and nodes, and
    nodes with the edges and faces between them. Removing a body removes its sets."""

    __slots__ = ()

    def __init__(self, world: World, handle: Any, label: str = "surface set") -> None:
        super().__init__(world, handle, label)

    @property
    def body(self) -> Body:
        """Body of the set."""
        return self._world._body(self._values["body"])

    @property
    def nodes(self) -> list[int]:
        """Numbers of the given nodes."""
        nodes: list[int] = self._values["nodes"]
        return nodes

    @property
    def faces(self) -> list[tuple[int, int, int]]:
        """The given faces by their nodes."""
        return [tuple(face) for face in self._values["faces"]]

    @property
    def surface_values(self) -> Surface:
        """Friction and restitution that were set. None stands for the value of the body. With `direction`, the
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
        """Direction in the frame of the mesh, which the faces carry along; None: there is none."""
        direction: Vector | None = self._values["direction"]
        return direction

    def set_surface(
        self,
        surface: Surface | None = None,
        /,
        *,
        friction_across: float | None = None,
        **values: Unpack[SurfaceChanges],
    ) -> None:
        """Sets the properties and wakes the body: set_surface(friction=0.3). Properties that are not given become those
        of the body."""
        given = dataclasses.replace(checked(surface or Surface(), "surface", Surface), **values)
        across = None if friction_across is None else real(friction_across, "friction_across")
        self._core.set_set_surface(self._handle, given, across)

    def remove(self) -> None:
        """Removes the set."""
        self._core.remove(self._handle)

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
        **values: Unpack[SurfaceChanges],
    ) -> SurfaceSet:
        """Gives a part of the surface of a body its own friction and restitution, and returns the part.

        nodes: numbers (n,) of nodes. faces: nodes (f, 3) of faces of the surface. friction_across: friction coefficient
        of sliding contacts across the direction; the friction in `surface` then applies along it. direction: direction
        (3,) in the frame of the mesh. Where sets overlap, the last one applies. SceneError: a face is not on the
        surface, or a value is out of range."""
        given = dataclasses.replace(checked(surface or Surface(), "surface", Surface), **values)
        handle = self._core.add_surface_set(
            self._own(body, "body", Body),
            index_array(nodes, "nodes", ("n",)).tolist(),
            index_array(faces, "faces", ("f", 3)).tolist(),
            given,
            None if friction_across is None else real(friction_across, "friction_across"),
            None if direction is None else vector(direction, "direction"),
        )
        return SurfaceSet(self._self, handle)

    @property
    def surface_sets(self) -> list[SurfaceSet]:
        """The surface sets in the order added. They have no names."""
        return [SurfaceSet(self._self, handle) for handle in self._core.surface_sets()]
