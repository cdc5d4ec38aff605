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
DynamicsReason: TypeAlias = Literal["given", "self_contact", "losses", "plasticity", "strain", "cost"]
OverlapKind: TypeAlias = Literal["crossing", "inside", "around", "coincident"]


@dataclass(frozen=True, kw_only=True)
class StepReport:
    """Report of one call of World.advance().

    status: "ok", "stopped" if the call was asked to end, or the reason why a step could not be completed.
    message: description of the failure: the body and the reason. Empty if `ok`.
    warning: names the body that is unstable at Settings.step_size, and the first element that turned inside out.
    body: body that caused the failure.
    body_name: name of `body`.
    node: number of the node within `body` that caused the failure.
    element: number of the element within `body` that caused the failure; `node` is one of its corners.
    value: measured value that caused the failure. "too_fast": norm of the change of the element's deformation gradient.
        "too_far": rounding error of positions over mean edge length. "too_stiff": stable step [s].
    step_size: length of the last step [s].
    steps: number of steps that were completed.
    shortened: number of attempts at a step that were repeated with a shorter step.
    retried: number of attempts at a step that were repeated because surfaces crossed.
    limited: number of steps shorter than Settings.step_size, because the body `limited_by` is unstable at that length.
    limited_step: longest step that the body `limited_by` allowed [s].
    limited_by: name of the body that is unstable at Settings.step_size.
    contacts: number of contacts of the last step, without those between sleeping bodies.
    regions: number of contact regions of the last step.
    largest_region: number of contacts of the largest region of the last step.
    unconverged: number of regions that the solver did not converge in, summed over the steps.
    worst_error: largest relative solver error of a region in any step.
    worst_region: number of contacts of the region with `worst_error`.
    max_penetration: largest overlap of surfaces in any step [m].
    max_gap_violation: largest penetration into the contact distance in any step [m].
    held_penetration: largest overlap of surfaces that no contact can move in any step, such as held nodes in a collider
        [m].
    inverted: number of elements that turned inside out, including those in discarded attempts.
    inverted_body: body of the first element that turned inside out.
    inverted_name: name of `inverted_body`.
    inverted_element: number of the first element that turned inside out, within its body.
    crossed: number of crossings of surfaces that no attempt at a step could prevent.
    """

    status: StepStatus
    message: str
    warning: str
    body: Body | None
    body_name: str
    node: int | None
    element: int | None
    value: float
    step_size: float
    steps: int
    shortened: int
    retried: int
    limited: int
    limited_step: float
    limited_by: str
    contacts: int
    regions: int
    largest_region: int
    unconverged: int
    worst_error: float
    worst_region: int
    max_penetration: float
    max_gap_violation: float
    held_penetration: float
    inverted: int
    inverted_body: Body | None
    inverted_name: str
    inverted_element: int | None
    crossed: int

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
    """Energies of a world.

    kinetic: kinetic energy [J].
    elastic: elastic energy [J].
    potential: energy of the weight, relative to the origin [J].
    dissipated: energy dissipated by contacts, damping, material losses and plastic flow since the start [J].
    """

    kinetic: float
    elastic: float
    potential: float
    dissipated: float


@dataclass(frozen=True, slots=True, kw_only=True)
class StageReport:
    """Computing time of one stage of the step.

    name: name in the form FOLDER/STAGE.
    seconds: elapsed time of all runs of the stage [s].
    runs: number of runs.
    skipped: number of steps that did not need the stage.
    """

    name: str
    seconds: float
    runs: int
    skipped: int


@dataclass(frozen=True, slots=True, kw_only=True)
class StepLimitReport:
    """Steps whose length one particular cause has limited.

    limit: the cause.
    body: body that limited the steps; None if the cause is not a body.
    body_name: name of the body when it limited a step.
    steps: number of steps.
    tries: number of attempts at a step that were discarded for this cause.
    seconds: sum of the lengths of the steps [s].
    """

    limit: StepLimit
    body: Body | None
    body_name: str
    steps: int
    tries: int
    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class DynamicsEstimate:
    """The estimate behind the choice for a body that was added with the dynamics "automatic".

    reason: reason of the choice; "given" if no choice was made.
    explicit_step: step length of the world if the body is explicit [s].
    implicit_step: step length of the world if the body is implicit [s].
    deforming_step: step length for the deformation of the body if it is implicit [s].
    explicit_cost: computing time per simulated second on one core if the body is explicit [s].
    implicit_cost: computing time per simulated second on one core if the body is implicit [s].
    strain: largest strain that weight, speed and a fall from ten times the body's size may cause.
    damped_above: frequency above which implicit steps damp vibrations [Hz].
    """

    reason: DynamicsReason
    explicit_step: float
    implicit_step: float
    deforming_step: float
    explicit_cost: float
    implicit_cost: float
    strain: float
    damped_above: float


