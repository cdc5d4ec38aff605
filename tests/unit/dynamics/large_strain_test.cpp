// Implicit bodies of large strain: elements with their material laws against explicit bodies and differences, and steps
// by Newton's method (docs/methods/implicit_bodies.md 8).
#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numeric>

#include "systems/dynamics/elements/element_energy.h"
#include "systems/dynamics/implicit/solve_large_step.h"
#include "tests/support/elastic_body.h"
#include "tests/support/element_kinds.h"
#include "tests/support/material_models.h"
#include "tests/support/random.h"

namespace skerry::test::dynamics_large_strain_test {

using test::ElasticBody;
using test::jittered_box;

namespace {

StiffBody stiff_body_of(const ElasticBody& body) {
    return StiffBody(body.list, body.constants.span(), body.mass, body.position, body.mesh.tetrahedra,
                     body.tetrahedron_mass);
}

ElasticBody rubber(MaterialModel model, ElementKind kind = ElementKind::linear) {
    return ElasticBody(jittered_box({2, 3, 2}, 0.1, 0.2, 1), material_constants(model, 1e5, 0.3, 1100),
                       Mat3::Identity(), kind);
}

std::vector<Vec3> random_vectors(std::size_t count, Real size, unsigned seed) {
    test::Random random(seed);
    std::vector<Vec3> vectors(count);
    for (Vec3& v : vectors) v = size * random.vector();
    return vectors;
}

/// Displacements by place [m]: a bend of some ten degrees, a stretch, and noise.
std::vector<Vec3> bent(const StiffBody& stiff, const ElasticBody& body, Real noise) {
    const std::vector<Vec3> by_node = random_vectors(stiff.size(), noise, 7);
    std::vector<Vec3> placed(stiff.size());
    for (std::size_t n = 0; n < stiff.size(); ++n) {
        const Vec3& x = body.position[n];
        placed[static_cast<std::size_t>(stiff.order_index(n))] =
            Vec3(-1.5 * x.y() * x.y() + 0.05 * x.x(), 0.1 * x.y(), 1.2 * x.x() * x.y()) + by_node[n];
    }
    return placed;
}

void hold_some(StiffBody& stiff) {
    std::vector<Real> inverse_mass(stiff.size(), 1);
    for (const std::size_t node : {0u, 2u, 5u, 6u}) inverse_mass[node] = 0;
    stiff.hold(inverse_mass);
}

/// Prepares a step from `displacement`, with velocities that would strain elements by some tenths.
void begin_step(StiffBody& stiff, const std::vector<Vec3>& displacement, const std::vector<Vec3>& velocity) {
    LargeStep& step = stiff.large_step;
    step.resize(stiff.size());
    step.unmoved_displacement = displacement;
    step.velocity = velocity;
    for (std::size_t k = 0; k < stiff.size(); ++k) step.impulse[k] = stiff.mass(k) * velocity[k];
}

}  // namespace

TEST_CASE("the largest strain is not a number if one displacement is not", "[dynamics][implicit]") {
    ElasticBody body = rubber(MaterialModel::stable_neo_hookean);
    const StiffBody stiff = stiff_body_of(body);
    const std::vector<Vec3> u = bent(stiff, body, 0.01);
    for (std::size_t n = 0; n < u.size(); ++n) {
        std::vector<Vec3> broken = u;
        broken[n].y() = std::numeric_limits<Real>::quiet_NaN();
        CHECK(std::isnan(stiff.elements().largest_strain(broken)));
    }
}

TEST_CASE("elements of an implicit body of large strain have the forces and energy of explicit ones",
          "[dynamics][implicit]") {
    const auto kind = GENERATE(from_range(std::begin(test::element_kinds), std::end(test::element_kinds)));
    const auto model = GENERATE(from_range(std::begin(test::material_models), std::end(test::material_models)));
    const auto executor = make_executor(Backend::serial, 1);
    ElasticBody body = rubber(model, kind);
    const StiffBody stiff = stiff_body_of(body);
    const std::vector<Vec3> u = bent(stiff, body, 0.01);
    CHECK(stiff.elements().largest_strain(u) > 0.2);
    std::vector<Vec3> force(u.size());
    stiff.elements().forces(u, force);
    for (std::size_t n = 0; n < u.size(); ++n) body.position[n] += u[static_cast<std::size_t>(stiff.order_index(n))];
    body.compute_forces(*executor);
    Real size = 0, difference = 0;
    for (std::size_t n = 0; n < u.size(); ++n) {
        size += body.force[n].squaredNorm();
        difference += (body.force[n] + force[static_cast<std::size_t>(stiff.order_index(n))]).squaredNorm();
    }
    CHECK(std::sqrt(difference / size) < 1e-12);
    CHECK(stiff.elements().energy(u) ==
          Approx(elastic_energy(body.inputs(), body.blocks, body.position)).epsilon(1e-12));
}

TEST_CASE("the tangent of an implicit body is the slope of its forces", "[dynamics][implicit]") {
    const auto kind = GENERATE(from_range(std::begin(test::element_kinds), std::end(test::element_kinds)));
    const auto model = GENERATE(from_range(std::begin(test::material_models), std::end(test::material_models)));
    const ElasticBody body = rubber(model, kind);
    StiffBody stiff = stiff_body_of(body);
    hold_some(stiff);
    // The stretch keeps the Hessian without negative eigenvalues. An element with only the volumetric part would have
    // some even then, so then the body is not stretched.
    const bool parted =
        std::ranges::any_of(body.list.part, [](ElementPart part) { return part == ElementPart::volume; });
    const bool bends =
        model == MaterialModel::stable_neo_hookean || model == MaterialModel::ogden || model == MaterialModel::hencky;
    const Real stretch = parted && bends ? 0 : 1;
    std::vector<Vec3> u(stiff.size());
    const Mat3 turn = Eigen::AngleAxis<Real>(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    const std::vector<Vec3> noise = random_vectors(stiff.size(), stretch * 2e-3, 3);
    for (std::size_t n = 0; n < u.size(); ++n) {
        const Vec3& x = body.position[n];
        const Vec3 stretched = x + stretch * Vec3(0.15 * x.x(), 0.1 * x.y(), 0.12 * x.z());
        u[static_cast<std::size_t>(stiff.order_index(n))] =
            (model == MaterialModel::linear ? stretched : Vec3(turn * stretched)) - x + noise[n];
    }
    constexpr Real inertia = 1.1, stiffness = 1e-4;
    REQUIRE(stiff.prepare_tangent(inertia, stiffness, u));
    // tests A A^-1 r = r, with A by differences
    std::vector<Vec3> impulse = random_vectors(stiff.size(), 1, 11);
    for (std::size_t k = 0; k < stiff.size(); ++k)
        if (stiff.holds(k)) impulse[k].setZero();
    std::vector<Vec3> velocity = impulse;
    stiff.respond(velocity);
    constexpr Real step = 1e-6;
    std::vector<Vec3> up = u, down = u, pulled(u.size()), pushed(u.size());
    for (std::size_t k = 0; k < u.size(); ++k) {
        up[k] += step * velocity[k];
        down[k] -= step * velocity[k];
    }
    stiff.elements().forces(up, pulled);
    stiff.elements().forces(down, pushed);
    Real size = 0, difference = 0;
    for (std::size_t k = 0; k < u.size(); ++k) {
        if (stiff.holds(k)) {
            CHECK(velocity[k].isZero(0));
            continue;
        }
        const Vec3 found = inertia * stiff.mass(k) * velocity[k] + stiffness / (2 * step) * (pulled[k] - pushed[k]);
        size += impulse[k].squaredNorm();
        difference += (found - impulse[k]).squaredNorm();
    }
    CHECK(std::sqrt(difference / size) < 1e-6);
}

TEST_CASE("a free implicit body of large strain answers without rigid motion, and evenly", "[dynamics][implicit]") {
    const ElasticBody body = rubber(MaterialModel::stable_neo_hookean);
    StiffBody stiff = stiff_body_of(body);
    const std::vector<Vec3> shape = bent(stiff, body, 0);
    stiff.set_shape(shape);
    REQUIRE(stiff.prepare_tangent(1, 1e-3, shape));
    REQUIRE(stiff.is_tangent());
    const std::vector<Vec3> impulse = random_vectors(stiff.size(), 1, 5), other = random_vectors(stiff.size(), 1, 6);
    std::vector<Vec3> velocity = impulse, other_velocity = other;
    stiff.respond(velocity);
    stiff.respond(other_velocity);
    Vec3 momentum = Vec3::Zero(), moment = Vec3::Zero(), sum = Vec3::Zero();
    Real there = 0, back = 0, work = 0;
    for (std::size_t k = 0; k < stiff.size(); ++k) {
        momentum += stiff.mass(k) * velocity[k];
        sum += impulse[k];
        there += other[k].dot(velocity[k]);
        back += impulse[k].dot(other_velocity[k]);
        work += impulse[k].dot(velocity[k]);
    }
    // angular momentum of the solid, whose velocity is linear between nodes
    for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t) {
        Vec3 places = Vec3::Zero(), velocities = Vec3::Zero();
        for (const Index n : body.mesh.tetrahedra[t]) {
            const auto k = static_cast<std::size_t>(stiff.order_index(static_cast<std::size_t>(n)));
            const Vec3 place = body.position[static_cast<std::size_t>(n)] + shape[k];
            places += place;
            velocities += velocity[k];
            moment += body.tetrahedron_mass[t] / 20 * place.cross(velocity[k]);
        }
        moment += body.tetrahedron_mass[t] / 20 * places.cross(velocities);
    }
    CHECK(momentum.norm() < 1e-13 * sum.norm());
    CHECK(moment.norm() < 1e-13 * sum.norm());
    CHECK(there == Approx(back).epsilon(1e-10));
    CHECK(work > 0);
    // Afterwards the matrix of small strain is unchanged.
    StiffBody small = stiff_body_of(body);
    REQUIRE(small.prepare(1, 1e-3));
    REQUIRE(stiff.prepare(1, 1e-3));
    CHECK(!stiff.is_tangent());
    CHECK(std::ranges::equal(stiff.column(7), small.column(7)));
}

TEST_CASE("the solid of an implicit body turns as its tetrahedra do, and its frame is that without rigid motion",
          "[dynamics][implicit]") {
    const ElasticBody body = rubber(MaterialModel::stable_neo_hookean);
    const StiffBody stiff = stiff_body_of(body);
    const std::vector<Vec3> by_order = bent(stiff, body, 0.01);
    BodyShape shape;
    stiff.find_shape(by_order, shape);
    // Arms are those of a rotating body: sum arm x (w x y) = I w, with energy w I w / 2.
    const Vec3 spin(0.3, -1, 2);
    std::vector<Vec3> turning(stiff.size());
    for (std::size_t k = 0; k < stiff.size(); ++k) turning[k] = spin.cross(shape.position[k]);
    CHECK((shape.angular_momentum(turning) - shape.inertia() * spin).norm() < 1e-13 * shape.inertia().norm());
    // The inertia is smaller than that of lumped masses, which lie at the corners.
    Real lumped = 0;
    for (std::size_t k = 0; k < stiff.size(); ++k) lumped += stiff.mass(k) * turning[k].squaredNorm();
    CHECK(spin.dot(shape.inertia() * spin) < 0.95 * lumped);
    // turned by a large angle, and back
    const Mat3 turn = Eigen::AngleAxis<Real>(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    std::vector<Vec3> plain(stiff.size()), turned(stiff.size());
    Vec3 center = Vec3::Zero();
    for (std::size_t n = 0; n < stiff.size(); ++n) center += body.mass[n] * body.position[n];
    center /= std::accumulate(body.mass.begin(), body.mass.end(), Real(0));
    for (std::size_t n = 0; n < stiff.size(); ++n) {
        const Vec3 arm = body.position[n] - center;
        plain[n] = by_order[static_cast<std::size_t>(stiff.order_index(n))];
        turned[n] = turn * (arm + plain[n]) - arm;
    }
    const Mat3 of_plain = stiff.rotate_to_own_frame(plain), of_turned = stiff.rotate_to_own_frame(turned);
    CHECK((of_turned - turn * of_plain).norm() < 1e-12);
    for (std::size_t n = 0; n < stiff.size(); ++n) CHECK((plain[n] - turned[n]).norm() < 1e-12);
}

TEST_CASE("a step of large strain is solved, held or free, crushed or not", "[dynamics][implicit]") {
    const auto model = GENERATE(MaterialModel::corotational, MaterialModel::stable_neo_hookean);
    const bool held = GENERATE(true, false);
    const Real noise = GENERATE(0.0, 0.03);  // for cells of 0.1 m: some elements are inverted [m]
    CAPTURE(model, held, noise);
    const ElasticBody body = rubber(model);
    StiffBody stiff = stiff_body_of(body);
    if (held) hold_some(stiff);
    std::vector<Vec3> velocity = random_vectors(stiff.size(), 2, 13);
    if (held)
        for (std::size_t k = 0; k < stiff.size(); ++k)
            if (stiff.holds(k)) velocity[k].setZero();
    constexpr Real theta_h = 0.01;
    begin_step(stiff, bent(stiff, body, noise), velocity);
    if (!held) {
        stiff.set_shape(stiff.large_step.unmoved_displacement);
        stiff.remove_momenta(stiff.large_step.velocity);
        stiff.large_step.angular_momentum = stiff.shape().inertia() * Vec3(2, -4, 6);
    }
    REQUIRE(solve_large_step(1, theta_h, stiff));
    const LargeStep& step = stiff.large_step;
    CHECK(step.counts.steps > 1);
    CHECK(step.counts.factors >= 1);
    CHECK(step.counts.factors <= step.counts.steps + 1);
    // residual of the equation, multiplied by A^-1, relative to the whole kick
    std::vector<Vec3> left(stiff.size()), at_end(stiff.size()), force(stiff.size());
    for (std::size_t k = 0; k < stiff.size(); ++k)
        at_end[k] = step.unmoved_displacement[k] + theta_h * step.velocity[k];
    stiff.elements().forces(at_end, force);
    if (!held) {  // the centrifugal force is the slope of the spin's energy
        BodyShape shape;
        const auto of_spin = [&] {
            stiff.find_shape(at_end, shape);
            return step.angular_momentum.dot(shape.inertia().inverse() * step.angular_momentum) / 2;
        };
        constexpr Real along = 1e-5;  // [m]
        for (std::size_t k = 0; k < stiff.size(); ++k)
            for (Index axis = 0; axis < 3; ++axis) {
                at_end[k][axis] += along;
                const Real more = of_spin();
                at_end[k][axis] -= 2 * along;
                force[k][axis] += (more - of_spin()) / (2 * along);
                at_end[k][axis] += along;
            }
    }
    Real kick = 0, missing = 0;
    for (std::size_t k = 0; k < stiff.size(); ++k)
        left[k] = stiff.mass(k) * step.velocity[k] + theta_h * force[k] - step.impulse[k];
    stiff.respond(left);
    for (std::size_t k = 0; k < stiff.size(); ++k) {
        if (stiff.holds(k)) {
            CHECK(step.velocity[k] == velocity[k]);
            continue;
        }
        kick += (step.velocity[k] - velocity[k]).squaredNorm();
        missing += left[k].squaredNorm();
    }
    CHECK(std::sqrt(missing / kick) < 1e-2);
}

TEST_CASE("a body that is not finite has no step of large strain", "[dynamics][implicit]") {
    const ElasticBody body = rubber(MaterialModel::stable_neo_hookean);
    StiffBody stiff = stiff_body_of(body);
    std::vector<Vec3> velocity(stiff.size(), Vec3::Zero());
    velocity[3].x() = std::numeric_limits<Real>::quiet_NaN();
    begin_step(stiff, bent(stiff, body, 0), velocity);
    stiff.set_shape(stiff.large_step.unmoved_displacement);
    CHECK(!solve_large_step(1, 0.01, stiff));
}

TEST_CASE("bounds find large strain as a test in each step does", "[dynamics][implicit]") {
    const auto model = GENERATE(from_range(std::begin(test::material_models), std::end(test::material_models)));
    const ElasticBody body = rubber(model);
    StiffBody stiff = stiff_body_of(body);
    const std::vector<Vec3> shape = random_vectors(stiff.size(), 0.02, 17);  // rough, so that bounds are nearly reached
    const Vec3 spin = GENERATE(0.0, 0.4) * Vec3(1, 0.5, 2);                  // [kg m^2/s]
    int large = 0;
    for (int k = 0; k < 600; ++k) {
        const Real size = 0.2 * std::pow(std::sin(0.01 * k), 2);
        std::vector<Vec3> in_order(stiff.size()), by_node(stiff.size());
        for (std::size_t n = 0; n < stiff.size(); ++n)
            by_node[n] = in_order[static_cast<std::size_t>(stiff.order_index(n))] =
                size * shape[static_cast<std::size_t>(stiff.order_index(n))];
        const bool by_bounds = stiff.becomes_large_in_order(in_order, spin);
        CHECK(by_bounds == stiff.becomes_large(by_node, spin));
        CHECK(by_bounds == stiff.becomes_large_in_order(in_order, spin));
        CHECK(!(by_bounds && stiff.becomes_small(by_node, spin)));
        large += by_bounds;
    }
    CHECK((model == MaterialModel::linear ? large == 0 : large > 20));
    CHECK(large < 580);
}

}  // namespace skerry::test::dynamics_large_strain_test
