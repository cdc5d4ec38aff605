// Team: workers that stay together through many short phases, for which separate calls of run_blocks would cost more
// than the work itself.
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

/// One thread leads; the other threads spin until it hands out work. No helper is required: if a worker is busy
/// elsewhere or suspended by the system, the others do its share. A phase costs about 0.3 us. The time for a worker to
/// join the team depends on the executor and is paid once per gather(). The memory is kept between calls.
class Team {
public:
    /// Largest number of threads in a team, leader included. All members count finished blocks on one cache line, so in
    /// a larger team each phase takes longer. The other workers stay free for other stages and regions.
    static constexpr int most_members = 8;

    /// Calls work() once. Calls of run_phases inside work() may use up to most_members workers of the executor. If the
    /// executor is a PhaseRunner, it runs the phases itself. Calls of gather() must not be nested.
    void gather(Executor& executor, FunctionRef<void()> work);

    /// Calls body(block) once for every block 0 .. phase_offset.back() - 1, after all blocks of earlier phases have
    /// returned. Phase p consists of the blocks phase_offset[p] .. phase_offset[p + 1] - 1. A worker prefers the same
    /// share of every phase, so that rows that are neighbours in all phases stay in its cache. After an exception the
    /// other blocks still run, and the exception of the lowest block is rethrown. Call it only from the leading thread.
    /// Outside of gather() all blocks run on the calling thread.
    void run_phases(std::span<const Index> phase_offset, FunctionRef<void(Index block)> body);

    /// Runs one phase of `count` blocks.
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

    // The leader writes these members only while no helper is inside.
    Job job_;
    // Number of the last job in which each block was claimed.
    std::unique_ptr<std::atomic<std::uint64_t>[]> claim_;
    Index claim_count_ = 0;
    bool together_ = false, may_spin_ = true;
    PhaseRunner* runner_ = nullptr;  // set during gather() if the executor is a PhaseRunner

    alignas(line) std::atomic<std::uint64_t> open_{0};  // number of the job that helpers may enter; 0: none
    std::atomic<bool> dismissed_{true};
    alignas(line) std::atomic<Index> done_{0};    // number of blocks of the job that have returned
    alignas(line) std::atomic<Index> inside_{0};  // number of helpers that may be reading the job
    std::atomic<Index> members_{1};               // number of threads in this gather(), leader included
};

}  // namespace skerry