@dataclass(frozen=True, slots=True, kw_only=True)
class DynamicsChoice:
    """The choice for one body that was added with the dynamics "automatic".

    body: the body; None if it was removed.
    name: name of the body.
    dynamics: the kind that was chosen.
    estimate: the estimate behind the choice.
    message: the choice as a text.
    """

    body: Body | None
    name: str
    dynamics: Dynamics
    estimate: DynamicsEstimate
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class StartOverlap:
    """Two objects that overlapped when the first step began after one of them was added or moved by the user.

    first: the first body.
    second: the other body; None if the partner is a collider.
    collider: the collider; None if both partners are bodies.
    first_name: name of the first body.
    second_name: name of its partner.
    kind: kind of the overlap: "inside" means that the first body is inside its partner.
    depth: approximate length of the shortest translation of `first` that ends the overlap [m].
    direction: unit direction of this translation.
    place: centre of the overlapping volume [m].
    resolved: True if the two partners were moved apart.
    message: the overlap as a text.
    """

    first: Body | None
    second: Body | None
    collider: Collider | None
    first_name: str
    second_name: str
    kind: OverlapKind
    depth: float
    direction: Vector
    place: Vector
    resolved: bool
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class StartMove:
    """A body that was moved before its first step, so that it overlaps no other object.

    body: the body.
    name: name of the body.
    translation: translation of the body [m].
    """

    body: Body | None
    name: str
    translation: Vector


