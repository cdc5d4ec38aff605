// Backend of threads of the C++ standard library. It uses no other library, so that the thread sanitizer sees all of
// its code.
#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <thread>
#include <vector>

#include "components/check.h"
#include "jobs/backends.h"
#include "jobs/pause.h"

namespace skerry {

namespace {

using Clock = std::chrono::steady_clock;

// Time for which an idle worker spins before it sleeps. A short step has a dozen stages in 100 us. A worker that fell
// asleep between two stages would wake up too late for the second stage.
constexpr std::chrono::microseconds spin_time{50};

// Index of this thread among the workers of its executor. Threads that the executor did not start, such as its caller,
// have index 0.
thread_local int own_number = 0;

/// Spins for at most spin_time until ready() is true. If `may_spin` is false, ready() is called only once. Returns the
/// last value of ready().
bool spin_until(bool may_spin, auto&& ready) {
    if (!may_spin) return ready();
    const Clock::time_point end = Clock::now() + spin_time;
    do {
        for (int i = 0; i < 64; ++i) {
            if (ready()) return true;
            pause_briefly();
        }
    } while (Clock::now() < end);
    return false;
}

/// An executor that consists of workers - 1 threads and the calling thread. One mutex guards the list of unfinished
/// run_blocks calls and the list of stages that are ready. Workers take the blocks of a call from atomic counters,
/// without the mutex.
class ThreadsExecutor final : public Executor {
public:
    explicit ThreadsExecutor(int workers)
        : workers_(workers > 0 ? workers : std::max(1, static_cast<int>(std::thread::hardware_concurrency()))),
          may_spin_(workers_ <= static_cast<int>(std::thread::hardware_concurrency())) {
        threads_.reserve(static_cast<std::size_t>(workers_ - 1));
        try {
            for (int i = 1; i < workers_; ++i)
                threads_.emplace_back([this, i] {
                    own_number = i;
                    work_until([this] { return stop_; });
                });
        } catch (...) {
            stop();
            throw;
        }
    }
    ~ThreadsExecutor() override { stop(); }

    Backend backend() const override { return Backend::threads; }
    int worker_count() const override { return workers_; }

    void run_blocks(Index count, FunctionRef<void(Index)> body) override {
        BlockJob job(count, body, workers_);
        if (count <= 1 || workers_ == 1) {
            job.drain(0);
        } else {
            OpenJob open{job};
            {
                std::lock_guard lock(mutex_);
                open.next = open_;
                open_ = &open;
                ++announced_;
            }
            wake(count - 1);
            job.drain(own_number);
            close(open);
        }
        job.rethrow();
    }

    void run_graph(const GraphEdges& edges, FunctionRef<void(Index)> run_stage) override {
        GraphJob job(edges, run_stage, left_);
        if (workers_ == 1) {
            job.run_all();
        } else {
            {
                std::lock_guard lock(mutex_);
                SKERRY_CHECK(stages_left_ == 0);
                stages_left_ = static_cast<Index>(edges.predecessor_count.size());
                ready_.reserve(edges.predecessor_count.size());
                graph_ = &job;
            }
            const auto spawn_stage = [this](Index stage) { spawn(stage); };
            finish_stages(job.run_from(job.spawn_roots(spawn_stage), spawn_stage));
            work_until([this] { return stages_left_ == 0; });
        }
        job.rethrow();
    }

private:
    /// A run_blocks call with blocks that other workers may run. The object is on the stack of the calling thread,
    /// which returns only after all helpers have finished.
    struct OpenJob {
        BlockJob& job;
        OpenJob* next = nullptr;
        // Number of workers that help with this call. It changes only under mutex_. It is atomic, so that the calling
        // thread can wait for zero without the mutex.
        std::atomic<int> helpers{0};
        bool owner_sleeps = false;
    };

    /// Runs ready stages and blocks of open calls until finished() is true. finished() is called while the mutex is
    /// locked.
    void work_until(auto&& finished) {
        std::unique_lock lock(mutex_);
        while (true) {
            if (do_something(lock)) continue;
            if (finished()) return;
            wait_for_work(lock);
        }
    }

