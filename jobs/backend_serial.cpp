// Serial backend: only the calling thread works. Tests compare the results of the other backends with those of the
// serial backend. Scenes that are too small for threads also use it.
#include "jobs/backends.h"

namespace skerry {

namespace {

class SerialExecutor final : public Executor {
public:
    Backend backend() const override { return Backend::serial; }
    int worker_count() const override { return 1; }

    void run_blocks(Index count, FunctionRef<void(Index)> body) override {
        BlockJob job(count, body, 1);
        job.drain(0);
        job.rethrow();
    }

    void run_graph(const GraphEdges& edges, FunctionRef<void(Index)> run_stage) override {
        GraphJob job(edges, run_stage, left_);
        job.run_all();
        job.rethrow();
    }

private:
    PredecessorCounts left_;
};

}  // namespace

std::unique_ptr<Executor> make_serial_executor() {
    return std::make_unique<SerialExecutor>();
}

}  // namespace skerry
