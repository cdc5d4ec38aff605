// Communication of processes that simulate one world together. Each process is a rank.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace skerry {

using RankMessage = std::vector<std::byte>;

/// Counts of the messages and calls of this rank so far.
struct RankTraffic {
    std::uint64_t messages = 0;     // messages to single ranks
    std::uint64_t bytes = 0;        // bytes of these messages
    std::uint64_t exchanges = 0;    // calls of exchange
    std::uint64_t reductions = 0;   // calls of reduce
    std::uint64_t collectives = 0;  // calls of all other collective functions
    double seconds = 0;             // wall time within these calls, which is mostly waiting [s]
};

/// The ranks that simulate one world. All ranks call the collective functions in the same order. Only one thread of a
/// rank calls at a time.
class Ranks {
public:
    virtual ~Ranks() = default;

    virtual int rank() const = 0;  // number of this rank, from 0
    virtual int size() const = 0;  // number of ranks
    /// Sends out[i] to the rank peers[i], and receives one message from this rank into in[i]. Each peer must name this
    /// rank in its own call. `peers` ascends and does not contain this rank. The function is not collective: ranks
    /// without peers need not call it.
    virtual void exchange(std::span<const int> peers, std::span<const RankMessage> out, std::span<RankMessage> in) = 0;
    /// Collective. Combines the records of all ranks, which have equal sizes; afterwards each rank has the result.
    /// combine(into, from) must be associative and commutative to the last bit.
    virtual void reduce(std::span<std::byte> record, void (*combine)(std::byte* into, const std::byte* from)) = 0;
    /// Collective. Returns the messages of all ranks, in the order of the ranks.
    virtual std::vector<RankMessage> gather_everywhere(std::span<const std::byte> own_message) = 0;
    /// Collective. Returns the messages of all ranks on rank 0, and nothing on the other ranks.
    virtual std::vector<RankMessage> gather(std::span<const std::byte> own_message) = 0;
    /// Prints `message` and ends all ranks with the exit code `code`. It is meant for errors that the other ranks do
    /// not know of.
    [[noreturn]] virtual void abort(std::string_view message, int code) = 0;

    const RankTraffic& traffic() const { return traffic_; }

protected:
    RankTraffic traffic_;
};

/// Reduces one record of a type without pointers. combine(Record& into, const Record& from): see Ranks::reduce.
template <auto combine, class Record>
void reduce(Ranks& ranks, Record& record) {
    static_assert(std::is_trivially_copyable_v<Record>);
    // The bytes of a record may lie at addresses that are not aligned for its type, so they are copied.
    ranks.reduce(std::as_writable_bytes(std::span(&record, 1)), [](std::byte* into, const std::byte* from) {
        Record all, other;
        std::memcpy(static_cast<void*>(&all), into, sizeof all);
        std::memcpy(static_cast<void*>(&other), from, sizeof other);
        combine(all, other);
        std::memcpy(into, &all, sizeof all);
    });
}

}  // namespace skerry
