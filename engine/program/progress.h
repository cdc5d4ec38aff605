// A progress bar on a terminal, and nothing anywhere else.
#pragma once

#include <chrono>

namespace skerry {

/// Seconds of wall time since it was made.
class Stopwatch {
public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

class Progress {
public:
    /// `wanted` false, or standard error not being a terminal: nothing is ever shown.
    Progress(bool wanted, double seconds);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Percent, simulated time, real-time factor and time left; at most ten times a second.
    void show(double time);

private:
    bool shown_;
    double seconds_;
    Stopwatch watch_;
    double last_ = -1;
};

}  // namespace skerry
