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

/// Appends the bytes of rows to a message.
template <class T>
void put_rows(std::span<const T> rows, RankMessage& message) {
    static_assert(std::is_trivially_destructible_v<T>);
    const std::span<const std::byte> bytes = std::as_bytes(rows);
    message.insert(message.end(), bytes.begin(), bytes.end());
}

/// Messages to and from all peers (ranks that hold a body of this rank). Their memory is reused, so that messages no
/// longer than earlier ones need no allocation.
struct RankMail {
    std::vector<RankMessage> out, in;  // by index in RankState::peers

    void start(std::size_t peers) {
        out.resize(peers);
        in.resize(peers);
        for (RankMessage& message : out) message.clear();
    }
    template <class T>
    void put(std::size_t peer, const T& value) {
        put_rows(std::span<const T>(&value, 1), out[peer]);
    }
};

/// Reads the values of a message in the order in which they were put.
class MailReader {
public:
    explicit MailReader(std::span<const std::byte> message) : rest_(message) {}

    bool at_end() const { return rest_.empty(); }
    /// Reads as many rows as `rows` has.
    template <class T>
    void take_rows(std::span<T> rows) {
        SKERRY_CHECK(rest_.size() >= rows.size_bytes());
        if (!rows.empty()) std::memcpy(static_cast<void*>(rows.data()), rest_.data(), rows.size_bytes());
        rest_ = rest_.subspan(rows.size_bytes());
    }
    template <class T>
    T take() {
        T value;
        take_rows(std::span(&value, 1));
        return value;
    }
    /// Calls visit(row) for each row up to the end of the message.
    template <class T>
    void take_all(auto&& visit) {
        while (!at_end()) visit(take<T>());
    }

private:
    std::span<const std::byte> rest_;
};

/// Gathers rows from all ranks, and calls visit(row) for each, in the order of the ranks. Collective: all ranks must
/// call it.
template <class T>
void for_each_gathered(Ranks& ranks, std::span<const T> own_rows, auto&& visit) {
    for (const RankMessage& message : ranks.gather_everywhere(std::as_bytes(own_rows)))
        MailReader(message).take_all<T>(visit);
}

}  // namespace skerry
