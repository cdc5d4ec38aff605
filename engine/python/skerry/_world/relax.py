"""Static equilibrium."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .body import Body


@dataclass(frozen=True, slots=True, kw_only=True)
class RelaxReport:
    """Report of World.relax().

    converged: True if the world is now in equilibrium; if False, it did not change.
    load: share of the loads in the last equilibrium that was found; 1 if converged.
    residual: largest out-of-balance force of a body in the last step, relative to the sum of the magnitudes of the
        weights, loads and contact forces on its nodes.
    worst: the body with this force; None if no body can move.
    speed: largest speed of a node of this body in the last step [m/s].
    steps: number of steps.
    seconds: sum of the step lengths [s].
    message: reason why a step could not be completed; otherwise empty.
    """

    converged: bool
    load: float
    residual: float
    worst: Body | None
    speed: float
    steps: int
    seconds: float
    message: str
