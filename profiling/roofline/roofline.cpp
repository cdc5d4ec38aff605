#include "profiling/roofline/roofline.h"

#include <algorithm>
#include <barrier>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <thread>

#include "components/row_memory.h"
#include "profiling/measure.h"

// The build generates peak_loops.inc with a line SKERRY_EACH(name) for the table of each instruction set.
#define SKERRY_EACH(loops) extern "C" const skerry::profiling::PeakLoops loops;
#include <peak_loops.inc>
#undef SKERRY_EACH

namespace skerry::profiling {

namespace {

constexpr double sample_seconds = 1e-3;  // least duration of one timed sample [s]

/// Numbers in memory as columns of the library have it: from the start of a cache line, and on large pages if the
/// system has them. With pages of 4 kB, translation of addresses would limit the bandwidth.
class Array {
public:
    explicit Array(std::size_t count) : rows_(allocate_rows(count * sizeof(double))) {
        std::uninitialized_fill_n(data(), count, 1.0);
    }
    double* data() const { return static_cast<double*>(rows_.get()); }

private:
    struct Free {
        void operator()(void* rows) const { free_rows(rows); }
    };
    std::unique_ptr<void, Free> rows_;
};

/// Best rate of all workers together, over the repeats. work_of() prepares the work of one worker, which is then called
/// with a number of rounds and returns the amount of work done. All workers start each repeat at the same time.
template <class WorkOf>
double best_rate(int workers, int repeats, WorkOf&& work_of) {
    std::vector<std::vector<double>> rate(static_cast<std::size_t>(workers));
    std::barrier together(workers);
    const auto run = [&](std::size_t worker) {
        auto work = work_of();
        const auto seconds_of = [&](std::size_t rounds, double& amount) {
            const double start = wall_seconds();
            amount = work(rounds);
            return wall_seconds() - start;
        };
        std::size_t rounds = 1;
        double amount = 0;
        while (seconds_of(rounds, amount) < sample_seconds) rounds *= 2;
        for (int r = 0; r < repeats; ++r) {
            together.arrive_and_wait();
            const double seconds = seconds_of(rounds, amount);
            rate[worker].push_back(amount / seconds);
        }
        together.arrive_and_wait();
    };
    std::vector<std::jthread> others;
    for (int worker = 1; worker < workers; ++worker) others.emplace_back(run, static_cast<std::size_t>(worker));
    run(0);
    others.clear();
    double best = 0;
    for (std::size_t r = 0; r < rate[0].size(); ++r) {
        double sum = 0;
        for (const std::vector<double>& of_worker : rate) sum += of_worker[r];
        best = std::max(best, sum);
    }
    return best;
}

double flop_rate(FlopLoop loop, int workers, int repeats) {
    if (loop == nullptr) return 0;
    const auto work_of = [loop] { return [loop](std::size_t rounds) { return loop(1000 * rounds, 0.5, 1); }; };
    return best_rate(workers, repeats, work_of);
}

/// Number of reals of which `arrays` arrays take `bytes` together.
std::size_t count_of(double bytes, int arrays) {
    const auto reals = static_cast<std::size_t>(bytes / (arrays * static_cast<double>(sizeof(double))));
    return std::max<std::size_t>(1, reals / reals_per_round) * reals_per_round;
}

double read_rate(const PeakLoops& loops, double bytes, int workers, int repeats) {
    return best_rate(workers, repeats, [&] {
        const std::size_t count = count_of(bytes, 1);
        return [&loops, count, from = Array(count), sum = 0.0](std::size_t rounds) mutable {
            for (std::size_t r = 0; r < rounds; ++r) sum += loops.read(from.data(), count);
            const volatile double used = sum;
            static_cast<void>(used);
            return static_cast<double>(rounds * count * sizeof(double));
        };
    });
}

/// `transfers`: reals that are moved for each number.
double triad_rate(const PeakLoops& loops, double bytes, double transfers, int workers, int repeats) {
    return best_rate(workers, repeats, [&] {
        const std::size_t count = count_of(bytes, 3);
        return [&loops, count, transfers, to = Array(count), x = Array(count),
                y = Array(count)](std::size_t rounds) mutable {
            for (std::size_t r = 0; r < rounds; ++r) loops.triad(to.data(), x.data(), y.data(), 0.5, count);
            return transfers * static_cast<double>(rounds * count * sizeof(double));
        };
    });
}

}  // namespace

Roofline measure_roofline(const PeakLoops& loops, const CacheSizes& sizes, int workers, int repeats) {
    Roofline roofline{.separate_double = flop_rate(loops.separate_double, workers, repeats),
                      .fused_double = flop_rate(loops.fused_double, workers, repeats),
                      .separate_single = flop_rate(loops.separate_single, workers, repeats),
                      .fused_single = flop_rate(loops.fused_single, workers, repeats),
                      .levels = memory_levels(sizes, workers)};
    constexpr double least_memory = 128e6;  // [B]
    double below = 0;                       // capacity of the level before
    for (MemoryLevel& level : roofline.levels) {
        // Half of a cache leaves space for other data. In memory, four times the caches leave little of the arrays in
        // them.
        const double total =
            std::isinf(level.capacity) ? std::max(4 * below, least_memory) : std::max(level.capacity, 2 * below) / 2;
        level.read = read_rate(loops, total / workers, workers, repeats);
        // A store to the L1 cache fetches no line.
        level.triad = triad_rate(loops, total / workers, below > 0 ? 4 : 3, workers, repeats);
        below = level.capacity;
    }
    return roofline;
}

const PeakLoops& peak_loops_for(const std::string& instruction_set) {
#define SKERRY_EACH(loops) \
    if (instruction_set == loops.instruction_set) return loops;
#include <peak_loops.inc>
#undef SKERRY_EACH
    throw std::invalid_argument("peak loops: found none for the instruction set \"" + instruction_set +
                                "\", expected a set of this build");
}

}  // namespace skerry::profiling
