// Inversion barriers that keep small tetrahedra of smoothed elements from inverting (docs/methods/elasticity.md 7.7).
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>
#include <random>

#include "jobs/executor.h"
#include "systems/dynamics/clusters/arm_guards.h"
#include "systems/dynamics/clusters/implicit_elements.h"
#include "systems/dynamics/elements/element_energy.h"
#include "systems/dynamics/stability/mass_forms.h"
#include "systems/dynamics/stability/stable_step.h"
#include "systems/material/guard.h"
#include "systems/material/material_law.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/elastic_body.h"
#include "tests/support/knotted_box.h"
#include "tests/support/sliver_box.h"

namespace skerry::test::property_guards_test {

using test::TetMesh;

namespace {

const MaterialConstants rubber = material_constants(MaterialModel::stable_neo_hookean, 1e5, 0.4, 1000);
const MaterialConstants law = part_of(rubber, ElementPart::guard);

Mat3 random_gradient(std::mt19937_64& random, Real size) {
    Mat3 F;
    F << test::random_vector(random), test::random_vector(random), test::random_vector(random);
    return size * F + 0.5 * Mat3::Identity();
}

LaneMat3<Real8> everywhere(const Mat3& F) {
    const auto column = [&](Eigen::Index c) {
        return LaneVec3<Real8>{Real8{} + F(0, c), Real8{} + F(1, c), Real8{} + F(2, c)};
    };
    return {column(0), column(1), column(2)};
}

/// dP/dF by finite differences, as a 9x9 matrix.
Eigen::Matrix<Real, 9, 9> hessian(const Mat3& F) {
    constexpr Real step = 1e-6;
    Eigen::Matrix<Real, 9, 9> H;
    for (Eigen::Index i = 0; i < 9; ++i) {
        Mat3 up = F, down = F;
        up.data()[i] += step;
        down.data()[i] -= step;
        const Mat3 slope = (Guard::stress(law, up) - Guard::stress(law, down)) / (2 * step);
        H.col(i) = Eigen::Map<const Eigen::Matrix<Real, 9, 1>>(slope.data());
    }
    return H;
}

/// A box with knots. Almost all of its other tetrahedra are above the size bound.
TetMesh knotted() {
    return test::knotted_box(test::jittered_box({3, 3, 3}, 0.1, 0.1, 7), {40, 100});
}

std::vector<MaterialZone> zone_of(const TetMesh& mesh, ElementKind kind) {
    MaterialZone zone{0, kind, std::vector<Index>(mesh.tetrahedra.size())};
    std::iota(zone.tetrahedra.begin(), zone.tetrahedra.end(), 0);
    return {zone};
}

ElementList guards_of(const TetMesh& mesh, ElementKind kind = ElementKind::edge_node_smoothed) {
    ElementList list;
    add_guards({mesh.tetrahedra, mesh.nodes}, zone_of(mesh, kind), list);
    return list;
}

/// A body whose elements have inversion barriers, built as the world builds it.
struct GuardedBody : test::ElasticBody {
    std::vector<Real> viscous_time;

    explicit GuardedBody(const TetMesh& of)
        : ElasticBody(of, rubber, Mat3::Identity(), ElementKind::edge_node_smoothed) {
        add_guards({mesh.tetrahedra, mesh.nodes}, zone_of(mesh, ElementKind::edge_node_smoothed), list);
        elements = {};
        element_nodes = {};
        patches = {};
        const AppendedElements appended = append_elements(list, mesh.nodes, 0, 0, elements, element_nodes);
        blocks = appended.blocks;
        element_at = appended.element;
        start_mass_shares(inputs(), blocks, elements.mass_share);
        build_patches(elements, mesh.nodes.size(), element_nodes, patches);
        viscous_time.assign(elements.first.size(), 0);
    }

    bool is_guard(std::size_t element) const { return elements.part[element / element_lanes] == ElementPart::guard; }

