"""Finding the objects of a world."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from .anchor import anchor_label
from .body import Attachment, Body
from .cable import Cable
from .collider import Collider
from .joint import Joint, joint_label
from .material import MaterialHandle
from .objects import ObjectList, Objects
from .spring import Spring
from .tie import Tie

if TYPE_CHECKING:
    from .world import World


class Finding:
    """The part of World that finds objects."""

    __slots__ = ()

    if TYPE_CHECKING:
        _core: Any

    @property
    def _self(self) -> World:
        """The world, which is the only subclass."""
        return cast("World", self)

    @property
    def bodies(self) -> Objects[Body]:
        """The bodies by name or number, in the order added."""
        return Objects(self._core, "bodies", self._body)

    @property
    def colliders(self) -> Objects[Collider]:
        """The colliders by name or number, in the order added."""
        return Objects(self._core, "colliders", self._collider)

    @property
    def joints(self) -> ObjectList[Joint]:
        """The joints in the order added."""
        return ObjectList(self._joint(handle) for handle in self._core.joints())

    @property
    def ties(self) -> ObjectList[Tie]:
        """The ties in the order added."""
        return ObjectList(self._tie(handle) for handle in self._core.ties())

    @property
    def cables(self) -> ObjectList[Cable]:
        """The cables in the order added."""
        return ObjectList(self._cable(handle) for handle in self._core.cables())

    @property
    def springs(self) -> ObjectList[Spring]:
        """The springs in the order added."""
        return ObjectList(self._spring(handle) for handle in self._core.springs())

    @property
    def attachments(self) -> list[Attachment]:
        """The attachments in the order added. They have no names."""
        return [self._attachment(handle) for handle in self._core.attachments()]

    @property
    def materials(self) -> list[MaterialHandle]:
        """The materials in the order added. They have no names."""
        return [MaterialHandle(self._self, handle) for handle in self._core.materials()]

    def _attachment(self, handle: Any) -> Attachment:
        body = self._body(self._core.body_of(handle))
        return Attachment(self._self, handle, body, len(self._core.nodes_of(handle)))

    def _body(self, handle: Any, name: str | None = None) -> Body:
        return Body(self._self, handle, self._core.name(handle) if name is None else name)

    def _collider(self, handle: Any, name: str | None = None) -> Collider:
        return Collider(self._self, handle, self._core.name(handle) if name is None else name)

    def _cable(self, handle: Any) -> Cable:
        points = self._core.cable_state(handle)["points"]
        objects = list(dict.fromkeys(anchor_label(self._self, point) for point in points))
        return Cable(self._self, handle, f"cable of {', '.join(objects[:-1])} and {objects[-1]}")

    def _joint(self, handle: Any) -> Joint:
        state = self._core.joint_state(handle)
        second = state["second"]
        label = joint_label(
            state["kind"], self._core.name(state["first"]), None if second is None else self._core.name(second)
        )
        return Joint(self._self, handle, label)

    def _tie(self, handle: Any) -> Tie:
        return Tie(self._self, handle, f"tie of body '{self._core.name(self._core.tie_state(handle)['body'])}'")

    def _spring(self, handle: Any) -> Spring:
        state = self._core.spring_state(handle)
        first, second = (anchor_label(self._self, state[name]) for name in ("first", "second"))
        return Spring(self._self, handle, f"spring of {first} and {second}")
