// Workers: what runs blocks of rows and stages of a graph. One implementation per backend_*.cpp.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "components/options.h"
#include "components/types.h"
#include "jobs/function_ref.h"

namespace skerry {

/// Which stages wait for which. Stages are numbered so that every edge goes up.
struct GraphEdges {
    std::span<const Index> successor_offset;  // stage_count + 1
    std::span<const Index> successor;
    std::span<const Index> predecessor_count;  // by stage
};

/// A set of workers. The calling thread is always one of them. Arithmetic never depends on how many there are: what is
/// split is split into fixed blocks. An exception thrown by a block or a stage reaches the caller of run_blocks or
/// run_graph, the one of the lowest number when there are several; a graph then starts no further stage.
class Executor {
public:
    virtual ~Executor() = default;

    virtual Backend backend() const = 0;
    virtual int worker_count() const = 0;

    /// Calls body(0) .. body(count - 1), each once, in any order and at the same time; returns when all have returned.
    /// May be called from within a block or a stage.
    virtual void run_blocks(Index count, FunctionRef<void(Index block)> body) = 0;

    /// Calls run_stage once for every stage, after all its predecessors; stages that do not wait for each other run at
    /// the same time.
    virtual void run_graph(const GraphEdges& edges, FunctionRef<void(Index stage)> run_stage) = 0;
};

/// Workers of the given backend, or for automatic of the first of this build. `workers` 0 means: as many as the
/// caller's arena has (tbb), as OMP_NUM_THREADS says (openmp), as the machine has cores (threads). With tbb and 0 the
/// work runs in the arena that the caller is in. Throws std::invalid_argument when this build lacks the backend.
std::unique_ptr<Executor> make_executor(Backend backend, int workers);

/// The backends of this build, the default first.
std::span<const Backend> available_backends();

}  // namespace skerry