    bool do_something(std::unique_lock<std::mutex>& lock) {
        if (!ready_.empty()) {
            const Index stage = ready_.back();
            ready_.pop_back();
            lock.unlock();
            finish_stages(graph_->run_from(stage, [this](Index next) { spawn(next); }));
            lock.lock();
            return true;
        }
        for (OpenJob* open = open_; open; open = open->next) {
            if (open->job.exhausted()) continue;
            open->helpers.fetch_add(1, std::memory_order_relaxed);
            lock.unlock();
            open->job.drain(own_number);
            lock.lock();
            // The flag is copied before `helpers` is reduced. Reason: if the thread that called run_blocks does not
            // sleep, it may return and destroy *open as soon as `helpers` is zero.
            const bool owner_sleeps = open->owner_sleeps;
            if (open->helpers.fetch_sub(1, std::memory_order_release) == 1 && owner_sleeps) helpers_left_.notify_all();
            return true;
        }
        return false;
    }

    void wait_for_work(std::unique_lock<std::mutex>& lock) {
        const std::uint64_t seen = announced_;
        lock.unlock();
        const bool found_work = spin_until(may_spin_, [&] { return announced_ != seen; });
        lock.lock();
        if (found_work) return;
        ++sleepers_;
        work_announced_.wait(lock, [&] { return announced_ != seen; });
        --sleepers_;
    }

    /// Wakes sleeping workers after `useful` new stages or blocks have been announced: one worker for a single stage or
    /// block, otherwise all workers. Call it after unlocking the mutex, so that a woken thread does not have to wait
    /// for the mutex.
    void wake(Index useful) {
        if (sleepers_ == 0) return;
        if (useful == 1) {
            work_announced_.notify_one();
        } else {
            work_announced_.notify_all();
        }
    }

    void close(OpenJob& open) {
        const auto all_helpers_left = [&] { return open.helpers.load(std::memory_order_acquire) == 0; };
        std::unique_lock lock(mutex_);
        OpenJob** link = &open_;
        while (*link != &open) link = &(*link)->next;
        *link = open.next;
        if (all_helpers_left()) return;
        lock.unlock();
        if (spin_until(may_spin_, all_helpers_left)) return;
        lock.lock();
        open.owner_sleeps = true;
        helpers_left_.wait(lock, all_helpers_left);
    }

    void spawn(Index stage) {
        {
            std::lock_guard lock(mutex_);
            ready_.push_back(stage);  // needs no allocation, because run_graph reserved enough capacity
            ++announced_;
        }
        wake(1);
    }

    void finish_stages(Index done) {
        bool all = false;
        {
            std::lock_guard lock(mutex_);
            stages_left_ -= done;
            all = stages_left_ == 0;
            if (all) ++announced_;
        }
        if (all) wake(workers_);
    }

    void stop() {
        {
            std::lock_guard lock(mutex_);
            stop_ = true;
            ++announced_;
        }
        work_announced_.notify_all();
        for (std::thread& thread : threads_) thread.join();
    }

    const int workers_;
    // False if there are more workers than cores, because a spinning worker would then take a core from a working one.
    const bool may_spin_;
    PredecessorCounts left_;

    std::mutex mutex_;
    std::condition_variable work_announced_, helpers_left_;
    // Number of announcements so far: of new work, of the end of a graph, and of the end of the executor. It is changed
    // under mutex_; spinning threads read it without locking the mutex.
    std::atomic<std::uint64_t> announced_{0};
    std::atomic<int> sleepers_{0};  // changed under mutex_; wake() reads it without locking the mutex
    OpenJob* open_ = nullptr;
    GraphJob* graph_ = nullptr;
    std::vector<Index> ready_;
    Index stages_left_ = 0;
    bool stop_ = false;
    std::vector<std::thread> threads_;
};

}  // namespace

std::unique_ptr<Executor> make_threads_executor(int workers) {
    return std::make_unique<ThreadsExecutor>(workers);
}

}  // namespace skerry
