"""The world, its bodies, colliders, attachments and joints, and their reports."""

from .body import Attachment, Body
from .cavity import Cavity, CavityState, Pipe, PipeState
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
from .world import World

__all__ = [
    "Attachment",
    "Body",
    "Cavity",
    "CavityState",
    "Collider",
    "DynamicsChoice",
    "DynamicsEstimate",
    "Energy",
    "Joint",
    "JointState",
    "MaterialHandle",
    "Objects",
    "Pipe",
    "PipeState",
    "SelfCrossing",
    "StageReport",
    "StartMove",
    "StartOverlap",
    "StepLimitReport",
    "StepReport",
    "World",
    "WorldReport",
]
