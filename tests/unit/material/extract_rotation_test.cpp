#include "systems/material/extract_rotation.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <limits>

#include "tests/support/jittered_box.h"

namespace skerry::test::extract_rotation_test {

namespace {

using Quaternion = std::array<Real, 4>;

Mat3 rotation_matrix_of(const Quaternion& q) {
    return Eigen::Quaternion<Real>(q[0], q[1], q[2], q[3]).toRotationMatrix();
}

struct Lanes8 {
    LaneMat3<Real8> F;
    LaneQuaternion<Real8> q;
    Real8 volume;
};

Lanes8 all_lanes(const Mat3& F, const Quaternion& q) {
    const auto all = [](Real x) { return Real8{} + x; };
    return {{{all(F(0, 0)), all(F(1, 0)), all(F(2, 0))},
             {all(F(0, 1)), all(F(1, 1)), all(F(2, 1))},
             {all(F(0, 2)), all(F(1, 2)), all(F(2, 2))}},
            {all(q[0]), all(q[1]), all(q[2]), all(q[3])},
            all(1)};
}

Mat3 random_rotation(std::mt19937_64& random, Real angle) {
    return Eigen::AngleAxis<Real>(angle, test::random_vector(random).normalized()).toRotationMatrix();
}

Mat3 symmetric(std::mt19937_64& random, Real size) {
    Mat3 a;
    a << test::random_vector(random), test::random_vector(random), test::random_vector(random);
    return Mat3::Identity() + size * 0.5 * (a + a.transpose());
}

constexpr Quaternion identity{1, 0, 0, 0};

}  // namespace

TEST_CASE("the frame is found from the identity whatever the rotation", "[unit]") {
    std::mt19937_64 random(1);
    for (int trial = 0; trial < 500; ++trial) {
        const Real angle = M_PI * trial / 499;  // up to half a turn, where the start is a saddle point
        const Mat3 R = random_rotation(random, angle), S = symmetric(random, 0.3);
        Lanes8 x = all_lanes(R * S, identity);
        extract_rotation(x.F, x.volume, x.q);
        INFO("angle " << angle);
        CHECK((lane_of(rotation_of(x.q), trial % element_lanes) - R).norm() <= 1e-13);
    }
}

TEST_CASE("two passes are enough from the frame of the last step", "[unit]") {
    std::mt19937_64 random(2);
    for (int trial = 0; trial < 200; ++trial) {
        const Mat3 R = random_rotation(random, 3.0), S = symmetric(random, 0.4);
        const Eigen::Quaternion<Real> before(random_rotation(random, 1e-2) * R);
        Lanes8 x = all_lanes(R * S, {before.w(), before.x(), before.y(), before.z()});
        Real8 trace;
        turn_towards(x.F, x.q, trace);
        turn_towards(x.F, x.q, trace);
        CHECK((lane_of(rotation_of(x.q), 0) - R).norm() <= 1e-13);
    }
}

TEST_CASE("the trace in the frame is known to rounding, without a product with it", "[unit]") {
    std::mt19937_64 random(6);
    for (int trial = 0; trial < 500; ++trial) {
        Mat3 F;
        if (trial % 2 == 0)
            F = random_rotation(random, 0.1) * symmetric(random, 0.4);
        else  // mirrored and strongly rotated F, some of which need the solver
            F << test::random_vector(random), test::random_vector(random), test::random_vector(random);
        Lanes8 x = all_lanes(F, identity);
        const Real8 trace = extract_rotation(x.F, x.volume, x.q);
        CHECK(std::abs(trace[2] - (lane_of(rotation_of(x.q), 2).transpose() * F).trace()) <= 1e-15 * 4 * F.norm());
    }
}

TEST_CASE("R^T F is symmetric with the frame found, mirrored elements included", "[unit]") {
    std::mt19937_64 random(3);
    for (int trial = 0; trial < 500; ++trial) {
        Mat3 F;
        F << test::random_vector(random), test::random_vector(random), test::random_vector(random);
        Lanes8 x = all_lanes(F, identity);
        extract_rotation(x.F, x.volume, x.q);
        const Mat3 R = lane_of(rotation_of(x.q), 5), S = R.transpose() * F;
        CHECK((S - S.transpose()).norm() <= 1e-12 * F.norm());
        CHECK((R.transpose() * R - Mat3::Identity()).norm() <= 1e-14);
        CHECK(R.determinant() > 0);
        // The maximum, not another stationary point: G = tr(S) I - S is not negative.
        const Vec3 axis = test::random_vector(random).normalized();
        CHECK(S.trace() - axis.dot(S * axis) >= -1e-12 * F.norm());
    }
}

TEST_CASE("the frame changes continuously while an element is pressed through itself", "[unit]") {
    // A slight shear keeps the smallest singular value's direction away from symmetry.
    Quaternion q = identity;
    Mat3 last = Mat3::Identity();
    for (Real height = 1; height > -0.8; height -= 1e-3) {
        Mat3 F = Vec3(1.1, 1, height).asDiagonal();
        F(0, 2) = 0.05;
        Lanes8 x = all_lanes(F, q);
        extract_rotation(x.F, x.volume, x.q);
        const Mat3 R = lane_of(rotation_of(x.q), 0);
        if (height < 1) CHECK((R - last).norm() <= 0.02);
        last = R;
        q = {x.q.w[0], x.q.x[0], x.q.y[0], x.q.z[0]};
    }
}

TEST_CASE("a collapsed element keeps the frame it had", "[unit]") {
    std::mt19937_64 random(4);
    const Eigen::Quaternion<Real> before(random_rotation(random, 1.0));
    const Quaternion start{before.w(), before.x(), before.y(), before.z()};
    CHECK(nearest_rotation(Mat3::Zero(), start) == start);
    // F maps to a line: all rotations about it are equally good, so none is made.
    const Vec3 axis = Vec3(1, 2, 3).normalized();
    const Mat3 line = before.toRotationMatrix() * axis * axis.transpose();
    CHECK((rotation_matrix_of(nearest_rotation(line, start)) - before.toRotationMatrix()).norm() <= 1e-12);
}

TEST_CASE("a frame that is not finite is never made", "[unit]") {
    Mat3 F = Mat3::Identity();
    F(1, 2) = std::numeric_limits<Real>::quiet_NaN();
    const Quaternion start{0.6, 0.8, 0, 0};
    CHECK(nearest_rotation(F, start) == start);
    Lanes8 x = all_lanes(F, start);
    extract_rotation(x.F, x.volume, x.q);
    CHECK(x.q.w[0] == 0.6);
    CHECK(x.q.x[7] == 0.8);
}

TEST_CASE("a lane without volume keeps its frame and costs the others nothing", "[unit]") {
    std::mt19937_64 random(5);
    const Mat3 R = random_rotation(random, 1e-3);
    Lanes8 x = all_lanes(R, identity);
    x.volume[3] = 0;
    for (Real8* part :
         {&x.F.c0.x, &x.F.c0.y, &x.F.c0.z, &x.F.c1.x, &x.F.c1.y, &x.F.c1.z, &x.F.c2.x, &x.F.c2.y, &x.F.c2.z})
        (*part)[3] = 0;
    extract_rotation(x.F, x.volume, x.q);
    CHECK((lane_of(rotation_of(x.q), 3) - Mat3::Identity()).norm() == 0);
    CHECK((lane_of(rotation_of(x.q), 2) - R).norm() <= 1e-14);
}

}  // namespace skerry::test::extract_rotation_test
