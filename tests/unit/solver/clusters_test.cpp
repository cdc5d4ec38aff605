// Contacts on nodes that are coupled by one matrix (docs/methods/clusters.md 4).
#include <Eigen/Core>
#include <catch2/catch.hpp>

#include "tests/support/contact_scene.h"
#include "tests/support/dense_algebra.h"

namespace skerry::test::solver_clusters_test {

namespace {

/// Couples nodes first .. first + count - 1 of a scene by (M + L)^-1, where L is a chain of springs.
Eigen::MatrixXd couple(ContactScene& scene, Index first, Index count, Real stiffness) {
    NodeClusters& clusters = scene.clusters;
    clusters.cluster_of.resize(scene.inverse_mass.size(), no_index);
    clusters.index_in_cluster.resize(scene.inverse_mass.size(), no_index);
    if (clusters.nodes.offset.empty()) clusters.nodes.offset.push_back(0);
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(count, count);
    for (Index k = 0; k < count; ++k) {
        const Index n = first + k;
        clusters.cluster_of[n] = static_cast<Index>(clusters.size());
        clusters.index_in_cluster[n] = k;
        clusters.nodes.item.push_back(n);
        A(k, k) += 1 / scene.inverse_mass[static_cast<std::size_t>(n)];
        if (k == 0) continue;
        A(k, k) += stiffness;
        A(k - 1, k - 1) += stiffness;
        A(k, k - 1) -= stiffness;
        A(k - 1, k) -= stiffness;
    }
    clusters.nodes.offset.push_back(static_cast<Index>(clusters.nodes.item.size()));
    clusters.first_entry.push_back(clusters.inverse.size());
    clusters.body.push_back(0);
    const Eigen::MatrixXd inverse = inverse_of(A);
    for (Index i = 0; i < count; ++i)
        for (Index j = 0; j < count; ++j) clusters.inverse.push_back(inverse(std::max(i, j), std::min(i, j)));
    return A;
}

constexpr Real fall = -1;

}  // namespace

TEST_CASE("an impulse on a node of a cluster moves all of it", "[solver][clusters]") {
    ContactScene scene;
    for (int n = 0; n < 4; ++n) scene.add_node(0.5 + n, {0.1 * n, 0, fall});
    const Eigen::MatrixXd A = couple(scene, 0, 4, 3);
    scene.touch_floor(0, 0.3);
    const SolvedScene solved = scene.solve({.tolerance = 1e-12});
    REQUIRE(solved.regions.status[0] == RegionStatus::converged);
    CHECK(solved.velocity[0].z() == Approx(0).margin(1e-12));
    for (Index i = 0; i < 4; ++i) {
        Vec3 momentum = Vec3::Zero();  // A (v - v_free)
        for (Index k = 0; k < 4; ++k)
            momentum +=
                A(i, k) * (solved.velocity[static_cast<std::size_t>(k)] - scene.velocity[static_cast<std::size_t>(k)]);
        CHECK((momentum - (i == 0 ? solved.impulse[0] : Vec3(Vec3::Zero()))).norm() < 1e-12);
    }
}

TEST_CASE("contacts on one cluster are one region, and are solved together", "[solver][clusters]") {
    for (const SolverMethod method : {SolverMethod::automatic, SolverMethod::pgs, SolverMethod::newton}) {
        ContactScene scene;
        for (int n = 0; n < 6; ++n) scene.add_node(1, {0.4, 0.2 * n, fall - 0.1 * n});
        scene.add_node(1, {0, 0, fall});
        scene.add_node(1, {0, 0, fall});
        const Eigen::MatrixXd A = couple(scene, 0, 6, 20);
        for (const Index n : {0, 2, 5, 6}) scene.touch_floor(n, 0.2);
        scene.touch_node(3, 7, {0, 1, 1}, 0.4);
        const SolvedScene solved = scene.solve({.method = method, .tolerance = 1e-10, .max_iterations = 5000});
        REQUIRE(solved.regions.size() == 2);  // node 6 is a region by itself
        for (std::size_t r = 0; r < 2; ++r) CHECK(solved.regions.status[r] != RegionStatus::iteration_limit);
        for (std::size_t i = 0; i < scene.stencil.size(); ++i) {
            const Vec3 u = scene.relative_velocity(i, solved.velocity), &r = solved.impulse[i], &n = scene.normal[i];
            CHECK(u.dot(n) > -1e-8);
            CHECK(r.dot(n) * u.dot(n) < 1e-7);
            CHECK((r - r.dot(n) * n).norm() <= scene.static_friction[i] * r.dot(n) + 1e-9);
        }
        Vec3 given = Vec3::Zero(), gained = Vec3::Zero();
        for (const Vec3& r : {solved.impulse[0], solved.impulse[1], solved.impulse[2], solved.impulse[3]}) given += r;
        for (std::size_t n = 0; n < 8; ++n) gained += solved.velocity[n] - scene.velocity[n];
        CHECK((given - gained).norm() < 1e-10);  // the springs add no momentum
    }
}

TEST_CASE("regions beside a cluster keep their bits", "[solver][clusters]") {
    ContactScene scene;
    for (int n = 0; n < 12; ++n) scene.add_node(1, {0.2, 0.1 * n, fall});
    for (Index n = 0; n + 1 < 12; n += 2) scene.touch_node(n, n + 1, {0, 0.1, n % 4 == 0 ? 1.0 : -1.0}, 0.3);
    for (Index n = 0; n < 12; ++n) scene.touch_floor(n, 0.3);
    const SolvedScene plain = scene.solve();
    couple(scene, 4, 2, 5);
    const SolvedScene solved = scene.solve();
    REQUIRE(plain.regions.size() == solved.regions.size());
    for (std::size_t n = 0; n < 12; ++n)
        if (n != 4 && n != 5) CHECK(plain.velocity[n] == solved.velocity[n]);
    CHECK(plain.velocity[4] != solved.velocity[4]);
}

}  // namespace skerry::test::solver_clusters_test
