// Executors: workers that run blocks of rows and stages of a graph. Each backend_*.cpp has one implementation.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "components/options.h"
#include "components/types.h"
#include "jobs/function_ref.h"

namespace skerry {

/// Dependencies of the stages. Stages are numbered so that every edge goes from a lower to a higher number.
struct GraphEdges {
    std::span<const Index> successor_offset;  // stage_count + 1
    std::span<const Index> successor;
    std::span<const Index> predecessor_count;  // by stage
};

/// A set of workers, one of which is the calling thread. Results never depend on the number of workers, because work is
/// split into fixed blocks. run_blocks and run_graph rethrow an exception of a block or stage; if several fail, the
/// exception of the lowest number. A graph starts no further stage after an exception.
class Executor {
public:
    virtual ~Executor() = default;

    virtual Backend backend() const = 0;
    virtual int worker_count() const = 0;

    /// Calls body(0) .. body(count - 1), each once, in any order and concurrently. Returns when all calls have
    /// returned. It may be called from within a block or a stage.
    virtual void run_blocks(Index count, FunctionRef<void(Index block)> body) = 0;

    /// Calls run_stage once for every stage, after all predecessors of the stage. Independent stages run concurrently.
    virtual void run_graph(const GraphEdges& edges, FunctionRef<void(Index stage)> run_stage) = 0;
};

/// Makes an executor of the given backend; `automatic` picks the first backend of this build. If `workers` is 0, the
/// number of workers is the size of the caller's arena (tbb), OMP_NUM_THREADS (openmp), or the number of cores
/// (threads). With tbb and 0 the work runs in the arena of the caller. Throws std::invalid_argument if this build lacks
/// the backend or `workers` is negative.
std::unique_ptr<Executor> make_executor(Backend backend, int workers);

/// The backends of this build, the default one first.
std::span<const Backend> available_backends();

}  // namespace skerry
