// Exports the contact problems of a run as files that other solvers can read.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/program/commands.h"
#include "skerry/world.h"

namespace skerry {

class ProblemExport {
public:
    /// Throws SceneError if problems are exported and the scene's name is not a valid file name.
    ProblemExport(const RunOptions& options, std::string scene);

    /// Export interval [steps]: as given in the options, otherwise derived from the number of steps to come.
    std::uint64_t every(double steps_to_come) const;
    void write_step(const StepProblem& step);
    long files() const { return files_; }
    long steps() const { return steps_; }
    double seconds() const { return seconds_; }  // time spent on the export [s]

private:
    void write(ContactProblem problem, const StepProblem& step, const std::string& name, std::span<const Vec3> impulse);

    const RunOptions& options_;
    std::string scene_;
    long files_ = 0, steps_ = 0;
    double seconds_ = 0;
};

}  // namespace skerry
