#include "systems/material/ogden.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <cstring>
#include <random>

#include "systems/material/material_law.h"
#include "tests/support/dense_algebra.h"
#include "tests/support/stress_slope.h"

namespace skerry::test::ogden_test {

namespace {

/// Rubber of Treloar as Ogden (1972) fits it, with this Poisson ratio.
MaterialConstants treloar(Real poisson_ratio) {
    const std::array<Real, 3> modulus{6.3e5, 1.2e3, -1e4}, exponent{1.3, 5, -2};
    Real twice_shear = 0;
    for (std::size_t p = 0; p < 3; ++p) twice_shear += modulus[p] * exponent[p];
    MaterialConstants material =
        material_constants(MaterialModel::ogden, twice_shear * (1 + poisson_ratio), poisson_ratio, 1000);
    for (std::size_t p = 0; p < 3; ++p) material.share[p] = modulus[p] * exponent[p] / twice_shear;
    material.exponent = exponent;
    return material;
}

/// Law of Mooney and Rivlin with c10 = 3e4 Pa and c01 = 1e4 Pa.
MaterialConstants mooney(Real poisson_ratio) {
    MaterialConstants material =
        material_constants(MaterialModel::ogden, 8e4 * 2 * (1 + poisson_ratio), poisson_ratio, 1000);
    material.share = {0.75, 0.25, 0};
    material.exponent = {2, -2, 2};
    return material;
}

/// Law of Hencky of a material that yields, so that its part `shear` resists no volume change.
MaterialConstants hencky(Real poisson_ratio) {
    MaterialConstants material = material_constants(MaterialModel::hencky, 2e5, poisson_ratio, 1000);
    material.yield_stress = 1e3;
    return material;
}

Mat3 random_turn(std::mt19937_64& random) {
    std::normal_distribution<Real> normal;
    return Eigen::Quaternion<Real>(normal(random), normal(random), normal(random), normal(random))
        .normalized()
        .toRotationMatrix();
}

/// Random F with the given stretches.
Mat3 turned(std::mt19937_64& random, const Vec3& stretch) {
    return random_turn(random) * stretch.asDiagonal() * random_turn(random);
}

const std::vector<Vec3> shapes{{1, 1, 1},        {1.2, 0.9, 0.95}, {3, 0.6, 0.55},     {0.5, 0.5, 0.5},
                               {2, 2, 0.25},     {1, 1, 0.15},     {1.3, 0.9, -0.6},   {4, 1, 0.01},
                               {2, 0.05, 0.04},  {1, 1, -1},       {1, 1 - 1e-6, 0.9}, {0.7, 0.7, 0.7 + 1e-9},
                               {1.1, 0.95, 0.9}, {5, 5, 0.04}};

/// True if a stretch or det F is so near to a limit that differences of the stress cross it, or if R jumps nearby.
bool near_kink(const Vec3& s) {
    const auto near = [](Real x, Real limit) { return std::abs(x - limit) < 1e-4; };
    return near(s.prod(), Ogden::least_volume) || near(s[2], Ogden::least_stretch) ||
           near(s[1], Ogden::least_stretch) || s[1] + s[2] < 0.1;
}

/// Collects the terms of add_stiffness as a dense matrix of the map from dF to dP.
class DenseTerms {
public:
    void add_identity(const Real8& s) { sum += s[0] * Matrix9::Identity(); }
    void add_dyad(const Real8& s, const LaneMat3<Real8>& X) {
        const Mat3 x = lane_of(X, 0);
        const Vector9 v = Eigen::Map<const Vector9>(x.data());
        sum += s[0] * v * v.transpose();
    }
    void add_turned_transpose(const Real8& s, const LaneMat3<Real8>& R) {
        const Mat3 r = lane_of(R, 0);
        add_map([&](const Mat3& X) { return Mat3(s[0] * r * X.transpose() * r); });
    }
    void add_cofactor_slope(const Real8& s, const LaneMat3<Real8>& F) {
        const Mat3 f = lane_of(F, 0);
        add_map([&](const Mat3& X) {
            Mat3 slope;
            for (Index c = 0; c < 3; ++c) {
                const Index d = (c + 1) % 3, e = (c + 2) % 3;
                slope.col(c) = X.col(d).cross(f.col(e)) + f.col(d).cross(X.col(e));
            }
            return Mat3(s[0] * slope);
        });
    }
    Matrix9 sum = Matrix9::Zero();

private:
    void add_map(auto&& map) {
        for (Index i = 0; i < 9; ++i) {
            Mat3 X = Mat3::Zero();
            X.data()[i] = 1;
            const Mat3 of = map(X);
            sum.col(i) += Eigen::Map<const Vector9>(of.data());
        }
    }
};

LaneMat3<Real8> in_all_lanes(const Mat3& F) {
    const LaneMat3<Real> f = from_matrix(F);
    const auto column = [](const LaneVec3<Real>& c) {
        return LaneVec3<Real8>{Real8{} + c.x, Real8{} + c.y, Real8{} + c.z};
    };
    return {column(f.c0), column(f.c1), column(f.c2)};
}

}  // namespace

TEST_CASE("logarithm and exponential function by lanes are exact to a few units in the last place", "[unit]") {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<Real> exponent(-300, 300);
    for (int trial = 0; trial < 20000; ++trial) {
        const Real y = trial < 10000 ? exponent(random) / 300 : exponent(random), x = std::exp(y);
        CHECK(std::abs(log_of(x) - std::log(x)) <= 4e-16 * std::max(std::abs(y), Real(0.01)));
        CHECK(std::abs(exp_of(y) - x) <= 4e-16 * x);
    }
    CHECK(log_of(Real(1)) == 0);
    CHECK(exp_of(Real(0)) == 1);
    CHECK(std::isfinite(exp_of(Real(1e6))));
    CHECK(exp_of(Real(-1e6)) > 0);
}

TEST_CASE("principal axes by lanes give F again, also for equal, zero and negative stretches", "[unit]") {
    std::mt19937_64 random(2);
    std::vector<Vec3> stretches = shapes;
    for (const Vec3& more : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(1e-8, 1e-9, 1e-9), Vec3(1e3, 1, 1e-3)})
        stretches.push_back(more);
    for (const Vec3& stretch : stretches)
        for (int trial = 0; trial < 20; ++trial) {
            const Mat3 F = trial == 0 ? Mat3(stretch.asDiagonal()) : turned(random, stretch);
            const LaneAxes<Real> axes = principal_axes(from_matrix(F));
            const Mat3 left = to_matrix(axes.left), right = to_matrix(axes.right);
            const Vec3 s(axes.stretch.x, axes.stretch.y, axes.stretch.z);
            INFO("stretch " << stretch.transpose() << " trial " << trial);
            CHECK((left.transpose() * left - Mat3::Identity()).norm() <= 1e-13);
            CHECK((right.transpose() * right - Mat3::Identity()).norm() <= 1e-13);
            CHECK(left.determinant() > 0);
            CHECK(right.determinant() > 0);
            // F^T F has the squares of the stretches, whose rounding turns the axes of small stretches more.
            const Real ratio = stretch[1] > 0 ? std::max(stretch[0] / stretch[1], Real(1)) : 1;
            CHECK((left * s.asDiagonal() * right.transpose() - F).norm() <= 1e-14 * ratio * F.norm());
            CHECK(std::abs(s.prod() - F.determinant()) <= 1e-13 * std::pow(F.norm(), 3));
        }
}

