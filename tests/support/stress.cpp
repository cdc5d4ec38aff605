#include "tests/support/stress.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "tests/support/record.h"

namespace skerry::test::stress {

void judge(const Outcome& outcome, const std::source_location& location) {
    RecordLine()
        .add("item", outcome.item)
        .add("what", outcome.description)
        .add("criterion", outcome.criterion)
        .add("found", outcome.found)
        .add("held", outcome.held ? 1 : 0)
        .add("file", std::filesystem::path(location.file_name()).filename().string())
        .add("test", Catch::getResultCapture().getCurrentTestName())
        .write();
    INFO("item " << outcome.item << ", " << outcome.description << ": asked for " << outcome.criterion << ", found "
                 << outcome.found);
    CHECK(outcome.held);
}

std::string text(Real value) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.4g", value);
    return digits;
}

void at_most(int item, const std::string& description, const std::string& quantity, Real found, Real limit,
             const std::source_location& location) {
    judge({item, description, quantity + " <= " + text(limit), text(found), found <= limit}, location);
}

void at_least(int item, const std::string& description, const std::string& quantity, Real found, Real limit,
              const std::source_location& location) {
    judge({item, description, quantity + " >= " + text(limit), text(found), found >= limit}, location);
}

Real mechanical_energy(const World& world) {
    const Energy energy = world.energy();
    return energy.kinetic + energy.elastic + energy.potential;
}

bool all_finite(const World& world) {
    for (const BodyHandle body : world.bodies()) {
        for (const Vec3& x : world.positions(body))
            if (!x.allFinite()) return false;
        for (const Vec3& v : world.velocities(body))
            if (!v.allFinite()) return false;
    }
    return true;
}

Course follow(World& world, Real seconds, int samples) {
    Course course;
    const Real start = mechanical_energy(world);
    for (int sample = 0; sample < samples && course.ok; ++sample) {
        const StepReport report = world.advance(seconds / samples);
        course.ok = report.ok();
        course.message = report.message();
        course.finite = course.finite && all_finite(world);
        course.max_penetration = std::max(course.max_penetration, report.max_penetration);
        course.unconverged += report.unconverged;
        course.steps += report.steps;
        course.limited += report.limited;
        course.shortened += report.shortened;
        course.retried += report.retried;
        const Energy energy = world.energy();
        course.in_play = std::max(course.in_play, energy.kinetic + energy.elastic);
        course.gained = std::max(course.gained, energy.kinetic + energy.elastic + energy.potential - start);
    }
    return course;
}

void deform(World& world, BodyHandle body, const std::vector<Vec3>& places, Real seconds) {
    const auto at = world.positions(body);
    REQUIRE(places.size() == at.size());
    std::vector<AttachmentHandle> held;
    for (std::size_t n = 0; n < places.size(); ++n) {
        const std::array<Index, 1> node{static_cast<Index>(n)};
        Motion motion;
        motion.keys = {{world.time(), at[n], Vec3::Zero()}, {world.time() + seconds, places[n], Vec3::Zero()}};
        held.push_back(world.attach(body, node, motion));
    }
    const StepReport report = world.advance(seconds);
    INFO(report.message());
    REQUIRE(report.ok());
    for (const AttachmentHandle attachment : held) world.remove(attachment);
    world.set_velocities(body, std::vector<Vec3>(places.size(), Vec3::Zero()));
}

Real inverted_share(const World& world, BodyHandle body) {
    const auto x = world.positions(body);
    const auto tetrahedra = world.tetrahedra(body);
    std::size_t inverted = 0;
    for (const auto& t : tetrahedra) {
        const auto at = [&](std::size_t a) -> const Vec3& { return x[static_cast<std::size_t>(t[a])]; };
        inverted += (at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)) < 0;
    }
    return static_cast<Real>(inverted) / static_cast<Real>(tetrahedra.size());
}

}  // namespace skerry::test::stress
