"""Types of keyword arguments that change single fields of a record."""

from typing import TypedDict

from .._arrays import VectorLike
from .._settings import (
    Backend,
    ContactRegions,
    Friction,
    Integrator,
    MaterialModel,
    OrthotropicModuli,
    Plasticity,
    SolverMethod,
    StartOverlaps,
)


class SettingsChanges(TypedDict, total=False):
    """Fields of Settings."""

    gravity: VectorLike
    step_size: float | None
    theta: float
    implicit_step: float
    integrator: Integrator
    clusters: bool
    backend: Backend
    threads: int
    contact_regions: ContactRegions
    method: SolverMethod
    friction: Friction
    tolerance: float
    max_iterations: int
    recovery_speed: float
    start_overlaps: StartOverlaps
    sleep: bool
    sleep_time: float
    continuous_collision: bool


class MaterialChanges(TypedDict, total=False):
    """Fields of Material."""

    young_modulus: float
    poisson_ratio: float
    density: float
    friction: float
    static_friction: float | None
    dynamic_friction: float | None
    restitution: float
    damping: float
    loss_factor: float | None
    bulk_viscosity: float
    model: MaterialModel
    terms: tuple[tuple[float, float], ...]
    orthotropic: OrthotropicModuli
    plasticity: Plasticity | None


class SurfaceChanges(TypedDict, total=False):
    """Fields of Surface."""

    friction: float | None
    static_friction: float | None
    dynamic_friction: float | None
    restitution: float | None


class SurfaceSetChanges(SurfaceChanges, total=False):
    """Values of a surface set."""

    friction_across: float | None
