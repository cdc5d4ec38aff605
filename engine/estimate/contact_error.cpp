#include "engine/estimate/contact_error.h"

#include <algorithm>
#include <span>

#include "engine/world/world_state.h"

namespace skerry {

void ContactError::sample(const World& world) {
    // This list is empty after a world was loaded or a body was removed, until the next step.
    const std::span<const Real> errors = WorldAccess::state_of(world).scratch.regions.error;
    for (const Contact& contact : world.contacts()) {
        if (contact.region < 0 || static_cast<std::size_t>(contact.region) >= errors.size()) continue;
        const Real size = contact.impulse.norm();
        for (const BodyHandle body : {contact.first, contact.second}) {
            if (!world.alive(body)) continue;
            Touched& touched = touched_[body];
            touched.impulse += size;
            touched.error += size * errors[static_cast<std::size_t>(contact.region)];
            touched.overlap = std::max(touched.overlap, -contact.distance);
            if (size > 0) touched.gap = std::max(touched.gap, contact.distance);
        }
    }
}

void ContactError::add_to(std::vector<ErrorEstimate>& bodies) const {
    for (ErrorEstimate& estimate : bodies) {
        const auto touched = touched_.find(estimate.body);
        if (touched == touched_.end()) continue;
        estimate.overlap = touched->second.overlap;
        estimate.gap = touched->second.gap;
        if (touched->second.impulse > 0) estimate.contact = touched->second.error / touched->second.impulse;
    }
}

}  // namespace skerry