TEST_CASE("law of Ogden: four and eight lanes have the bits of one element", "[unit]") {
    std::mt19937_64 random(3);
    const MaterialConstants material = treloar(0.45);
    for (int trial = 0; trial < 50; ++trial) {
        LaneMat3<Real8> F8 = in_all_lanes(Mat3::Zero());
        LaneMat3<Real4> F4{};
        std::array<Mat3, 8> F;
        for (std::size_t l = 0; l < 8; ++l) {
            F[l] = turned(random, shapes[static_cast<std::size_t>(trial + 5 * static_cast<int>(l)) % shapes.size()]);
            const Mat3& f = F[l];
            F8.c0.x[l] = f(0, 0), F8.c0.y[l] = f(1, 0), F8.c0.z[l] = f(2, 0);
            F8.c1.x[l] = f(0, 1), F8.c1.y[l] = f(1, 1), F8.c1.z[l] = f(2, 1);
            F8.c2.x[l] = f(0, 2), F8.c2.y[l] = f(1, 2), F8.c2.z[l] = f(2, 2);
            if (l >= 4) continue;
            F4.c0.x[l] = f(0, 0), F4.c0.y[l] = f(1, 0), F4.c0.z[l] = f(2, 0);
            F4.c1.x[l] = f(0, 1), F4.c1.y[l] = f(1, 1), F4.c1.z[l] = f(2, 1);
            F4.c2.x[l] = f(0, 2), F4.c2.y[l] = f(1, 2), F4.c2.z[l] = f(2, 2);
        }
        const LaneMat3<Real8> P8 = Ogden::stress(material, F8);
        const LaneMat3<Real4> P4 = Ogden::stress(material, F4);
        for (int l = 0; l < 8; ++l) {
            const Mat3 alone = to_matrix(Ogden::stress(material, from_matrix(F[static_cast<std::size_t>(l)])));
            CHECK(lane_of(P8, l) == alone);
            if (l < 4) CHECK(lane_of(P4, l) == alone);
        }
    }
}

