// How far a run is and how long it will take: a bar on a terminal, lines now and then anywhere else.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace skerry {

/// Seconds of wall time since it was made.
class Stopwatch {
public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// [######..................]
std::string bar_text(double share);

/// Takes a bar away for what is to be said; does nothing where there is none.
void clear_bar();

class Progress {
public:
    /// Of a run of so many seconds, in about so many steps of `step` seconds. All goes to standard error; `wanted`
    /// false: nothing is ever shown.
    Progress(bool wanted, double seconds, double steps, double step);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// What there is to do, once, and where the run is now, as often as anyone wants to read it: a bar ten times a
    /// second, lines after 1, 2, 4, ... s and in the end every ten minutes. Cheap enough to be called before every
    /// step.
    void show(double time, std::uint64_t steps);

private:
    void begin();
    void show_bar(double wall, double time);
    void show_line(double wall, double time, std::uint64_t steps);

    bool wanted_, bar_;
    double seconds_, steps_, step_;
    bool begun_ = false;
    Stopwatch watch_;
    double next_;  // s of wall time, when to show something again
};

}  // namespace skerry
