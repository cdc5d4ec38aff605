// Common code of the backends: the work of one call of run_blocks or run_graph, which any number of workers do
// together.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>

#include "components/access_check.h"
#include "jobs/arithmetic_scope.h"
#include "jobs/executor.h"

namespace skerry {

std::unique_ptr<Executor> make_tbb_executor(int workers);
std::unique_ptr<Executor> make_openmp_executor(int workers);
std::unique_ptr<Executor> make_threads_executor(int workers);
std::unique_ptr<Executor> make_serial_executor();

/// Stores the exception of the block or stage with the lowest number.
class FirstError {
public:
    /// Stores the current exception, thrown by block or stage `number`, unless one with a lower number is stored. Call
    /// it inside a catch block.
    void keep(Index number) noexcept {
        std::lock_guard lock(mutex_);
        if (any() && number_ <= number) return;
        number_ = number;
        error_ = std::current_exception();
        any_.store(true, std::memory_order_relaxed);
    }
    bool any() const noexcept { return any_.load(std::memory_order_relaxed); }
    /// Rethrows the stored exception if there is one. Call it after all workers have returned.
    void rethrow() {
        if (any()) std::rethrow_exception(std::move(error_));
    }

private:
    std::mutex mutex_;
    std::atomic<bool> any_{false};
    Index number_ = 0;
    std::exception_ptr error_;
};

/// The blocks of one run_blocks call, divided into one contiguous share per worker. Each share has a counter, from
/// which any worker takes the next block. So a call needs only one task per worker, and a slow block delays no other
/// block.
///
/// A worker begins with its own share, whose data it wrote in the previous loop and may still have in its caches. Then
/// it runs blocks of the following shares. After an exception the other blocks still run, so that the lowest failing
/// block does not depend on timing.
class BlockJob {
public:
    BlockJob(Index count, FunctionRef<void(Index)> body, int workers)
        : body_(body),
          count_(count),
          shares_(std::clamp(count, 1, std::clamp(workers, 1, most_shares))),
          watch_(current_access_watch()) {
        for (int share = 0; share < shares_; ++share) share_[share].next = begin_of(share);
    }

    /// Runs blocks until none is left. `worker`: number of the calling thread among the workers of the executor.
    void drain(int worker) noexcept {
        const ArithmeticScope arithmetic;
        // Each thread has its own access check. So each worker first takes over the check of the stage that called
        // run_blocks.
        const AccessScope access(watch_);
        for (int i = 0; i < shares_; ++i) {
            const int share = (worker + i) % shares_;
            const Index end = begin_of(share + 1);
            std::atomic_ref<Index> next(share_[share].next);
            if (next.load(std::memory_order_relaxed) >= end) continue;
            for (Index block = take(next); block < end; block = take(next)) {
                try {
                    body_(block);
                } catch (...) {
                    error_.keep(block);
                }
            }
        }
        exhausted_.store(true, std::memory_order_relaxed);
    }
    /// True if all blocks have been taken. The result may become true with a delay.
    bool exhausted() const noexcept { return exhausted_.load(std::memory_order_relaxed); }
    void rethrow() { error_.rethrow(); }

private:
    static constexpr int most_shares = 64;
    struct alignas(64) Share {  // each share is on its own cache line, because its counter is written for each block
        Index next;
    };

    static Index take(std::atomic_ref<Index> next) noexcept { return next.fetch_add(1, std::memory_order_relaxed); }
    Index begin_of(int share) const noexcept { return static_cast<Index>(std::int64_t{count_} * share / shares_); }

    FunctionRef<void(Index)> body_;
    Index count_;
    int shares_;
    const AccessWatch* watch_;
    std::atomic<bool> exhausted_{false};
    FirstError error_;
    Share share_[most_shares];
};

/// Number of unfinished predecessors of each stage. The executor stores the array between calls, so that a graph with
/// no more stages than an earlier graph needs no allocation.
class PredecessorCounts {
public:
    void reset(std::span<const Index> counts) {
        if (counts.size() > capacity_) {
            left_ = std::make_unique<std::atomic<Index>[]>(counts.size());
            capacity_ = counts.size();
        }
        for (std::size_t stage = 0; stage < counts.size(); ++stage)
            left_[stage].store(counts[stage], std::memory_order_relaxed);
    }
    /// Records that one predecessor of the stage has finished. Returns true for the last predecessor. The thread that
    /// receives true sees the memory writes of all predecessors.
    bool arrive(Index stage) {
        return left_[static_cast<std::size_t>(stage)].fetch_sub(1, std::memory_order_acq_rel) == 1;
    }

private:
    std::unique_ptr<std::atomic<Index>[]> left_;
    std::size_t capacity_ = 0;
};

/// The stages of one run_graph call, and a count of the unfinished predecessors of each stage.
class GraphJob {
public:
    GraphJob(const GraphEdges& edges, FunctionRef<void(Index)> run_stage, PredecessorCounts& left)
        : edges_(edges), run_stage_(run_stage), left_(left) {
        left_.reset(edges.predecessor_count);
    }

    /// Returns the first stage that has no predecessor, or no_index for an empty graph. Calls spawn(stage) for every
    /// other stage without a predecessor.
    template <class Spawn>
    Index spawn_roots(Spawn&& spawn) {
        Index first = no_index;
        for (Index stage = 0; stage < static_cast<Index>(edges_.predecessor_count.size()); ++stage) {
            if (edges_.predecessor_count[stage] != 0) continue;
            if (first == no_index) {
                first = stage;
            } else {
                spawn(stage);
            }
        }
        return first;
    }

    /// Runs the stage, then one of the stages that became ready, and so on until none became ready. Calls spawn(stage)
    /// for all other stages that became ready. Returns the number of finished stages. After an exception the remaining
    /// stages count as finished but are not run.
    template <class Spawn>
    Index run_from(Index stage, Spawn&& spawn) noexcept {
        Index done = 0;
        while (stage != no_index) {
            run(stage);
            ++done;
            Index next = no_index;
            for (Index e = edges_.successor_offset[stage]; e < edges_.successor_offset[stage + 1]; ++e) {
                const Index successor = edges_.successor[e];
                if (!left_.arrive(successor)) continue;
                if (next == no_index) {
                    next = successor;
                } else {
                    spawn(successor);
                }
            }
            stage = next;
        }
        return done;
    }

    /// Runs all stages on the calling thread, in the order of their numbers.
    void run_all() noexcept {
        for (Index stage = 0; stage < static_cast<Index>(edges_.predecessor_count.size()); ++stage) run(stage);
    }
    void rethrow() { error_.rethrow(); }

private:
    void run(Index stage) noexcept {
        if (error_.any()) return;
        const ArithmeticScope arithmetic;
        try {
            run_stage_(stage);
        } catch (...) {
            error_.keep(stage);
        }
    }

    const GraphEdges& edges_;
    FunctionRef<void(Index)> run_stage_;
    PredecessorCounts& left_;
    FirstError error_;
};

}  // namespace skerry
