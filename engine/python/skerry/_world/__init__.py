"""The world, its bodies, colliders, attachments and joints, and their reports."""

from .anchor import Anchor
from .body import Attachment, Body
from .collider import Collider
from .joint import Joint, JointState
from .material import MaterialHandle
from .objects import Objects
from .reports import (
    DynamicsChoice,
    DynamicsEstimate,
    Energy,
    SelfCrossing,
    StageReport,
    StartMove,
    StartOverlap,
    StepLimitReport,
    StepReport,
    WorldReport,
)
from .spring import Spring, SpringState
from .world import World

__all__ = [
    "Anchor",
    "Attachment",
    "Body",
    "Collider",
    "DynamicsChoice",
    "DynamicsEstimate",
    "Energy",
    "Joint",
    "JointState",
    "MaterialHandle",
    "Objects",
    "SelfCrossing",
    "Spring",
    "SpringState",
    "StageReport",
    "StartMove",
    "StartOverlap",
    "StepLimitReport",
    "StepReport",
    "World",
    "WorldReport",
]
