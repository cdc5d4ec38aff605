#include "jobs/run_tasks.h"

#include <algorithm>
#include <condition_variable>
#include <thread>
#include <vector>

#include "jobs/backends.h"

namespace skerry {

namespace {

/// The state that the threads of one run_tasks call share.
class TaskQueue {
public:
    TaskQueue(Index count, FunctionRef<void(Index)> task) : count_(count), task_(task) {}

    /// Runs tasks until none is left.
    void drain() noexcept {
        // Numbers are taken in ascending order, and a task whose number was taken always runs. So if a task fails, all
        // tasks with lower numbers run as well. The lowest failing number therefore does not depend on timing.
        while (!closed_) {
            const Index number = next_++;
            if (number >= count_) break;
            try {
                task_(number);
            } catch (...) {
                error_.keep(number);
                close();
            }
        }
        const std::lock_guard lock(mutex_);
        ++left_;
        thread_left_.notify_one();
    }
    /// Prevents further tasks from starting.
    void close() noexcept { closed_ = true; }
    /// Waits for at most `period` until `threads` threads have returned from drain(). Returns true if they have.
    bool wait(int threads, std::chrono::milliseconds period) {
        std::unique_lock lock(mutex_);
        return thread_left_.wait_for(lock, period, [&] { return left_ == threads; });
    }
    void rethrow() { error_.rethrow(); }

private:
    const Index count_;
    const FunctionRef<void(Index)> task_;
    std::atomic<Index> next_{0};
    std::atomic<bool> closed_{false};
    FirstError error_;
    std::mutex mutex_;
    std::condition_variable thread_left_;
    int left_ = 0;  // number of threads that have returned from drain()
};

/// The threads that run the tasks of a queue. The destructor waits until they have ended.
class TaskThreads {
public:
    explicit TaskThreads(TaskQueue& queue) : queue_(queue) {}
    ~TaskThreads() {
        for (std::thread& thread : threads_) thread.join();
    }
    TaskThreads(const TaskThreads&) = delete;
    TaskThreads& operator=(const TaskThreads&) = delete;

    void start(int count) {
        threads_.reserve(static_cast<std::size_t>(count));
        while (static_cast<int>(threads_.size()) < count) threads_.emplace_back([this] { queue_.drain(); });
    }

private:
    TaskQueue& queue_;
    std::vector<std::thread> threads_;
};

}  // namespace

int core_count() {
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void run_tasks(Index count, int threads, FunctionRef<void(Index)> task, std::chrono::milliseconds period,
               FunctionRef<void()> watch) {
    TaskQueue queue(count, task);
    {
        TaskThreads pool(queue);
        const int started = std::clamp(threads, 1, std::max(count, 1));
        try {
            pool.start(started);
            while (!queue.wait(started, period)) watch();
        } catch (...) {
            queue.close();
            throw;
        }
    }
    queue.rethrow();
}

}  // namespace skerry
