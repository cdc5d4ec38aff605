// Executors: workers that run blocks of rows and stages of a graph. Each backend_*.cpp contains one implementation.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "components/options.h"
#include "components/types.h"
#include "jobs/function_ref.h"

namespace skerry {

/// Dependencies between stages. Stages are numbered so that every edge goes from a lower to a higher number.
struct GraphEdges {
    // Index in `successor` of the first successor of each stage. A last entry contains the size of `successor`.
    std::span<const Index> successor_offset;
    std::span<const Index> successor;
    std::span<const Index> predecessor_count;  // number of predecessors of each stage
};

/// A set of workers; the calling thread is one of them. Results never depend on the number of workers, because work is
/// divided into fixed blocks.
///
/// If blocks or stages throw, run_blocks or run_graph rethrows the exception of the lowest block or stage number. After
/// an exception, no further stage of the graph starts.
class Executor {
public:
    virtual ~Executor() = default;

    virtual Backend backend() const = 0;
    virtual int worker_count() const = 0;

    /// Calls body(0) .. body(count - 1), each once, concurrently and in any order. Returns when all these calls have
    /// returned. A block or a stage may call run_blocks itself.
    virtual void run_blocks(Index count, FunctionRef<void(Index block)> body) = 0;

    /// Calls run_stage once for every stage, after all predecessors of the stage. Independent stages run concurrently.
    virtual void run_graph(const GraphEdges& edges, FunctionRef<void(Index stage)> run_stage) = 0;
};

/// Makes an executor of the given backend; `automatic` selects the first backend of this build. Throws
/// std::invalid_argument if this build lacks the backend or if `workers` is negative. If `workers` is 0, the number of
/// workers is
/// - tbb: the size of the caller's arena, in which the tasks then run,
/// - openmp: omp_get_max_threads(),
/// - threads: the number of cores.
std::unique_ptr<Executor> make_executor(Backend backend, int workers);

/// The backends of this build; the first one is the default.
std::span<const Backend> available_backends();

}  // namespace skerry
