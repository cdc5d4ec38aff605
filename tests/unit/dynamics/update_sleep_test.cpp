// When one body counts as still, by motions that are given (docs/methods/skipping.md 3.1).
#include "systems/dynamics/motion/update_sleep.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

using namespace skerry;

namespace {

constexpr Real h = 1e-3, time_still = 0.5;  // s

/// One free body of two nodes, of which one moves along x as it is told.
class Alone {
public:
    Alone(SleepSettings settings, Real edge) : settings_(settings), mean_edge_{edge} {}

    /// s, when it was put to rest, or nothing within this time.
    std::optional<Real> rests(Real seconds, const std::function<Real(Real)>& way) {
        for (int step = 1; step * h <= seconds; ++step) {
            const Real now = step * h;
            position_[1].x() = way(now);
            velocity_[1].x() = (way(now) - way(now - h)) / h;
            max_speed_[0] = std::abs(velocity_[1].x());
            const TakenByRest taken = rest_bodies({}, inputs(), settings_, h, memory_, state());
            if (taken.bodies > 0) return now;
        }
        return std::nullopt;
    }

private:
    RestInputs inputs() const {
        RestInputs inputs;
        inputs.kind = kind_;
        inputs.nodes = nodes_;
        inputs.mean_edge = mean_edge_;
        inputs.max_speed = max_speed_;
        inputs.position = position_;
        inputs.mass = mass_;
        inputs.inverse_mass = mass_;
        return inputs;
    }
    RestOutputs state() {
        return {asleep_, still_time_, drift_, drift_before_, still_position_, velocity_, velocity_next_};
    }

    SleepSettings settings_;
    SleepMemory memory_;
    std::vector<BodyKind> kind_{BodyKind::deformable};
    std::vector<Range> nodes_{{0, 2}};
    std::vector<Real> mean_edge_, max_speed_{0}, mass_{1, 1};
    std::vector<std::uint8_t> asleep_{0};
    std::vector<Real> still_time_{0}, drift_{0}, drift_before_{0};
    std::vector<Vec3> position_{2, Vec3::Zero()}, still_position_{2, Vec3::Zero()}, velocity_{2, Vec3::Zero()},
        velocity_next_{2, Vec3::Zero()};
};

const SleepSettings own_limits{.speed = 0, .own_limits = true, .time = time_still, .gravity = 9.81};

std::optional<Real> rests(Real edge, Real seconds, const std::function<Real(Real)>& way) {
    return Alone(own_limits, edge).rests(seconds, way);
}

}  // namespace

TEST_CASE("what does not move rests after the time that is asked for, what swings within the limits does, too",
          "[unit]") {
    const auto still = rests(0.02, 1, [](Real) { return 0.0; });
    REQUIRE(still);
    CHECK(*still == Approx(time_still).margin(2 * h));
    CHECK(rests(0.02, 1, [](Real t) { return 2e-5 * std::sin(40 * t); }));
}

TEST_CASE("what is fast, or comes far slowly, is not still", "[unit]") {
    // 3 um to and fro at 6 mm/s, where 4.4 are allowed
    CHECK_FALSE(rests(0.02, 3, [](Real t) { return 3e-6 * std::sin(2000 * t); }));
    // a creep of 5e-3 edges in half of the time, at 0.4 mm/s
    CHECK_FALSE(rests(0.02, 3, [](Real t) { return 4e-4 * t; }));
    // the error that the page states
    CHECK(rests(0.02, 3, [](Real t) { return 0.9 * 12e-3 * 0.02 * t; }));
}

TEST_CASE("what begins to slide is not still though it has hardly moved", "[unit]") {
    const Real edge = 1;  // m: in the second quarter of a second it comes two thirds as far as is allowed
    CHECK_FALSE(rests(edge, 5, [](Real t) { return 0.02 * t * t / 2; }));
    CHECK_FALSE(rests(edge, 5, [](Real t) { return 1e-5 * (std::exp(4 * t) - 1); }));
}

TEST_CASE("an oscillation that is back at evenly spread looks is seen", "[unit]") {
    const Real edge = 0.002, period = time_still / 2 / own_sleep_limits::looks;
    // 8 um from side to side, where 6 are allowed; 0.8 mm/s, where 1.4 are
    CHECK_FALSE(rests(edge, 3, [&](Real t) { return 4e-6 * std::cos(2 * std::numbers::pi * t / period); }));
}

TEST_CASE("what moves is not put to rest where no time is asked for", "[unit]") {
    SleepSettings at_once{.speed = 1e-3, .own_limits = false, .time = 0, .gravity = 9.81};
    CHECK_FALSE(Alone(at_once, 0.02).rests(0.1, [](Real t) { return t; }));
    CHECK(Alone(at_once, 0.02).rests(0.1, [](Real) { return 0.0; }) == std::optional<Real>(h));
    at_once.own_limits = true;
    CHECK_FALSE(Alone(at_once, 0.02).rests(0.1, [](Real t) { return t; }));
}
