#include "profiling/scaling/measure_costs.h"

#include <chrono>
#include <thread>
#include <vector>

#include "jobs/team.h"
#include "profiling/measure.h"
#include "profiling/scaling/quiet.h"

namespace skerry::profiling {

namespace {

constexpr double block_seconds = 200e-6;  // longer than any delay that is measured

void work_for(double seconds) {
    const double end = wall_seconds() + seconds;
    while (wall_seconds() < end) continue;
}

/// Extra time of two blocks on two threads over one block [s].
double delay_of_two_blocks(Executor& executor) {
    const double start = wall_seconds();
    executor.run_blocks(2, [](Index) { work_for(block_seconds); });
    return wall_seconds() - start - block_seconds;
}

double phase_seconds(Executor& executor) {
    constexpr std::size_t phases = 2000;
    std::vector<Index> offset(phases + 1);
    for (std::size_t phase = 0; phase <= phases; ++phase) offset[phase] = static_cast<Index>(2 * phase);
    Team team;
    double seconds = 0;
    team.gather(executor, [&] {
        team.run_phases(offset, [](Index) {});  // waits until the other worker has joined
        const double start = wall_seconds();
        team.run_phases(offset, [](Index) {});
        seconds = wall_seconds() - start;
    });
    return seconds / phases;
}

}  // namespace

HandingOutCosts measure_costs() {
    const auto executor = make_executor(Backend::automatic, 2);
    std::vector<double> awake, asleep, phase;
    constexpr int batches = 5;
    for (int batch = 0; batch < batches; ++batch) {
        constexpr double patience = 4;  // [s]
        wait_for_quiet(patience);
        for (int i = 0; i < 100; ++i) awake.push_back(delay_of_two_blocks(*executor));
        for (int i = 0; i < 20; ++i) {
            phase.push_back(phase_seconds(*executor));
            std::this_thread::sleep_for(std::chrono::milliseconds(3));
            asleep.push_back(delay_of_two_blocks(*executor));
        }
    }
    return {lower_fifth(awake), lower_fifth(asleep), lower_fifth(phase)};
}

}  // namespace skerry::profiling
