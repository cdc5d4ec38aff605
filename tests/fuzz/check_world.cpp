#include "check_world.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

namespace skerry::test {

namespace {

[[noreturn]] void fail(const std::string& what) {
    throw std::runtime_error(what);
}

void expect(bool good, const std::string& what) {
    if (!good) fail(what);
}

}  // namespace

void check_bodies(const World& world) {
    for (const BodyHandle body : world.bodies()) {
        const auto position = world.positions(body), velocity = world.velocities(body);
        expect(position.size() == velocity.size(), world.name(body) + ": positions and velocities of different sizes");
        for (std::size_t n = 0; n < position.size(); ++n)
            expect(position[n].allFinite() && velocity[n].allFinite(),
                   world.name(body) + ": node " + std::to_string(n) + " is not finite");
        for (const Real stress : world.von_mises_stress(body))
            expect(stress >= 0, world.name(body) + ": stress " + std::to_string(stress));
    }
    const Energy energy = world.energy();
    expect(std::isfinite(energy.kinetic) && std::isfinite(energy.elastic) && std::isfinite(energy.potential) &&
               std::isfinite(energy.dissipated),
           "an energy is not finite");
    expect(energy.kinetic >= 0, "kinetic energy below zero");
}

/// The weights with all digits, because a weight that is only a rounding error may be the fault.
std::string describe(const std::array<Real, 4>& weight) {
    std::ostringstream text;
    text.precision(17);
    for (const Real w : weight) text << ' ' << w;
    return text.str();
}

void check_contacts(const World& world) {
    Real largest = 0;
    for (const Contact& c : world.contacts()) largest = std::max(largest, c.impulse.norm());
    for (std::size_t i = 0; i < world.contacts().size(); ++i) {
        const Contact& c = world.contacts()[i];
        const std::string who = "contact " + std::to_string(i) + ": ";
        expect(c.point.allFinite() && c.normal.allFinite() && c.slip.allFinite() && c.impulse.allFinite() &&
                   std::isfinite(c.gap),
               who + "not finite");
        expect(std::abs(c.normal.norm() - 1) < 1e-6, who + "normal of length " + std::to_string(c.normal.norm()));
        expect(world.alive(c.first) || world.alive(c.second), who + "of no body");
        // The tolerance covers rounding in the sums that the solver methods project with.
        expect(c.impulse.dot(c.normal) >= -1e-9 * largest,
               who + "pulls with " + std::to_string(-c.impulse.dot(c.normal) / largest) + " of the largest impulse " +
                   std::to_string(largest) + " region " + std::to_string(c.region) + " state " +
                   std::to_string((int)c.motion) + " gap " + std::to_string(c.gap) + " of " +
                   std::to_string(world.contacts().size()));
        for (std::size_t a = 0; a < 4; ++a) {
            expect(std::isfinite(c.weight[a]) && std::abs(c.weight[a]) <= 1 + 1e-9,
                   who + "weight " + std::to_string(c.weight[a]));
            if (c.weight[a] == 0) continue;
            const BodyHandle body = c.weight[a] > 0 ? c.first : c.second;
            if (!world.alive(body)) continue;  // belongs to a collider
            expect(c.node[a] >= 0 && c.node[a] < static_cast<Index>(world.positions(body).size()),
                   who + "node " + std::to_string(c.node[a]) + " of " + world.name(body) + ", weights " +
                       describe(c.weight));
        }
    }
}

void check_report(const StepReport& report, Real extent) {
    expect(report.ok() == report.message().empty(),
           "a report that is " + std::string(report.ok() ? "ok" : "not ok") + " says \"" + report.message() + "\"");
    expect(report.ok() || report.status == StepStatus::stopped || !report.body_name.empty(),
           "a refusal without a culprit: " + report.message());
    expect(report.max_penetration >= 0 && report.max_penetration <= extent,
           "penetration " + std::to_string(report.max_penetration) + " m of " + std::to_string(extent));
    expect(report.max_gap_violation >= 0 && report.max_gap_violation <= extent,
           "gap violation " + std::to_string(report.max_gap_violation) + " m");
    expect(std::isfinite(report.worst_error) && report.worst_error >= 0, "an error of a region that is not finite");
    expect(report.unconverged >= 0 && report.contacts >= 0 && report.regions <= report.contacts,
           "counts that disagree");
}

}  // namespace skerry::test