TEST_CASE("law of Ogden: the stress is the derivative of the energy, the tangent that of the stress", "[unit]") {
    std::mt19937_64 random(4);
    for (const MaterialConstants& material :
         {treloar(0.3), treloar(0.49), mooney(0.45), hencky(0.3), part_of(hencky(0.3), ElementPart::shear)})
        for (const Vec3& shape : shapes)
            for (int trial = 0; trial < 5; ++trial) {
                const Mat3 F = turned(random, shape);
                const Mat3 P = stress(material, F);
                const Mat3 by_lanes = to_matrix(Ogden::stress(material, from_matrix(F)));
                INFO("shape " << shape.transpose());
                const Real scale = 1 + P.norm() / material.shear_modulus;
                if (shape[1] + shape[2] == 0) continue;  // the axes are not unique
                CHECK((P - by_lanes).norm() <= 1e-11 * scale * scale * material.shear_modulus);
                if (near_kink(shape)) continue;
                constexpr Real step = 1e-6;
                Mat3 slope;
                for (Index i = 0; i < 9; ++i) {
                    Mat3 up = F, down = F;
                    up.data()[i] += step;
                    down.data()[i] -= step;
                    slope.data()[i] = (energy_density(material, up) - energy_density(material, down)) / (2 * step);
                }
                const Matrix9 H = slope_of_stress(material, F);
                CHECK((slope - P).norm() <= 1e-7 * (H.norm() + P.norm()));
                CHECK((H - H.transpose()).norm() <= 1e-6 * H.norm());
                // The tangent lacks negative eigenvalues. Those of H that are positive, it keeps.
                const SymmetricModes modes = symmetric_modes(0.5 * (H + H.transpose()));
                const Matrix9 positive =
                    modes.eigenvectors * modes.eigenvalues.cwiseMax(0).asDiagonal() * modes.eigenvectors.transpose();
                const Tangent tangent = skerry::tangent(material, F);
                Matrix9 dense;
                for (Index i = 0; i < 9; ++i) {
                    Mat3 X = Mat3::Zero();
                    X.data()[i] = 1;
                    const Mat3 x = tangent.left.transpose() * X * tangent.right;
                    Mat3 y = Mat3::Zero();
                    y.diagonal() = tangent.normal * x.diagonal();
                    for (Index k = 0; k < 3; ++k) {
                        const Index a = (k + 1) % 3, b = (k + 2) % 3;
                        y(a, b) = (tangent.flip[k] + tangent.twist[k]) / 2 * x(a, b) +
                                  (tangent.flip[k] - tangent.twist[k]) / 2 * x(b, a);
                        y(b, a) = (tangent.flip[k] + tangent.twist[k]) / 2 * x(b, a) +
                                  (tangent.flip[k] - tangent.twist[k]) / 2 * x(a, b);
                    }
                    const Mat3 out = tangent.left * y * tangent.right.transpose();
                    dense.col(i) = Eigen::Map<const Vector9>(out.data());
                }
                CHECK((dense - positive).norm() <= 1e-5 * H.norm());
            }
}

