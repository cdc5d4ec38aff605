#include "systems/contact/sum_contact_impulses.h"

#include <Eigen/Geometry>
#include <utility>

namespace skerry {

namespace {

/// The partners of a contact, and whether they are swapped: true if the first body of the contact is not the first
/// partner.
std::pair<ContactPartners, bool> partners_of(const ContactSumInputs& contacts, std::size_t c) {
    const Index first = contacts.first_body[c], second = contacts.second_body[c];
    const auto deforms = [&](Index body) {
        return body != no_index && contacts.body_kind[static_cast<std::size_t>(body)] == BodyKind::deformable;
    };
    if (!deforms(second)) return {{first, no_index, contacts.collider[c]}, false};
    if (!deforms(first)) return {{second, no_index, contacts.collider[c]}, true};
    const bool turned =
        contacts.body_slot[static_cast<std::size_t>(second)] < contacts.body_slot[static_cast<std::size_t>(first)];
    return {turned ? ContactPartners{second, first, no_index} : ContactPartners{first, second, no_index}, turned};
}

/// Point at which the impulse acts on one side of a contact, relative to `from` [m]: the mean of the nodes whose
/// weights have the sign `sign`, weighted with |weight|. The absolute weights of a side sum to one.
Vec3 arm(const Stencil& stencil, Real sign, std::span<const Vec3> position, const Vec3& from) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t a = 0; a < 4; ++a)
        if (sign * stencil.weight[a] > 0)
            sum += sign * stencil.weight[a] * (position[static_cast<std::size_t>(stencil.node[a])] - from);
    return sum;
}

}  // namespace

void sum_contact_impulses(const ContactSumInputs& contacts, const Vec3& moment_point, Column<PairSums>& pairs,
                          Column<Vec3>& held_impulse) {
    pairs.clear();
    held_impulse.resize(contacts.position.size());
    for (const Index node : contacts.held) held_impulse[static_cast<std::size_t>(node)].setZero();
    for (std::size_t c = 0; c < contacts.stencil.size(); ++c) {
        if (contacts.impulse[c] == Vec3::Zero()) continue;
        const Stencil& stencil = contacts.stencil[c];
        const Vec3& impulse = contacts.impulse[c];
        const Vec3& normal = contacts.normal[c];
        const auto [partners, turned] = partners_of(contacts, c);
        // contacts of one pair are adjacent, so only the last row is compared
        if (pairs.empty() || pairs.back().partners != partners) pairs.push_back({.partners = partners});
        const bool analytic = contacts.second_body[c] == no_index;
        const auto arm_of = [&](Index body, Real sign) -> Vec3 {
            const auto b = static_cast<std::size_t>(body);
            if (contacts.core_nodes[b] == cylinder_core_nodes) return contacts.touch.on(sign, c, normal) - moment_point;
            return arm(stencil, sign, contacts.position, moment_point) - sign * contacts.round_radius[b] * normal;
        };
        const Vec3 on_first = arm_of(contacts.first_body[c], 1).cross(impulse);
        const Vec3 second_arm = analytic ? Vec3(contacts.point[c] - moment_point) : arm_of(contacts.second_body[c], -1);
        const Vec3 on_second = -second_arm.cross(impulse);
        const Real along = impulse.dot(normal), sign = turned ? -1 : 1;
        PairSums& pair = pairs.back();
        pair.sums += {sign * impulse, turned ? on_second : on_first, turned ? on_first : on_second,
                      sign * (impulse - along * normal), std::abs(along)};
        ++pair.contacts;
        for (std::size_t a = 0; a < 4; ++a) {
            const auto node = static_cast<std::size_t>(stencil.node[a]);
            if (stencil.weight[a] != 0 && contacts.inverse_mass[node] == 0)
                held_impulse[node] += stencil.weight[a] * impulse;
        }
    }
}

}  // namespace skerry
