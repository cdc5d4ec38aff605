// Ends a run at a signal, between two steps.
#pragma once

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstring>

namespace skerry {

inline volatile std::sig_atomic_t caught_signal = 0;
// text that a signal writes to standard error at once; null: none
inline std::atomic<const char*> signal_note = nullptr;

/// Handles signals during a run. The first SIGINT or SIGTERM ends the run between two steps, and the second kills the
/// process. SIGXFSZ is ignored, so that exceeding the file size limit becomes an ordinary write error.
class SignalGuard {
public:
    SignalGuard() {
        struct sigaction action = {};
        action.sa_handler = [](int number) {
            caught_signal = number;
            const char* const note = signal_note;
            if (note != nullptr && ::write(STDERR_FILENO, note, std::strlen(note)) < 0) signal_note = nullptr;
        };
        action.sa_flags = static_cast<int>(SA_RESETHAND);
        sigaction(SIGINT, &action, &old_interrupt_);
        sigaction(SIGTERM, &action, &old_terminate_);
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
