// The requested outputs of a run. If one of them fails, the others continue.
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
    /// Opens the outputs that `options` request. Throws SceneError if one of them cannot be written, or would replace
    /// another one or an input. Failures and the time spent are added to `result`. All references must outlive this.
    RunOutputs(const RunOptions& options, Scene& scene, const RunStart& start, RunResult& result);

    /// Call this after every call of advance.
    void sample(const World& world);
    void add_frame(const World& world);
    /// Completes all files, and lists them in the result.
    void finish(const World& world);

    /// True if outputs were requested and none of them is still usable.
    bool all_failed() const;

private:
    struct Output {
        const char* option;
        std::unique_ptr<Writer> writer;
        bool failed = false;
    };
    /// Calls `write` for each output that has not failed. Reports a failure at once.
    void for_each(FunctionRef<void(Writer&)> write);

    std::vector<Output> outputs_;
    RunResult& result_;
};

}  // namespace skerry
