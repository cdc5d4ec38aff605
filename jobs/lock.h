// Lock for data outside a step that several threads may fill when they first need them.
#pragma once

#include <mutex>

namespace skerry {

class Lock {
public:
    /// Locks until the returned object is destroyed. A thread must not lock twice.
    [[nodiscard]] std::unique_lock<std::mutex> hold() { return std::unique_lock(mutex_); }

private:
    std::mutex mutex_;
};

}  // namespace skerry
