#include "engine/world/state/contact_cache.h"

#include <algorithm>
#include <limits>

namespace skerry {

void ContactCache::search_afresh(Model& model) {
    search.body_valid_until.clear();
    search.collider_valid_until.clear();
    constexpr Real long_ago = -std::numeric_limits<Real>::infinity();
    std::ranges::fill(model.bodies.uninverted_until, long_ago);
    std::ranges::fill(model.tetrahedra.uninverted_until, long_ago);
}

void ContactCache::drop_pairs(Model& model) {
    pairs = PairTable{};
    search_afresh(model);
}

}  // namespace skerry
