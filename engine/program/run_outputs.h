// Outputs of a run. If one of them fails, the others continue.
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
    /// Throws SceneError if an output cannot be written, or would replace another one or the scene.
    RunOutputs(const RunOptions& options, const Scene& scene);

    /// Exports contact problems from now on, while the world advances.
    void watch(World& world, double steps_to_come);
    /// Opens the series of probes. Their handles must be valid in the current world. `go_on`: keep the content of an
    /// existing file.
    void record(Scene& scene, bool go_on);
    /// Call this after every call of advance.
    void sample(const World& world);
    void add_frame(const World& world);
    /// Resumes output: ParaView frames continue after those of the first part; a page begins anew.
    void go_on(const World& world, const RunMemory& memory);
    /// Writes the outputs that need the whole run. The figures come last: they report the outputs that failed.
    void finish(const World& world, RunResult& result);

    /// True if outputs were requested and none of them is still usable.
    bool all_failed() const;
    /// One line for each written output.
    std::string summary() const;
    int frames() const { return frames_; }
    /// Wall time spent within the steps on exported problems [s].
    double seconds_in_steps() const { return problems_.seconds(); }

private:
    struct Output {
        const char* option;
        std::filesystem::path place;  // empty: not requested
        std::string failure = {};
        bool open() const { return !place.empty() && failure.empty(); }
    };
    /// Calls `write` unless the output has failed before; reports a failure at once.
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
