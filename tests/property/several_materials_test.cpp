// A body of several materials: no element spans two materials (docs/methods/elasticity.md 7.6).
#include <catch2/catch.hpp>
#include <set>

#include "jobs/executor.h"
#include "systems/dynamics/elements/element_energy.h"
#include "systems/dynamics/stability/mass_forms.h"
#include "tests/support/elastic_body.h"
#include "tests/support/element_kinds.h"
#include "tests/support/exact_frequency.h"

namespace skerry::test::several_materials_test {

using test::ElasticBody;
using test::jittered_box;

namespace {

constexpr Real cell = 0.1;  // [m]

MaterialConstants soft(MaterialModel model = MaterialModel::stable_neo_hookean) {
    return material_constants(model, 1e4, 0.4, 500);
}

MaterialConstants stiff(MaterialModel model = MaterialModel::stable_neo_hookean) {
    return material_constants(model, 1e6, 0.3, 2000);
}

/// Material of each tetrahedron by its centroid: 0 below the plane y = middle, 1 above.
std::vector<Index> layers_of(const test::TetMesh& mesh, Real middle) {
    std::vector<Index> layer;
    for (const auto& t : mesh.tetrahedra) {
        Real y = 0;
        for (const Index n : t) y += mesh.nodes[static_cast<std::size_t>(n)].y() / 4;
        layer.push_back(y > middle ? 1 : 0);
    }
    return layer;
}

ElasticBody layered(const test::TetMesh& mesh, const std::vector<MaterialConstants>& materials, ElementKind kind) {
    return {mesh, materials, layers_of(mesh, 1.5 * cell), Mat3::Identity(), kind};
}

std::vector<Vec3> forces(ElasticBody& body) {
    const auto executor = make_executor(Backend::serial, 1);
    body.compute_forces(*executor);
    return body.force;
}

}  // namespace

TEST_CASE("no element covers tetrahedra of two materials, and each material is covered once", "[property]") {
    const test::TetMesh mesh = jittered_box({4, 3, 3}, cell, 0.2, 1);
    const std::vector<Index> layer = layers_of(mesh, 1.5 * cell);
    for (const ElementKind kind : test::element_kinds) {
        INFO(name_of(kind));
        const ElasticBody body = layered(mesh, {soft(), stiff()}, kind);
        std::array<Real, 2> whole{}, shear{}, volume{};
        for (std::size_t t = 0; t < layer.size(); ++t)
            whole[static_cast<std::size_t>(layer[t])] += volume_of(mesh, mesh.tetrahedra[t]);
        for (std::size_t place = 0; place < body.element_at.size(); ++place) {
            if (body.element_at[place] == no_index) continue;
            const auto e = static_cast<std::size_t>(body.element_at[place]);
            const std::size_t block = place / element_lanes;
            const auto material = static_cast<std::size_t>(body.elements.material[block]);
            for (std::size_t i = body.list.first_tetrahedron[e]; i < body.list.first_tetrahedron[e + 1]; ++i)
                CHECK(layer[static_cast<std::size_t>(body.list.tetrahedron[i])] == static_cast<Index>(material));
            if (body.elements.part[block] != ElementPart::volume) shear[material] += body.volume(place);
            if (body.elements.part[block] != ElementPart::shear) volume[material] += body.volume(place);
        }
        for (std::size_t m = 0; m < 2; ++m) {
            CHECK(shear[m] == Approx(whole[m]).epsilon(1e-13));
            CHECK(volume[m] == Approx(whole[m]).epsilon(1e-13));
        }
    }
}

TEST_CASE("an edge or a node between two materials has an element of each", "[property]") {
    // Two tetrahedra with a common face: three edges and three nodes belong to both.
    const test::TetMesh mesh{{{0, 0, 0}, {cell, 0, 0}, {0, cell, 0}, {0, 0, cell}, {cell, cell, cell}},
                             {{0, 1, 2, 3}, {1, 2, 3, 4}}};
    REQUIRE(volume_of(mesh, mesh.tetrahedra[1]) > 0);
    const auto count = [&](ElementKind kind, Index second) {
        return ElasticBody(mesh, {soft(), stiff()}, {0, second}, Mat3::Identity(), kind).list.size();
    };
    CHECK(count(ElementKind::edge_smoothed, 0) == 9);
    CHECK(count(ElementKind::edge_smoothed, 1) == 12);
    CHECK(count(ElementKind::edge_node_smoothed, 0) == 9 + 5);
    CHECK(count(ElementKind::edge_node_smoothed, 1) == 12 + 8);
    CHECK(count(ElementKind::linear, 0) == count(ElementKind::linear, 1));
}

TEST_CASE("each zone has its own kind of element", "[property]") {
    const test::TetMesh mesh = jittered_box({2, 2, 2}, cell, 0, 1);
    std::vector<MaterialZone> zones{{5, ElementKind::edge_smoothed, {}}, {3, ElementKind::edge_node_smoothed, {}}};
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) zones[t % 2].tetrahedra.push_back(static_cast<Index>(t));
    const ElementList list = elements_of({mesh.tetrahedra, mesh.nodes}, zones);
    std::set<std::pair<Index, ElementPart>> found;
    for (std::size_t e = 0; e < list.size(); ++e) found.emplace(list.material[e], list.part[e]);
    CHECK(found == std::set<std::pair<Index, ElementPart>>{
                       {5, ElementPart::whole}, {3, ElementPart::shear}, {3, ElementPart::volume}});
}

