// Messages of fixed layout between ranks that hold the same bodies.
#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "components/check.h"
#include "jobs/ranks/ranks.h"

namespace skerry {

/// Messages to and from all peers. Their memory is reused, so that a steady state allocates nothing.
struct RankMail {
    std::vector<RankMessage> out, in;  // by index in RankState::peers

    void start(std::size_t peers) {
        out.resize(peers);
        in.resize(peers);
        for (RankMessage& message : out) message.clear();
    }
    template <class T>
    void put(std::size_t peer, const T& value) {
        static_assert(std::is_trivially_destructible_v<T>);
        const auto* const bytes = reinterpret_cast<const std::byte*>(&value);
        out[peer].insert(out[peer].end(), bytes, bytes + sizeof value);
    }
};

/// Reads the values of a message in the order in which they were put.
class MailReader {
public:
    explicit MailReader(std::span<const std::byte> message) : rest_(message) {}

    bool at_end() const { return rest_.empty(); }
    template <class T>
    T take() {
        SKERRY_CHECK(rest_.size() >= sizeof(T));
        T value;
        std::memcpy(static_cast<void*>(&value), rest_.data(), sizeof value);
        rest_ = rest_.subspan(sizeof value);
        return value;
    }

private:
    std::span<const std::byte> rest_;
};

}  // namespace skerry
