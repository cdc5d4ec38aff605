// RecordingExecutor: one thread that runs work divided as if for many threads, and records the time of each block.
#pragma once

#include <chrono>

#include "jobs/executor.h"
#include "jobs/phase_runner.h"
#include "profiling/scaling/recording.h"

namespace skerry::profiling {

/// Runs everything on the calling thread in the order of the list. Blocks that a block hands out count as part of it.
class RecordingExecutor final : public Executor, public PhaseRunner {
public:
    /// `claimed_workers` is returned by worker_count(), so work is divided for it. It must be at least 2: one worker
    /// does without a Team.
    explicit RecordingExecutor(int claimed_workers);

    /// Starts recording. `expected` is a recording of the same steps; memory for its size is allocated beforehand.
    void begin(const Recording& expected = {});
    /// Stops recording and returns the work since begin().
    Recording end();

    Backend backend() const override { return Backend::serial; }
    int worker_count() const override { return claimed_workers_; }
    void run_blocks(Index count, FunctionRef<void(Index block)> body) override;
    void run_graph(const GraphEdges& edges, FunctionRef<void(Index stage)> run_stage) override;
    void run_phases(std::span<const Index> phase_offset, FunctionRef<void(Index block)> body) override;

private:
    using Clock = std::chrono::steady_clock;

    /// Records the time since the last record as a block.
    void note_block();
    void note_serial();
    void run_noted(PieceKind kind, Index begin, Index end, FunctionRef<void(Index block)> body);
    void open_run(Index stage);
    void close_run();

    int claimed_workers_;
    bool on_ = false, in_block_ = false;
    double note_cost_ = 0;  // time of recording itself, subtracted from each block [s]
    Clock::time_point last_{};
    Recording recording_;
};

}  // namespace skerry::profiling
