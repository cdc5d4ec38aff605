#include "jobs/team.h"

#include <algorithm>
#include <array>
#include <thread>

#include "components/check.h"
#include "jobs/backends.h"
#include "jobs/pause.h"
#include "jobs/phase_runner.h"

namespace skerry {

/// Waits until ready() is true. The thread first spins, because the threads for which it waits are usually running.
/// Then it yields the core, because the operating system may have suspended them.
template <class Ready>
void Team::wait_until(Ready&& ready) const {
    // Number of pauses before the thread yields the core. 50,000 pauses take 2 ms, about as long as a yield, which
    // would be too long in a wait of a microsecond. With more workers than cores, the thread yields early, because the
    // thread for which it waits may need the core.
    const int max_pauses = may_spin_ ? 50000 : 20;
    for (int i = 0; !ready(); ++i) {
        if (i < max_pauses) {
            pause_briefly();
        } else {
            std::this_thread::yield();
        }
    }
}

void Team::gather(Executor& executor, FunctionRef<void()> work) {
    SKERRY_CHECK(!together_ && !runner_);
    if (auto* const runner = dynamic_cast<PhaseRunner*>(&executor)) {
        struct Turn {
            Team& team;
            ~Turn() { team.runner_ = nullptr; }
        } const turn{*this};
        runner_ = runner;
        work();
        return;
    }
    const int workers = std::min(executor.worker_count(), most_members);
    if (workers <= 1) {
        work();
        return;
    }
    may_spin_ = executor.worker_count() <= static_cast<int>(std::thread::hardware_concurrency());
    members_.store(1, std::memory_order_relaxed);
    dismissed_.store(false, std::memory_order_relaxed);
    together_ = true;
    std::atomic<bool> has_leader{false};
    executor.run_blocks(workers, [&](Index) {
        // The first thread that arrives becomes the leader. The thread of a fixed block, for example of block 0, could
        // not lead, because an executor may run this block late.
        if (has_leader.exchange(true)) {
            help();
            return;
        }
        struct Dismissal {
            Team& team;
            ~Dismissal() {
                team.together_ = false;
                team.dismissed_.store(true);
            }
        } const dismissal{*this};
        work();
    });
}

void Team::run_blocks(Index count, FunctionRef<void(Index)> body) {
    const std::array<Index, 2> whole{0, count};
    run_phases(whole, body);
}

void Team::run_phases(std::span<const Index> phase_offset, FunctionRef<void(Index)> body) {
    const Index count = phase_offset.empty() ? 0 : phase_offset.back();
    if (count == 0) return;
    if (runner_) {
        runner_->run_phases(phase_offset, body);
        return;
    }
    FirstError error;
    if (!together_ || count == 1) {
        for (Index block = 0; block < count; ++block) {
            try {
                body(block);
            } catch (...) {
                error.keep(block);
            }
        }
        error.rethrow();
        return;
    }
    if (count > claim_count_) {
        claim_ = std::make_unique<std::atomic<std::uint64_t>[]>(static_cast<std::size_t>(count));
        claim_count_ = count;
    }
    const std::uint64_t number = job_.number + 1;
    job_ = {phase_offset, &body, &error, number, members_.load(std::memory_order_relaxed)};
    done_.store(0, std::memory_order_relaxed);
    open_.store(number);
    take_part(job_, 0);
    wait_until([&] { return done_.load(std::memory_order_acquire) == count; });
    // A helper first increments `inside_` and then checks whether the job is open. The leader first closes the job and
    // then reads `inside_`. So either the helper finds the job closed, or the leader sees the helper and waits for it.
    open_.store(0);
    wait_until([&] { return inside_.load() == 0; });
    error.rethrow();
}

void Team::help() {
    const Index member = members_.fetch_add(1, std::memory_order_relaxed);
    std::uint64_t last = 0;
    while (true) {
        std::uint64_t number = 0;
        wait_until([&] {
            number = open_.load(std::memory_order_acquire);
            return (number != 0 && number != last) || dismissed_.load(std::memory_order_acquire);
        });
        if (number == 0 || number == last) return;
        inside_.fetch_add(1);
        number = open_.load();
        if (number != 0 && number != last) {
            take_part(job_, member);
            last = number;
        }
        inside_.fetch_sub(1, std::memory_order_release);
    }
}

void Team::take_part(const Job& job, Index member) {
    for (std::size_t phase = 0; phase + 1 < job.phase_offset.size(); ++phase) {
        const Index begin = job.phase_offset[phase], end = job.phase_offset[phase + 1], count = end - begin;
        if (count == 0) continue;
        // Blocks of a phase start only after all blocks of earlier phases have returned. The number of finished blocks
        // therefore shows which phases are complete.
        wait_until([&] { return done_.load(std::memory_order_acquire) >= begin; });
        if (done_.load(std::memory_order_acquire) >= end) continue;
        const Index share = static_cast<Index>(std::int64_t{count} * (member % job.members) / job.members);
        const Index own_end =
            begin + static_cast<Index>(std::int64_t{count} * (member % job.members + 1) / job.members);
        take_blocks(job, begin + share, own_end);
        // Usually the other workers are about to finish. Reading the claims of their blocks would move the cache lines
        // of the claims away from them. This worker therefore waits a little, and then helps only workers that are
        // late.
        constexpr int short_pauses = 40;  // number of pauses, 2 us in total
        for (int i = 0; i < short_pauses && done_.load(std::memory_order_acquire) < end; ++i) pause_briefly();
        if (done_.load(std::memory_order_acquire) >= end) continue;
        take_blocks(job, own_end, end);
        take_blocks(job, begin, begin + share);
    }
}

void Team::take_blocks(const Job& job, Index begin, Index end) {
    Index finished = 0;
    for (Index block = begin; block < end; ++block) {
        if (!claim(block, job.number)) continue;
        try {
            (*job.body)(block);
        } catch (...) {
            job.error->keep(block);
        }
        ++finished;
    }
    if (finished > 0) done_.fetch_add(finished, std::memory_order_acq_rel);
}

bool Team::claim(Index block, std::uint64_t job_number) {
    std::atomic<std::uint64_t>& taken = claim_[static_cast<std::size_t>(block)];
    return taken.load(std::memory_order_relaxed) != job_number &&
           taken.exchange(job_number, std::memory_order_relaxed) != job_number;
}

}  // namespace skerry
