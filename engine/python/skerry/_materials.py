"""Materials with values from the literature."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from . import _core
from ._settings import Material, OrthotropicModuli


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownFriction:
    """Friction coefficients of two clean, dry surfaces.

    first: name of the first material.
    second: name of the second material.
    static_friction: coefficient of sticking contacts.
    dynamic_friction: coefficient of sliding contacts.
    source: citation.
    """

    first: str
    second: str
    static_friction: float
    dynamic_friction: float
    source: str


class NamedMaterials(Mapping[str, Material]):
    """Materials by name: materials["steel"] is a Material. list(materials) lists the names, sources() names the
    source of each value, and frictions() lists pairs of materials. A change:
    dataclasses.replace(materials["steel"], friction=0.2).
    """

    def __getitem__(self, name: str) -> Material:
        if name not in self._names():
            raise KeyError(f"found {name!r}, expected one of the names {', '.join(self)}")
        return Material(**_core.named_material(name))

    def __iter__(self) -> Iterator[str]:
        return iter(self._names())

    def __len__(self) -> int:
        return len(self._names())

    def sources(self, name: str) -> dict[str, str]:
        """Sources of the values of a material, by the fields of Material. Fields without a source have defaults.
        KeyError: no material has this name."""
        self[name]
        return dict(_core.material_sources(name))

    @staticmethod
    def frictions() -> list[KnownFriction]:
        """Friction coefficients of pairs of materials, for World.set_pair()."""
        return [KnownFriction(**values) for values in _core.known_frictions()]

    @staticmethod
    def _names() -> list[str]:
        return list(_core.material_names())


def ogden(terms: Sequence[tuple[float, float]], bulk_modulus: float, base: Material | None = None) -> Material:
    """Material with the law of Ogden for rubber, split into changes of shape and volume.

    terms: one to three pairs (modulus mu_p [Pa], exponent alpha_p), of the same sign.
    bulk_modulus: [Pa].
    base: gives density, friction and losses.
    SceneError: the values give no stable law."""
    return Material(**_core.ogden([*terms], bulk_modulus, base or Material()))


def mooney_rivlin(c10: float, c01: float, bulk_modulus: float, base: Material | None = None) -> Material:
    """Material with the law of Mooney and Rivlin: the law of Ogden with the exponents 2 and -2.

    c10, c01: moduli of the two invariants [Pa].
    bulk_modulus: [Pa].
    base: gives density, friction and losses.
    SceneError: the values give no stable law."""
    return Material(**_core.mooney_rivlin(c10, c01, bulk_modulus, base or Material()))


def orthotropic(moduli: OrthotropicModuli, base: Material | None = None) -> Material:
    """Material with orthotropic elasticity, for strains of some per cent at any rotation.

    base: gives density, friction and losses.
    SceneError: the stiffness is not positive definite."""
    return Material(**_core.orthotropic(moduli, base or Material()))


materials = NamedMaterials()
"""Materials with values from the literature."""
