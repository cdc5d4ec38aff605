// Displays the progress of a run and the time left: a bar on a terminal, otherwise occasional lines.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace skerry {

/// Measures wall time since its construction [s].
class Stopwatch {
public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Returns, for example, [######..................].
std::string bar_text(double share);

/// Erases the bar before a message is printed; does nothing if standard error is not a terminal.
void clear_bar();

class Progress {
public:
    /// Progress of a run of `seconds` with about `steps` steps of size `step` [s]. Everything goes to standard error.
    /// With `wanted` false nothing is ever shown.
    Progress(bool wanted, double seconds, double steps, double step);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Prints a summary of the run once, then its progress at limited intervals: the bar ten times a second, lines
    /// after 1, 2, 4, ... s and finally every ten minutes. Cheap enough to be called before every step.
    void show(double time, std::uint64_t steps);

private:
    void begin();
    void show_bar(double wall, double time);
    void show_line(double wall, double time, std::uint64_t steps);

    bool wanted_, bar_;
    double seconds_, steps_, step_;
    bool begun_ = false;
    Stopwatch watch_;
    double next_;  // wall time of the next display [s]
};

}  // namespace skerry
