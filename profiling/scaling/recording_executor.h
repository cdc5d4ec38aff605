// RecordingExecutor: one thread that has work cut as for many, and notes what each block takes.
#pragma once

#include <chrono>

#include "jobs/executor.h"
#include "jobs/phase_runner.h"
#include "profiling/scaling/recording.h"

namespace skerry::profiling {

/// Runs all on the calling thread in the order of the list. Blocks that a block hands out count as part of it.
class RecordingExecutor final : public Executor, public PhaseRunner {
public:
    /// `claimed_workers`: what worker_count() says, and so what work is cut for. At least 2: one worker does without a
    /// Team.
    explicit RecordingExecutor(int claimed_workers);

    /// From now on. `expected`: of the same steps, for its size; memory is then there before.
    void begin(const Recording& expected = {});
    /// What was done since begin().
    Recording end();

    Backend backend() const override { return Backend::serial; }
    int worker_count() const override { return claimed_workers_; }
    void run_blocks(Index count, FunctionRef<void(Index block)> body) override;
    void run_graph(const GraphEdges& edges, FunctionRef<void(Index stage)> run_stage) override;
    void run_phases(std::span<const Index> phase_offset, FunctionRef<void(Index block)> body) override;

private:
    using Clock = std::chrono::steady_clock;

    /// Notes the time since the last note as a block, and returns its row.
    void note_block();
    void note_serial();
    void run_noted(PieceKind kind, Index begin, Index end, FunctionRef<void(Index block)> body);
    void open_run(Index stage);
    void close_run();

    int claimed_workers_;
    bool on_ = false, in_block_ = false;
    double note_cost_ = 0;  // s, of noting itself, which is taken off each block
    Clock::time_point last_{};
    Recording recording_;
};

}  // namespace skerry::profiling
