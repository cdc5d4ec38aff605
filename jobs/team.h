// Team: workers that stay together for many short phases. Separate calls of run_blocks for such phases would cost more
// time than the work itself.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "jobs/executor.h"
#include "jobs/function_ref.h"

namespace skerry {

class FirstError;
class PhaseRunner;

/// A group of threads for many short phases of work: the leader hands out work, the helpers spin until there is work.
/// If a helper is busy elsewhere or suspended by the operating system, the other threads do its share.
///
/// A phase has an overhead of about 0.3 us. The time for a worker to join the team depends on the executor and is spent
/// once per gather(). Later calls reuse the memory of the Team object.
class Team {
public:
    /// Largest number of threads in a team, leader included. All threads increment the same counter of finished blocks,
    /// so each phase takes longer in a larger team. The other workers of the executor stay free for other work.
    static constexpr int most_members = 8;

    /// Calls work() once. Calls of run_phases inside work() may use up to most_members workers of the executor. If the
    /// executor is a PhaseRunner, the executor runs the phases itself. Calls of gather() must not be nested.
    void gather(Executor& executor, FunctionRef<void()> work);

    /// Calls body(block) once for each block. Phase p consists of the blocks phase_offset[p] .. phase_offset[p + 1] -
    /// 1; it starts after all blocks of earlier phases have returned. Call run_phases only from the leading thread.
    /// Outside of gather() all blocks run on the calling thread.
    ///
    /// A worker begins each phase with the same share of the blocks, for example the second quarter. If this share uses
    /// about the same rows in all phases, the rows stay in the worker's cache. After an exception the other blocks
    /// still run, and the exception of the lowest block is rethrown.
    void run_phases(std::span<const Index> phase_offset, FunctionRef<void(Index block)> body);

    /// Runs a single phase of `count` blocks.
    void run_blocks(Index count, FunctionRef<void(Index block)> body);

private:
    struct Job {
        std::span<const Index> phase_offset;
        const FunctionRef<void(Index)>* body = nullptr;
        FirstError* error = nullptr;
        std::uint64_t number = 0;
        Index members = 1;
    };

    void help();
    void take_part(const Job& job, Index member);
    void take_blocks(const Job& job, Index begin, Index end);
    bool claim(Index block, std::uint64_t job_number);
    template <class Ready>
    void wait_until(Ready&& ready) const;

    static constexpr std::size_t line = 64;  // cache line [bytes]

    // The leader replaces job_ and the array claim_ only while inside_ is 0: no helper can then read them.
    Job job_;
    // For each block: number of the last job in which a thread claimed the block.
    std::unique_ptr<std::atomic<std::uint64_t>[]> claim_;
    Index claim_count_ = 0;
    bool together_ = false, may_spin_ = true;
    PhaseRunner* runner_ = nullptr;  // the executor during gather() if it is a PhaseRunner, else null

    alignas(line) std::atomic<std::uint64_t> open_{0};  // number of the job that helpers may enter; 0: no job
    std::atomic<bool> dismissed_{true};
    alignas(line) std::atomic<Index> done_{0};    // number of blocks of the current job that have returned
    alignas(line) std::atomic<Index> inside_{0};  // number of helpers that may be reading job_
    std::atomic<Index> members_{1};               // number of threads in this gather(), leader included
};

}  // namespace skerry
