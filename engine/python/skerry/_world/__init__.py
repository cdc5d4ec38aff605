"""The world, its bodies, colliders, attachments, joints and cables, and their reports."""

from .anchor import Anchor
from .body import Attachment, Body
from .cable import Cable, CableState
from .cavity import Cavity, CavityState, Pipe, PipeState
from .collider import Collider
from .fibre import FibreFamily, FibreState
from .joint import Joint, JointState
from .load import Load, LoadKind, LoadState
from .material import MaterialHandle
from .objects import ObjectList, Objects
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
from .spring import Spring, SpringState
from .surface import SurfaceSet
from .tie import Tie, TieState
from .world import World

__all__ = [
    "Anchor",
    "Attachment",
    "Body",
    "Cable",
    "CableState",
    "Cavity",
    "CavityState",
    "Collider",
    "DynamicsChoice",
    "DynamicsEstimate",
    "Energy",
    "FibreFamily",
    "FibreState",
    "Joint",
    "JointState",
    "Load",
    "LoadKind",
    "LoadState",
    "MaterialHandle",
    "ObjectList",
    "Objects",
    "Pipe",
    "PipeState",
    "RelaxReport",
    "SelfCrossing",
    "Spring",
    "SpringState",
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
