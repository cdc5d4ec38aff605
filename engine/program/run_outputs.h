// The requested outputs of a run. If an output fails, the other outputs continue.
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/separate_outputs.h"
#include "engine/output/writer.h"
#include "engine/program/commands.h"
#include "engine/program/run_result.h"
#include "jobs/function_ref.h"

namespace skerry {

class RunOutputs {
public:
    /// Opens the outputs that `options` request. Throws SceneError if an output cannot be written, or would replace
    /// another output or an input, or if another process writes it. Later failures and the time spent are added to
    /// `result`. `options`, `scene` and `result` must outlive the object.
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
    /// Locks all outputs and the checkpoint file until the object is destroyed.
    void reserve(const RunOptions& options, const std::string& scene);
    /// Calls `write` for each output that has not failed. If the call throws, the output counts as failed, and the
    /// error is added to the result and printed to standard error at once.
    void for_each(FunctionRef<void(Writer&)> write);

    std::deque<OutputLock> locks_;
    std::vector<Output> outputs_;
    RunResult& result_;
};

}  // namespace skerry
