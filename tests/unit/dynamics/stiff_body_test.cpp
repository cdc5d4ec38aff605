// Elasticity of implicit bodies against the forces of explicit bodies and against dense algebra
// (docs/methods/implicit_bodies.md 2, 3).
#include "systems/dynamics/implicit/stiff_body.h"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <numeric>

#include "tests/support/dense_algebra.h"
#include "tests/support/elastic_body.h"
#include "tests/support/element_kinds.h"
#include "tests/support/random.h"

namespace skerry::test::stiff_body_test {

using test::ElasticBody;
using test::jittered_box;

namespace {

MaterialConstants stiff_rubber() {
    return material_constants(MaterialModel::corotational, 1e6, 0.3, 1100);
}

StiffBody stiff_body_of(const ElasticBody& body) {
    return StiffBody(body.list, body.constants.span(), body.mass, body.position, body.mesh.tetrahedra,
                     body.tetrahedron_mass);
}

std::vector<Vec3> random_vectors(std::size_t count, Real size, unsigned seed) {
    test::Random random(seed);
    std::vector<Vec3> vectors(count);
    for (Vec3& v : vectors) v = size * random.vector();
    return vectors;
}

/// Reorders values from node order to place order.
std::vector<Vec3> in_places(const StiffBody& stiff, const std::vector<Vec3>& by_node) {
    std::vector<Vec3> placed(by_node.size());
    for (std::size_t n = 0; n < by_node.size(); ++n)
        placed[static_cast<std::size_t>(stiff.order_index(n))] = by_node[n];
    return placed;
}

/// A = inertia M + stiffness K, from the columns of K.
Eigen::MatrixXd dense_matrix(const StiffBody& stiff, Real inertia, Real stiffness) {
    const std::size_t n = stiff.size();
    Eigen::MatrixXd matrix(3 * n, 3 * n);
    for (std::size_t c = 0; c < 3 * n; ++c) {
        std::vector<Vec3> unit(n, Vec3::Zero()), force(n);
        unit[c / 3][static_cast<Eigen::Index>(c % 3)] = 1;
        stiff.elastic_forces(unit, force);
        for (std::size_t k = 0; k < n; ++k)
            matrix.block<3, 1>(static_cast<Eigen::Index>(3 * k), static_cast<Eigen::Index>(c)) = stiffness * force[k];
        matrix(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(c)) += inertia * stiff.mass(c / 3);
    }
    return matrix;
}

}  // namespace

TEST_CASE("the stiffness of an implicit body is that of the forces of its elements", "[dynamics][implicit]") {
    const auto kind = GENERATE(from_range(std::begin(test::element_kinds), std::end(test::element_kinds)));
    const auto executor = make_executor(Backend::serial, 1);
    ElasticBody body(jittered_box({2, 3, 2}, 0.1, 0.2, 1), stiff_rubber(), Mat3::Identity(), kind);
    const StiffBody stiff = stiff_body_of(body);
    const std::vector<Vec3> u = random_vectors(body.position.size(), 1e-7, 3);
    std::vector<Vec3> force(u.size());
    stiff.elastic_forces(in_places(stiff, u), force);

    const std::vector<Vec3> rest = body.position;
    const auto forces_at = [&](Real sign) {
        for (std::size_t n = 0; n < u.size(); ++n) body.position[n] = rest[n] + sign * u[n];
        body.compute_forces(*executor);
        return body.force;
    };
    const std::vector<Vec3> pulled = forces_at(1), pushed = forces_at(-1);
    Real size = 0, difference = 0;
    for (std::size_t n = 0; n < u.size(); ++n) {
        const Vec3 expected = (pushed[n] - pulled[n]) / 2,
                   found = force[static_cast<std::size_t>(stiff.order_index(n))];
        size += expected.squaredNorm();
        difference += (found - expected).squaredNorm();
    }
    CHECK(std::sqrt(difference / size) < 1e-6);
}

TEST_CASE("an implicit body answers impulses by A^-1, without rigid motion", "[dynamics][implicit]") {
    const ElasticBody body(jittered_box({3, 2, 2}, 0.1, 0.2, 2), stiff_rubber());
    StiffBody stiff = stiff_body_of(body);
    const auto h = GENERATE(1e-4, 1e-2);
    REQUIRE(stiff.prepare(1.2, h * h));
    const Eigen::MatrixXd matrix = dense_matrix(stiff, 1.2, h * h);
    const std::size_t n = stiff.size();
    std::vector<Vec3> impulse = random_vectors(n, 1, 5);
    // Momentum and angular momentum are removed first, so that A^-1 gives no rigid motion.
    std::vector<Vec3> velocity = impulse;
    stiff.respond(velocity);
    Eigen::VectorXd elastic(3 * n);
    for (std::size_t k = 0; k < n; ++k) elastic.segment<3>(static_cast<Eigen::Index>(3 * k)) = velocity[k];
    const Eigen::VectorXd given = matrix * elastic;  // elastic part of the impulse
    Vec3 momentum = Vec3::Zero(), sum = Vec3::Zero(), moment = Vec3::Zero();
    const std::vector<Vec3> position = in_places(stiff, body.position);
    Vec3 center = Vec3::Zero();
    Real mass = 0;
    for (std::size_t k = 0; k < n; ++k) {
        momentum += stiff.mass(k) * velocity[k];
        sum += given.segment<3>(static_cast<Eigen::Index>(3 * k));
        moment += position[k].cross(given.segment<3>(static_cast<Eigen::Index>(3 * k)));
        center += stiff.mass(k) * position[k];
        mass += stiff.mass(k);
    }
    center /= mass;
    CHECK(momentum.norm() < 1e-12);
    CHECK(sum.norm() < 1e-11);
    CHECK(moment.norm() < 1e-11);
    // The rest of the impulse is a rigid motion of the masses.
    Vec3 left = Vec3::Zero();
    std::vector<Vec3> rest(n);
    for (std::size_t k = 0; k < n; ++k) {
        rest[k] = (impulse[k] - given.segment<3>(static_cast<Eigen::Index>(3 * k))) / stiff.mass(k);
        left += stiff.mass(k) / mass * rest[k];
    }
    for (std::size_t k = 1; k < n; ++k) {
        const Vec3 arm = position[k] - position[0];
        CHECK(std::abs(arm.dot(rest[k] - rest[0])) < 1e-9 * arm.norm() * left.norm());
    }
}

TEST_CASE("columns are answers to unit impulses, kept or calculated again", "[dynamics][implicit]") {
    const ElasticBody body(jittered_box({2, 2, 2}, 0.1, 0.2, 2), stiff_rubber());
    StiffBody stiff = stiff_body_of(body);
    REQUIRE(stiff.prepare(1, 1e-4));
    const std::vector<Mat3> column(stiff.column(7).begin(), stiff.column(7).end());
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        std::vector<Vec3> impulse(stiff.size(), Vec3::Zero());
        impulse[static_cast<std::size_t>(stiff.order_index(7))][axis] = 1;
        stiff.respond(impulse);
        for (std::size_t k = 0; k < stiff.size(); ++k) CHECK((column[k].col(axis) - impulse[k]).norm() < 1e-15);
    }
    REQUIRE(stiff.prepare(1, 1e-6));
    CHECK(!std::ranges::equal(stiff.column(7), column));
    REQUIRE(stiff.prepare(1, 1e-4));
    CHECK(std::ranges::equal(stiff.column(7), column));
    // symmetric: the response at 3 to an impulse at 7 is the transpose of the response at 7 to one at 3
    const Mat3 there = stiff.column(7)[static_cast<std::size_t>(stiff.order_index(3))],
               back = stiff.column(3)[static_cast<std::size_t>(stiff.order_index(7))];
    CHECK((there - back.transpose()).norm() < 1e-12 * there.norm());
}

