// Trace: what every worker did and when, for Perfetto and chrome://tracing.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace skerry {

/// Records zones: pieces of work with a begin and an end. Every thread writes to a list of its own; the lists grow
/// while recording, up to the bound given. Zones beyond it are counted, and the file says how many.
class Trace {
public:
    using Clock = std::chrono::steady_clock;
    using Time = Clock::time_point;

    static constexpr std::size_t default_zones_per_worker = std::size_t{1} << 20;  // 24 bytes each

    /// The calling thread becomes worker 0.
    explicit Trace(std::size_t max_zones_per_worker = default_zones_per_worker);
    ~Trace();
    Trace(const Trace&) = delete;
    Trace& operator=(const Trace&) = delete;

    static Time now() { return Clock::now(); }

    /// Adds a zone of the calling thread. The name must outlive the trace: a literal. Any thread, at any time but
    /// during clear and write_json.
    void add(const char* name, Time begin, Time end);

    /// Forgets all zones, and counts time from now on.
    void clear();

    std::size_t zone_count() const;
    std::uint64_t dropped_count() const;
    int worker_count() const;  // threads that recorded something, and the one that made the trace

    /// Trace Event Format: one complete event ("X") for each zone, times in microseconds.
    void write_json(std::ostream& out) const;

private:
    struct Zone {
        const char* name;
        std::int64_t begin;  // ns after start_
        std::int64_t end;
    };
    struct Worker {
        std::thread::id thread;
        std::vector<Zone> zones;
        std::uint64_t dropped = 0;
    };

    Worker& worker_of_this_thread();

    std::uint64_t id_;  // of this trace, never used again: a thread remembers its list by it
    std::size_t max_zones_per_worker_;
    Time start_;
    mutable std::mutex mutex_;  // guards the list, not what is in it
    std::vector<std::unique_ptr<Worker>> workers_;
};

/// Records the time between its construction and its destruction. Without a trace it costs a test of a pointer.
class TraceZone {
public:
    TraceZone(Trace* trace, const char* name) : trace_(trace), name_(name) {
        if (trace_) begin_ = Trace::now();
    }
    ~TraceZone() {
        if (trace_) trace_->add(name_, begin_, Trace::now());
    }
    TraceZone(const TraceZone&) = delete;
    TraceZone& operator=(const TraceZone&) = delete;

private:
    Trace* trace_;
    const char* name_;
    Trace::Time begin_{};
};

}  // namespace skerry
