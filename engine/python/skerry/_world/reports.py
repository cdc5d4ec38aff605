"""Reports of steps and of runs: records that do not change any more."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from .._arrays import Vector
from .._settings import Dynamics

if TYPE_CHECKING:
    from .body import Body
    from .collider import Collider
    from .world import World

StepStatus: TypeAlias = Literal["ok", "not_finite", "too_fast", "too_far", "too_stiff", "unsolved", "stopped"]
StepLimit: TypeAlias = Literal["setting", "rest", "strain", "speed", "inversion", "crossing"]
DynamicsReason: TypeAlias = Literal["given", "self_contact", "losses", "strain", "cost"]
OverlapKind: TypeAlias = Literal["crossing", "inside", "around", "coincident"]


@dataclass(frozen=True, kw_only=True)
class StepReport:
    """Report of one call of World.advance()."""

    status: StepStatus
    """ "ok", "stopped" if the call was asked to end, or the reason why a step could not be completed."""
    message: str
    """Description of the failure: the body and the reason. Empty if `ok`."""
    warning: str
    """Names the body that is unstable at Settings.step_size, and the first element that turned inside out."""
    body: Body | None
    """Body that caused the failure."""
    body_name: str
    """Name of `body`."""
    node: int | None
    """Number of the node within `body` that caused the failure."""
    element: int | None
    """Number of the element within `body` that caused the failure; `node` is one of its corners."""
    value: float
    """Measured value that caused the failure. "too_fast": norm of the change of the element's deformation gradient.
    "too_far": rounding error of positions over mean edge length. "too_stiff": stable step [s]."""
    step_size: float
    """Length of the last step [s]."""
    steps: int
    """Number of steps that were completed."""
    shortened: int
    """Number of attempts at a step that were repeated with a shorter step."""
    retried: int
    """Number of attempts at a step that were repeated because surfaces crossed."""
    limited: int
    """Number of steps shorter than Settings.step_size, because the body `limited_by` is unstable at that length."""
    limited_step: float
    """Longest step that the body `limited_by` allowed [s]."""
    limited_by: str
    """Name of the body that is unstable at Settings.step_size."""
    contacts: int
    """Number of contacts of the last step, without those between sleeping bodies."""
    regions: int
    """Number of contact regions of the last step."""
    largest_region: int
    """Number of contacts of the largest region of the last step."""
    unconverged: int
    """Number of regions that the solver did not converge in, summed over the steps."""
    worst_error: float
    """Largest relative solver error of a region in any step."""
    worst_region: int
    """Number of contacts of the region with `worst_error`."""
    max_penetration: float
    """Largest overlap of surfaces in any step [m]."""
    max_gap_violation: float
    """Largest penetration into the contact distance in any step [m]."""
    held_penetration: float
    """Largest overlap of surfaces that no contact can move in any step, such as held nodes in a collider [m]."""
    inverted: int
    """Number of elements that turned inside out, including those in discarded attempts."""
    inverted_body: Body | None
    """Body of the first element that turned inside out."""
    inverted_name: str
    """Name of `inverted_body`."""
    inverted_element: int | None
    """Number of the first element that turned inside out, within its body."""
    crossed: int
    """Number of crossings of surfaces that no attempt at a step could prevent."""

    @property
    def ok(self) -> bool:
        """False if a step could not be completed, or if the call was asked to stop."""
        return self.status == "ok"

    def __repr__(self) -> str:
        doubts = "".join(f", {text}" for text in (self.message, self.warning) if text)
        return (
            f"<skerry.StepReport {self.status}, {self.steps:,} steps, {self.contacts:,} contacts, "
            f"worst error {self.worst_error:.3g}{doubts}>"
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Energy:
    """Energies of a world."""

    kinetic: float
    """Kinetic energy [J]."""
    elastic: float
    """Elastic energy [J]."""
    potential: float
    """Energy of the weight, relative to the origin [J]."""
    dissipated: float
    """Energy dissipated by contacts, damping and material losses since the start [J]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StageReport:
    """Computing time of one stage of the step."""

    name: str
    """Name in the form FOLDER/STAGE."""
    seconds: float
    """Elapsed time of all runs of the stage [s]."""
    runs: int
    """Number of runs."""
    skipped: int
    """Number of steps that did not need the stage."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StepLimitReport:
    """Steps whose length one particular cause has limited."""

    limit: StepLimit
    """The cause."""
    body: Body | None
    """Body that limited the steps; None if the cause is not a body."""
    body_name: str
    """Name of the body when it limited a step."""
    steps: int
    """Number of steps."""
    tries: int
    """Number of attempts at a step that were discarded for this cause."""
    seconds: float
    """Sum of the lengths of the steps [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DynamicsEstimate:
    """The estimate behind the choice for a body that was added with the dynamics "automatic"."""

    reason: DynamicsReason
    """Reason of the choice; "given" if no choice was made."""
    explicit_step: float
    """Step length of the world if the body is explicit [s]."""
    implicit_step: float
    """Step length of the world if the body is implicit [s]."""
    deforming_step: float
    """Step length for the deformation of the body if it is implicit [s]."""
    explicit_cost: float
    """Computing time per simulated second on one core if the body is explicit [s]."""
    implicit_cost: float
    """Computing time per simulated second on one core if the body is implicit [s]."""
    strain: float
    """Largest strain that weight, speed and a fall from ten times the body's size may cause."""
    damped_above: float
    """Frequency above which implicit steps damp vibrations [Hz]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DynamicsChoice:
    """The choice for one body that was added with the dynamics "automatic"."""

    body: Body | None
    """The body; None if it was removed."""
    name: str
    """Name of the body."""
    dynamics: Dynamics
    """The kind that was chosen."""
    estimate: DynamicsEstimate
    """The estimate behind the choice."""
    message: str
    """The choice as a text."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StartOverlap:
    """Two objects that overlapped when the first step began after one of them was added or moved by the user."""

    first: Body | None
    """The first body."""
    second: Body | None
    """The other body; None if the partner is a collider."""
    collider: Collider | None
    """The collider; None if both partners are bodies."""
    first_name: str
    """Name of the first body."""
    second_name: str
    """Name of its partner."""
    kind: OverlapKind
    """Kind of the overlap: "inside" means that the first body is inside its partner."""
    depth: float
    """Approximate length of the shortest translation of `first` that ends the overlap [m]."""
    direction: Vector
    """Unit direction of this translation."""
    place: Vector
    """Centre of the overlapping volume [m]."""
    resolved: bool
    """True if the two partners were moved apart."""
    message: str
    """The overlap as a text."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StartMove:
    """A body that was moved before its first step, so that it overlaps no other object."""

    body: Body | None
    """The body."""
    name: str
    """Name of the body."""
    translation: Vector
    """Translation of the body [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SelfCrossing:
    """A deformable body whose surface was found to cross itself."""

    body: Body | None
    """The body."""
    name: str
    """Name of the body when the crossing was found."""
    self_contact: bool
    """True if the body had self-contact when the crossing was last found."""
    first_time: float
    """Time of the first check that found a crossing [s]."""
    last_time: float
    """Time of the last check that found a crossing [s]."""
    last_places: int
    """Number of places of the last check that found the surface crossing; 0 if a later check found none."""
    most_places: int
    """Largest number of places in all checks."""
    message: str
    """The crossing as a text."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WorldReport:
    """Sums and maxima over all steps since the world was made, and measures of the present state."""

    time: float
    """Time of the world [s]."""
    steps: int
    """Number of steps."""
    inline_steps: int
    """Number of steps with so little work that they ran on one thread."""
    resting_steps: int
    """Number of steps in which all bodies were asleep and nothing moved."""
    unstrained: int
    """Number of bodies that flew freely and undeformed, summed over all steps."""
    shortened: int
    """Number of attempts at a step that were repeated with a shorter step."""
    retried: int
    """Number of attempts that were repeated with crossings of surfaces as contacts."""
    limited: int
    """Number of steps shorter than Settings.step_size, because a body is unstable at that length."""
    inversions: int
    """Number of times that an element turned inside out."""
    contact_sum: int
    """Number of contacts, summed over the steps."""
    iteration_sum: int
    """Number of solver sweeps over all regions, summed over the steps."""
    solved: int
    """Number of solved contact regions, summed over the steps."""
    unconverged: int
    """Number of regions that reached the iteration limit."""
    certified: int
    """Number of regions whose warm start was accurate enough."""
    closed_form: int
    """Number of regions of one contact, solved in closed form."""
    separating: int
    """Number of regions whose contacts all separate."""
    frictionless: int
    """Number of regions without friction."""
    in_lanes: int
    """Number of regions solved in the lanes of vector instructions."""
    contact_steps: int
    """Sum of contacts times sweeps over all regions that needed sweeps."""
    swept: int
    """Number of regions that needed sweeps."""
    large_strain_steps: int
    """Number of steps of implicit bodies of large strain."""
    newton_steps: int
    """Number of Newton steps of implicit bodies of large strain."""
    tangent_factors: int
    """Number of factorisations of their tangent stiffness."""
    max_contacts: int
    """Largest number of contacts in a step."""
    max_regions: int
    """Largest number of regions in a step."""
    largest_region: int
    """Largest number of contacts of a region."""
    worst_error: float
    """Largest relative solver error of a region in any step."""
    worst_region: int
    """Number of contacts of the region with `worst_error`."""
    dissipated: float
    """Energy dissipated by contacts, damping and material losses [J]."""
    max_penetration: float
    """Largest overlap of surfaces in any step [m]."""
    max_gap_violation: float
    """Largest penetration into the contact distance in any step [m]."""
    start_penetration: float
    """Value of max_penetration in the first step alone [m]."""
    start_gap_violation: float
    """Value of max_gap_violation in the first step alone [m]."""
    asleep: int
    """Number of bodies that are asleep now."""
    bodies: int
    """Number of bodies."""
    colliders: int
    """Number of colliders."""
    nodes: int
    """Number of nodes."""
    elements: int
    """Number of elements."""
    clusters: int
    """Number of groups of nodes that are coupled by implicit elements of explicit bodies."""
    cluster_nodes: int
    """Number of nodes in clusters."""
    implicit_elements: int
    """Number of implicit elements in clusters."""
    guards: int
    """Number of tetrahedra in clusters that have an inversion barrier."""
    dynamics_choices: tuple[DynamicsChoice, ...]
    """Choices for the bodies that were added with the dynamics "automatic"."""
    start_overlaps: tuple[StartOverlap, ...]
    """Overlaps found by the last check before a step."""
    start_moves: tuple[StartMove, ...]
    """Bodies that were moved to resolve these overlaps."""
    self_crossings: tuple[SelfCrossing, ...]
    """Bodies whose surface was found to cross itself."""
    step_limits: tuple[StepLimitReport, ...] = field(repr=False)
    """Causes that limited step lengths, the most frequent first."""
    stages: tuple[StageReport, ...] = field(repr=False)
    """Computing times of the stages of the step."""
    stable_step: float
    """Stable step of the stiffest body now [s]."""
    stable_step_body: str
    """Name of this body; empty if no body limits the step."""
    mean_contacts: float
    """Mean number of contacts of a step."""
    mean_regions: float
    """Mean number of regions of a step."""
    mean_iterations: float
    """Mean number of sweeps of a solved region."""
    broad_searches: int
    """Number of searches for pairs of near bodies."""
    pair_searches: int
    """Number of searches for pairs of near features."""
    candidates: int
    """Number of pairs of features in all candidate lists now."""
    crossing_tests: int
    """Number of tests for crossings of surfaces."""
    crossings_found: int
    """Number of crossings found in discarded attempts."""
    crossed: int
    """Number of crossings that no attempt at a step could prevent."""
    held_penetration: float
    """Largest overlap of surfaces that no contact can move, in any step [m]."""
    held_body: str
    """Name of the body with held nodes that overlapped; empty if it was removed."""
    held_in: str
    """Name of the object that it overlapped."""
    energy: Energy
    """Energies now."""
    momentum: Vector
    """Momentum now [kg m/s]."""
    angular_momentum: Vector
    """Angular momentum about the origin now [kg m^2/s]."""
    energy_error: float
    """Change of energy that loads, weight, colliders and losses do not explain [J]."""
    energy_error_share: float
    """energy_error relative to all energy that could be exchanged."""
    momentum_error: float
    """Change of momentum that loads, weight and colliders do not explain [kg m/s]; NaN if it cannot be known."""
    momentum_error_share: float
    """momentum_error relative to all momentum that could be exchanged."""
    balanced_steps: int
    """Number of steps since these balances were restarted by a change from outside."""
    worst_volume_ratio: float
    """Smallest ratio of present volume to rest volume of a tetrahedron now; negative if inverted."""
    worst_volume_body: str
    """Name of the body of this tetrahedron."""
    worst_volume_element: int | None
    """Number of this tetrahedron within its body."""
    near_inversion: int
    """Number of tetrahedra below a tenth of their rest volume."""
    folded: int
    """Number of smoothed elements below a fifth of their rest volume."""
    folded_body: str
    """Name of the first body with such elements."""
    folded_element: int | None
    """Number of a tetrahedron of the most compressed element of this body."""
    inverted: int
    """Number of inverted tetrahedra now."""
    collider_turn: float
    """Rotation of the fastest rotating collider during the longest step allowed now [rad]."""
    turning_collider: str
    """Name of this collider."""
    distrust: str
    """Reason why positions, forces and energies of the run cannot be trusted; empty if there is none."""

    def __repr__(self) -> str:
        return (
            f"<skerry.WorldReport at {self.time:.6g} s, {self.steps:,} steps, {self.bodies:,} bodies, "
            f"worst error {self.worst_error:.3g}{f', {self.distrust}' if self.distrust else ''}>"
        )


def step_report(world: World, values: dict[str, Any]) -> StepReport:
    """Makes a StepReport of the values of the extension module, which become its fields. The constructor would set the
    fields one by one, which takes as long as the rest of a call of advance() beside its steps."""
    if values["body"] is not None:
        values["body"] = world._body(values["body"], values["body_name"])
    if values["inverted_body"] is not None:
        values["inverted_body"] = world._body(values["inverted_body"], values["inverted_name"])
    report = StepReport.__new__(StepReport)
    object.__setattr__(report, "__dict__", values)
    return report


_NAMES = {
    DynamicsChoice: {"body": "name"},
    StartOverlap: {"first": "first_name", "second": "second_name"},
    StartMove: {"body": "name"},
    SelfCrossing: {"body": "name"},
    StepLimitReport: {"body": "body_name"},
}
"""Fields of records that hold bodies, and the fields that hold their names."""


def world_report(world: World, values: dict[str, Any]) -> WorldReport:
    """Makes a WorldReport of the values of the extension module."""

    def records(kind: type, rows: list[dict[str, Any]]) -> tuple[Any, ...]:
        for row in rows:
            for key, name in _NAMES.get(kind, {}).items():
                if row[key] is not None:
                    row[key] = world._body(row[key], row[name])
            if row.get("collider") is not None:
                row["collider"] = world._collider(row["collider"], row["second_name"])
            if "estimate" in row:
                row["estimate"] = DynamicsEstimate(**row["estimate"])
        return tuple(kind(**row) for row in rows)

    values["dynamics_choices"] = records(DynamicsChoice, values["dynamics_choices"])
    values["start_overlaps"] = records(StartOverlap, values["start_overlaps"])
    values["start_moves"] = records(StartMove, values["start_moves"])
    values["self_crossings"] = records(SelfCrossing, values["self_crossings"])
    values["step_limits"] = records(StepLimitReport, values["step_limits"])
    values["stages"] = records(StageReport, values["stages"])
    values["energy"] = Energy(**values["energy"])
    return WorldReport(**values)
