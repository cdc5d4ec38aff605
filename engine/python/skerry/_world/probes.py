"""Probes: the quantities that recorders and rollouts record."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

from numpy.typing import ArrayLike

from .. import _core
from .._arrays import Vector, VectorLike, checked, index_array, name_text, real_array
from .._fields import Field, held

if TYPE_CHECKING:
    from .body import Attachment, Body
    from .cable import Cable
    from .cavity import Cavity
    from .collider import Collider
    from .joint import Joint
    from .objects import PosedObject
    from .spring import Spring
    from .tie import Tie
    from .world import World


@dataclass(frozen=True, slots=True)
class PointProbe:
    """Position, displacement and velocity of a point of a body, which Body.probe() finds.

    body: body of the point.
    node: numbers of four nodes between which the point lies; they may be equal.
    weight: weight of each of these nodes; the sum is 1.
    origin: position from which the displacement is measured [m]; None: the position when the recorder is made.
    """

    body: Body
    _: KW_ONLY
    node: tuple[int, int, int, int]
    weight: tuple[float, float, float, float]
    origin: Vector | None = None

    def __post_init__(self) -> None:
        nodes = index_array(self.node, "PointProbe.node", (4,))
        weights = real_array(self.weight, "PointProbe.weight", (4,))
        object.__setattr__(self, "node", tuple(nodes.tolist()))
        object.__setattr__(self, "weight", tuple(weights.tolist()))


@dataclass(frozen=True, slots=True)
class BodyProbe:
    """Position, displacement and velocity of the centre of mass of a body.

    body: the body.
    origin: position from which the displacement is measured [m]; None: the position when the recorder is made.
    """

    body: Body
    _: KW_ONLY
    origin: Vector | None = None


@dataclass(frozen=True, slots=True)
class ForceProbe:
    """Contact forces on a body or a collider.

    on: object on which the forces act.
    by: only forces of this object; None: the forces of all contacts.
    """

    on: Body | Collider
    by: Body | Collider | None = None


@dataclass(frozen=True, slots=True)
class ReactionProbe:
    """Force of an attachment on its body.

    attachment: the attachment.
    """

    attachment: Attachment


@dataclass(frozen=True, slots=True)
class JointProbe:
    """Force and moment of a joint, and for a hinge or slider its coordinate and its speed.

    joint: the joint.
    """

    joint: Joint


@dataclass(frozen=True, slots=True)
class TieProbe:
    """Force, moment and error of a tie.

    tie: the tie.
    """

    tie: Tie


@dataclass(frozen=True, slots=True)
class CableProbe:
    """Tensions, length, rate, work and friction loss of a cable.

    cable: the cable.
    """

    cable: Cable


@dataclass(frozen=True, slots=True)
class CavityProbe:
    """Pressure, volume, gas mass and energy of a cavity, and its force on the body.

    cavity: the cavity.
    """

    cavity: Cavity


@dataclass(frozen=True, slots=True)
class SpringProbe:
    """Length, rate, force and energy of a spring.

    spring: the spring.
    """

    spring: Spring


@dataclass(frozen=True, slots=True)
class EnergyProbe:
    """Kinetic, elastic, potential and dissipated energy of the world."""


@dataclass(frozen=True, slots=True)
class StressProbe:
    """Largest von Mises stress at some nodes of a body.

    body: the body.
    nodes: numbers of the nodes; none: all nodes.
    """

    body: Body
    nodes: Field[ArrayLike, tuple[int, ...]] = held(())

    def __post_init__(self) -> None:
        object.__setattr__(self, "nodes", tuple(index_array(self.nodes, "StressProbe.nodes", ("j",)).tolist()))


@dataclass(frozen=True, slots=True)
class VolumeProbe:
    """Smallest ratio of present volume to rest volume among the tetrahedra of a body.

    body: the body.
    """

    body: Body


@dataclass(frozen=True, slots=True)
class PoseProbe:
    """Pose of a body, a collider or an attachment.

    object: the object.
    """

    object: PosedObject


@dataclass(frozen=True, slots=True)
class VelocityProbe:
    """Velocity and angular velocity of a body, a collider or an attachment.

    object: the object.
    """

    object: PosedObject


@dataclass(frozen=True, slots=True)
class NodesProbe:
    """Positions of all nodes of a body.

    body: the body.
    """

    body: Body


Probe: TypeAlias = (
    PointProbe
    | BodyProbe
    | ForceProbe
    | ReactionProbe
    | JointProbe
    | TieProbe
    | CableProbe
    | SpringProbe
    | EnergyProbe
    | StressProbe
    | VolumeProbe
    | PoseProbe
    | VelocityProbe
    | NodesProbe
    | CavityProbe
)
"""A quantity that a recorder records."""


def recorded_probes(probes: Mapping[str, Probe], owner: World | None = None) -> list[Any]:
    """Probes by name for the extension module. Their objects must be objects of `owner`, if it is given."""
    if not isinstance(probes, Mapping):
        raise TypeError(f"probes: found {probes!r}, expected a mapping of names to probes")
    return [_recorded(name_text(name, "name of a probe"), probe, owner) for name, probe in probes.items()]


def _recorded(name: str, probe: Probe, owner: World | None) -> Any:
    from .body import Attachment, Body
    from .cable import Cable
    from .cavity import Cavity
    from .collider import Collider
    from .joint import Joint
    from .spring import Spring
    from .tie import Tie

    def handle_of(field: str, *kinds: type) -> Any:
        given, place = getattr(probe, field), f"probe '{name}': {field}"
        return checked(given, place, *kinds)._handle if owner is None else owner._own(given, place, *kinds)

    match probe:
        case PointProbe():
            return _core.point_probe(name, handle_of("body", Body), probe.node, probe.weight, probe.origin)
        case BodyProbe():
            return _core.body_probe(name, handle_of("body", Body), probe.origin)
        case ForceProbe():
            by = (Body, Collider) if isinstance(probe.on, Body) else (Body,)
            return _core.force_probe(
                name, handle_of("on", Body, Collider), None if probe.by is None else handle_of("by", *by)
            )
        case ReactionProbe():
            return _core.reaction_probe(name, handle_of("attachment", Attachment))
        case JointProbe():
            return _core.joint_probe(name, handle_of("joint", Joint))
        case TieProbe():
            return _core.tie_probe(name, handle_of("tie", Tie))
        case CableProbe():
            return _core.cable_probe(name, handle_of("cable", Cable))
        case CavityProbe():
            return _core.cavity_probe(name, handle_of("cavity", Cavity))
        case SpringProbe():
            return _core.spring_probe(name, handle_of("spring", Spring))
        case EnergyProbe():
            return _core.energy_probe(name)
        case StressProbe():
            return _core.stress_probe(name, handle_of("body", Body), list(probe.nodes))
        case VolumeProbe():
            return _core.volume_probe(name, handle_of("body", Body))
        case PoseProbe():
            return _core.pose_probe(name, handle_of("object", Body, Collider, Attachment))
        case VelocityProbe():
            return _core.velocity_probe(name, handle_of("object", Body, Collider, Attachment))
        case NodesProbe():
            return _core.nodes_probe(name, handle_of("body", Body))
    raise TypeError(f"probe '{name}': found {probe!r}, expected a probe such as Body.probe(point) or EnergyProbe()")


def probe_of(world: World, recorded: Any) -> Probe:
    """The Python object of a probe of the extension module."""
    kind, values = recorded.values
    given = {field: _object_of(world, value) for field, value in values.items()}
    for field in ("node", "weight", "nodes"):
        if field in given:
            given[field] = tuple(given[field])
    probe: Probe = globals()[kind](**given)
    return probe


def _object_of(world: World, value: Any) -> Any:
    """The object of a handle; other values as they are."""
    if isinstance(value, _core.BodyHandle):
        return world._body(value)
    if isinstance(value, _core.ColliderHandle):
        return world._collider(value)
    if isinstance(value, _core.JointHandle):
        return world._joint(value)
    if isinstance(value, _core.TieHandle):
        return world._tie(value)
    if isinstance(value, _core.CableHandle):
        return world._cable(value)
    if isinstance(value, _core.CavityHandle):
        return world._cavity(value)
    if isinstance(value, _core.SpringHandle):
        return world._spring(value)
    return world._attachment(value) if isinstance(value, _core.AttachmentHandle) else value


def point_probe(body: Body, point: VectorLike) -> PointProbe:
    """Probe for the material point that is now at `point` (3,) [m]."""
    _, values = _core.probe_point(body.world._core, body._handle, real_array(point, "point", (3,)))
    return PointProbe(body, node=tuple(values["node"]), weight=tuple(values["weight"]))
