// Tetrahedra that smoothed elements would not see are linear ones among them (docs/methods/elasticity.md 7.7).
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>
#include <random>

#include "jobs/executor.h"
#include "systems/dynamics/elements/element_energy.h"
#include "tests/support/elastic_body.h"
#include "tests/support/exact_frequency.h"
#include "tests/support/knotted_box.h"
#include "tests/support/material_models.h"
#include "tests/support/sliver_box.h"

using namespace skerry;
using test::ElasticBody;
using test::jittered_box;
using test::knotted_box;
using test::TetMesh;

namespace {

constexpr Real cell = 0.1;  // m

TetMesh box_with_knots(std::uint64_t seed = 7) {
    return knotted_box(jittered_box({4, 4, 4}, cell, 0.25, seed), {100, 171, 222});
}

Real volume_of_all(const TetMesh& mesh) {
    return std::accumulate(mesh.tetrahedra.begin(), mesh.tetrahedra.end(), Real(0),
                           [&](Real sum, const auto& t) { return sum + test::volume_of(mesh, t); });
}

std::vector<std::uint8_t> tiny_of(const TetMesh& mesh) {
    return tiny_tetrahedra({mesh.tetrahedra, mesh.nodes});
}

ElasticBody body_of(const TetMesh& mesh, ElementKind kind = ElementKind::smoothed,
                    MaterialModel model = MaterialModel::stable_neo_hookean, Real nu = 0.4) {
    return {mesh, material_constants(model, 1e5, nu, 1000), Mat3::Identity(), kind};
}

}  // namespace

TEST_CASE("tiny tetrahedra are below a tenth of the mean volume, and all that are where they are few", "[property]") {
    const TetMesh mesh = box_with_knots();
    const std::vector<std::uint8_t> tiny = tiny_of(mesh), sliver = sliver_tetrahedra({mesh.tetrahedra, mesh.nodes});
    const Real all = volume_of_all(mesh), tenth = 0.1 * all / static_cast<Real>(mesh.tetrahedra.size());
    Real together = 0;
    std::size_t count = 0;
    for (std::size_t t = 0; t < tiny.size(); ++t) {
        const Real volume = test::volume_of(mesh, mesh.tetrahedra[t]);
        CHECK((tiny[t] != 0) == (volume < tenth && sliver[t] == 0));
        if (tiny[t] != 0) together += volume, ++count;
    }
    CHECK(together < 0.01 * all);
    CHECK(count >= 3 * 5);  // of each knot what is inside and what has a face of that
}

TEST_CASE("the fine half of a graded mesh is not tiny, and equal tetrahedra are so together", "[property]") {
    // A tenth of the extent has cells of a tenth: half of the tetrahedra, at a sixth of the mean volume; thinner ones
    // are below a tenth of it, and more than a hundredth of the volume.
    for (const Real thin : {0.1, 0.02}) {
        TetMesh mesh = jittered_box({10, 3, 3}, cell, 0, 1);
        for (Vec3& x : mesh.nodes) x.x() = x.x() < 0.55 ? thin * x.x() : x.x() - (1 - thin) * 0.5;
        const std::vector<std::uint8_t> tiny = tiny_of(mesh);
        CHECK(std::accumulate(tiny.begin(), tiny.end(), 0) == 0);
    }
    // A graded one: the finest of all, no part of a layer, a hundredth of the volume.
    TetMesh mesh = jittered_box({20, 3, 3}, cell, 0, 1);
    for (Vec3& x : mesh.nodes) x.x() = std::pow(x.x(), 4);
    const std::vector<std::uint8_t> tiny = tiny_of(mesh);
    Real together = 0;
    for (std::size_t t = 0; t < tiny.size(); ++t)
        if (tiny[t] != 0) together += test::volume_of(mesh, mesh.tetrahedra[t]);
    const int count = std::accumulate(tiny.begin(), tiny.end(), 0);
    CHECK(count > 0);
    CHECK(count % (3 * 3 * 6) == 0);  // whole layers
    CHECK(together <= 0.01 * volume_of_all(mesh));
    CHECK(together >= 0.0001 * volume_of_all(mesh));
}

TEST_CASE("slivers among large tetrahedra are not tiny ones: linear, they would be far stiffer", "[property]") {
    const Mesh box = test::sliver_box(0.2, 6, 0.01, 0.005);
    const TetMesh mesh{box.nodes, box.tetrahedra};
    const std::vector<std::uint8_t> sliver = sliver_tetrahedra({mesh.tetrahedra, mesh.nodes});
    CHECK(std::accumulate(sliver.begin(), sliver.end(), 0) > 5);
    const std::vector<std::uint8_t> tiny = tiny_of(mesh);
    CHECK(std::accumulate(tiny.begin(), tiny.end(), 0) == 0);
}

TEST_CASE("a mesh without tiny tetrahedra has the elements that it has without them, to the last bit", "[property]") {
    const TetMesh mesh = jittered_box({4, 3, 3}, cell, 0.25, 7);
    const ElasticBody parted = body_of(mesh), whole = body_of(mesh, ElementKind::edge_node_smoothed);
    CHECK(parted.list.node == whole.list.node);
    CHECK(parted.list.gradient == whole.list.gradient);
    CHECK(parted.list.volume == whole.list.volume);
    CHECK(parted.list.part == whole.list.part);
    CHECK(parted.list.tetrahedron == whole.list.tetrahedron);
}

