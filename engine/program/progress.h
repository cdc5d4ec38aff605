// Displays the progress of a run and the estimated time left: as a bar on a terminal, otherwise as a line from time to
// time.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

#include "engine/program/time_left.h"

namespace skerry {

struct SceneOverrides;
struct ScenePlan;

/// Measures the wall time since the construction of the object [s].
class Stopwatch {
public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Returns the CPU time of this process since its start, summed over all threads [s].
double cpu_seconds();

/// Returns a bar filled to this fraction, for example [######..................].
std::string bar_text(double fraction);

/// Erases the progress bar, so that a message can be printed. Does nothing if standard error is not a terminal.
void clear_bar();

class Progress {
public:
    /// `visible`: if false, nothing is displayed. `seconds`: simulated time at which the run ends [s]. `steps`:
    /// estimated number of steps. `step`: step length [s]. `begin`: simulated time at which the run begins or resumes
    /// [s]. All output goes to standard error.
    Progress(bool visible, double seconds, double steps, double step, double begin);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Displays the progress if the last display was long enough ago: the bar ten times a second, lines after 1, 2, 4,
    /// ... s and later every ten minutes. Before the first display it prints the duration and estimated step count of
    /// the run. `time`: simulated time [s]. The function is cheap enough to be called at every step.
    void show(double time, std::uint64_t steps);

private:
    void begin();
    void show_bar(double wall, double time);
    void show_line(double wall, double time, std::uint64_t steps);
    /// Returns the estimated time left as text, or an empty text if there is no estimate yet.
    std::string remaining_text() const;

    bool visible_, bar_;
    double seconds_, steps_, step_;
    bool begun_ = false;
    Stopwatch watch_;
    TimeLeft time_left_;
    double next_;  // wall time of the next display [s]
};

/// Reports the set-up of a large scene on standard error. A small scene is set up within a second and is not reported.
class SetupProgress {
public:
    /// With `visible` false nothing is reported.
    SetupProgress(bool visible, const ScenePlan& plan);
    /// Reports the number of bodies that were added, at most once a second.
    void added(std::size_t bodies);
    /// Reports that the given work begins.
    void begin(const char* work);

private:
    bool visible_;
    std::size_t bodies_;
    double last_ = 0;  // wall time of the last line [s]
    Stopwatch watch_;
};

/// Shows the current activity and the elapsed seconds: as a status line on a terminal, otherwise as lines after 10, 20,
/// 40 seconds and so on, so that a log shows that long work continues.
class ActivityLine {
public:
    explicit ActivityLine(bool visible);
    ~ActivityLine();
    ActivityLine(const ActivityLine&) = delete;
    ActivityLine& operator=(const ActivityLine&) = delete;

    void show(const std::string& activity);

private:
    bool visible_, terminal_;
    double next_ = 10;  // wall time of the next line, if standard error is not a terminal [s]
    Stopwatch watch_;
};

/// Plans a scene. If `visible` is true, an ActivityLine shows the progress while surfaces of the scene are filled with
/// tetrahedra.
ScenePlan plan_with_progress(const std::filesystem::path& file, const SceneOverrides& overrides, bool visible);

}  // namespace skerry
