// Motion in time: stability limit, frequency, conservation, and the energy theorem of the contact step.
#include <catch2/catch.hpp>

#include "jobs/executor.h"
#include "systems/dynamics/elements/element_energy.h"
#include "systems/dynamics/stability/stable_step.h"
#include "tests/support/accuracy.h"
#include "tests/support/elastic_body.h"
#include "tests/support/frequency.h"

namespace skerry::test::elastic_motion_test {

using test::ElasticBody;
using test::jittered_box;
namespace accuracy = test::accuracy;
using accuracy::Tolerance;

namespace {

struct Motion {
    ElasticBody& body;
    std::unique_ptr<Executor> executor = make_executor(Backend::serial, 1);
    std::vector<Vec3> next = body.velocity;

    void predict(Real h, const Vec3& gravity = Vec3::Zero()) {
        body.compute_forces(*executor, gravity);
        test::kick(body.force, body.inverse_mass, body.velocity, h, next);
    }
    void advance(Real h) {
        for (std::size_t n = 0; n < next.size(); ++n) body.position[n] += h * next[n];
        body.velocity = next;
    }
};

/// One element with all corners pinned except the last: an oscillator along x with the known frequency sqrt(k / m). k =
/// V mu |g|^2 for motion across the element's gradient g = z / h.
ElasticBody oscillator() {
    const test::TetMesh one{{Vec3(0, 0, 0), Vec3(0.1, 0, 0), Vec3(0, 0.1, 0), Vec3(0, 0, 0.1)}, {{0, 1, 2, 3}}};
    ElasticBody body(one, material_constants(MaterialModel::linear, 1e5, 0.3, 1000));
    for (std::size_t n = 0; n < 3; ++n) body.inverse_mass[n] = 0;
    return body;
}
Real omega_of(const ElasticBody& body) {
    return std::sqrt(body.volume(0) * body.constants[0].shear_modulus * 100 * body.inverse_mass[3]);
}

struct Momenta {
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
};
Momenta momenta(const ElasticBody& body) {
    Momenta m;
    for (std::size_t n = 0; n < body.position.size(); ++n) {
        m.linear += body.mass[n] * body.velocity[n];
        m.angular += body.mass[n] * body.position[n].cross(body.velocity[n]);
    }
    return m;
}

}  // namespace

TEST_CASE("the discrete frequency is 2/h asin(omega h / 2)", "[property][accuracy]") {
    // docs/accuracy.md, item 4. A sampled harmonic obeys x_n+1 + x_n-1 = 2 cos(omega_num h) x_n exactly.
    ElasticBody body = oscillator();
    const Real omega = omega_of(body), h = 0.5 / omega;
    Motion motion{body};
    body.position[3].x() = 1e-3;
    const Real expected = 2 / h * std::asin(omega * h / 2);
    Real before = 0, now = body.position[3].x(), worst = 0;
    for (int n = 0; n < 200; ++n) {
        motion.predict(h);
        motion.advance(h);
        const Real after = body.position[3].x();
        if (n > 0 && std::abs(now) > 1e-4)
            worst = std::max(worst, std::abs(std::acos((after + before) / (2 * now)) / (h * expected) - 1));
        before = now;
        now = after;
    }
    accuracy::check({.item = 4,
                     .name = "oscillator at omega h = 0.5, relative error of the frequency, worst of 200 steps",
                     .formula = "(2 / h) asin(omega h / 2)",
                     .found = worst,
                     .tolerance = 1e-6,
                     .kind = Tolerance::absolute});
}

TEST_CASE("the stability edge is omega h = 2", "[property][accuracy]") {
    // docs/accuracy.md, item 5.
    for (Real edge : {1.99, 2.01}) {
        ElasticBody body = oscillator();
        const Real h = edge / omega_of(body);
        Motion motion{body};
        constexpr Real start = 1e-3;
        body.position[3].x() = start;
        Real largest = 0, before = 0, now = start;
        const int steps = edge < 2 ? 100000 : 300;
        for (int n = 0; n < steps; ++n) {
            motion.predict(h);
            motion.advance(h);
            before = now;
            now = std::abs(body.position[3].x());
            largest = std::max(largest, now);
        }
        if (edge < 2)
            accuracy::check({.item = 5,
                             .name = "oscillator at omega h = 1.99, largest amplitude of 1e5 steps over the start",
                             .formula = "1 / sqrt(1 - (omega h / 2)^2)",
                             .expected = 1 / std::sqrt(1 - edge * edge / 4),
                             .found = largest / start,
                             .tolerance = 1e-3});
        else
            accuracy::check({.item = 5,
                             .name = "oscillator at omega h = 2.01, growth a step",
                             .formula = "exp(2 acosh(omega h / 2))",
                             .expected = std::exp(2 * std::acosh(edge / 2)),
                             .found = now / before,
                             .tolerance = 1e-6});
    }
}

TEST_CASE("plane waves have the speeds of the bulk", "[property][accuracy]") {
    // docs/accuracy.md, item 12. Nodes move along one axis only, as they would inside an infinite body: a standing
    // wave with one wavelength over 20 elements.
    constexpr Index n = 20;
    constexpr Real h_element = 0.1, nu = 0.3, density = 1000;
    for (bool pressure : {true, false}) {
        ElasticBody body(jittered_box({1, 1, n}, h_element, 0, 1),
                         material_constants(MaterialModel::linear, 1e5, nu, density));
        const int axis = pressure ? 2 : 0;
        std::vector<Real> part;
        std::vector<Vec3> rest = body.position;
        for (std::size_t k = 0; k < rest.size(); ++k) {
            part.push_back(std::cos(2 * M_PI * rest[k].z() / (n * h_element)));
            body.velocity[k][axis] = 1e-3 * part[k];
        }
        std::vector<Real> scratch(rest.size());
        const Real h = 0.5 * stable_step(body.inputs(), body.blocks, body.position, body.mass, scratch).step;
        const Real modulus =
            body.constants[0].shear_modulus * (pressure ? 2 : 1) + (pressure ? body.constants[0].lame_lambda : 0);
        const Real expected = std::sqrt(modulus / density), wave = 2 * M_PI / (n * h_element);
        Motion motion{body};
        std::vector<Real> sample;
        for (Real t = 0; t < 3 * 2 * M_PI / (wave * expected); t += h) {
            motion.predict(h);
            for (Vec3& v : motion.next) v = Vec3::Unit(axis) * v[axis];
            motion.advance(h);
            Real sum = 0;
            for (std::size_t k = 0; k < rest.size(); ++k)
                sum += body.mass[k] * part[k] * (body.position[k] - rest[k])[axis];
            sample.push_back(sum);
        }
        accuracy::check({.item = 12,
                         .name = pressure ? "pressure wave, 20 elements a wavelength, speed (m/s)"
                                          : "shear wave, 20 elements a wavelength, speed (m/s)",
                         .formula = pressure ? "sqrt((lambda + 2 mu) / rho)" : "sqrt(mu / rho)",
                         .expected = expected,
                         .found = test::angular_frequency(sample, h) / wave,
                         .tolerance = 0.01});
    }
}

TEST_CASE("a body runs at its stable step and keeps its momenta", "[property]") {
    for (MaterialModel model : {MaterialModel::corotational, MaterialModel::stable_neo_hookean}) {
        ElasticBody body(jittered_box({4, 2, 2}, 0.1, 0.25, 1, 0.02), material_constants(model, 1e5, 0.45, 1000));
        for (std::size_t n = 0; n < body.position.size(); ++n)
            body.velocity[n] = Vec3(1, -0.5, 0.2) + Vec3(2, 3, -4).cross(body.position[n]) +
                               0.3 * Vec3(std::sin(30 * body.position[n].x()), 0, 0);
        std::vector<Real> scratch(body.position.size());
        const Real h = stable_step(body.inputs(), body.blocks, body.position, body.mass, scratch).step;
        const Momenta start = momenta(body);
        Motion motion{body};
        constexpr int steps = 2000;
        Real largest = 0;
        for (int n = 0; n < steps; ++n) {
            motion.predict(h);
            motion.advance(h);
            for (const Vec3& v : body.velocity) largest = std::max(largest, v.norm());
        }
        const Momenta end = momenta(body);
        INFO(name_of(model));
        CHECK(largest < 10);  // initial value: 2.5
        // docs/accuracy.md, item 3: 1e-12 per step; symplectic Euler conserves the sum of x cross m v exactly.
        CHECK((end.linear - start.linear).norm() <= 1e-13 * steps * start.linear.norm());
        CHECK((end.angular - start.angular).norm() <= 1e-12 * steps * start.angular.norm());
    }
}

}  // namespace skerry::test::elastic_motion_test
