// Trace: a timeline of the work of every worker, for Perfetto and chrome://tracing.
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

/// Records zones: pieces of work with a begin and an end. Every thread writes to a list of its own, which grows up to
/// the given bound. Zones beyond the bound are only counted, and the file reports their number.
class Trace {
public:
    using Clock = std::chrono::steady_clock;
    using Time = Clock::time_point;

    static constexpr std::size_t default_zones_per_worker = std::size_t{1} << 20;  // 24 bytes each

    /// Starts a trace in which the calling thread is worker 0.
    explicit Trace(std::size_t max_zones_per_worker = default_zones_per_worker);
    ~Trace();
    Trace(const Trace&) = delete;
    Trace& operator=(const Trace&) = delete;

    static Time now() { return Clock::now(); }

    /// Adds a zone of the calling thread. The name must outlive the trace, as a literal does. It can be called from any
    /// thread at any time except during clear and write_json.
    void add(const char* name, Time begin, Time end);

    /// Removes all zones and restarts the clock at zero.
    void clear();

    std::size_t zone_count() const;
    std::uint64_t dropped_count() const;
    int worker_count() const;  // number of threads that recorded a zone, and the thread that made the trace

    /// Writes the Trace Event Format: one complete event ("X") for each zone, times in microseconds.
    void write_json(std::ostream& out) const;

private:
    struct Zone {
        const char* name;
        std::int64_t begin;  // after start_ [ns]
        std::int64_t end;
    };
    struct Worker {
        std::thread::id thread;
        std::vector<Zone> zones;
        std::uint64_t dropped = 0;
    };

    Worker& worker_of_this_thread();

    std::uint64_t id_;  // number of this trace, never reused: a thread caches its list under the number
    std::size_t max_zones_per_worker_;
    Time start_;
    mutable std::mutex mutex_;  // guards the list of workers, not its elements
    std::vector<std::unique_ptr<Worker>> workers_;
};

/// Records the time between its construction and its destruction as a zone. If `trace` is null, it costs one pointer
/// test.
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
