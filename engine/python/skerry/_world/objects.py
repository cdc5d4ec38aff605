"""Objects of a world: their common properties, and the mappings of their names."""

from __future__ import annotations

import copy
import dataclasses
import operator
from collections.abc import Callable, ItemsView, Iterator, Mapping, ValuesView
from typing import TYPE_CHECKING, Any, Generic, Self, SupportsIndex, TypeVar, Unpack, overload

from .._arrays import Reals, VectorLike, checked, name_text, real, real_array, whole
from .._errors import BusyError, SceneError
from .._settings import Pose, Surface
from .changes import SurfaceChanges

if TYPE_CHECKING:
    from .world import World


class WorldObject:
    """An object of a world. It keeps its world alive. Two of them are equal if they are the same object of the same
    world."""

    __slots__ = ("_given_handle", "_label", "_world")

    def __init__(self, world: World, handle: Any, label: str) -> None:
        self._world = world
        self._given_handle = handle
        self._label = label

    @property
    def world(self) -> World:
        """World of the object."""
        return self._world

    @property
    def alive(self) -> bool:
        """False after the object was removed. Every other use of a removed object raises SceneError."""
        return bool(self._core.alive(self._given_handle))

    def in_copy(self, world: World) -> Self:
        """Returns this object in a copy of its world, also in a loaded one. SceneError: the copy does not have it."""
        from .world import World

        twin = copy.copy(self)
        twin._world = checked(world, "world", World)
        if not twin.alive:
            raise SceneError(
                f"{self._label}: found a world without it, expected a copy of its world",
                object=self._label,
                found="a world without it",
                expected="a copy of its world",
            )
        return twin

    @property
    def _core(self) -> Any:
        """World of the extension module."""
        return self._world._core

    @property
    def _handle(self) -> Any:
        """Handle for the extension module. Raises SceneError if the object was removed."""
        if not self.alive:
            raise SceneError(f"{self._label} was removed", object=self._label, found="a removed object")
        return self._given_handle

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self), (self._world, self._given_handle, self._label))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, WorldObject):
            return NotImplemented
        return self._world is other._world and bool(self._given_handle == other._given_handle)

    def __hash__(self) -> int:
        return hash(self._given_handle)

    def _description(self) -> str:
        """Text of a living object for repr()."""
        return f": {self._label}"

    def __repr__(self) -> str:
        try:
            text = self._description() if self.alive else f": {self._label}, removed"
        except BusyError:
            text = f": {self._label}, in use by another thread"
        return f"<skerry.{type(self).__name__}{text}>"


class NamedObject(WorldObject):
    """An object of a world whose name can be changed."""

    __slots__ = ()

    @property
    def name(self) -> str:
        """Name, by default the kind and a number, such as "cable_0". It affects no step."""
        return str(self._core.name(self._handle))

    @name.setter
    def name(self, name: str) -> None:
        self._core.set_name(self._handle, name_text(name, "name"))

    def _named(self, name: str | None) -> Self:
        """This object, with a name unless it is None."""
        if name is not None:
            self.name = name
        return self

    def remove(self) -> None:
        """Removes the object."""
        self._world.remove(self)


Named = TypeVar("Named", bound=NamedObject)


class ObjectList(list[Named]):
    """Objects in the order added. An index may also be a name: world.cables["tendon"]."""

    @overload
    def __getitem__(self, key: SupportsIndex | str) -> Named: ...
    @overload
    def __getitem__(self, key: slice) -> list[Named]: ...
    def __getitem__(self, key: SupportsIndex | slice | str) -> Named | list[Named]:
        if not isinstance(key, str):
            return super().__getitem__(key)
        found = [item for item in self if item.name == key]
        if len(found) == 1:
            return found[0]
        if found:
            raise KeyError(f"{len(found)} objects have the name '{key}'; use their numbers")
        raise KeyError(f"no object has the name '{key}'; the names are {[item.name for item in self]}")


class PosedObject(WorldObject):
    """An object of a world that has a pose and a velocity."""

    __slots__ = ()

    @property
    def pose(self) -> Pose:
        """Present pose. Assignment jumps to a pose: objects on the way are neither pushed nor detected, and keys and
        targets are dropped. For a deformed body the pose is the best fit, and assignment keeps its shape."""
        pose: Pose = self._core.pose(self._handle)
        return pose

    @pose.setter
    def pose(self, pose: Pose) -> None:
        self._core.set_pose(self._handle, checked(pose, "pose", Pose))

    @property
    def velocity(self) -> Reals:
        """Velocity, shape (3,) [m/s]: of the centre of mass of a body; of the origin of the pose of a collider or an
        attachment in the last step."""
        velocity: Reals = self._core.velocity(self._handle)[0]
        return velocity

    @property
    def angular_velocity(self) -> Reals:
        """Angular velocity, shape (3,) [rad/s]. For a deformable body, that of the motion with its angular
        momentum."""
        angular_velocity: Reals = self._core.velocity(self._handle)[1]
        return angular_velocity

    def set_velocity(self, velocity: VectorLike, angular_velocity: VectorLike = (0.0, 0.0, 0.0)) -> None:
        """Sets the velocities, each of shape (3,) [m/s, rad/s]. A collider or an attachment keeps them until they are
        set again, and turns about the origin of its pose. A body gets the velocities of a rigid motion about its centre
        of mass."""
        self._core.set_velocity(
            self._handle,
            real_array(velocity, "velocity", (3,)),
            real_array(angular_velocity, "angular_velocity", (3,)),
        )

    def remove(self) -> None:
        """Removes the object from its world."""
        self._world.remove(self)