TEST_CASE("an implicit body that is held responds as the matrix of its free nodes alone", "[dynamics][implicit]") {
    const ElasticBody body(jittered_box({2, 1, 2}, 0.1, 0.2, 3), stiff_rubber());
    StiffBody stiff = stiff_body_of(body);
    std::vector<Real> inverse_mass(stiff.size(), 1);
    for (const std::size_t node : {2u, 5u, 6u, 11u}) inverse_mass[node] = 0;
    REQUIRE(stiff.prepare(1, 1e-4));
    stiff.hold(inverse_mass);
    CHECK(stiff.is_held());
    REQUIRE(stiff.prepare(1, 1e-4));
    const Eigen::MatrixXd matrix = dense_matrix(stiff, 1, 1e-4);
    std::vector<Eigen::Index> free;
    for (std::size_t n = 0; n < inverse_mass.size(); ++n)
        for (Eigen::Index i = 0; i < 3 && inverse_mass[n] > 0; ++i) free.push_back(3 * stiff.order_index(n) + i);
    std::vector<Vec3> impulse = in_places(stiff, random_vectors(stiff.size(), 1, 4));
    const Eigen::VectorXd given = Eigen::Map<const Eigen::VectorXd>(impulse.data()->data(), matrix.rows());
    Eigen::VectorXd expected = Eigen::VectorXd::Zero(matrix.rows());
    const Eigen::MatrixXd of_free = matrix(free, free);
    const Eigen::VectorXd on_free = given(free), response = solve_symmetric(of_free, on_free);
    expected(free) = response;
    stiff.respond(impulse);
    const Eigen::VectorXd found = Eigen::Map<const Eigen::VectorXd>(impulse.data()->data(), matrix.rows());
    CHECK((found - expected).norm() < 1e-12 * expected.norm());
    CHECK(std::ranges::all_of(stiff.column(5), [](const Mat3& of_node) { return of_node.isZero(0); }));
    // After its release the body equals one that was never held.
    stiff.hold(std::vector<Real>(stiff.size(), 1));
    REQUIRE(stiff.prepare(1, 1e-4));
    StiffBody never = stiff_body_of(body);
    REQUIRE(never.prepare(1, 1e-4));
    CHECK(std::ranges::equal(stiff.column(7), never.column(7)));
}