TEST_CASE("a tiny tetrahedron is one linear element, and all others fill the rest once", "[property]") {
    const TetMesh mesh = box_with_knots();
    const std::vector<std::uint8_t> tiny = tiny_of(mesh);
    const ElasticBody body = body_of(mesh);
    std::vector<Real> shear(mesh.tetrahedra.size(), 0), volume = shear;  // that an element gives to each
    std::vector<int> linear(mesh.tetrahedra.size(), 0);
    const ElementList& list = body.list;
    for (std::size_t e = 0; e < list.size(); ++e) {
        const std::size_t first = list.first_tetrahedron[e], end = list.first_tetrahedron[e + 1];
        for (std::size_t i = first; i < end; ++i) {
            const auto t = static_cast<std::size_t>(list.tetrahedron[i]);
            const Real share = list.part[e] == ElementPart::whole   ? 1
                               : list.part[e] == ElementPart::shear ? 1. / 6
                                                                    : 0.25;
            if (list.part[e] != ElementPart::volume) shear[t] += share;
            if (list.part[e] != ElementPart::shear) volume[t] += share;
            CHECK((tiny[t] != 0) == (list.part[e] == ElementPart::whole));
            linear[t] += end - first == 1 && list.part[e] == ElementPart::whole;
        }
    }
    for (std::size_t t = 0; t < tiny.size(); ++t) {
        CHECK(shear[t] == Approx(1));
        CHECK(volume[t] == Approx(1));
        CHECK(linear[t] == tiny[t]);
    }
}

TEST_CASE("patch test with tiny tetrahedra", "[property]") {
    const auto executor = make_executor(Backend::serial, 1);
    Mat3 A;
    A << 1.1, 0.05, 0, 0.02, 0.95, 0.03, -0.04, 0, 1.2;
    for (const MaterialModel model : test::material_models) {
        ElasticBody body = body_of(box_with_knots(), ElementKind::smoothed, model);
        std::vector<bool> inside;
        for (std::size_t n = 0; n < body.position.size(); ++n) {
            const auto at = [&](Index stride) { return static_cast<Index>(n) / stride % 5 % 4 != 0; };
            inside.push_back(n >= 5 * 5 * 5 || (at(1) && at(5) && at(25)));  // knots come behind the box
            body.position[n] = A * body.position[n] + Vec3(1, 2, 3);
        }
        body.compute_forces(*executor);
        Real inner = 0, most = 0;
        for (std::size_t n = 0; n < body.position.size(); ++n) {
            most = std::max(most, body.force[n].norm());
            if (inside[n]) inner = std::max(inner, body.force[n].norm());
        }
        INFO(name_of(model));
        CHECK(inner <= 1e-12 * most);
        // all of the volume has the energy of that F
        const ElasticBody one = [&] {
            ElasticBody linear = body_of(box_with_knots(), ElementKind::linear, model);
            linear.position = body.position;
            return linear;
        }();
        CHECK(elastic_energy(body.inputs(), body.blocks, body.position) ==
              Approx(elastic_energy(one.inputs(), one.blocks, one.position)).epsilon(1e-10));
    }
}

TEST_CASE("the stable step of a body with tiny tetrahedra is below the limit, at rest and strained", "[property]") {
    for (const MaterialModel model : test::material_models)
        for (const Vec3& stretch : {Vec3(1, 1, 1), Vec3(1.6, 0.8, 0.8), Vec3(1, 1, 0.4)}) {
            ElasticBody body =
                body_of(knotted_box(jittered_box({3, 2, 2}, cell, 0.2, 3), {20, 41}), ElementKind::smoothed, model);
            REQUIRE(std::ranges::count(tiny_of(body.mesh), 1) > 5);
            std::mt19937_64 random(13);
            for (Vec3& x : body.position) x = stretch.cwiseProduct(x) + 0.001 * test::random_vector(random);
            const Real limit = test::exact_limit(body), step = test::stable_step_of(body);
            INFO(name_of(model) << " stretch " << stretch.transpose() << ": " << step / limit);
            CHECK(step <= 0.9 * limit * (1 + 1e-5));
            CHECK(step >= 0.2 * limit);
        }
}

TEST_CASE("tiny tetrahedra that are shaken turn inside out far less than where only smoothed elements see them",
          "[property]") {
    const TetMesh mesh = knotted_box(jittered_box({2, 2, 2}, cell, 0.2, 1), {20}, 0.15);
    const std::size_t first = 3 * 3 * 3;  // nodes of the knot
    const auto executor = make_executor(Backend::serial, 1);
    const Real step = 0.3 * test::stable_step_of(body_of(mesh));
    const auto inverted = [&](ElementKind kind) {  // tetrahedra times steps
        std::ptrdiff_t count = 0;
        for (unsigned seed = 1; seed <= 8; ++seed) {
            ElasticBody body = body_of(mesh, kind);
            std::mt19937_64 random(seed);
            std::vector<Vec3> velocity(body.position.size(), Vec3::Zero());
            for (std::size_t n = first; n < velocity.size(); ++n) velocity[n] = 4 * test::random_vector(random);  // m/s
            TetMesh now = mesh;
            for (int i = 0; i < 1000; ++i) {
                body.compute_forces(*executor);
                for (std::size_t n = 0; n < velocity.size(); ++n) {
                    velocity[n] += step / body.mass[n] * body.force[n];
                    body.position[n] += step * velocity[n];
                }
                now.nodes = body.position;
                count +=
                    std::ranges::count_if(mesh.tetrahedra, [&](const auto& t) { return test::volume_of(now, t) < 0; });
            }
        }
        return count;
    };
    const std::ptrdiff_t linear = inverted(ElementKind::smoothed), whole = inverted(ElementKind::edge_node_smoothed);
    CAPTURE(linear, whole);
    CHECK(whole > 200);
    CHECK(4 * linear < whole);
}
