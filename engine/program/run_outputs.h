// What a run writes. Each output fails on its own: the others go on.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/program/checkpoint.h"
#include "engine/program/commands.h"
#include "engine/program/problem_export.h"
#include "engine/program/run_result.h"
#include "jobs/function_ref.h"
#include "skerry/output.h"
#include "skerry/recorder.h"

namespace skerry {

class RunOutputs {
public:
    /// Throws SceneError where an output could not be written, or would be in the place of another or of the scene.
    RunOutputs(const RunOptions& options, const Scene& scene);

    /// Writes exported problems from now on, while the world advances.
    void watch(World& world, double steps_to_come);
    /// Opens the series of probes, whose handles are of the world as it is; `go_on`: with what their file has so far.
    void record(Scene& scene, bool go_on);
    /// After every call of advance.
    void sample(const World& world);
    void add_frame(const World& world);
    /// Of a run that is taken up: frames for ParaView go on, those of the first part being there; a page begins.
    void go_on(const World& world, const RunMemory& memory);
    /// Writes what takes the whole run, the figures last: they tell what could not be written.
    void finish(const World& world, RunResult& result);

    /// Outputs were asked for, and none is left that could be written.
    bool all_failed() const;
    /// A line each for what was written.
    std::string summary() const;
    int frames() const { return frames_; }
    /// Spent within the steps, on problems.
    double seconds_in_steps() const { return problems_.seconds(); }

private:
    struct Output {
        const char* option;
        std::filesystem::path place;  // empty: not asked for
        std::string failure = {};
        bool open() const { return !place.empty() && failure.empty(); }
    };
    /// Does what may fail, unless the output has failed before; says so at once.
    void attempt(Output& output, FunctionRef<void()> write);
    std::vector<Output*> all() { return {&out_, &page_file_, &probes_, &trace_, &problem_folder_, &stats_}; }
    std::vector<const Output*> all() const {
        return {&out_, &page_file_, &probes_, &trace_, &problem_folder_, &stats_};
    }

    Output out_, page_file_, probes_, trace_, problem_folder_, stats_;
    std::unique_ptr<Recorder> recorder_;
    std::unique_ptr<VtkWriter> vtk_;
    std::unique_ptr<PageWriter> page_;
    ProblemExport problems_;
    int frames_ = 0;
    double seconds_ = 0;
};

}  // namespace skerry
