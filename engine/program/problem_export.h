// Writes contact problems of a run as files that other solvers read.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/program/commands.h"
#include "skerry/world.h"

namespace skerry {

class ProblemExport {
public:
    /// Throws SceneError when the scene's name is no file name.
    ProblemExport(const RunOptions& options, std::string scene);

    /// Every how many steps; unless the options say so, that follows from how many are to come.
    std::uint64_t every(double steps_to_come) const;
    void write_step(const StepProblem& step);
    long files() const { return files_; }
    long steps() const { return steps_; }
    double seconds() const { return seconds_; }  // spent on it

private:
    void write(ContactProblem problem, const StepProblem& step, const std::string& name, std::span<const Vec3> impulse);

    const RunOptions& options_;
    std::string scene_;
    long files_ = 0, steps_ = 0;
    double seconds_ = 0;
};

}  // namespace skerry
