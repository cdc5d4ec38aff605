#include "systems/solver/push_out_region.h"

#include <algorithm>
#include <cmath>

namespace skerry {
namespace {

/// One Gauss-Seidel sweep. Returns the sum of D change^2.
Real sweep(std::span<const LumpedContact> contacts, const PushMemory& memory) {
    Real sum = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i)
        sum += push_contact(contacts[i], memory.bias[i], memory.velocity.data(), memory.impulse[i]);
    return sum;
}

}  // namespace

bool push_out_region(std::span<const LumpedContact> contact, std::span<const Index> row, std::span<const Real> gap,
                     std::span<const Vec4> velocity, Real gravity, const SolverSettings& settings, Real h, const PushMemory& memory) {
    const Real slop = push_slop(gravity, h);
    if (std::none_of(row.begin(), row.end(), [&](Index i) { return gap[i] < -slop; })) return false;
    std::fill(memory.velocity.begin(), memory.velocity.end(), Vec4::Zero());
    std::fill(memory.impulse.begin(), memory.impulse.end(), 0);
    Real size = 0;  // J, of the push asked for
    for (std::size_t i = 0; i < contact.size(); ++i) {
        memory.bias[i] = push_bias(contact[i], gap[row[i]], slop, velocity, settings, h);
        const Real asked = std::min(memory.bias[i], Real(0));
        size += contact[i].inverse_diagonal * asked * asked;
    }
    const Real small = settings.tolerance * settings.tolerance * size;
    for (Index iteration = 1; iteration <= settings.max_iterations; ++iteration)
        if (sweep(contact, memory) <= small && !settings.fixed_iterations) break;
    return true;
}

}  // namespace skerry
