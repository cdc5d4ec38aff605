// Fits from which fields at nodes are recovered (docs/methods/elasticity.md 7.9).
#include <catch2/catch.hpp>

#include "systems/dynamics/recovery/polynomial_fit.h"
#include "systems/dynamics/recovery/surface_search.h"
#include "systems/material/material_law.h"
#include "tests/support/jittered_box.h"
#include "tests/support/material_models.h"

namespace skerry::test::recover_nodes_test {

namespace {

using Two = Eigen::Matrix<Real, 1, 2>;

/// Two fields at a point, quadratic for curved = 1 and linear for curved = 0.
Two fields_at(const Vec3& x, Real curved) {
    return {2 - x.x() + 3 * x.y() + 0.5 * x.z() + curved * (x.x() * x.y() - 2 * x.z() * x.z()),
            -1 + 0.2 * x.x() + x.z() + curved * (0.7 * x.y() * x.z() + x.x() * x.x() - 0.3 * x.y() * x.y())};
}

template <int terms>
Two fitted(std::span<const Vec3> points, Real curved, int& rank) {
    std::vector<Real> factor;
    for (std::size_t i = 0; i < points.size(); ++i) factor.push_back(1 + 0.1 * static_cast<Real>(i));
    rank = find_fit_factors<terms>(points, factor);
    Two sum = Two::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) sum += factor[i] * fields_at(points[i], curved);
    return sum;
}

}  // namespace

TEST_CASE("a least-squares fit reproduces polynomials of its degree, also on one side of the point", "[property]") {
    std::mt19937_64 random(3);
    std::vector<Vec3> points;
    for (int i = 0; i < 25; ++i) points.push_back(random_vector(random) + Vec3(1.2, 0, 0));
    int rank = 0;
    CHECK((fitted<linear_terms>(points, 0, rank) - fields_at(Vec3::Zero(), 0)).norm() < 1e-11);
    CHECK(rank == linear_terms);
    CHECK((fitted<quadratic_terms>(points, 1, rank) - fields_at(Vec3::Zero(), 1)).norm() < 1e-11);
    CHECK(rank == quadratic_terms);
}

TEST_CASE("a fit to samples in two planes still reproduces linear fields", "[property]") {
    std::mt19937_64 random(4);
    std::vector<Vec3> points;
    for (int i = 0; i < 30; ++i) {
        points.push_back(random_vector(random));
        points.back().z() = i % 2;
    }
    int rank = 0;
    CHECK((fitted<quadratic_terms>(points, 0, rank) - fields_at(Vec3::Zero(), 0)).norm() < 1e-11);
    CHECK(rank == quadratic_terms - 1);  // z^2 equals z at all samples
    for (Vec3& x : points) x.z() = 0;
    fitted<linear_terms>(points, 0, rank);
    CHECK(rank == linear_terms - 1);
    CHECK(fitted<linear_terms>({}, 0, rank) == Two::Zero());
    CHECK(rank == 0);
}

TEST_CASE("the gradient at a curved surface is that of the body for a uniform deformation", "[property]") {
    // A dome of six triangles, at whose top node the surface bends by up to 25 degrees.
    std::vector<Vec3> rest{{0.02, -0.01, 0.05}};
    std::vector<std::array<Index, 3>> surface;
    std::vector<Index> around;
    std::mt19937_64 random(5);
    for (Index i = 0; i < 6; ++i) {
        const Real angle = 1.0 * i;
        rest.push_back(Vec3(std::cos(angle), std::sin(angle), -0.2) + 0.1 * random_vector(random));
        surface.push_back({0, i + 1, (i + 1) % 6 + 1});
        around.push_back(i);
    }
    Mat3 F;
    F << 1.1, 0.2, -0.1, 0.05, 0.9, 0.15, -0.1, 0.1, 1.05;
    std::vector<Vec3> position;
    for (const Vec3& x : rest) position.emplace_back(F * x + Vec3(1, 2, 3));
    const SurfaceAround dome = surface_around(surface, around, rest);
    REQUIRE(dome.smooth);
    std::vector<SurfaceTriangle> triangles;
    for (const std::array<Index, 3>& nodes : surface) triangles.push_back(surface_triangle(nodes, rest).value());
    const Mat3 stretch = surface_stretch(triangles, position);
    for (const MaterialModel model : material_models) {
        INFO(name_of(model));
        const MaterialConstants material = material_constants(model, 1e6, 0.45, 1000);
        const auto found =
            surface_gradient(material, dome, stretch, stress(material, F) * dome.normal, Vec3(dome.normal));
        REQUIRE(found);
        CHECK((*found - F).norm() < 1e-9);
    }
}

TEST_CASE("gradients of many nodes are those of single nodes and do not depend on the others", "[property]") {
    // Twelve nodes of flat surfaces in a body of each material, with known gradients.
    std::mt19937_64 random(6);
    std::vector<SurfaceAround> around;
    std::vector<SurfaceSearch> searches;
    std::vector<Mat3> exact;
    around.reserve(12 * std::size(material_models));
    for (const MaterialModel model : material_models) {
        const MaterialConstants material = material_constants(model, 1e6, 0.45, 1000);
        for (int i = 0; i < 12; ++i) {
            const std::vector<Vec3> rest{random_vector(random), random_vector(random), random_vector(random)};
            const std::vector<std::array<Index, 3>> surface{{0, 1, 2}};
            around.push_back(surface_around(surface, std::vector<Index>{0}, rest));
            Mat3 F = Mat3::Identity();
            for (int k = 0; k < 3; ++k) F.col(k) += 0.002 * i * random_vector(random);
            exact.push_back(F);
            std::vector<Vec3> position;
            for (const Vec3& x : rest) position.emplace_back(F * x);
            const std::vector<SurfaceTriangle> triangles{surface_triangle(surface[0], rest).value()};
            const Vec3& normal = around.back().normal;
            searches.push_back({material, &around.back(), surface_stretch(triangles, position),
                                stress(material, F) * normal,
                                (Mat3::Identity() + 0.9 * (F - Mat3::Identity())) * normal});
        }
    }
    const std::vector<std::optional<Mat3>> found = surface_gradients(searches);
    for (std::size_t i = 0; i < searches.size(); ++i) {
        INFO(name_of(searches[i].material.model) << ", node " << i);
        REQUIRE(found[i]);
        CHECK((*found[i] - exact[i]).norm() < 1e-10);
        CHECK(*surface_gradients(std::span(searches).subspan(i, 1)).front() == *found[i]);
    }
}

TEST_CASE("an edge of a box is no smooth surface", "[property]") {
    const std::vector<Vec3> rest{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, 0, -1}};
    const std::vector<std::array<Index, 3>> surface{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};
    const std::vector<Index> around{0, 1, 2, 3};
    const SurfaceAround edge = surface_around(surface, around, rest);
    CHECK_FALSE(edge.smooth);
    CHECK((edge.area - Vec3(0, -1, 1) / 3).norm() < 1e-15);
}

}  // namespace skerry::test::recover_nodes_test
