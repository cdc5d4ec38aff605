// Trace: a timeline of the work of every worker, which Perfetto and chrome://tracing can display.
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

/// Records zones: named time intervals of work. Every thread writes to its own list, which grows up to the given
/// maximum. Further zones are dropped; write_json() writes their number.
class Trace {
public:
    using Clock = std::chrono::steady_clock;
    using Time = Clock::time_point;

    static constexpr std::size_t default_zones_per_worker = std::size_t{1} << 20;  // a zone takes 24 bytes

    /// Starts a trace in which the calling thread is worker 0.
    explicit Trace(std::size_t max_zones_per_worker = default_zones_per_worker);
    ~Trace();
    Trace(const Trace&) = delete;
    Trace& operator=(const Trace&) = delete;

    static Time now() { return Clock::now(); }

    /// Adds a zone for the calling thread. `name` must outlive the trace, for example as a string literal. Any thread
    /// may call add at any time except during clear and write_json.
    void add(const char* name, Time begin, Time end);

    /// Removes all zones and restarts the clock of the trace at zero.
    void clear();

    std::size_t zone_count() const;
    std::uint64_t dropped_count() const;
    // Number of threads with a list of zones: those that have recorded a zone, and the thread that made the trace.
    int worker_count() const;

    /// Writes a file in the Trace Event Format: one complete event ("X") for each zone, with times in microseconds.
    void write_json(std::ostream& out) const;

private:
    struct Zone {
        const char* name;
        std::int64_t begin;  // time since start_ [ns]
        std::int64_t end;
    };
    struct Worker {
        std::thread::id thread;
        std::vector<Zone> zones;
        std::uint64_t dropped = 0;
    };

    Worker& worker_of_this_thread();

    // Number of this trace, never reused. A thread stores the number together with a pointer to its list of zones. By
    // the number it detects that the pointer belongs to another trace.
    std::uint64_t id_;
    std::size_t max_zones_per_worker_;
    Time start_;
    mutable std::mutex mutex_;  // guards the list of workers, but not the lists of zones
    std::vector<std::unique_ptr<Worker>> workers_;
};

/// Records the time from its construction to its destruction as a zone. A null `trace` records nothing and costs one
/// comparison.
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
