#include "systems/solver/push_out_region.h"

#include <algorithm>
#include <cmath>

namespace skerry {
namespace {

/// The least u_n + p_n of a contact, taken from u_n: negative asks for a push. Contacts that are not pressed in ask for nothing, whatever
/// error the velocity solve has left: so a region without a pressed contact comes out as zero, on its own or within a larger one.
Real push_bias(const LumpedContact& contact, Real gap, Real slop, std::span<const Vec4> velocity, const SolverSettings& settings, Real h) {
    const Real normal_velocity = contact.normal.dot(contact_velocity(contact, velocity.data())) - contact.bias;
    if (gap < -slop) return normal_velocity - std::min(settings.recovery * -gap / h, settings.recovery_speed);
    return std::max(Real(0), normal_velocity + std::max(gap, Real(0)) / h);
}

/// One Gauss-Seidel sweep. Returns the sum of D change^2.
Real sweep(std::span<const LumpedContact> contacts, const PushMemory& memory) {
    Real sum = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const LumpedContact& contact = contacts[i];
        Real along = memory.bias[i];
        for (Index a = 0; a < contact.node_count; ++a) along += contact.weight[a] * contact.normal.dot(memory.velocity[contact.node[a]]);
        const Real next = std::max(Real(0), memory.impulse[i] - contact.inverse_diagonal * along);
        const Real change = next - memory.impulse[i];
        if (change == 0) continue;
        apply_impulse(contact, change * contact.normal, memory.velocity.data());
        memory.impulse[i] = next;
        sum += contact.diagonal * change * change;
    }
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
