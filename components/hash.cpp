#include "components/hash.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <new>

namespace skerry {

static_assert(XXH_VERSION_NUMBER >= 800, "XXH3 hash values are stable only since version 0.8.0 of the xxHash library");

Hash::Hash() {
    static_assert(sizeof state_ == sizeof(XXH3_state_t) && alignof(Hash) >= alignof(XXH3_state_t));
    XXH3_64bits_reset(::new (state_) XXH3_state_t{});
}

void Hash::add(const void* data, std::size_t bytes) {
    XXH3_64bits_update(std::launder(reinterpret_cast<XXH3_state_t*>(state_)), data, bytes);
}

std::uint64_t Hash::value() const {
    return XXH3_64bits_digest(std::launder(reinterpret_cast<const XXH3_state_t*>(state_)));
}

}  // namespace skerry
