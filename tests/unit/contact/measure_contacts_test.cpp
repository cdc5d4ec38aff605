#include "systems/contact/measure_contacts.h"

#include <catch2/catch.hpp>
#include <vector>

#include "systems/contact/tangent_frame.h"

namespace skerry::test::measure_contacts_test {

namespace {

/// Contacts of node i with a floor: normal z, mu_s 0.5, mu_d 0.4.
ContactTable floor_contacts(const std::vector<Vec3>& impulse) {
    ContactTable table;
    table.resize(impulse.size());
    for (std::size_t i = 0; i < impulse.size(); ++i) {
        const Index node = static_cast<Index>(i);
        table.stencil[i] = {{node, node, node, node}, {1, 0, 0, 0}};
        table.normal[i] = Vec3::UnitZ();
        table.surface_velocity[i] = Vec3::Zero();
        table.impulse[i] = impulse[i];
        table.static_friction[i] = 0.5;
        table.dynamic_friction[i] = 0.4;
    }
    return table;
}

struct Measured {
    ContactMeasures sums;
    std::vector<Vec3> slip;
    std::vector<ContactState> state;
};

Measured measure(const ContactTable& table, const std::vector<Vec3>& before, const std::vector<Vec3>& after,
                 int workers = 1, Friction friction = Friction::cone) {
    Measured result{{}, std::vector<Vec3>(table.size()), std::vector<ContactState>(table.size())};
    const auto executor = make_executor(Backend::threads, workers);
    result.sums = measure_contacts(*executor, table, std::vector<Real>(before.size(), 1.0), before, after, {},
                                   result.slip, result.state, friction);
    return result;
}

}  // namespace

TEST_CASE("a contact is open without impulse, sticks inside the cone, slides on it", "[unit][contact]") {
    const ContactTable table =
        floor_contacts({{0, 0, 0}, {0.1, 0, 1}, {0.4, 0, 1}, {0.45, 0, 1}, {0.5, 0, 1}, {0, 0, 1}});
    const std::vector<Vec3> zero(6, Vec3::Zero());
    const Measured result = measure(table, zero, zero);
    using enum ContactState;
    CHECK(result.state == std::vector{open, stick, slide, stick, slide, stick});
    CHECK(result.sums.stick_count == 3);
    CHECK(result.sums.slide_count == 2);
}

TEST_CASE("the pyramid slides on its faces, not on the circle inside", "[unit][contact]") {
    ContactTable table = floor_contacts({{0.35, 0.35, 1}, {0.5, 0.1, 1}});
    for (std::size_t i = 0; i < 2; ++i) table.dynamic_friction[i] = 0.5;
    const std::vector<Vec3> zero(2, Vec3::Zero());
    CHECK(measure(table, zero, zero, 1, Friction::pyramid).state ==
          std::vector{ContactState::stick, ContactState::slide});
    CHECK(measure(table, zero, zero, 1, Friction::cone).state[0] == ContactState::stick);
    table.impulse[0] = Vec3(0.4, 0.4, 1);  // outside the circle, inside the box
    CHECK(measure(table, zero, zero, 1, Friction::pyramid).state[0] == ContactState::stick);
    CHECK(measure(table, zero, zero, 1, Friction::cone).state[0] == ContactState::slide);
}

TEST_CASE("slip is measured against the moving surface, without its normal part", "[unit][contact]") {
    ContactTable table = floor_contacts({{0, 0, 1}});
    table.surface_velocity[0] = Vec3(1, 0, 0);
    const Measured result = measure(table, {Vec3::Zero()}, {Vec3(3, 4, 5)});
    CHECK(result.slip[0] == Vec3(2, 4, 0));
}

TEST_CASE("dissipation is the work against the mean velocity, penetration the deepest", "[unit][contact]") {
    ContactTable table = floor_contacts({{-0.4, 0, 1}, {0, 0, 0}});
    table.gap[0] = -0.01;
    table.distance[0] = 0.02;
    table.gap[1] = 0.5;
    table.distance[1] = -0.03;
    const Measured result = measure(table, {Vec3(2, 0, -1), Vec3(9, 9, 9)}, {Vec3(1.6, 0, 0), Vec3(9, 9, 9)});
    CHECK(result.sums.dissipated == Approx(0.4 * 1.8 + 0.5).epsilon(1e-14));
    CHECK(result.sums.max_gap_violation == 0.01);
    CHECK(result.sums.max_penetration == 0.03);
}

TEST_CASE("no contacts measure nothing", "[unit][contact]") {
    const Measured result = measure({}, {}, {});
    CHECK(result.sums.dissipated == 0);
    CHECK(result.sums.max_penetration == 0);
}

TEST_CASE("the sum over many contacts has the same bits on any number of workers", "[unit][contact][determinism]") {
    std::vector<Vec3> impulse, velocity;
    for (int i = 0; i < 60000; ++i) {
        impulse.emplace_back(0.1 * i, 0.3, 1.0 / (1 + i));
        velocity.emplace_back(1.0 / (3 + i), 0.1, 0.7);
    }
    const ContactTable table = floor_contacts(impulse);
    const Real one = measure(table, velocity, velocity).sums.dissipated;
    for (const int workers : {2, 3, 4, 8}) CHECK(measure(table, velocity, velocity, workers).sums.dissipated == one);
}

TEST_CASE("the tangent frame is orthonormal and right-handed for every normal", "[unit][contact]") {
    for (const Vec3& direction : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(1e-12, 0, -1),
                                  Vec3(1, 2, -3), Vec3(1, 1, -0.0)}) {
        const Vec3 normal = direction.normalized();
        const TangentFrame frame = tangent_frame(normal);
        Mat3 axes;
        axes << normal, frame.first, frame.second;
        CHECK((axes.transpose() * axes - Mat3::Identity()).cwiseAbs().maxCoeff() < 1e-14);
        const Real volume = axes(0, 0) * (axes(1, 1) * axes(2, 2) - axes(1, 2) * axes(2, 1)) -
                            axes(0, 1) * (axes(1, 0) * axes(2, 2) - axes(1, 2) * axes(2, 0)) +
                            axes(0, 2) * (axes(1, 0) * axes(2, 1) - axes(1, 1) * axes(2, 0));
        CHECK(volume == Approx(1));
    }
}

}  // namespace skerry::test::measure_contacts_test
