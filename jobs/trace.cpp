#include "jobs/trace.h"

#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <ostream>
#include <string>
#include <string_view>

namespace skerry {

namespace {

std::atomic<std::uint64_t> traces_made{0};

std::string json_string(std::string_view text) {
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') {
            quoted += '\\';
            quoted += c;
        } else if (static_cast<unsigned char>(c) < 0x20) {
            std::array<char, 8> escaped{};
            std::snprintf(escaped.data(), escaped.size(), "\\u%04x", static_cast<unsigned>(c));
            quoted += escaped.data();
        } else {
            quoted += c;
        }
    }
    return quoted + '"';
}

// Converts nanoseconds to text in microseconds with three decimals. The conversion is exact and independent of the
// settings and locale of the stream. The number is negative for a zone that had begun before the trace was cleared.
std::string microseconds(std::int64_t nanoseconds) {
    const long long size = std::abs(static_cast<long long>(nanoseconds));
    std::array<char, 40> text{};
    std::snprintf(text.data(), text.size(), "%s%lld.%03lld", nanoseconds < 0 ? "-" : "", size / 1000, size % 1000);
    return text.data();
}

std::int64_t nanoseconds_between(Trace::Time begin, Trace::Time end) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(end - begin).count();
}

// Category of a zone: its name up to the first slash. For example, "dynamics/predict_velocity" has the category
// "dynamics".
std::string_view category(std::string_view name) {
    const std::size_t slash = name.find('/');
    return slash == std::string_view::npos ? std::string_view("skerry") : name.substr(0, slash);
}

}  // namespace

Trace::Trace(std::size_t max_zones_per_worker)
    : id_(++traces_made), max_zones_per_worker_(max_zones_per_worker), start_(now()) {
    worker_of_this_thread();
}

Trace::~Trace() = default;

Trace::Worker& Trace::worker_of_this_thread() {
    thread_local std::uint64_t known_id = 0;
    thread_local Worker* known = nullptr;
    if (known_id == id_) return *known;

    // `known` points to no list of this trace: the thread has not yet recorded a zone in this trace, or the last zone
    // that it has recorded belongs to another trace.
    std::lock_guard lock(mutex_);
    known = nullptr;
    for (const auto& worker : workers_)
        if (worker->thread == std::this_thread::get_id()) known = worker.get();
    if (!known) {
        workers_.push_back(std::make_unique<Worker>());
        known = workers_.back().get();
        known->thread = std::this_thread::get_id();
    }
    known_id = id_;
    return *known;
}

void Trace::add(const char* name, Time begin, Time end) {
    Worker& worker = worker_of_this_thread();
    if (worker.zones.size() >= max_zones_per_worker_) {
        ++worker.dropped;
        return;
    }
    worker.zones.push_back({name, nanoseconds_between(start_, begin), nanoseconds_between(start_, end)});
}

void Trace::clear() {
    std::lock_guard lock(mutex_);
    for (const auto& worker : workers_) {
        worker->zones.clear();
        worker->dropped = 0;
    }
    start_ = now();
}

std::size_t Trace::zone_count() const {
    std::lock_guard lock(mutex_);
    std::size_t count = 0;
    for (const auto& worker : workers_) count += worker->zones.size();
    return count;
}

std::uint64_t Trace::dropped_count() const {
    std::lock_guard lock(mutex_);
    std::uint64_t count = 0;
    for (const auto& worker : workers_) count += worker->dropped;
    return count;
}

int Trace::worker_count() const {
    std::lock_guard lock(mutex_);
    return static_cast<int>(workers_.size());
}

void Trace::write_json(std::ostream& out) const {
    const std::uint64_t dropped = dropped_count();
    std::lock_guard lock(mutex_);
    out << "{\"displayTimeUnit\":\"ns\",\"otherData\":{\"dropped_zones\":" << std::to_string(dropped)
        << ",\"max_zones_per_worker\":" << std::to_string(max_zones_per_worker_) << "},\n\"traceEvents\":[\n";
    out << R"({"name":"process_name","ph":"M","pid":1,"tid":0,"args":{"name":"skerry"}})";
    for (std::size_t w = 0; w < workers_.size(); ++w) {
        const std::string number = std::to_string(w);
        out << ",\n"
            << R"({"name":"thread_name","ph":"M","pid":1,"tid":)" << number << R"(,"args":{"name":"worker )" << number
            << "\"}}";
        for (const Zone& zone : workers_[w]->zones)
            out << ",\n{\"name\":" << json_string(zone.name) << ",\"cat\":" << json_string(category(zone.name))
                << R"(,"ph":"X","pid":1,"tid":)" << number << ",\"ts\":" << microseconds(zone.begin)
                << ",\"dur\":" << microseconds(zone.end - zone.begin) << "}";
    }
    out << "\n]}\n";
}

}  // namespace skerry