class MovedObject(PosedObject):
    """A collider or an attachment: the user prescribes its motion."""

    __slots__ = ()

    def move_to(self, pose: Pose, seconds: float) -> None:
        """Moves to a pose at constant velocities within the given time, > 0 [s], and then stops."""
        self._core.move_to(self._handle, checked(pose, "pose", Pose), real(seconds, "seconds"))


class TouchingObject(PosedObject):
    """A body or a collider."""

    __slots__ = ("_name",)

    def __init__(self, world: World, handle: Any, label: str, name: str) -> None:
        super().__init__(world, handle, label)
        self._name = name

    @property
    def name(self) -> str:
        """Name."""
        return self._name

    @property
    def surface_values(self) -> Surface:
        """Friction and restitution that were set. None means for a body the value of its material, and for a collider
        the value of the body that touches it."""
        surface: Surface = self._core.surface_properties(self._handle)
        return surface

    def set_surface(self, surface: Surface | None = None, /, **values: Unpack[SurfaceChanges]) -> None:
        """Replaces `surface_values`, or some of them: set_surface(friction=0.3). A new `friction` replaces the static
        and the dynamic friction."""
        self._core.set_surface_properties(self._handle, changed_surface(self.surface_values, surface, values))

    @property
    def collision_groups(self) -> tuple[int, int]:
        """The group and the mask of set_collision_groups()."""
        group, mask = self._core.collision_groups(self._handle)
        return (group, mask)

    def set_collision_groups(self, *, group: int = 1, mask: int = 0xFFFFFFFF) -> None:
        """Sets the collision groups of the object, and the groups that it can touch, both as bits. Two objects can
        touch only if each of the two masks contains a group of the other object."""
        self._core.set_collision_groups(self._handle, whole(group, "group"), whole(mask, "mask"))

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self), (self._world, self._given_handle, self._name))


def changed_surface(present: Surface, surface: Surface | None, values: SurfaceChanges) -> Surface:
    """`surface`, or the present one if it is None, with some new values."""
    given = present if surface is None else checked(surface, "surface", Surface)
    if "friction" in values:
        given = dataclasses.replace(given, static_friction=None, dynamic_friction=None)
    elif "static_friction" in values or "dynamic_friction" in values:
        both = {"static_friction": given.friction, "dynamic_friction": given.friction}
        kept = {name: value for name, value in both.items() if getattr(given, name) is None}
        given = dataclasses.replace(given, friction=None, **kept)
    return dataclasses.replace(given, **values)


Item = TypeVar("Item", bound=TouchingObject)


class Objects(Mapping[str, Item], Generic[Item]):
    """Bodies or colliders of a world, in the order of the world, by name or by number. An object of a copy of the world
    is a key too: world.bodies[body] is the object that `body` is in the copy.

    Names that Python gives are unique. A world that was built otherwise may have objects without a name, or several of
    one name: use their numbers."""

    __slots__ = ("_core", "_kind", "_make")

    def __init__(self, core: Any, kind: str, make: Callable[[Any], Item]) -> None:
        self._core = core
        self._kind = kind
        self._make = make

    def _all(self) -> list[Any]:
        """Handles of all objects."""
        return list(getattr(self._core, self._kind)())

    def _named(self, name: str) -> list[Any]:
        """Handles of all objects of this name."""
        return list(getattr(self._core, f"{self._kind}_named")(name))

    def __getitem__(self, key: str | SupportsIndex | Item) -> Item:
        if isinstance(key, str):
            return self._make(self._only(key))
        handles = self._all()
        if isinstance(key, WorldObject):
            if key._given_handle in handles:
                return self._make(key._given_handle)
            raise KeyError(f"the world has no {key._label}")
        if not isinstance(key, SupportsIndex):
            raise TypeError(f"{self._kind}: found the key {key!r}, expected a name, a number or an object of a world")
        try:
            return self._make(handles[key])
        except IndexError:
            raise KeyError(f"{self._kind} {key}: the world has {len(handles)}") from None

    def _only(self, name: str) -> Any:
        """Handle of the only object of this name."""
        found = self._named(name)
        if len(found) == 1:
            return found[0]
        if found:
            raise KeyError(f"{len(found)} {self._kind} have the name '{name}'; use their numbers")
        names = ", ".join(f"'{known}'" for known in self)
        raise KeyError(
            f"no {self._kind} have the name '{name}'; the names are {names}" if names else f"no {self._kind}"
        )

    def __iter__(self) -> Iterator[str]:
        return iter([self._core.name(handle) for handle in self._all()])

    def __len__(self) -> int:
        return len(self._all())

    def __contains__(self, key: object) -> bool:
        if isinstance(key, str):
            return bool(self._named(key))
        if isinstance(key, WorldObject):
            return key._given_handle in self._all()
        return isinstance(key, SupportsIndex) and -len(self) <= operator.index(key) < len(self)

    def items(self) -> ItemsView[str, Item]:
        """Pairs of a name and an object, in the order of the world."""
        return _Items(self)

    def values(self) -> ValuesView[Item]:
        """The objects in the order of the world."""
        return _Values(self)

    def __repr__(self) -> str:
        return f"<skerry {self._kind}: {', '.join(self) or 'none'}>"


class _Values(ValuesView[Item]):
    """The values by number, since names may not be unique."""

    def __init__(self, objects: Objects[Item]) -> None:
        super().__init__(objects)
        self._objects = objects

    def __iter__(self) -> Iterator[Item]:
        return iter([self._objects._make(handle) for handle in self._objects._all()])


class _Items(ItemsView[str, Item]):
    """The items by number, since names may not be unique."""

    def __init__(self, objects: Objects[Item]) -> None:
        super().__init__(objects)
        self._objects = objects

    def __iter__(self) -> Iterator[tuple[str, Item]]:
        objects = self._objects
        return iter([(objects._core.name(handle), objects._make(handle)) for handle in objects._all()])
