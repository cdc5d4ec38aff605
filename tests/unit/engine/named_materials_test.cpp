// Materials with values from the literature.
#include "skerry/materials.h"

#include <catch2/catch.hpp>
#include <set>
#include <string>

#include "engine/scene/scene_plan.h"
#include "skerry/error.h"
#include "skerry/world.h"
#include "tests/unit/engine/scene_files.h"

namespace skerry::test::named_materials_test {

TEST_CASE("every named material can be used, and names a source of each value") {
    World world;
    std::set<std::string_view> names;
    for (const NamedMaterial& material : named_materials()) {
        INFO(material.name);
        CHECK(names.insert(material.name).second);
        CHECK(!material.title.empty());
        CHECK(!material.young_modulus.source.empty());
        CHECK(!material.poisson_ratio.source.empty());
        CHECK(!material.density.source.empty());
        const MaterialSettings settings = named_material(material.name);
        CHECK(settings.young_modulus == material.young_modulus.value);
        CHECK(settings.poisson_ratio == material.poisson_ratio.value);
        CHECK(settings.density == material.density.value);
        CHECK_NOTHROW(world.add_material(settings));
    }
    CHECK(names.size() >= 25);
    for (const KnownFriction& pair : known_frictions()) {
        CHECK(names.contains(pair.first));
        CHECK(names.contains(pair.second));
        CHECK(pair.static_friction >= pair.dynamic_friction);
        CHECK(!pair.source.empty());
    }
}

TEST_CASE("stiff named materials set no loss factor, which implicit bodies would refuse") {
    CHECK(!named_material("steel").loss_factor);
    CHECK(!named_material("aluminium").loss_factor);
    CHECK(named_material("rubber_natural").loss_factor == 0.1);
    CHECK(named_material("steel").friction == 0.57);
}

TEST_CASE("an unknown name of a material is refused with the names of all materials") {
    try {
        named_material("stel");
        FAIL();
    } catch (const SceneError& error) {
        CHECK(error.complaint().found == "the name \"stel\"");
        CHECK(error.complaint().expected.find("aluminium, steel") != std::string::npos);
    }
}

TEST_CASE("a material of a scene is like a named one, except for its other keys", "[unit]") {
    const TemporaryFolder folder;
    const auto planned = [&](const std::string& keys) {
        return plan_scene(folder.write("m.json", material_with(keys))).materials.at(0).second;
    };
    // The order of the keys in the file does not matter.
    const MaterialSettings made = planned(R"("rho": 5000, "like": "steel", "static_friction": 0.9,
                                             "dynamic_friction": 0.8)");
    const MaterialSettings steel = named_material("steel");
    CHECK(made.young_modulus == steel.young_modulus);
    CHECK(made.poisson_ratio == steel.poisson_ratio);
    CHECK(made.density == 5000);
    CHECK(made.dynamic_friction == 0.8);
    CHECK(planned(R"("like": "rubber_natural")").loss_factor == 0.1);
    CHECK_THROWS_WITH(planned(R"("like": "stel")"),
                      Catch::Contains("materials.rubber.like: found \"stel\", expected one of \"brain\"") &&
                          Catch::Contains("did you mean \"steel\""));
}

TEST_CASE("a scene gives the moduli of rubber as papers do", "[unit]") {
    const TemporaryFolder folder;
    const auto planned = [&](const std::string& keys) {
        return plan_scene(folder.write("m.json", material_with(keys))).materials.at(0).second;
    };
    const MaterialSettings both =
        planned(R"("mooney_rivlin": {"c10": 3e4, "c01": 1e4, "bulk_modulus": 4e6}, "like": "rubber_natural")");
    CHECK(both.model == MaterialModel::ogden);
    CHECK(both.terms == mooney_rivlin(3e4, 1e4, 4e6).terms);
    CHECK(both.young_modulus == mooney_rivlin(3e4, 1e4, 4e6).young_modulus);
    CHECK(both.density == 950);
    const MaterialSettings one =
        planned(R"("ogden": {"terms": [{"modulus": 6e5, "exponent": 1.3}], "bulk_modulus": 1e7})");
    CHECK(one.terms[0] == StretchTerm{1, 1.3});
    CHECK_THROWS_WITH(planned(R"("mooney_rivlin": {"c10": 3e4, "c01": 1e4, "bulk_modulus": 4e6}, "E": 1e5)"),
                      Catch::Contains("at most one of the keys \"ogden\", \"mooney_rivlin\", \"orthotropic\", \"E\""));
    CHECK_THROWS_WITH(planned(R"("ogden": {"terms": [{"modulus": 6e5, "exponent": -1.3}], "bulk_modulus": 1e7})"),
                      Catch::Contains("materials.rubber.ogden: ") && Catch::Contains("of the same sign"));
    CHECK_THROWS_WITH(planned(R"("ogden": {"terms": [], "bulk_modulus": 1e7})"), Catch::Contains("one to three terms"));
    CHECK_THROWS_WITH(planned(R"("mooney_rivlin": {"c10": 3e4, "bulk_modulus": 1e7})"),
                      Catch::Contains("no key \"c01\""));
}

TEST_CASE("a scene gives the law \"orthotropic\" with its elastic constants only", "[unit]") {
    const TemporaryFolder folder;
    const auto planned = [&](const std::string& keys) {
        return plan_scene(folder.write("m.json", material_with(keys))).materials.at(0).second;
    };
    const std::string constants =
        R"("orthotropic": {"young_modulus": [2e6, 1e6, 1e6], "poisson_ratio": [0.3, 0.3, 0.3],
                           "shear_modulus": [4e5, 4e5, 4e5]})";
    CHECK(planned(constants).model == MaterialModel::orthotropic);
    CHECK_THROWS_WITH(planned(R"("model": "orthotropic", "E": 1e9)"),
                      Catch::Contains("model: found \"orthotropic\", expected another constitutive law") &&
                          Catch::Contains("replace the key by \"orthotropic\""));
    CHECK_THROWS_WITH(planned(R"("model": "hencky", )" + constants), Catch::Contains("at most one"));
}

TEST_CASE("a scene gives the plasticity of a material, and named metals list their yield stress", "[unit]") {
    const TemporaryFolder folder;
    const auto planned = [&](const std::string& keys) {
        return plan_scene(folder.write("m.json", material_with(keys))).materials.at(0).second;
    };
    const MaterialSettings metal =
        planned(R"("model": "hencky", "plasticity": {"yield_stress": 1e6, "hardening": 2e6}, "like": "steel")");
    CHECK(metal.plasticity == Plasticity{1e6, 2e6});
    CHECK(metal.model == MaterialModel::hencky);
    CHECK(!named_material("steel").plasticity);
    CHECK_THROWS_WITH(planned(R"("model": "hencky", "plasticity": {"hardening": 2e6})"),
                      Catch::Contains("no key \"yield_stress\""));
    CHECK_THROWS_WITH(planned(R"("model": "hencky", "plasticity": {"yield_stress": 0})"),
                      Catch::Contains("yield_stress: found 0"));
    for (const NamedMaterial& material : named_materials())
        if (material.name == "aluminium") CHECK(material.yield_stress->value == 9.5e7);
}

}  // namespace skerry::test::named_materials_test