    /// Makes those elements implicit for all of whose nodes `chained` returns true.
    template <class Chained>
    void make_implicit(Chained&& chained) {
        for (std::size_t e = 0; e < element_at.size(); ++e) {
            if (is_guard(e) || element_at[e] == no_index) continue;
            bool all = true;
            for (std::size_t k = 0; k < node_count(e); ++k)
                if (!gradient(e, k).isZero(0)) all &= chained(node(e, k));
            elements.implicit_modulus[e / element_lanes][e % element_lanes] = all ? 1e6 : 0;
        }
        arm_guards(inputs(), blocks, inverse_mass, {elements.implicit_modulus, elements.volume});
        find_viscous_times(elements.implicit_modulus, 1e-3, viscous_time);
    }

    /// Forces without viscosity: nothing moves.
    std::vector<Vec3> forces() {
        const auto executor = make_executor(Backend::serial, 1);
        ElementInputs now = inputs();
        now.implicit_modulus = elements.implicit_modulus;
        now.viscous_time = viscous_time;
        compute_element_forces(*executor, now, position, velocity, 1e-3, elements.rotation,
                               {elements.rotation_next, elements.spring_strain_next}, patch_forces());
        gather();
        return force;
    }
    std::size_t acting() const {
        std::size_t count = 0;
        for (std::size_t e = 0; e < element_at.size(); ++e) count += is_guard(e) && volume(e) > 0;
        return count;
    }
};

}  // namespace

TEST_CASE("the law of guards is nothing above half of the volume, and below it the slope of its energy", "[property]") {
    std::mt19937_64 random(3);
    int pressed = 0, mirrored = 0;
    for (int i = 0; i < 200; ++i) {
        const Mat3 F = random_gradient(random, i % 2 == 0 ? 0.3 : 1);
        const Real J = F.determinant();
        const Mat3 P = Guard::stress(law, F);
        if (J > Guard::barrier_ratio) {
            CHECK(Guard::energy_density(law, F) == 0);
            CHECK(P.isZero(0));
            CHECK(Guard::stiffness_bound(law, F) == 0);
            continue;
        }
        ++(J > 0 ? pressed : mirrored);
        Mat3 turn = Mat3::Zero();
        turn << test::random_vector(random), test::random_vector(random), test::random_vector(random);
        constexpr Real step = 1e-6;
        const Real slope =
            (Guard::energy_density(law, F + step * turn) - Guard::energy_density(law, F - step * turn)) / (2 * step);
        CHECK(P.cwiseProduct(turn).sum() ==
              Approx(slope).epsilon(1e-6).margin(1e-8 * law.lame_lambda * turn.norm() * (1 + F.squaredNorm())));
        CHECK((P * F.transpose() - F * P.transpose()).norm() <= 1e-12 * (P * F.transpose()).norm());  // no torque
        CHECK(P.cwiseProduct((F.inverse()).transpose()).sum() * J < 0);  // the force opens the element
    }
    CHECK(pressed > 20);
    CHECK(mirrored > 20);
}

TEST_CASE("the bounds on the stiffness of guards hold, and lanes are as the law", "[property]") {
    std::mt19937_64 random(4);
    for (int i = 0; i < 100; ++i) {
        const Mat3 F = random_gradient(random, i % 2 == 0 ? 0.3 : 1);
        const Real J = F.determinant();
        if (std::abs(J - Guard::barrier_ratio) < 1e-3) continue;  // the differences would cross the kink
        const Real bound = Guard::stiffness_bound(law, F);
        const SymmetricModes modes = symmetric_modes(hessian(F));
        const Real highest = modes.eigenvalues[8];
        CHECK(highest <= bound + 1e-4 * law.lame_lambda);
        CHECK(bound <= Guard::rough_stiffness_bound(law, F.squaredNorm(), J) * (1 + 1e-12));
        const LaneMat3<Real8> lanes = everywhere(F);
        CHECK(Guard::stiffness_bound(law, lanes)[3] == Approx(bound));
        CHECK(Guard::energy_density(law, lanes)[5] == Approx(Guard::energy_density(law, F)));
        const Mat3 P = Guard::stress(law, F);
        const LaneMat3<Real8> P_lanes = Guard::stress(law, lanes);
        CHECK(P_lanes.c0.y[2] == Approx(P(1, 0)).margin(1e-9 * P.norm()));
        CHECK(P_lanes.c2.x[7] == Approx(P(0, 2)).margin(1e-9 * P.norm()));
        // The tangent is the Hessian without its softening part.
        const Tangent tangent = Guard::tangent(law, F);
        CHECK(std::max({tangent.normal.norm(), tangent.flip.maxCoeff(), tangent.twist.maxCoeff()}) <=
              std::sqrt(Real(3)) * bound + 1e-9);
        const Mat3 X = random_gradient(random, 1), inside = tangent.left.transpose() * X * tangent.right;
        Real form = inside.diagonal().dot(tangent.normal * inside.diagonal());
        for (Eigen::Index k = 0; k < 3; ++k) {
            const Real there = inside((k + 1) % 3, (k + 2) % 3), back = inside((k + 2) % 3, (k + 1) % 3);
            form += tangent.flip[k] / 2 * (there + back) * (there + back) +
                    tangent.twist[k] / 2 * (there - back) * (there - back);
        }
        const Eigen::Matrix<Real, 9, 1> share =
            modes.eigenvectors.transpose() * Eigen::Map<const Eigen::Matrix<Real, 9, 1>>(X.data());
        CHECK(form == Approx(share.cwiseAbs2().dot(modes.eigenvalues.cwiseMax(0)))
                          .epsilon(1e-5)
                          .margin(1e-5 * law.lame_lambda * X.squaredNorm()));
    }
}

TEST_CASE("small tetrahedra of smoothed elements have guards, slivers and linear ones have none", "[property]") {
    const TetMesh mesh = knotted();
    const std::vector<std::uint8_t> sliver = sliver_tetrahedra({mesh.tetrahedra, mesh.nodes});
    Real mean = 0;
    for (const auto& t : mesh.tetrahedra) mean += test::volume_of(mesh, t) / static_cast<Real>(mesh.tetrahedra.size());
    std::vector<Index> expected;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        if (test::volume_of(mesh, mesh.tetrahedra[t]) < 0.5 * mean && sliver[t] == 0)
            expected.insert(expected.end(), mesh.tetrahedra[t].begin(), mesh.tetrahedra[t].end());
    const ElementList guards = guards_of(mesh);
    REQUIRE(guards.size() >= 10);
    CHECK(guards.node == expected);
    CHECK(std::ranges::count(guards.part, ElementPart::guard) == static_cast<std::ptrdiff_t>(guards.size()));
    CHECK(std::ranges::count(guards.volume, 0) == static_cast<std::ptrdiff_t>(guards.size()));
    CHECK(guards.tetrahedron.empty());
    CHECK(guards_of(mesh, ElementKind::linear).size() == 0);
    CHECK(guards_of(test::jittered_box({3, 3, 3}, 0.1, 0, 1)).size() == 0);
    const Mesh slivers = test::sliver_box(0.2, 6, 0.01, 0.005);
    const std::vector<std::uint8_t> flat = sliver_tetrahedra({slivers.tetrahedra, slivers.nodes});
    REQUIRE(std::ranges::count(flat, 1) > 5);
    CHECK(guards_of({slivers.nodes, slivers.tetrahedra}).size() < slivers.tetrahedra.size() / 4);
}

TEST_CASE("guards come after the elements of the body without them, and take no mass", "[property]") {
    const TetMesh mesh = knotted();
    const GuardedBody guarded(mesh);
    const test::ElasticBody plain(mesh, rubber, Mat3::Identity(), ElementKind::edge_node_smoothed);
    const std::size_t blocks = plain.elements.first.size();
    REQUIRE(guarded.elements.first.size() > blocks);
    for (std::size_t b = 0; b < blocks; ++b) {
        CHECK(guarded.elements.part[b] == plain.elements.part[b]);
        CHECK(std::ranges::equal(guarded.elements.volume[b].lane, plain.elements.volume[b].lane));
        CHECK(guarded.elements.first[b] == plain.elements.first[b]);
    }
    CHECK(guarded.elements.opens_patch[blocks] == 1);
    for (std::size_t b = blocks; b < guarded.elements.first.size(); ++b) {
        CHECK(guarded.elements.part[b] == ElementPart::guard);
        for (const Real share : guarded.elements.mass_share[b].lane) CHECK(share == 0);
        for (const Real volume : guarded.elements.volume[b].lane) CHECK(volume == 0);
    }
}

TEST_CASE("guards leave mass forms, found in groups or not, and the step of their body as they are, to the last bit",
          "[property]") {
    const TetMesh mesh = knotted();
    GuardedBody guarded(mesh);
    test::ElasticBody plain(mesh, rubber, Mat3::Identity(), ElementKind::edge_node_smoothed);
    for (const Real products : {1e9, 1e4, 1e2}) {
        std::vector<Real> step;
        for (test::ElasticBody* body : {&plain, static_cast<test::ElasticBody*>(&guarded)}) {
            std::vector<Real> sums(body->position.size());
            find_mass_forms(body->inputs(), body->blocks, body->position, body->mass, products,
                            body->elements.mass_form);
            step.push_back(stable_step(body->inputs(), body->blocks, body->position, body->mass, sums).step);
        }
        CHECK(step[0] > 0);
        CHECK(step[1] == step[0]);
        for (std::size_t b = 0; b < plain.elements.first.size(); ++b)
            for (std::size_t i = 0; i < 6; ++i)
                CHECK(std::ranges::equal(guarded.elements.mass_form[b][i].lane, plain.elements.mass_form[b][i].lane));
    }
    std::vector<Real> sums(mesh.nodes.size());
    find_mass_shares(plain.inputs(), plain.blocks, plain.position, plain.mass, sums, plain.elements.mass_share);
    find_mass_shares(guarded.inputs(), guarded.blocks, guarded.position, guarded.mass, sums,
                     guarded.elements.mass_share);
    for (std::size_t b = 0; b < plain.elements.first.size(); ++b)
        CHECK(std::ranges::equal(guarded.elements.mass_share[b].lane, plain.elements.mass_share[b].lane));
}

TEST_CASE("guards act where one cluster has all of their moving corners", "[property]") {
    const TetMesh mesh = knotted();
    GuardedBody body(mesh);
    CHECK(body.acting() == 0);
    const std::size_t all = guards_of(mesh).size();
    body.make_implicit([](std::size_t) { return true; });
    CHECK(body.acting() == all);
    // Half of the body is in a cluster. A held corner need not be in it.
    const auto left = [&](std::size_t n) { return mesh.nodes[n].x() < 0.16; };
    body.inverse_mass[body.mesh.nodes.size() - 1] = 0;
    body.make_implicit(left);
    std::size_t expected = 0;
    for (std::size_t e = 0; e < body.element_at.size(); ++e) {
        if (!body.is_guard(e) || body.element_at[e] == no_index) continue;
        bool inside = true;
        std::array<Vec3, 4> corner;
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t n = body.node(e, k);
            corner[k] = mesh.nodes[n];
            bool chained = false;  // true if the node belongs to an implicit element, whose nodes are all on the left
            for (std::size_t other = 0; other < body.element_at.size(); ++other) {
                if (body.is_guard(other) ||
                    !(body.elements.implicit_modulus[other / element_lanes][other % element_lanes] > 0))
                    continue;
                for (std::size_t j = 0; j < body.node_count(other); ++j)
                    chained |= body.node(other, j) == n && !body.gradient(other, j).isZero(0);
            }
            inside &= chained || body.inverse_mass[n] == 0;
        }
        const Real volume =
            std::abs((corner[1] - corner[0]).cross(corner[2] - corner[0]).dot(corner[3] - corner[0])) / 6;
        CHECK(body.volume(e) == Approx(inside ? volume : 0));
        CHECK((body.elements.implicit_modulus[e / element_lanes][e % element_lanes] > 0) == inside);
        expected += inside;
    }
    CHECK(expected > 0);
    CHECK(expected < all);
    CHECK(body.acting() == expected);
    // An acting barrier keeps the modulus that it has reached, and is released together with the cluster.
    for (std::size_t b = 0; b < body.elements.first.size(); ++b)
        for (Real& m : body.elements.implicit_modulus[b].lane) m *= 1e3;
    const Column<ElementLane> raised = body.elements.implicit_modulus;
    arm_guards(body.inputs(), body.blocks, body.inverse_mass, {body.elements.implicit_modulus, body.elements.volume});
    for (std::size_t b = 0; b < raised.size(); ++b)
        CHECK(std::ranges::equal(raised[b].lane, body.elements.implicit_modulus[b].lane));
    body.make_implicit([](std::size_t) { return false; });
    CHECK(body.acting() == 0);
}

