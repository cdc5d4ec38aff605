"""The world, its bodies, colliders, attachments and joints, and their reports."""

from .body import Attachment, Body
from .collider import Collider
from .joint import Joint, JointState
from .load import Load, LoadKind, LoadState
from .material import MaterialHandle
from .objects import Objects
from .relax import RelaxReport
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
    "Load",
    "LoadKind",
    "LoadState",
    "MaterialHandle",
    "Objects",
    "RelaxReport",
    "SelfCrossing",
    "StageReport",
    "StartMove",
    "StartOverlap",
    "StepLimitReport",
    "StepReport",
    "World",
    "WorldReport",
]
