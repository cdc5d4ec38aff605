"""The world, its bodies, colliders, attachments and joints, and their reports."""

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
from .surface import SurfaceSet
from .tie import Tie, TieState
from .world import World

__all__ = [
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
    "StageReport",
    "StartMove",
    "StartOverlap",
    "StepLimitReport",
    "StepReport",
    "SurfaceSet",
    "Tie",
    "TieState",
    "World",
    "WorldReport",
]
