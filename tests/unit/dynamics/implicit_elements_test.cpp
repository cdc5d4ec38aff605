// Implicit elements and their matrices against dense textbook matrices (docs/methods/clusters.md 2, 3).
#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <random>

#include "systems/dynamics/checks/check_state.h"
#include "systems/dynamics/clusters/build_clusters.h"
#include "systems/dynamics/clusters/find_implicit_elements.h"
#include "systems/dynamics/clusters/implicit_elements.h"
#include "systems/dynamics/clusters/stiffen_clusters.h"
#include "systems/dynamics/stability/mass_forms.h"
#include "systems/dynamics/stability/stable_step.h"
#include "systems/dynamics/stability/stiffness_share.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/elastic_body.h"
#include "tests/support/jittered_box.h"
#include "tests/support/sliver_box.h"

namespace skerry::test::implicit_elements_test {

namespace {

using Matrix = Eigen::MatrixXd;
constexpr Real anything = std::numeric_limits<Real>::infinity();  // no limit on the moment

/// A box with slivers. Its implicit elements are found for a step at which the explicit box would be unstable.
struct SliverBox {
    test::ElasticBody body;
    std::vector<Range> body_blocks;
    std::vector<Real> stiffness_sum, cluster_step;
    Real plain_step;
    ImplicitShare share;
    NodeClusters clusters;

