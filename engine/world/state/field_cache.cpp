#include "engine/world/state/field_cache.h"

#include <algorithm>
#include <vector>

#include "jobs/lock.h"
#include "systems/dynamics/recovery/recovery_plan.h"

namespace skerry {

struct FieldCache::Data {
    Lock lock;
    std::shared_ptr<const OwnElements> elements;
    std::vector<std::shared_ptr<const RecoveryPlan>> plans;  // in the order of their last use, the most recent last
};

FieldCache::FieldCache() : data_(std::make_unique<Data>()) {}
FieldCache::FieldCache(const FieldCache&) : FieldCache() {}
FieldCache::FieldCache(FieldCache&& other) noexcept = default;
FieldCache& FieldCache::operator=(const FieldCache&) {
    data_ = std::make_unique<Data>();
    return *this;
}
FieldCache& FieldCache::operator=(FieldCache&& other) noexcept = default;
FieldCache::~FieldCache() = default;

std::shared_ptr<const OwnElements> FieldCache::elements(const std::function<OwnElements()>& build) const {
    const auto held = data_->lock.hold();
    if (!data_->elements) data_->elements = std::make_shared<const OwnElements>(build());
    return data_->elements;
}

std::shared_ptr<const RecoveryPlan> FieldCache::plan(std::span<const Index> nodes,
                                                     const std::function<RecoveryPlan()>& build) const {
    // Largest number of plans in the cache. A plan is made for one list of nodes, and each probe of a body may request
    // its own list. The limit bounds the memory if a caller requests another list in each call.
    constexpr std::size_t most_plans = 64;
    const auto held = data_->lock.hold();
    auto& plans = data_->plans;
    const auto known =
        std::ranges::find_if(plans, [&](const auto& plan) { return std::ranges::equal(plan->nodes, nodes); });
    if (known != plans.end()) {
        std::rotate(known, known + 1, plans.end());
    } else {
        if (plans.size() == most_plans) plans.erase(plans.begin());
        plans.push_back(std::make_shared<const RecoveryPlan>(build()));
    }
    return plans.back();
}

}  // namespace skerry
