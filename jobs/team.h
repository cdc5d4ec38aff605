// Team: workers that stay together through many short phases, for which a call of run_blocks each would cost more than
// the work in them.
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

/// One thread leads and the others wait, spinning, for what it hands out. Nobody is needed: a worker that is busy
/// elsewhere, or that the system has put aside, comes late or never, and what it would have done is done by those who
/// are there. A phase costs about 0.3 us; how long it takes a worker to join is the executor's matter and is paid once.
/// Memory is kept between calls.
class Team {
public:
    /// The leader and who helps. All count what they have done on one cache line, so that from some number on a phase
    /// takes longer the more they are; the others have their hands free for other stages and regions.
    static constexpr int most_members = 8;

    /// Calls work() once; run_phases called in it may use most_members workers of the executor, or is left to it if it
    /// is a PhaseRunner. Not within itself.
    void gather(Executor& executor, FunctionRef<void()> work);

    /// Calls body(block) once for every block 0 .. phase_offset.back() - 1, after all blocks of earlier phases have
    /// returned; phase p is the blocks phase_offset[p] .. phase_offset[p + 1] - 1. A worker prefers the same share of
    /// every phase, so that rows that are near each other in all phases stay in its cache. After an exception the other
    /// blocks still run; that of the lowest block comes out. Only from the thread that leads; outside of gather it
    /// works alone.
    void run_phases(std::span<const Index> phase_offset, FunctionRef<void(Index block)> body);

    /// One phase of `count` blocks.
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

    static constexpr std::size_t line = 64;  // bytes that a core owns at a time

    // Written by the leader while no helper is inside.
    Job job_;
    std::unique_ptr<std::atomic<std::uint64_t>[]> claim_;  // by block: number of the last job in which it was taken
    Index claim_count_ = 0;
    bool together_ = false, may_spin_ = true;
    PhaseRunner* runner_ = nullptr;  // of this gathering, if it has one

    alignas(line) std::atomic<std::uint64_t> open_{0};  // number of the job that may be entered, 0: none
    std::atomic<bool> dismissed_{true};
    alignas(line) std::atomic<Index> done_{0};    // blocks of the job that have returned
    alignas(line) std::atomic<Index> inside_{0};  // helpers that may look at the job
    std::atomic<Index> members_{1};               // of this gathering, the leader is 0
};

}  // namespace skerry
