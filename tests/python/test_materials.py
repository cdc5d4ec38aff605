"""Materials with values from the literature."""

import dataclasses

import pytest

import skerry as sk


def test_named_materials_are_records_with_sources():
    silicone = sk.materials["silicone_ecoflex_30"]
    assert isinstance(silicone, sk.Material)
    assert silicone.young_modulus == pytest.approx(118e3, rel=0.01)
    assert silicone.density == 1070
    assert len(sk.materials) >= 25
    for name in sk.materials:
        assert {"young_modulus", "poisson_ratio", "density"} <= set(sk.materials.sources(name))
    assert "friction" in sk.materials.sources("steel")
    assert sk.materials["steel"].friction == 0.57


def test_frictions_of_pairs_have_sources_and_make_pairs_of_a_world():
    pairs = sk.materials.frictions()
    assert all(pair.first in sk.materials and pair.second in sk.materials and pair.source for pair in pairs)
    assert any(pair.first == pair.second == "steel" and pair.dynamic_friction == 0.57 for pair in pairs)
    pair = next(pair for pair in pairs if pair.first != pair.second)
    world = sk.World()
    first, second = world.add_material(sk.materials[pair.first]), world.add_material(sk.materials[pair.second])
    surface = sk.Surface(static_friction=pair.static_friction, dynamic_friction=pair.dynamic_friction)
    world.set_pair(first, second, surface)
    assert world.pair(second, first) == surface


def test_a_named_material_makes_a_collider():
    world = sk.World()
    plane = world.add_collider(sk.Plane(), material=sk.materials["steel"])
    body = world.add_body(sk.Mesh.box((0.1, 0.1, 0.1), (1, 1, 1)), sk.materials["steel"])
    assert plane.material == body.material and len(world.materials) == 1
    with pytest.raises(TypeError, match="material: found 'steel', expected a Material or a MaterialHandle"):
        world.add_collider(sk.Plane(), material="steel")


def test_a_named_material_makes_a_body():
    world = sk.World()
    slippery = dataclasses.replace(sk.materials["ice"], friction=0.01)
    body = world.add_body(sk.Mesh.box((0.1, 0.1, 0.1), (1, 1, 1)), slippery)
    assert body.material.settings == slippery


def test_moduli_of_rubber_as_papers_give_them():
    both = sk.mooney_rivlin(3e4, 1e4, 4e6, sk.Material(density=950.0))
    assert both.model == "ogden"
    assert both.density == 950
    assert both.terms == ((0.75, 2.0), (0.25, -2.0))
    world = sk.World()
    body = world.add_body(sk.Mesh.box((0.1, 0.1, 0.1), (1, 1, 1)), both)
    assert body.material.settings == both
    three = sk.ogden([(6.3e5, 1.3), (1.2e3, 5), (-1e4, -2)], 1e7)
    assert sum(share for share, _ in three.terms) == pytest.approx(1)
    with pytest.raises(sk.SceneError, match="of the same sign"):
        sk.ogden([(-1e5, 2)], 1e6)
    with pytest.raises(sk.SceneError, match="up to three pairs"):
        world.add_material(model="ogden", terms=((0.25, 1.0),) * 4)


def test_orthotropic_constants() -> None:
    moduli = sk.OrthotropicModuli(
        young_modulus=(2e6, 1e5, 5e4),
        poisson_ratio=(0.3, 0.35, 0.25),
        shear_modulus=(6e4, 2e4, 4e4),
        first_axis=(0, 0, 1),
    )
    wood = sk.orthotropic(moduli, sk.Material(density=500.0))
    assert wood.model == "orthotropic" and wood.density == 500 and wood.orthotropic == moduli
    world = sk.World()
    body = world.add_body(sk.Mesh.box((0.1, 0.1, 0.1), (1, 1, 1)), wood)
    assert body.material.settings == wood
    with pytest.raises(sk.SceneError, match=r"poisson_ratio\[0\]: found 9"):
        sk.orthotropic(sk.OrthotropicModuli(poisson_ratio=(9, 0.3, 0.3)))
    with pytest.raises(sk.SceneError, match="orthotropic: found no elastic constants"):
        world.add_material(model="orthotropic", young_modulus=1e9)


def test_an_unknown_name_is_refused_with_the_names():
    with pytest.raises(KeyError, match="found 'stel', expected one of the names .*steel"):
        sk.materials["stel"]
    with pytest.raises(KeyError, match="'stel'"):
        sk.materials.sources("stel")
    assert "stel" not in sk.materials


def test_a_material_yields_and_a_body_keeps_its_dent():
    clay = sk.Material(young_modulus=1e6, model="hencky", plasticity=sk.Plasticity(yield_stress=1e4, hardening=1e4))
    world = sk.World(gravity=(0, 0, 0))
    body = world.add_body(sk.Mesh.box((0.1, 0.1, 0.1), (1, 1, 1)), clay)
    assert body.material.settings == clay
    assert not body.plastic_strain().any()
    body.positions = body.positions * (1.3, 0.9, 0.9)
    assert body.plastic_strain().min() > 0.2
    world.advance(0.01)
    assert world.report().plastic_work > 0
    with pytest.raises(sk.SceneError, match="model: found stable_neo_hookean, expected hencky"):
        world.add_material(plasticity=sk.Plasticity(yield_stress=1.0))
