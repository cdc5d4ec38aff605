// oneTBB backend: tasks run in the arena of the caller, or in an arena that belongs to the executor.
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <optional>

#include "jobs/backends.h"

namespace skerry {

namespace {

class TbbExecutor final : public Executor {
public:
    explicit TbbExecutor(int workers) {
        if (workers > tbb::info::default_concurrency())
            more_threads_.emplace(tbb::global_control::max_allowed_parallelism, workers);
        if (workers > 0) arena_.emplace(workers);
    }

    Backend backend() const override { return Backend::tbb; }
    int worker_count() const override {
        return arena_ ? arena_->max_concurrency() : tbb::this_task_arena::max_concurrency();
    }

    void run_blocks(Index count, FunctionRef<void(Index)> body) override {
        const int all = worker_count(), workers = std::min(count, all);
        BlockJob job(count, body, all);
        if (workers <= 1) {
            job.drain(0);
        } else {
            // The loop is isolated: a worker that waits for the last block must not start another stage meanwhile. This
            // stage would delay all work that waits for the blocks, and its time would count for the stage that called
            // run_blocks.
            in_arena([&] { tbb::this_task_arena::isolate([&] { drain_together(job, workers); }); });
        }
        job.rethrow();
    }

    void run_graph(const GraphEdges& edges, FunctionRef<void(Index)> run_stage) override {
        GraphJob job(edges, run_stage, left_);
        if (worker_count() <= 1) {
            job.run_all();
        } else {
            in_arena([&] { run_together(job); });
        }
        job.rethrow();
    }

private:
    void in_arena(auto&& work) {
        if (arena_) {
            arena_->execute(work);
        } else {
            work();
        }
    }

    // The task contexts are isolated: if the host program cancels its own tasks, the blocks and stages of this executor
    // still run.
    static void drain_together(BlockJob& job, int workers) {
        tbb::task_group_context context(tbb::task_group_context::isolated);
        tbb::parallel_for(
            tbb::blocked_range<int>(0, workers, 1),
            [&](const tbb::blocked_range<int>&) {
                job.drain(std::max(0, tbb::this_task_arena::current_thread_index()));
            },
            tbb::simple_partitioner(), context);
    }

    static void run_together(GraphJob& job) {
        tbb::task_group_context context(tbb::task_group_context::isolated, tbb::task_group_context::concurrent_wait);
        tbb::task_group group(context);
        const Spawner spawn{job, group};
        job.run_from(job.spawn_roots(spawn), spawn);
        group.wait();
    }

    struct Spawner {
        GraphJob& job;
        tbb::task_group& group;

        void operator()(Index stage) const {
            group.run([spawn = *this, stage] { spawn.job.run_from(stage, spawn); });
        }
    };

    // oneTBB runs more workers than cores only if the limit on the number of threads is raised. oneTBB applies the
    // smallest of all requested limits. So this request never raises a limit that the host program has set.
    std::optional<tbb::global_control> more_threads_;
    std::optional<tbb::task_arena> arena_;  // empty: tasks run in the arena of the caller
    PredecessorCounts left_;
};

}  // namespace

std::unique_ptr<Executor> make_tbb_executor(int workers) {
    return std::make_unique<TbbExecutor>(workers);
}

}  // namespace skerry
