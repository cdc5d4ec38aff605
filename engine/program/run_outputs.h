// The requested outputs of a run. If an output fails, the other outputs continue.
#pragma once

#include <memory>
#include <vector>

#include "engine/output/writer.h"
#include "engine/program/commands.h"
#include "engine/program/run_result.h"
#include "jobs/function_ref.h"

namespace skerry {

class RunOutputs {
public:
    /// Opens the outputs that `options` request. Throws SceneError if an output cannot be written, or would replace
    /// another output or an input. Later failures, and the time spent on writing, are added to `result`. `options`,
    /// `scene` and `result` must outlive the object.
    RunOutputs(const RunOptions& options, Scene& scene, const RunStart& start, RunResult& result);

    /// Passes the world to all outputs. Must be called after every call of World::advance.
    void sample(const World& world);
    void add_frame(const World& world);
    /// Completes the files of all outputs, and adds their descriptions to RunResult::written.
    void finish(const World& world);

    /// True if outputs were requested and all of them have failed.
    bool all_failed() const;

private:
    struct Output {
        const char* option;
        std::unique_ptr<Writer> writer;
        bool failed = false;
    };
    /// Calls `write` for each output that has not failed. If the call throws, the output counts as failed, and the
    /// error is added to the result and printed to standard error at once.
    void for_each(FunctionRef<void(Writer&)> write);

    std::vector<Output> outputs_;
    RunResult& result_;
};

}  // namespace skerry
