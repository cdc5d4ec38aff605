#include "engine/program/sweep/process_pool.h"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <iostream>
#include <system_error>

namespace skerry {

namespace {

/// Blocks the signals that the pool waits for. A signal that arrives between a check and the next wait is then not
/// lost.
class HeldSignals {
public:
    HeldSignals() {
        sigemptyset(&held_);
        for (const int number : {SIGCHLD, SIGINT, SIGTERM}) sigaddset(&held_, number);
        sigprocmask(SIG_BLOCK, &held_, &before_);
    }
    ~HeldSignals() { sigprocmask(SIG_SETMASK, &before_, nullptr); }
    HeldSignals(const HeldSignals&) = delete;
    HeldSignals& operator=(const HeldSignals&) = delete;

    /// Waits for one of the blocked signals. Returns the number of the signal, or 0 if none arrives within half a
    /// second.
    int next() const {
        const timespec patience{0, 500000000};  // [ns]
        const int number = sigtimedwait(&held_, nullptr, &patience);
        return number > 0 ? number : 0;
    }
    /// Restores the signal mask that was set before the pool was created. A child process calls this function, so that
    /// signals end it.
    void let_go() const { sigprocmask(SIG_SETMASK, &before_, nullptr); }

private:
    sigset_t held_, before_;
};

std::string how_it_ended(int status) {
    if (!WIFSIGNALED(status)) return "ended with exit code " + std::to_string(WEXITSTATUS(status));
    const int number = WTERMSIG(status);
    const char* const hint = number == SIGKILL ? ", which the system sends if memory runs out" : "";
    return "ended by signal " + std::to_string(number) + " (" + strsignal(number) + hint + ")";
}

class ProcessPool {
public:
    ProcessPool(int count, int at_once, const PoolCalls& calls) : count_(count), at_once_(at_once), calls_(calls) {}

    PoolEnd run() {
        while ((may_begin_ && next_ < count_) || !running_.empty()) {
            begin_jobs();
            collect();
            calls_.show(ended_, static_cast<int>(running_.size()));
            const bool room = may_begin_ && next_ < count_ && static_cast<int>(running_.size()) < at_once_;
            if (running_.empty() || room) continue;
            const int number = signals_.next();
            if (number == SIGINT || number == SIGTERM) stop(number);
        }
        return std::move(end_);
    }

private:
    struct Running {
        pid_t process;
        int job;
    };

    void begin_jobs() {
        while (may_begin_ && next_ < count_ && static_cast<int>(running_.size()) < at_once_) {
            std::cout.flush();
            // Buffers are flushed before the fork. Otherwise parent and child would both write the buffered text.
            std::fflush(nullptr);
            const pid_t parent = getpid(), process = fork();
            if (process == 0) in_child(parent);
            if (process < 0 && running_.empty())
                throw std::system_error(errno, std::generic_category(), "cannot start a process for a case");
            if (process < 0) {
                // the system allows no more processes than are running now
                at_once_ = static_cast<int>(running_.size());
                return;
            }
            running_.push_back({process, next_++});
        }
    }

    [[noreturn]] void in_child(pid_t parent) {
        for (const int number : {SIGINT, SIGTERM}) std::signal(number, SIG_DFL);
        signals_.let_go();
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (getppid() != parent) _exit(1);  // the parent process ended before the call of prctl
        const int code = calls_.run(next_);
        std::cout.flush();
        std::fflush(nullptr);
        _exit(code);  // unlike exit, _exit does not run the exit handlers of the parent
    }

    void collect() {
        std::erase_if(running_, [this](const Running& of) {
            int status = 0;
            if (waitpid(of.process, &status, WNOHANG) != of.process) return false;
            ended(of.job, status);
            return true;
        });
    }

    void ended(int job, int status) {
        ++ended_;
        const bool well = WIFEXITED(status) && WEXITSTATUS(status) == 0;
        if (well)
            ++end_.done;
        else if (end_.signal != 0)
            end_.stopped.push_back(job);
        else
            end_.lost.emplace_back(job, how_it_ended(status));
        may_begin_ &= calls_.goes_on(job, WIFEXITED(status) ? WEXITSTATUS(status) : -1);
    }

    void stop(int number) {
        const int sent = end_.signal == 0 ? SIGTERM : SIGKILL;
        end_.signal = number;
        may_begin_ = false;
        for (const Running& of : running_) kill(of.process, sent);
    }

    const int count_;
    int at_once_;
    const PoolCalls& calls_;
    const HeldSignals signals_;
    std::vector<Running> running_;
    int next_ = 0, ended_ = 0;
    bool may_begin_ = true;
    PoolEnd end_;
};

}  // namespace

PoolEnd run_in_processes(int count, int at_once, const PoolCalls& calls) {
    return ProcessPool(count, at_once, calls).run();
}

}  // namespace skerry
