// Lock for data that are computed only when a thread first needs them, outside of time steps.
#pragma once

#include <mutex>

namespace skerry {

class Lock {
public:
    /// Locks until the returned object is destroyed. The lock is not recursive: a thread that holds it must not lock it
    /// again.
    [[nodiscard]] std::unique_lock<std::mutex> hold() { return std::unique_lock(mutex_); }

private:
    std::mutex mutex_;
};

}  // namespace skerry
