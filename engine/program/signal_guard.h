// Ends a run at a signal, between two steps.
#pragma once

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstring>

namespace skerry {

inline volatile std::sig_atomic_t caught_signal = 0;
// text that the signal handler writes to standard error at once if the signal comes from the launcher (mpirun or srun),
// because the launcher may kill the process soon; null: none
inline std::atomic<const char*> signal_note = nullptr;

/// Handles signals while the object exists:
/// - first SIGINT or SIGTERM: sets caught_signal, and may print signal_note. The run then ends between two steps.
/// - second signal of the same kind: kills the process.
/// - SIGXFSZ: ignored, so that exceeding the file size limit becomes an ordinary write error.
class SignalGuard {
public:
    SignalGuard() {
        struct sigaction action = {};
        action.sa_sigaction = [](int number, siginfo_t* info, void*) {
            caught_signal = number;
            const char* const note = signal_note;
            const bool of_launcher = info->si_pid == getppid();
            if (note != nullptr && of_launcher && ::write(STDERR_FILENO, note, std::strlen(note)) < 0)
                signal_note = nullptr;
        };
        action.sa_flags = static_cast<int>(SA_RESETHAND | SA_SIGINFO);
        sigaction(SIGINT, &action, &old_interrupt_);
        sigaction(SIGTERM, &action, &old_terminate_);
        action.sa_flags = 0;
        action.sa_handler = SIG_IGN;
        sigaction(SIGXFSZ, &action, &old_too_large_);
    }
    ~SignalGuard() {
        sigaction(SIGINT, &old_interrupt_, nullptr);
        sigaction(SIGTERM, &old_terminate_, nullptr);
        sigaction(SIGXFSZ, &old_too_large_, nullptr);
    }
    SignalGuard(const SignalGuard&) = delete;
    SignalGuard& operator=(const SignalGuard&) = delete;

private:
    struct sigaction old_interrupt_, old_terminate_, old_too_large_;
};

}  // namespace skerry