    SliverBox(MaterialModel model, ElementKind kind, Real longer,
              const Mesh& mesh = test::sliver_box(0.2, 4, 0.05, 0.01))
        : body({mesh.nodes, mesh.tetrahedra}, material_constants(model, 1e5, 0.4, 1000), Mat3::Identity(), kind),
          body_blocks{body.blocks},
          stiffness_sum(body.position.size()),
          plain_step(stable_step(body.inputs(), body.blocks, body.position, body.mass, stiffness_sum).step) {
        cluster_step = {longer * plain_step};
        share = search().find({cluster_step[0], cluster_step[0], 4, anything});
        build();
    }
    ImplicitSearch search() {
        return {body.inputs(), body.blocks,   body.position,
                body.mass,     stiffness_sum, {body.elements.mass_share, body.elements.implicit_modulus}};
    }
    void build() {
        build_clusters(body.inputs(),
                       {body_blocks, cluster_step, body.elements.implicit_modulus, body.mass, body.inverse_mass},
                       clusters);
    }
    /// Present stable step of the explicit elements [s].
    Real explicit_step() {
        return stable_step(body.inputs(), body.blocks, body.position, body.mass, stiffness_sum).step;
    }
    /// Inertia matrix A over all nodes, by its definition.
    Matrix inertia() const {
        const auto n = static_cast<Eigen::Index>(body.position.size());
        Matrix A = Matrix::Zero(n, n);
        for (Eigen::Index i = 0; i < n; ++i) A(i, i) = body.mass[static_cast<std::size_t>(i)];
        const Real beta = std::pow(cluster_step[0] / 1.8, 2);
        for (std::size_t e = 0; e < element_lanes * body.elements.first.size(); ++e) {
            const Real modulus = body.elements.implicit_modulus[e / element_lanes][e % element_lanes];
            for (std::size_t k = 0; k < body.node_count(e) && modulus > 0; ++k)
                for (std::size_t j = 0; j < body.node_count(e); ++j)
                    A(static_cast<Eigen::Index>(body.node(e, k)), static_cast<Eigen::Index>(body.node(e, j))) +=
                        beta * modulus * body.volume(e) * body.gradient(e, k).dot(body.gradient(e, j));
        }
        return A;
    }
    /// Inverse of A by node and component, from the inverse matrices of clusters and the masses of all other nodes.
    Matrix inverse_inertia() const {
        const auto n = static_cast<Eigen::Index>(body.position.size());
        Matrix inverse = Matrix::Zero(n, n);
        for (Index i = 0; i < static_cast<Index>(n); ++i) {
            const Index cluster = clusters.cluster(i);
            if (cluster == no_index) {
                inverse(i, i) = body.inverse_mass[static_cast<std::size_t>(i)];
                continue;
            }
            const std::span<const Index> nodes = clusters.nodes[static_cast<std::size_t>(cluster)];
            const std::span<const Real> row =
                clusters.row(cluster, clusters.index_in_cluster[static_cast<std::size_t>(i)]);
            for (std::size_t k = 0; k < nodes.size(); ++k) inverse(i, nodes[k]) = row[k];
        }
        return inverse;
    }
    /// K at rest by differences of the forces, which are linear there to 1e-6.
    Matrix stiffness() {
        const auto executor = make_executor(Backend::serial, 1);
        const auto n = static_cast<Eigen::Index>(body.position.size());
        Matrix K(3 * n, 3 * n);
        constexpr Real way = 1e-7;
        const std::vector<Vec3> rest = body.position;
        for (Eigen::Index i = 0; i < 3 * n; ++i) {
            Real& x = body.position[static_cast<std::size_t>(i / 3)][i % 3];
            const Real at = x;
            std::vector<Vec3> force[2];
            for (const int side : {0, 1}) {
                x = at + (side == 0 ? -way : way);
                body.compute_forces(*executor);
                force[side] = body.force;
            }
            x = at;
            for (Eigen::Index k = 0; k < 3 * n; ++k)
                K(k, i) = (force[0][static_cast<std::size_t>(k / 3)][k % 3] -
                           force[1][static_cast<std::size_t>(k / 3)][k % 3]) /
                          (2 * way);
        }
        return (K + K.transpose()) / 2;
    }
};

Matrix by_component(const Matrix& by_node) {
    Matrix all = Matrix::Zero(3 * by_node.rows(), 3 * by_node.cols());
    for (Eigen::Index i = 0; i < by_node.rows(); ++i)
        for (Eigen::Index k = 0; k < by_node.cols(); ++k)
            for (Eigen::Index c = 0; c < 3; ++c) all(3 * i + c, 3 * k + c) = by_node(i, k);
    return all;
}

}  // namespace

TEST_CASE("with clusters the exact highest frequency is stable at the step", "[unit][clusters][long]") {
    const auto kind = GENERATE(ElementKind::linear, ElementKind::edge_smoothed, ElementKind::edge_node_smoothed);
    const auto model = GENERATE(MaterialModel::corotational, MaterialModel::stable_neo_hookean);
    INFO(name_of(kind) << ", " << name_of(model));
    SliverBox box(model, kind, 2);
    REQUIRE_FALSE(box.share.too_many);
    REQUIRE_FALSE(box.clusters.empty());
    const Real step = std::min(box.explicit_step(), box.cluster_step[0]);
    CHECK(step > 1.99 * box.plain_step);
    const Matrix K = box.stiffness();
    const Real highest = symmetric_eigenvalues(K, by_component(box.inertia())).maxCoeff();
    CHECK(step * std::sqrt(highest) <= 1.8);
    // purpose of the clusters: with plain masses the frequency is higher
    const Matrix M = by_component(
        Matrix(Eigen::Map<const Eigen::VectorXd>(box.body.mass.data(), static_cast<Eigen::Index>(box.body.mass.size()))
                   .asDiagonal()));
    const Real of_masses = symmetric_eigenvalues(K, M).maxCoeff();
    CHECK(highest < of_masses);
}

TEST_CASE("mass forms without implicit elements lengthen the step, within the exact limit", "[unit][clusters]") {
    const auto kind = GENERATE(ElementKind::edge_smoothed, ElementKind::edge_node_smoothed);
    const auto model = GENERATE(MaterialModel::corotational, MaterialModel::stable_neo_hookean);
    INFO(name_of(kind) << ", " << name_of(model));
    SliverBox box(model, kind, 2);
    REQUIRE_FALSE(box.clusters.empty());
    const Real by_shares = box.explicit_step();
    ElementInputs inputs = box.body.inputs();
    inputs.implicit_modulus = box.body.elements.implicit_modulus;
    find_mass_forms(inputs, box.body.blocks, box.body.position, box.body.mass, products_of_group,
                    box.body.elements.mass_form);
    const Real by_forms = box.explicit_step();
    CHECK(by_forms > 1.15 * by_shares);
    box.cluster_step[0] = by_forms;
    const Matrix K = box.stiffness();
    const Real highest = symmetric_eigenvalues(K, by_component(box.inertia())).maxCoeff();
    CHECK(by_forms * std::sqrt(highest) <= 1.8);
    CHECK(by_forms * std::sqrt(highest) > 1.2);
}

TEST_CASE("clusters have the inverse of the inertia that implicit elements add", "[unit][clusters]") {
    const SliverBox box(MaterialModel::stable_neo_hookean, ElementKind::edge_node_smoothed, 3);
    const Matrix product = box.inertia() * box.inverse_inertia();
    CHECK((product - Matrix::Identity(product.rows(), product.cols())).cwiseAbs().maxCoeff() < 1e-10);
}

TEST_CASE("an element that stiffens raises its part of the inverse, with the needed stiffness", "[unit][clusters]") {
    SliverBox box(MaterialModel::stable_neo_hookean, ElementKind::edge_node_smoothed, 3);
    const Column<ElementLane> before = box.body.elements.implicit_modulus;
    const std::vector<std::uint8_t> asleep{0}, resting{1};
    std::mt19937_64 random(4);
    for (Vec3& v : box.body.velocity) v = test::random_vector(random);
    const auto stiffen = [&](const std::vector<std::uint8_t>& rest) {
        return stiffen_all_clusters(
            box.body.inputs(),
            {box.body_blocks, box.cluster_step, rest, box.body.position, box.body.velocity, box.body.inverse_mass},
            {box.body.elements.implicit_modulus, box.clusters});
    };
    const auto kinetic = [&] {
        const Matrix A = box.inertia();
        Real energy = 0;
        for (Eigen::Index c = 0; c < 3; ++c) {
            Eigen::VectorXd v(A.rows());
            for (Eigen::Index i = 0; i < A.rows(); ++i) v[i] = box.body.velocity[static_cast<std::size_t>(i)][c];
            energy += v.dot(A * v) / 2;
        }
        return energy;
    };
    CHECK(stiffen(asleep) == 0);  // at rest the moduli are sufficient
    CHECK(box.body.elements.implicit_modulus[0][0] == before[0][0]);
    // stretched to 2.5 times in one direction: the law's Hessian grows with the square
    for (Vec3& x : box.body.position) x.z() *= 2.5;
    CHECK(worst_stiffening(box.body.inputs(), box.body.blocks, box.body.position, box.body.elements.implicit_modulus) >
          1);
    CHECK(stiffen(resting) == 0);
    const Real energy = kinetic();
    const Real booked = stiffen(asleep);
    int raised = 0;
    for (std::size_t b = 0; b < before.size(); ++b)
        for (std::size_t l = 0; l < element_lanes; ++l) {
            const Real now = box.body.elements.implicit_modulus[b][l];
            CHECK(now >= before[b][l]);
            raised += now > before[b][l];
        }
    CHECK(raised > 5);
    CHECK(worst_stiffening(box.body.inputs(), box.body.blocks, box.body.position, box.body.elements.implicit_modulus) <
          0.95);
    CHECK(booked == Approx(kinetic() - energy).epsilon(1e-9));
    for (std::size_t c = 0; c < box.clusters.size(); ++c)
        for (Index i = 0; i < static_cast<Index>(box.clusters.nodes[c].size()); ++i)
            for (Index j = 0; j < i; ++j)  // the matrix is symmetric
                CHECK(box.clusters.row(static_cast<Index>(c), i)[static_cast<std::size_t>(j)] ==
                      box.clusters.row(static_cast<Index>(c), j)[static_cast<std::size_t>(i)]);
    const Matrix product = box.inertia() * box.inverse_inertia();
    CHECK((product - Matrix::Identity(product.rows(), product.cols())).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("few elements are implicit but those that need the most", "[unit][clusters]") {
    SliverBox box(MaterialModel::stable_neo_hookean, ElementKind::edge_node_smoothed, 3,
                  test::sliver_box(0.2, 6, 0.02, 0.005));
    REQUIRE_FALSE(box.share.too_many);
    CHECK(std::min(box.explicit_step(), box.cluster_step[0]) > 2.999 * box.plain_step);
    int implicit = 0;
    for (const ElementLane& modulus : box.body.elements.implicit_modulus)
        for (std::size_t l = 0; l < element_lanes; ++l) implicit += modulus[l] > 0;
    // of 2,197 elements. Giving up the elements with the shortest step instead takes 73 and a moment of 0.01.
    CHECK(implicit < 30);
    CHECK(box.share.moment < 0.003);
}

namespace {

/// Plain version of the search in docs/methods/clusters.md 3, without state carried from step to step.
class SimpleSearch {
public:
    SimpleSearch(SliverBox& box, Real step) : box_(box), in_(box.body.inputs()), step_(step), own_(in_.blocks()) {
        start_mass_shares(in_, box.body.blocks, box.body.elements.mass_share);
        LaneQuaternion<Real8> q{Real8{} + 1.0, {}, {}, {}};
        for (std::size_t b = 0; b < in_.blocks(); ++b) {
            const LaneMat3<Real8> F = deformation_of(in_, b, box.body.position);
            const Real8 bound = frequency_squared_of(in_, b, F, box.body.mass, {}, q);
            for (std::size_t l = 0; l < element_lanes; ++l) need_.push_back(bound[l] * step * step / (1.8 * 1.8));
        }
        for_each_element([&](std::size_t e) {
            if (need_[e] > 1) this->share(e) = 0;
        });
        for (int round = 1;; ++round) {
            find_steps(round % 24 == 1 || all_stand());
            if (all_stand() && exact_) break;
            if (all_stand()) continue;
            if (round % 4 == 0) give_up();
            for_each_element(
                [&](std::size_t e) { this->share(e) *= std::clamp(step_ / own(e), Real(1) / 4, Real(4)); });
        }
    }

private:
    void for_each_element(auto&& visit) const {
        for (std::size_t e = 0; e < element_lanes * in_.blocks(); ++e)
            if (in_.volume[e / element_lanes][e % element_lanes] > 0) visit(e);
    }
    void for_each_node(std::size_t e, auto&& visit) const {
        const BlockNodes of = in_.nodes_of(e / element_lanes);
        const std::size_t l = e % element_lanes;
        for (Index k = 0; k < of.count; ++k) {
            const Vec3 g(of.gradient[k][0][l], of.gradient[k][1][l], of.gradient[k][2][l]);
            if (!g.isZero(0)) visit(static_cast<std::size_t>(of.node[k][l]), g.squaredNorm());
        }
    }
    Real& share(std::size_t e) { return box_.body.elements.mass_share[e / element_lanes][e % element_lanes]; }
    Real& own(std::size_t e) { return own_[e / element_lanes][e % element_lanes]; }
    bool all_stand() {
        Real shortest = anything;
        for_each_element([&](std::size_t e) { shortest = std::min(shortest, own(e)); });
        return started_ && shortest >= step_;
    }
    /// sum_k S_k/m_k over the nodes k of an element, divided by its share.
    Real trace(std::size_t e) {
        Real sum = 0;
        for_each_node(e, [&](std::size_t n, Real) { sum += box_.stiffness_sum[n] / box_.body.mass[n]; });
        return share(e) > 0 ? sum / share(e) : 1;
    }
    void find_steps(bool exact) {
        started_ = true;
        exact_ = exact;
        if (exact) {
            element_steps(in_, box_.body.blocks, box_.body.position, box_.body.mass, box_.stiffness_sum, own_);
            measured_ = own_;
            trace_.assign(need_.size(), 1);
            for_each_element([&](std::size_t e) { trace_[e] = trace(e); });
            return;
        }
        std::ranges::fill(box_.stiffness_sum, Real(0));
        for_each_element([&](std::size_t e) {
            const std::size_t b = e / element_lanes, l = e % element_lanes;
            Lanes<Real, element_lanes> weight;
            store(stiffness_weight(in_, b, deformation_of(in_, b, box_.body.position)), weight);
            for_each_node(e, [&](std::size_t n, Real size) { box_.stiffness_sum[n] += weight[l] * size; });
        });
        for_each_element([&](std::size_t e) {
            own(e) = measured_[e / element_lanes][e % element_lanes] * std::sqrt(trace_[e] / trace(e));
        });
    }
    void give_up() {
        std::vector<bool> starved(box_.body.position.size()), in_cluster(starved.size());
        std::vector<std::size_t> given;
        for_each_element([&](std::size_t e) {
            for_each_node(e, [&](std::size_t n, Real) {
                if (share(e) == 0)
                    in_cluster[n] = true;
                else if (own(e) < step_)
                    starved[n] = true;
            });
        });
        for_each_element([&](std::size_t e) {
            bool beside = false, inside = true;
            for_each_node(e, [&](std::size_t n, Real) {
                beside = beside || starved[n];
                inside = inside && in_cluster[n];
            });
            if (share(e) > 0 && beside && (need_[e] >= least_need_ || inside)) given.push_back(e);
        });
        for (const std::size_t e : given) share(e) = 0;
        if (given.empty()) least_need_ *= 0.7;
    }

    SliverBox& box_;
    const ElementInputs in_;
    Real step_;
    std::vector<ElementLane> own_, measured_;
    std::vector<Real> need_, trace_;
    Real least_need_ = 1;
    bool exact_ = false, started_ = false;
};

}  // namespace

TEST_CASE("the search gives up the same elements as a simple one, however many steps were tried before",
          "[unit][clusters]") {
    const auto kind = GENERATE(ElementKind::linear, ElementKind::edge_node_smoothed);
    const auto model = GENERATE(MaterialModel::corotational, MaterialModel::stable_neo_hookean);
    INFO(name_of(kind) << ", " << name_of(model));
    SliverBox box(model, kind, 2), other(model, kind, 2);
    ImplicitSearch search = box.search();
    for (const Real longer : {8.0, 2.0, 4.0}) {
        ImplicitGoal goal{longer * box.plain_step, longer * box.plain_step, 4, anything};
        const ImplicitShare found = search.find(goal);
        if (found.too_many) continue;
        SimpleSearch(other, longer * box.plain_step);
        for (std::size_t b = 0; b < box.body.inputs().blocks(); ++b)
            for (std::size_t l = 0; l < element_lanes; ++l) {
                const Real share = box.body.elements.mass_share[b][l];
                CHECK(share == Approx(other.body.elements.mass_share[b][l]).epsilon(1e-9));
                CHECK((box.body.elements.implicit_modulus[b][l] > 0) == (share == 0));
            }
        CHECK(std::min(box.explicit_step(), longer * box.plain_step) == longer * box.plain_step);
        // A search that exceeds the moment limit stops early. A limit equal to the result does not change the result.
        REQUIRE(found.moment > 0);
        goal.max_moment = 0.99 * found.moment;
        CHECK(search.find(goal).moment > goal.max_moment);
        goal.max_moment = found.moment;
        CHECK(search.find(goal).moment == found.moment);
        // The limit on the nodes of a cluster acts likewise.
        test::ElasticBody& of = box.body;
        goal.inverse_mass = of.inverse_mass;
        goal.max_nodes = cluster_sizes(of.inputs(), of.blocks, of.elements.implicit_modulus, of.inverse_mass).largest;
        CHECK(!search.find(goal).too_many);
        --goal.max_nodes;
        CHECK(search.find(goal).too_many);
    }
}

TEST_CASE("the volume that must be implicit is small for slivers, and large in an even mesh", "[unit][clusters]") {
    SliverBox even(MaterialModel::stable_neo_hookean, ElementKind::edge_node_smoothed, 2, test::mirrored_box(0.2, 6));
    CHECK(even.search().estimate_volume(even.plain_step / 4) == 0);
    CHECK(even.search().estimate_volume(2 * even.plain_step) > 0.15);
    SliverBox slivers(MaterialModel::stable_neo_hookean, ElementKind::edge_node_smoothed, 2,
                      test::sliver_box(0.2, 6, 0.02, 0.005));
    CHECK(slivers.search().estimate_volume(2 * slivers.plain_step) < 0.05);
}

TEST_CASE("masses at the nodes add to a moment of inertia as the square of an edge", "[unit][clusters]") {
    const auto of = [](const test::TetMesh& mesh) {
        const test::ElasticBody body(mesh, material_constants(MaterialModel::linear, 1e5, 0.4, 1000));
        return moment_of_lumping(body.tetrahedra.node, body.tetrahedra.volume, body.position);
    };
    // One tetrahedron about its centre: lumping gives sum x x^T/4 instead of sum x x^T/20, a fifth of it.
    CHECK(of({{{1, 2, 3}, {2, 2, 3}, {1, 4, 3}, {1, 2, 6}}, {{0, 1, 2, 3}}}) == Approx(4));
    const auto of_box = [&](int cells) {
        const Mesh box = test::mirrored_box(0.3, cells);
        return of({box.nodes, box.tetrahedra});
    };
    const Real coarse = of_box(4), fine = of_box(8);
    CHECK(coarse / fine == Approx(4).epsilon(0.01));
    // Each cell of an even box has masses at its corners: c^2/4 along each axis instead of c^2/12.
    CHECK(fine == Approx(2.0 / 64).epsilon(0.01));
    CHECK(moment_of_lumping({}, {}, {}) == 0);
}

TEST_CASE("tetrahedra have leeway that implicit elements cover", "[unit][clusters]") {
    Ragged<Index> covered;
    for (const Index at : {0, 2, 4, 6, 7}) covered.offset.push_back(at);
    for (const Index t : {0, 1, 1, 2, 2, 9, 9}) covered.item.push_back(t);
    std::vector<ElementLane> modulus(1), leeway(2);
    modulus[0][0] = modulus[0][1] = modulus[0][3] = 1e5;  // the third element (tetrahedra 2, 9) is explicit
    find_leeway(covered, modulus, implicit_leeway, leeway);
    for (std::size_t t = 0; t < 2 * element_lanes; ++t) {
        CAPTURE(t);
        CHECK(leeway[t / element_lanes][t % element_lanes] == (t < 3 || t == 9 ? implicit_leeway : 1));
    }
}

namespace {

/// Viscous forces of a box: forces of moving nodes minus forces of nodes at rest.
std::vector<Vec3> viscous_forces(SliverBox& box, std::vector<std::uint8_t>& viscous) {
    const auto executor = make_executor(Backend::serial, 1);
    ElementInputs inputs = box.body.inputs();
    std::vector<Real> time(inputs.blocks());
    find_viscous_times(box.body.elements.implicit_modulus, box.cluster_step[0], time);
    inputs.implicit_modulus = box.body.elements.implicit_modulus;
    std::vector<ElementViscousImpulse> impulse(inputs.blocks());
    viscous.assign(inputs.blocks(), 0);
    PatchForces patches = box.body.patch_forces();
    patches.viscous_impulse = impulse;
    patches.viscous = viscous;
    std::vector<Vec3> without;
    for (const bool with : {false, true}) {
        if (with) inputs.viscous_time = time;
        compute_element_forces(*executor, inputs, box.body.position, box.body.velocity, 1e-4,
                               box.body.elements.rotation,
                               {box.body.elements.rotation_next, box.body.elements.spring_strain_next}, patches);
        box.body.gather();
        if (!with) without = box.body.force;
    }
    std::vector<Vec3> added = box.body.force;
    for (std::size_t n = 0; n < added.size(); ++n) added[n] -= without[n];
    return added;
}

Real largest(const std::vector<Vec3>& of) {
    return std::ranges::max(of, {}, [](const Vec3& one) { return one.norm(); }).norm();
}

}  // namespace

TEST_CASE("implicit elements far from rest are viscous: they lose energy, no momentum, and as much as is stable",
          "[unit][clusters]") {
    const auto kind = GENERATE(ElementKind::linear, ElementKind::edge_node_smoothed);
    INFO(name_of(kind));
    SliverBox box(MaterialModel::stable_neo_hookean, kind, 3);
    const std::vector<Vec3> rest = box.body.position;
    std::mt19937_64 random(3);
    std::vector<std::uint8_t> viscous;
    for (Vec3& v : box.body.velocity) v = test::random_vector(random);
    CHECK(largest(viscous_forces(box, viscous)) == 0);
    CHECK(std::ranges::count(viscous, 1) == 0);

    for (std::size_t n = 0; n < rest.size(); ++n) box.body.position[n] = Vec3(4, 0.9, 0.8).asDiagonal() * rest[n];
    std::vector<Vec3> added = viscous_forces(box, viscous);
    CHECK(std::ranges::count(viscous, 1) > 0);
    Vec3 momentum = Vec3::Zero(), moment = Vec3::Zero();
    Real power = 0, sum = 0, allowed = 0;
    for (std::size_t n = 0; n < added.size(); ++n) {
        momentum += added[n];
        moment += box.body.position[n].cross(added[n]);
        power += added[n].dot(box.body.velocity[n]);
        sum += added[n].norm();
    }
    for (std::size_t e = 0; e < element_lanes * box.body.elements.first.size(); ++e) {
        const Real modulus = box.body.elements.implicit_modulus[e / element_lanes][e % element_lanes];
        if (!(modulus > 0)) continue;
        Mat3 rate = Mat3::Zero();
        for (std::size_t k = 0; k < box.body.node_count(e); ++k)
            rate += box.body.velocity[box.body.node(e, k)] * box.body.gradient(e, k).transpose();
        allowed += 0.1 * box.cluster_step[0] * modulus * box.body.volume(e) * rate.squaredNorm();
    }
    CHECK(power < 0);
    CHECK(-power < allowed);
    CHECK(momentum.norm() < 1e-12 * sum);
    CHECK(moment.norm() < 1e-12 * sum);
    const Vec3 spin(1, -2, 3);
    for (std::size_t n = 0; n < rest.size(); ++n) box.body.velocity[n] = spin.cross(box.body.position[n]);
    CHECK(largest(viscous_forces(box, viscous)) < 1e-9 * largest(added));
}

}  // namespace skerry::test::implicit_elements_test