TEST_CASE("responses of touched nodes are the columns of those nodes, whatever was computed before",
          "[dynamics][implicit]") {
    const ElasticBody body(jittered_box({2, 2, 2}, 0.1, 0.2, 2), stiff_rubber());
    StiffBody stiff = stiff_body_of(body);
    constexpr Index first = 100;  // row of the body's first node
    const auto check = [&](const std::vector<Index>& nodes) {
        const std::span<const Real> found = stiff.responses(nodes, first);
        const std::size_t numbers = 3 * nodes.size();
        REQUIRE(found.size() == numbers * numbers);
        for (std::size_t from = 0; from < nodes.size(); ++from) {
            const std::span<const Mat3> column = stiff.column(static_cast<std::size_t>(nodes[from] - first));
            for (std::size_t to = 0; to < nodes.size(); ++to) {
                const Mat3& block =
                    column[static_cast<std::size_t>(stiff.order_index(static_cast<std::size_t>(nodes[to] - first)))];
                for (std::size_t c = 0; c < 3; ++c)
                    for (std::size_t r = 0; r < 3; ++r) {
                        const std::size_t at = (3 * from + c) * numbers + 3 * to + r,
                                          back = (3 * to + r) * numbers + 3 * from + c;
                        CHECK(std::abs(found[at] - block(static_cast<Index>(r), static_cast<Index>(c))) <=
                              1e-12 * block.norm());
                        CHECK(found[at] == found[back]);
                    }
            }
        }
    };
    REQUIRE(stiff.prepare(1, 1e-4));
    const std::vector<Index> some{first + 1, first + 7, first + 20}, others{first, first + 7},
        more{first, first + 1, first + 7, first + 26};
    for (const std::vector<Index>* nodes : {&some, &some, &others, &more, &some}) check(*nodes);
    REQUIRE(stiff.prepare(1, 1e-6));  // another factor: no old column may be used
    check(some);
    std::vector<Real> inverse_mass(stiff.size(), 1);
    for (const std::size_t node : {2u, 5u, 7u}) inverse_mass[node] = 0;
    stiff.hold(inverse_mass);
    REQUIRE(stiff.prepare(1, 1e-6));
    check(some);
}

TEST_CASE("columns of all nodes that a step touches are kept, however many", "[dynamics][implicit][long]") {
    const ElasticBody body(jittered_box({9, 9, 9}, 0.1, 0.2, 2), stiff_rubber());
    StiffBody stiff = stiff_body_of(body);
    const std::size_t count = stiff.size(), within_memory = StiffBody::column_memory / (count * sizeof(Mat3));
    REQUIRE(within_memory < count - 10);
    REQUIRE(stiff.prepare(1, 1e-4));
    std::vector<Index> most(within_memory + 5), others;
    std::iota(most.begin(), most.end(), Index{0});
    others = most;
    others.back() = static_cast<Index>(count - 1);
    stiff.responses(most, 0);
    CHECK(stiff.columns_made() == most.size());
    stiff.responses(others, 0);  // one more column, in the place of the unused one
    CHECK(stiff.columns_made() == most.size() + 1);
    stiff.responses(most, 0);
    CHECK(stiff.columns_made() == most.size() + 2);
}

TEST_CASE("a matrix that is not positive definite has no factor", "[dynamics][implicit]") {
    const ElasticBody body(jittered_box({1, 1, 1}, 0.1, 0, 1), stiff_rubber());
    StiffBody stiff = stiff_body_of(body);
    CHECK(!stiff.prepare(-1, 1e-4));
    CHECK(stiff.prepare(1, 1e-4));
}

}  // namespace skerry::test::stiff_body_test
