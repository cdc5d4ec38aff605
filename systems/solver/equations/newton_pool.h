// Memory for Newton steps of regions that are solved at the same time.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "systems/solver/equations/body_equations.h"

namespace skerry {

/// As many as were ever in use at once, which is as many as there are workers.
class NewtonPool {
public:
    /// Gives its equations back.
    class Lease {
    public:
        Lease() = default;
        Lease(NewtonPool& pool, std::unique_ptr<BodyEquations> equations)
            : pool_(&pool), equations_(std::move(equations)) {}
        Lease(Lease&&) noexcept = default;
        Lease& operator=(Lease&&) noexcept = default;
        ~Lease() {
            if (equations_) pool_->give_back(std::move(equations_));
        }
        explicit operator bool() const { return equations_ != nullptr; }
        BodyEquations& operator*() const { return *equations_; }

    private:
        NewtonPool* pool_ = nullptr;
        std::unique_ptr<BodyEquations> equations_;
    };

    Lease lease() {
        const std::scoped_lock lock(mutex_);
        if (idle_.empty()) {
            idle_.reserve(++count_);  // so that giving back allocates nothing
            return {*this, std::make_unique<BodyEquations>()};
        }
        Lease last(*this, std::move(idle_.back()));
        idle_.pop_back();
        return last;
    }

private:
    void give_back(std::unique_ptr<BodyEquations> equations) {
        const std::scoped_lock lock(mutex_);
        idle_.push_back(std::move(equations));
    }

    std::mutex mutex_;
    std::vector<std::unique_ptr<BodyEquations>> idle_;
    std::size_t count_ = 0;
};

}  // namespace skerry