@dataclass(frozen=True, slots=True, kw_only=True)
class SelfCrossing:
    """A deformable body whose surface was found to cross itself.

    body: the body.
    name: name of the body when the crossing was found.
    self_contact: True if the body had self-contact when the crossing was last found.
    first_time: time of the first check that found a crossing [s].
    last_time: time of the last check that found a crossing [s].
    last_places: number of places where an edge passes through a triangle, at the last check; 0 if it found none.
    most_places: largest number of such places in any check.
    message: the crossing as a text.
    """

    body: Body | None
    name: str
    self_contact: bool
    first_time: float
    last_time: float
    last_places: int
    most_places: int
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class WorldReport:
    """Sums and maxima over all steps since the world was made, and measures of the present state.

    time: time of the world [s].
    steps: number of steps.
    inline_steps: number of steps with so little work that they ran on one thread.
    resting_steps: number of steps in which all bodies were asleep and nothing moved.
    unstrained: number of bodies that flew freely and undeformed, summed over all steps.
    shortened: number of attempts at a step that were repeated with a shorter step.
    retried: number of attempts that were repeated with crossings of surfaces as contacts.
    limited: number of steps shorter than Settings.step_size, because a body is unstable at that length.
    inversions: number of times that an element turned inside out.
    contact_sum: number of contacts, summed over the steps.
    iteration_sum: number of solver sweeps over all regions, summed over the steps.
    solved: number of solved contact regions, summed over the steps.
    unconverged: number of regions that reached the iteration limit.
    certified: number of regions whose warm start was accurate enough.
    closed_form: number of regions of one contact, solved in closed form.
    separating: number of regions whose contacts all separate.
    frictionless: number of regions without friction.
    in_lanes: number of regions solved in the lanes of vector instructions.
    contact_steps: sum of contacts times sweeps over all regions that needed sweeps.
    swept: number of regions that needed sweeps.
    large_strain_steps: number of steps of implicit bodies of large strain.
    newton_steps: number of Newton steps of implicit bodies of large strain.
    tangent_factors: number of factorisations of their tangent stiffness.
    max_contacts: largest number of contacts in a step. If it is 0, nothing has touched in the whole run, and the text
        of the report says so; World.nearest_points() finds how far a tool was away.
    max_regions: largest number of regions in a step.
    largest_region: largest number of contacts of a region.
    worst_error: largest relative solver error of a region in any step.
    worst_region: number of contacts of the region with `worst_error`.
    dissipated: energy dissipated by contacts, damping, material losses and plastic flow [J].
    plastic_work: part of dissipated: plastic flow of elements in steps, not when positions are set [J].
    max_penetration: largest overlap of surfaces in any step [m].
    max_gap_violation: largest penetration into the contact distance in any step [m].
    start_penetration: value of max_penetration in the first step alone [m].
    start_gap_violation: value of max_gap_violation in the first step alone [m].
    asleep: number of bodies that are asleep now.
    bodies: number of bodies.
    colliders: number of colliders.
    nodes: number of nodes.
    elements: number of elements.
    clusters: number of groups of nodes that are coupled by implicit elements of explicit bodies.
    cluster_nodes: number of nodes in clusters.
    implicit_elements: number of implicit elements in clusters.
    guards: number of tetrahedra in clusters that have an inversion barrier.
    dynamics_choices: choices for the bodies that were added with the dynamics "automatic".
    start_overlaps: overlaps found by the last check before a step.
    start_moves: bodies that were moved to resolve these overlaps.
    self_crossings: bodies whose surface was found to cross itself.
    step_limits: causes that limited step lengths, the most frequent first.
    stages: computing times of the stages of the step.
    stable_step: stable step of the stiffest body now [s].
    stable_step_body: name of this body; empty if no body limits the step.
    mean_contacts: mean number of contacts of a step.
    mean_regions: mean number of regions of a step.
    mean_iterations: mean number of sweeps of a solved region.
    broad_searches: number of searches for pairs of near bodies.
    pair_searches: number of searches for pairs of near features.
    candidates: number of pairs of features in all candidate lists now.
    crossing_tests: number of tests for crossings of surfaces.
    crossings_found: number of crossings found in discarded attempts.
    crossed: number of crossings that no attempt at a step could prevent.
    held_penetration: largest overlap of surfaces that no contact can move, in any step [m].
    held_body: name of the body with held nodes that overlapped; empty if it was removed.
    held_in: name of the object that it overlapped.
    energy: energies now.
    momentum: momentum now [kg m/s].
    angular_momentum: angular momentum about the origin now [kg m^2/s].
    energy_error: change of energy that loads, weight, colliders and losses do not explain [J].
    energy_error_share: energy_error relative to all energy that could be exchanged.
    momentum_error: change of momentum that loads, weight and colliders do not explain [kg m/s]; NaN if it cannot be
        known.
    momentum_error_share: momentum_error relative to all momentum that could be exchanged.
    balanced_steps: number of steps since these balances were restarted by a change from outside.
    worst_volume_ratio: smallest ratio of present volume to rest volume of a tetrahedron now; negative if inverted.
    worst_volume_body: name of the body of this tetrahedron.
    worst_volume_element: number of this tetrahedron within its body.
    near_inversion: number of tetrahedra below a tenth of their rest volume.
    folded: number of smoothed elements below a fifth of their rest volume.
    folded_body: name of the first body with such elements.
    folded_element: number of a tetrahedron of the most compressed element of this body.
    inverted: number of inverted tetrahedra now.
    collider_turn: rotation of the fastest rotating collider during the longest step allowed now [rad].
    turning_collider: name of this collider.
    distrust: reason why positions, forces and energies of the run cannot be trusted; empty if there is none.
    """

    time: float
    steps: int
    inline_steps: int
    resting_steps: int
    unstrained: int
    shortened: int
    retried: int
    limited: int
    inversions: int
    contact_sum: int
    iteration_sum: int
    solved: int
    unconverged: int
    certified: int
    closed_form: int
    separating: int
    frictionless: int
    in_lanes: int
    contact_steps: int
    swept: int
    large_strain_steps: int
    newton_steps: int
    tangent_factors: int
    max_contacts: int
    max_regions: int
    largest_region: int
    worst_error: float
    worst_region: int
    dissipated: float
    plastic_work: float
    max_penetration: float
    max_gap_violation: float
    start_penetration: float
    start_gap_violation: float
    asleep: int
    bodies: int
    colliders: int
    nodes: int
    elements: int
    clusters: int
    cluster_nodes: int
    implicit_elements: int
    guards: int
    dynamics_choices: tuple[DynamicsChoice, ...]
    start_overlaps: tuple[StartOverlap, ...]
    start_moves: tuple[StartMove, ...]
    self_crossings: tuple[SelfCrossing, ...]
    step_limits: tuple[StepLimitReport, ...] = field(repr=False)
    stages: tuple[StageReport, ...] = field(repr=False)
    stable_step: float
    stable_step_body: str
    mean_contacts: float
    mean_regions: float
    mean_iterations: float
    broad_searches: int
    pair_searches: int
    candidates: int
    crossing_tests: int
    crossings_found: int
    crossed: int
    held_penetration: float
    held_body: str
    held_in: str
    energy: Energy
    momentum: Vector
    angular_momentum: Vector
    energy_error: float
    energy_error_share: float
    momentum_error: float
    momentum_error_share: float
    balanced_steps: int
    worst_volume_ratio: float
    worst_volume_body: str
    worst_volume_element: int | None
    near_inversion: int
    folded: int
    folded_body: str
    folded_element: int | None
    inverted: int
    collider_turn: float
    turning_collider: str
    distrust: str

    def __repr__(self) -> str:
        apart = self.steps > 0 and self.max_contacts == 0 and self.bodies + self.colliders > 1
        doubts = (", no contact in the whole run" if apart else "") + (f", {self.distrust}" if self.distrust else "")
        return (
            f"<skerry.WorldReport at {self.time:.6g} s, {self.steps:,} steps, {self.bodies:,} bodies, "
            f"worst error {self.worst_error:.3g}{doubts}>"
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
