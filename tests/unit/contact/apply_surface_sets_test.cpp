#include "systems/contact/apply_surface_sets.h"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>

#include "systems/contact/tangent_frame.h"

namespace skerry::test::apply_surface_sets_test {

namespace {

const Vec3 normal = Vec3(0.3, -0.5, 0.8).normalized();
const TangentFrame frame = tangent_frame(normal);

FrictionShape shape(Real angle, Real across) {
    return {std::cos(angle) * frame.first + std::sin(angle) * frame.second, across};
}

Eigen::Matrix2d tensor(const Vec3& direction, Real along, Real across) {
    const Eigen::Vector2d t(direction.dot(frame.first), direction.dot(frame.second)), n(-t.y(), t.x());
    return along * t * t.transpose() + across * n * n.transpose();
}

Eigen::Matrix2d tensor(const MeanShape& mean) {
    if (mean.axis.across == 1) return mean.scale * Eigen::Matrix2d::Identity();
    return tensor(mean.axis.direction, mean.scale, mean.scale * mean.axis.across);
}

}  // namespace

TEST_CASE("the mean of two friction tensors is their geometric mean, in either order", "[contact][surface]") {
    for (const Real turn : {0.0, 0.4, 1.2, 1.5707963267948966})
        for (const Real across : {0.2, 0.7, 3.0}) {
            const FrictionShape a = shape(0.3, 0.4), b = shape(0.3 + turn, across);
            const Eigen::Matrix2d of_a = tensor(a.direction, 1, a.across), of_b = tensor(b.direction, 1, b.across);
            const Eigen::Matrix2d mean = tensor(mean_shape(a, b, normal));
            // The geometric mean G is the only positive solution of G A^-1 G = B.
            CHECK((mean * of_a.inverse() * mean - of_b).norm() < 1e-12);
            CHECK((mean - tensor(mean_shape(b, a, normal))).norm() < 1e-13);
            CHECK(mean_shape(a, b, normal).axis.across <= 1);
        }
}

TEST_CASE("friction without a direction halves the anisotropy in the logarithm", "[contact][surface]") {
    const MeanShape one = mean_shape(shape(0.3, 0.25), {}, normal);
    CHECK(one.scale == Approx(1));
    CHECK(one.axis.across == Approx(0.5));
    CHECK(one.axis.direction.cross(shape(0.3, 1).direction).norm() < 1e-12);
    const MeanShape same = mean_shape(shape(0.3, 4), shape(0.3, 4), normal);
    CHECK(same.scale == Approx(4));
    CHECK(same.axis.across == Approx(0.25));
    CHECK(mean_shape({}, {}, normal).axis.across == 1);
    // Two crossed tensors cancel each other's anisotropy.
    const MeanShape crossed = mean_shape(shape(0, 0.25), shape(1.5707963267948966, 0.25), normal);
    CHECK(crossed.axis.across == 1);
    CHECK(crossed.scale == Approx(0.5));
}

}  // namespace skerry::test::apply_surface_sets_test
