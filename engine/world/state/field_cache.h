// Data from which the stress and strain of a body are computed, kept from one call to the next.
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "components/element_table.h"
#include "components/ragged.h"
#include "components/range.h"
#include "components/types.h"

namespace skerry {

struct RecoveryPlan;

/// Elements of an implicit body, for stress and strain. Steps need no such elements, so no table of the world contains
/// them.
struct OwnElements {
    ElementBlockTable table;
    ElementNodeTable nodes;
    Range blocks;
    Ragged<Index> covered;
};

/// Cache of one body for data that depend only on its mesh, materials, element kind and BodyRecord::built. These never
/// change during the life of a BodyRecord, so the cache never becomes invalid. Several threads may request data at the
/// same time; the first request builds them. A copy of a cache is empty.
class FieldCache {
public:
    FieldCache();
    FieldCache(const FieldCache& other);
    FieldCache(FieldCache&& other) noexcept;
    FieldCache& operator=(const FieldCache& other);
    FieldCache& operator=(FieldCache&& other) noexcept;
    ~FieldCache();

    std::shared_ptr<const OwnElements> elements(const std::function<OwnElements()>& build) const;
    /// Plan by which stress and strain at the given nodes of the body are computed. `build`: called if the cache has no
    /// plan for this list of nodes. The cache keeps the plans for the 64 lists that were requested last.
    std::shared_ptr<const RecoveryPlan> plan(std::span<const Index> nodes,
                                             const std::function<RecoveryPlan()>& build) const;

private:
    struct Data;
    std::unique_ptr<Data> data_;
};

}  // namespace skerry