TEST_CASE("law of Ogden: the bounds on the stiffness hold", "[unit]") {
    std::mt19937_64 random(5);
    for (const MaterialConstants& material :
         {treloar(0.3), treloar(0.49), mooney(0.45), part_of(treloar(0.49), ElementPart::shear), hencky(0.3),
          part_of(hencky(0.49), ElementPart::shear)})
        for (const Vec3& shape : shapes)
            for (int trial = 0; trial < 5; ++trial) {
                const Mat3 F = turned(random, shape);
                INFO("shape " << shape.transpose());
                const Real bound = stiffness_bound(material, F);
                const Real rough = Ogden::rough_stiffness_bound(material, F.squaredNorm(), F.determinant());
                CHECK(bound > 0);
                CHECK(rough >= bound);
                if (shape == Vec3::Ones())
                    CHECK(rough <= bound + 1.001 * material.shear_modulus + 2 * material.shear_modulus);
                if (near_kink(shape)) continue;
                const Matrix9 H = slope_of_stress(material, F), symmetric = 0.5 * (H + H.transpose());
                const Real top = symmetric_eigenvalues(symmetric)[8];
                CHECK(top <= bound * (1 + 1e-6));
                CHECK(bound <= 2.5 * std::max(top, material.shear_modulus));
                DenseTerms terms;
                Ogden::add_stiffness(material, in_all_lanes(F), terms);
                CHECK(symmetric_eigenvalues(terms.sum - symmetric)[0] >= -1e-6 * (bound + terms.sum.norm()));
            }
    // At rest the terms are the stiffness of small strain.
    const MaterialConstants material = treloar(0.4);
    DenseTerms terms;
    Ogden::add_stiffness(material, in_all_lanes(Mat3::Identity()), terms);
    CHECK((terms.sum - slope_of_stress(material, Mat3::Identity())).norm() <= 1e-5 * terms.sum.norm());
}

TEST_CASE("one term of exponent 2 is the neo-Hookean law, exponents 2 and -2 are the law of Mooney and Rivlin",
          "[unit]") {
    std::mt19937_64 random(6);
    MaterialConstants neo_hookean = material_constants(MaterialModel::ogden, 1e5, 0.4, 1000);
    const MaterialConstants both = mooney(0.4);
    for (const Vec3& shape : shapes) {
        if (shape.minCoeff() < Ogden::least_stretch || shape.prod() < Ogden::least_volume) continue;
        const Mat3 F = turned(random, shape), inverse = F.inverse().transpose();
        const Real J = F.determinant(), I1 = F.squaredNorm(), third = std::cbrt(J);
        const Mat3 cof = J * inverse;
        const Real I2 = cof.squaredNorm();
        const auto volume = [&](const MaterialConstants& m) {
            return Mat3((m.lame_lambda + 2.0 / 3 * m.shear_modulus) * (J - 1) * cof);
        };
        const Mat3 of_I1 = 2 / (third * third) * (F - I1 / 3 * inverse);
        const Mat3 of_I2 = 2 / (third * J) * (I1 * F - F * F.transpose() * F - 2.0 / 3 * I2 * inverse);
        const Mat3 expected = neo_hookean.shear_modulus / 2 * of_I1 + volume(neo_hookean);
        const Mat3 of_both = 3e4 * of_I1 + 1e4 * of_I2 + volume(both);
        INFO("shape " << shape.transpose());
        CHECK((to_matrix(Ogden::stress(neo_hookean, from_matrix(F))) - expected).norm() <=
              1e-11 * (1e4 + expected.norm()));
        CHECK((to_matrix(Ogden::stress(both, from_matrix(F))) - of_both).norm() <= 1e-11 * (1e4 + of_both.norm()));
    }
}

TEST_CASE("law of Ogden: curves of uniaxial and equibiaxial tension and of shear", "[unit]") {
    const MaterialConstants material = treloar(0.495);
    const Real K = Ogden::bulk_modulus(material);
    const auto factor = [&](std::size_t p) {
        return 2 * material.shear_modulus * material.share[p] / material.exponent[p];
    };
    const auto stress_of = [&](const Vec3& stretch) {
        return to_matrix(Ogden::stress(material, from_matrix(Mat3(stretch.asDiagonal()))));
    };
    for (const Real stretch : {0.5, 0.8, 1.1, 2.0, 4.0}) {
        // Cauchy stress sigma along an axis without other stress: 3 K (J - 1) = sigma, and J sigma is the difference of
        // the terms of the stretch and of the cross stretch. Bisection finds J.
        // sides: number of axes that are stretched, 1 or 2.
        for (const int sides : {1, 2}) {
            const auto difference = [&](Real J) {
                const Real across = sides == 1 ? std::sqrt(J / stretch) : J / (stretch * stretch);
                Real sum = 0;
                for (std::size_t p = 0; p < 3; ++p)
                    sum += factor(p) * (std::pow(stretch / std::cbrt(J), material.exponent[p]) -
                                        std::pow(across / std::cbrt(J), material.exponent[p]));
                return sum;  // J sigma
            };
            Real low = 0.5, high = 2;
            for (int i = 0; i < 100; ++i) {
                const Real middle = (low + high) / 2;
                (3 * K * (middle - 1) * middle > sides * difference(middle) ? high : low) = middle;
            }
            const Real across = sides == 1 ? std::sqrt(low / stretch) : low / (stretch * stretch);
            const Mat3 P = stress_of(sides == 1 ? Vec3(stretch, across, across) : Vec3(stretch, stretch, across));
            const Real expected = difference(low) / stretch;
            INFO("stretch " << stretch << ", sides " << sides << ", J " << low);
            CHECK(P(0, 0) == Approx(expected).epsilon(1e-9));
            CHECK(std::abs(P(2, 2)) <= 1e-9 * (std::abs(expected) + K));
        }
        // Simple shear by gamma has the stretches s, 1, 1/s with gamma = s - 1/s, and the shear stress dPsi/dgamma.
        const Real gamma = stretch - 1 / stretch;
        Mat3 F = Mat3::Identity();
        F(0, 1) = gamma;
        Real expected = 0;
        for (std::size_t p = 0; p < 3; ++p)
            expected += factor(p) *
                        (std::pow(stretch, material.exponent[p]) - std::pow(stretch, -material.exponent[p])) /
                        (stretch + 1 / stretch);
        CHECK(to_matrix(Ogden::stress(material, from_matrix(F)))(0, 1) == Approx(expected).epsilon(1e-10));
    }
}