TEST_CASE("where strain is the same everywhere all kinds give the forces of both materials", "[property]") {
    const test::TetMesh mesh = jittered_box({3, 3, 2}, cell, 0.25, 4);
    Mat3 F;
    F << 1.1, 0.05, -0.02, 0.08, 0.9, 0.1, 0, -0.06, 1.05;
    std::vector<Vec3> expected;
    for (const ElementKind kind : test::element_kinds) {
        ElasticBody body = layered(mesh, {soft(), stiff()}, kind);
        for (Vec3& x : body.position) x = F * x;
        const std::vector<Vec3> found = forces(body);
        if (expected.empty()) expected = found;  // forces of plain tetrahedra
        INFO(name_of(kind));
        Real size = 0;
        for (const Vec3& f : expected) size = std::max(size, f.norm());
        for (std::size_t n = 0; n < found.size(); ++n) CHECK((found[n] - expected[n]).norm() <= 1e-12 * size);
    }
}

TEST_CASE("forces of a layered body are minus the derivative of its energy, without a sum or a torque", "[property]") {
    for (const ElementKind kind : test::element_kinds) {
        INFO(name_of(kind));
        ElasticBody body =
            layered(jittered_box({3, 3, 2}, cell, 0.2, 5), {soft(), stiff(MaterialModel::corotational)}, kind);
        std::mt19937_64 random(6);
        for (Vec3& x : body.position) x += 0.1 * cell * test::random_vector(random);
        const std::vector<Vec3> force = forces(body), start = body.position;
        std::vector<Vec3> way;
        Real work = 0, size = 0;
        Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
        for (std::size_t n = 0; n < start.size(); ++n) {
            way.push_back(test::random_vector(random));
            work += force[n].dot(way[n]);
            size += force[n].norm();
            sum += force[n];
            torque += start[n].cross(force[n]);
        }
        const auto energy_at = [&](Real s) {
            for (std::size_t n = 0; n < start.size(); ++n) body.position[n] = start[n] + s * way[n];
            return elastic_energy(body.inputs(), body.blocks, body.position);
        };
        constexpr Real step = 1e-5;  // [m]
        const Real slope =
            (8 * (energy_at(step) - energy_at(-step)) - (energy_at(2 * step) - energy_at(-2 * step))) / (12 * step);
        CHECK(-slope == Approx(work).epsilon(1e-7));
        CHECK(sum.norm() <= 1e-13 * size);
        CHECK(torque.norm() <= 1e-13 * size);
    }
}

TEST_CASE("two names for one material: the same with tetrahedra, between them and the mean with smoothed elements",
          "[property]") {
    const test::TetMesh mesh = jittered_box({3, 3, 3}, cell, 0.25, 7);
    const MaterialConstants material = soft(MaterialModel::linear);
    ElasticBody linear(mesh, material, Mat3::Identity(), ElementKind::linear);
    ElasticBody linear_twice = layered(mesh, {material, material}, ElementKind::linear);
    CHECK(linear_twice.mass == linear.mass);
    std::mt19937_64 random(8);
    std::vector<Vec3> u(mesh.nodes.size());
    const auto twice_energy = [&](ElasticBody& body) {
        for (std::size_t n = 0; n < u.size(); ++n) body.position[n] = mesh.nodes[n] + u[n];
        return 2 * elastic_energy(body.inputs(), body.blocks, body.position);
    };
    for (const ElementKind kind : {ElementKind::edge_smoothed, ElementKind::edge_node_smoothed}) {
        INFO(name_of(kind));
        ElasticBody once(mesh, material, Mat3::Identity(), kind), twice = layered(mesh, {material, material}, kind);
        for (int trial = 0; trial < 100; ++trial) {
            for (Vec3& x : u) x = 0.01 * test::random_vector(random);
            const Real of_tetrahedra = twice_energy(linear), split = twice_energy(twice), whole = twice_energy(once);
            CHECK(twice_energy(linear_twice) == Approx(of_tetrahedra).epsilon(1e-13));
            CHECK(whole < split);
            CHECK(split < of_tetrahedra);
        }
    }
}

TEST_CASE("the stable step of a layered body is below its limit, and shares of mass come near it", "[property]") {
    struct Pair {
        MaterialModel below, above;
    };
    for (const auto& [below, above] : {Pair{MaterialModel::linear, MaterialModel::linear},
                                       {MaterialModel::stable_neo_hookean, MaterialModel::stable_neo_hookean},
                                       {MaterialModel::linear, MaterialModel::stable_neo_hookean},
                                       {MaterialModel::stable_neo_hookean, MaterialModel::corotational}})
        for (const ElementKind kind : test::element_kinds) {
            ElasticBody body = layered(jittered_box({4, 3, 3}, cell, 0.2, 9, 0.02), {soft(below), stiff(above)}, kind);
            const Real limit = test::exact_limit(body), before = test::stable_step_of(body);
            std::vector<Real> sums(body.position.size());
            find_mass_shares(body.inputs(), body.blocks, body.position, body.mass, sums,
                             body.elements.mass_share.span());
            const Real after = test::stable_step_of(body);
            INFO(name_of(kind) << ", " << name_of(below) << " below " << name_of(above) << ": " << before / limit
                               << ", shared " << after / limit);
            CHECK(before <= 0.9 * limit * (1 + 1e-6));  // 1e-6: error of the differences
            CHECK(after <= 0.9 * limit * (1 + 1e-6));
            CHECK(after >= 0.6 * 0.9 * limit);
            CHECK(after >= 0.99 * before);
            find_mass_forms(body.inputs(), body.blocks, body.position, body.mass, products_of_group,
                            body.elements.mass_form.span());
            const Real by_forms = test::stable_step_of(body);
            CHECK(by_forms <= 0.9 * limit * (1 + 1e-6));
            CHECK(by_forms >= 0.6 * 0.9 * limit);
        }
}

}  // namespace skerry::test::several_materials_test