TEST_CASE("while small tetrahedra are intact guards change no bit of a force; crushed ones are pushed open",
          "[property]") {
    const TetMesh mesh = knotted();
    GuardedBody idle(mesh), acting(mesh);
    acting.make_implicit([](std::size_t) { return true; });
    std::mt19937_64 random(8);
    std::vector<Vec3> moved;
    for (const Vec3& x : mesh.nodes) moved.push_back(Vec3(1.2 * x.x(), 0.8 * x.y(), x.z() + 0.1 * x.x()));
    idle.position = acting.position = moved;
    CHECK(idle.forces() == acting.forces());
    CHECK(elastic_energy(acting.inputs(), acting.blocks, acting.position) ==
          elastic_energy(idle.inputs(), idle.blocks, idle.position));
    // The inside of a knot is pressed flat.
    const ElementList guards = guards_of(mesh);
    for (const Index n : std::span(guards.node).first(4)) moved[static_cast<std::size_t>(n)].z() *= 1.001;
    for (std::size_t n = 0; n < moved.size(); ++n)
        if (std::ranges::find(guards.node, static_cast<Index>(n)) != guards.node.end())
            moved[n] += 0.02 * test::random_vector(random);
    idle.position = acting.position = moved;
    const std::vector<Vec3> force = acting.forces(), without = idle.forces();
    Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
    Real size = 0;
    for (std::size_t n = 0; n < force.size(); ++n) {
        sum += force[n] - without[n];
        torque += moved[n].cross(force[n] - without[n]);
        size += (force[n] - without[n]).norm();
    }
    REQUIRE(size > 0.1);
    CHECK(sum.norm() <= 1e-10 * size);
    CHECK(torque.norm() <= 1e-10 * size);
    const auto energy = [&](const std::vector<Vec3>& at) { return elastic_energy(acting.inputs(), acting.blocks, at); };
    constexpr Real step = 1e-7;
    for (const Index n : std::span(guards.node).first(8))
        for (Eigen::Index i = 0; i < 3; ++i) {
            std::vector<Vec3> up = moved, down = moved;
            up[static_cast<std::size_t>(n)][i] += step;
            down[static_cast<std::size_t>(n)][i] -= step;
            CHECK(force[static_cast<std::size_t>(n)][i] ==
                  Approx(-(energy(up) - energy(down)) / (2 * step)).epsilon(1e-4).margin(1e-4 * size));
        }
    // After the release nothing remains of the barriers' effect.
    acting.make_implicit([](std::size_t) { return false; });
    CHECK(acting.forces() == without);
}

}  // namespace skerry::test::property_guards_test
