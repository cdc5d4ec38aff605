// Motion in time: stability edge, frequency, conservation, and the energy theorem of the contact step.
#include <catch2/catch.hpp>

#include "jobs/executor.h"
#include "systems/dynamics/advance_positions.h"
#include "systems/dynamics/element_energy.h"
#include "systems/dynamics/predict_velocity.h"
#include "systems/dynamics/stable_step.h"
#include "tests/support/elastic_body.h"

using namespace skerry;
using test::ElasticBody;
using test::jittered_box;

namespace {

struct Motion {
    ElasticBody& body;
    std::unique_ptr<Executor> executor = make_executor(Backend::serial, 1);
    std::vector<Vec3> next = body.velocity, push = std::vector<Vec3>(body.velocity.size(), Vec3::Zero());

    void predict(Real h, const Vec3& gravity = Vec3::Zero()) {
        body.compute_forces(*executor, gravity);
        predict_velocity(*executor, body.force, body.inverse_mass, body.velocity, h, next);
    }
    void advance(Real h) { advance_positions(*executor, next, h, push, body.position, body.velocity); }
};

/// One element, all corners pinned but the last: an oscillator with a known frequency along x, sqrt(k / m), k = V mu |g|^2 for motion across its
/// gradient g = z / h.
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

TEST_CASE("the discrete frequency is 2/h asin(omega h / 2)", "[property]") {
    // methods.md 8.4. A sampled harmonic obeys x_n+1 + x_n-1 = 2 cos(omega_num h) x_n exactly.
    ElasticBody body = oscillator();
    const Real omega = omega_of(body), h = 0.5 / omega;
    Motion motion{body};
    body.position[3].x() = 1e-3;
    const Real expected = 2 / h * std::asin(omega * h / 2);
    Real before = 0, now = body.position[3].x();
    for (int n = 0; n < 200; ++n) {
        motion.predict(h);
        motion.advance(h);
        const Real after = body.position[3].x();
        if (n > 0 && std::abs(now) > 1e-4) CHECK(std::acos((after + before) / (2 * now)) / h == Approx(expected).epsilon(1e-6));
        before = now;
        now = after;
    }
}

TEST_CASE("the stability edge is omega h = 2", "[property]") {
    // methods.md 8.5.
    for (Real edge : {1.99, 2.01}) {
        ElasticBody body = oscillator();
        const Real h = edge / omega_of(body);
        Motion motion{body};
        body.position[3].x() = 1e-3;
        Real largest = 0;
        const int steps = edge < 2 ? 100000 : 300;
        for (int n = 0; n < steps; ++n) {
            motion.predict(h);
            motion.advance(h);
            largest = std::max(largest, std::abs(body.position[3].x()));
        }
        if (edge < 2)
            CHECK(largest < 0.02);  // amplitude 1 / sqrt(1 - (omega h / 2)^2): ten times the start
        else
            CHECK(largest > 1e3);
    }
}

TEST_CASE("a body runs at its stable step and keeps its momenta", "[property]") {
    for (MaterialModel model : {MaterialModel::corotational, MaterialModel::stable_neo_hookean}) {
        ElasticBody body(jittered_box({4, 2, 2}, 0.1, 0.25, 1, 0.02), material_constants(model, 1e5, 0.45, 1000));
        for (std::size_t n = 0; n < body.position.size(); ++n)
            body.velocity[n] =
                Vec3(1, -0.5, 0.2) + Vec3(2, 3, -4).cross(body.position[n]) + 0.3 * Vec3(std::sin(30 * body.position[n].x()), 0, 0);
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
        CHECK(largest < 10);  // it started with 2.5
        // methods.md 8.3: 1e-12 a step; symplectic Euler keeps x cross m v exactly.
        CHECK((end.linear - start.linear).norm() <= 1e-13 * steps * start.linear.norm());
        CHECK((end.angular - start.angular).norm() <= 1e-12 * steps * start.angular.norm());
    }
}

TEST_CASE("a bar that bounces on a wall never gains energy", "[property]") {
    // methods.md 4.3 and 8.32: E_n = v_n+1 M v_n+1 / 2 + x_n K x_n+1 / 2 + weight at the middle of the step; frictionless contact of the end nodes
    // with the wall z = 0, exact speculative constraint v_z >= -z / h, gaps never negative.
    ElasticBody body(jittered_box({1, 1, 10}, 0.1, 0.15, 2), material_constants(MaterialModel::linear, 1e5, 0.3, 1000));
    Real lowest = 0;
    for (const Vec3& x : body.position) lowest = std::min(lowest, x.z());
    const Vec3 lift(0, 0, 0.05 - lowest), gravity(0, 0, -9.81);
    std::vector<Real> scratch(body.position.size());
    const Real limit = stable_step(body.inputs(), body.blocks, body.position, body.mass, scratch).step / 0.9;
    for (Vec3& x : body.position) x += lift;
    const std::vector<Vec3> start = body.position;
    for (Real fraction : {0.5, 0.9, 0.99}) {
        body.position = start;
        std::fill(body.velocity.begin(), body.velocity.end(), Vec3(0, 0, -1));
        const Real h = fraction * limit;
        Motion motion{body};
        Real last = 0, scale = 0;
        int touching = 0, released = 0;
        for (int n = 0; n < 6000; ++n) {
            motion.predict(h, gravity);
            bool contact = false;
            for (std::size_t i = 0; i < body.position.size(); ++i) {
                const Real closing = -body.position[i].z() / h;
                if (motion.next[i].z() < closing) {
                    motion.next[i].z() = closing;
                    contact = true;
                }
            }
            touching += contact;
            released += !contact && touching > 0;
            motion.advance(h);
            Real energy = 0;
            for (std::size_t i = 0; i < body.position.size(); ++i) {
                const Vec3 elastic = body.force[i] - body.mass[i] * gravity;  // -K (x_n - rest)
                energy += 0.5 * body.mass[i] * body.velocity[i].squaredNorm() - 0.5 * elastic.dot(body.position[i] - start[i]) -
                          body.mass[i] * gravity.z() * (body.position[i].z() - 0.5 * h * body.velocity[i].z());
            }
            if (n > 0) CHECK(energy - last <= 1e-14 * scale);
            last = energy;
            scale = std::max(scale, std::abs(energy));
        }
        INFO("fraction " << fraction);
        CHECK(touching > 10);
        CHECK(released > 10);
    }
}
