// Pool of working memories for regions that are solved concurrently.
#pragma once

#include <atomic>
#include <memory>
#include <utility>
#include <vector>

namespace skerry {

/// The pool has one memory per worker. Results must not depend on which memory a region gets.
template <class Memory>
class Pool {
    struct Slot {
        std::atomic<bool> taken = false;
        Memory memory;
    };

public:
    /// A leased memory. The destructor returns the memory to the pool.
    class Lease {
    public:
        Lease() = default;
        explicit Lease(Slot& slot) : slot_(&slot) {}
        Lease(Lease&& other) noexcept : slot_(std::exchange(other.slot_, nullptr)) {}
        Lease& operator=(Lease&& other) noexcept {
            std::swap(slot_, other.slot_);
            return *this;
        }
        ~Lease() {
            if (slot_ != nullptr) slot_->taken.store(false, std::memory_order_release);
        }
        explicit operator bool() const { return slot_ != nullptr; }
        Memory& operator*() const { return slot_->memory; }
        Memory* operator->() const { return &slot_->memory; }

    private:
        Slot* slot_ = nullptr;
    };

    /// Makes room for this number of workers. Call it only while no memory is leased.
    void make_room(std::size_t workers) {
        while (slots_.size() < workers) slots_.push_back(std::make_unique<Slot>());
    }
    /// Leases a working memory. At least one is free, because each worker solves one region at a time.
    Lease lease() {
        while (true)
            for (const std::unique_ptr<Slot>& slot : slots_)
                if (!slot->taken.exchange(true, std::memory_order_acquire)) return Lease(*slot);
    }

private:
    std::vector<std::unique_ptr<Slot>> slots_;
};

}  // namespace skerry