TEST_CASE("the law of Hencky is the limit of the law of Ogden for small exponents", "[unit]") {
    std::mt19937_64 random(8);
    MaterialConstants ogden = material_constants(MaterialModel::ogden, 2e5, 0.3, 1000);
    ogden.exponent[0] = 1e-5;
    for (const Vec3& shape : shapes) {
        if (shape.minCoeff() < Ogden::least_stretch || shape.prod() < Ogden::least_volume) continue;
        const Mat3 F = turned(random, shape), expected = stress(ogden, F);
        CHECK((stress(hencky(0.3), F) - expected).norm() <= 1e-4 * expected.norm() + 1e-5);
        CHECK(energy_density(hencky(0.3), F) == Approx(energy_density(ogden, F)).epsilon(1e-4).margin(1e-5));
    }
}

TEST_CASE("law of Ogden: the parts by Lame constant add up to the whole law", "[unit]") {
    std::mt19937_64 random(7);
    const MaterialConstants material = treloar(0.45);
    for (const Vec3& shape : shapes) {
        const Mat3 F = turned(random, shape), P = stress(material, F);
        const Mat3 sum =
            stress(part_of(material, ElementPart::shear), F) + stress(part_of(material, ElementPart::volume), F);
        CHECK((sum - P).norm() <= 1e-12 * (material.lame_lambda + P.norm()));
    }
}

TEST_CASE("law of Ogden: stress turns with the body, and no direction of the material differs", "[unit]") {
    std::mt19937_64 random(8);
    const MaterialConstants material = treloar(0.45);
    for (const Vec3& shape : shapes) {
        if (shape[1] + shape[2] == 0) continue;  // the axes are not unique
        const Mat3 F = turned(random, shape), Q = random_turn(random);
        const auto stress_of = [&](const Mat3& f) { return to_matrix(Ogden::stress(material, from_matrix(f))); };
        const Mat3 P = stress_of(F);
        const Real scale = 1 + stiffness_bound(material, F) / material.shear_modulus;
        INFO("shape " << shape.transpose());
        CHECK((stress_of(Q * F) - Q * P).norm() <= 1e-13 * scale * material.lame_lambda * (1 + F.norm()));
        CHECK((stress_of(F * Q) - P * Q).norm() <= 1e-13 * scale * material.lame_lambda * (1 + F.norm()));
    }
}

TEST_CASE("law of Ogden: flat and inverted elements are pushed apart with finite forces", "[unit]") {
    for (const MaterialConstants& material : {treloar(0.3), mooney(0.45)})
        for (const Real thickness : {0.05, 0.01, 0.0, -0.01, -0.5}) {
            const Mat3 F = Vec3(1, 1, thickness).asDiagonal();
            const Mat3 P = to_matrix(Ogden::stress(material, from_matrix(F)));
            CHECK(P.allFinite());
            CHECK(P(2, 2) < 0);
            CHECK(std::isfinite(energy_density(material, F)));
        }
    CHECK(to_matrix(Ogden::stress(treloar(0.3), from_matrix(Mat3::Zero()))).allFinite());
}

}  // namespace skerry::test::ogden_test
