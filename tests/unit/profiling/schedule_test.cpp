#include "profiling/scaling/schedule.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "tests/unit/profiling/hand_made.h"

namespace skerry::test::profiling_schedule_test {

using namespace skerry::profiling;

namespace {

constexpr double us = 1e-6;

/// Predicted time on a machine without overheads [us].
double free_us(const Recording& recording, int cores) {
    return predict_seconds(recording, cores, MachineModel::free_of_cost()) / us;
}

std::vector<double> blocks(std::size_t count, double seconds) {
    return std::vector<double>(count, seconds);
}

/// Stages of one serial piece or one loop, with random edges.
Recording random_recording(unsigned seed, bool loops) {
    std::mt19937 random(seed);
    const auto below = [&](unsigned n) { return static_cast<unsigned>(random() % n); };
    const Index count = 1 + static_cast<Index>(below(30));
    std::vector<std::vector<HandMadePiece>> stages;
    std::vector<std::pair<Index, Index>> edges;
    for (Index s = 0; s < count; ++s) {
        if (loops && below(2) == 0) {
            std::vector<double> seconds(1 + below(40));
            for (double& each : seconds) each = (1 + below(9)) * us;
            stages.push_back({serial(below(4) * us), loop(seconds), serial(us)});
        } else {
            stages.push_back({serial((1 + below(20)) * us)});
        }
        for (Index to = s + 1; to < count; ++to)
            if (below(10) == 0) edges.emplace_back(s, to);
    }
    return graph_of(stages, edges);
}

}  // namespace

TEST_CASE("a chain takes the same on any number of cores", "[unit]") {
    const Recording chain = graph_of({{serial(us)}, {serial(2 * us)}, {serial(3 * us)}}, {{0, 1}, {1, 2}});
    for (int cores : {1, 2, 64}) CHECK(free_us(chain, cores) == Approx(6));
    CHECK(chain.critical_path() / us == Approx(6));
    CHECK(chain.serial() / us == Approx(6));
}

TEST_CASE("stages that do not wait for each other run at the same time", "[unit]") {
    const Recording fork =
        graph_of({{serial(us)}, {serial(5 * us)}, {serial(3 * us)}, {serial(us)}}, {{0, 1}, {0, 2}, {1, 3}, {2, 3}});
    CHECK(free_us(fork, 1) == Approx(10));
    CHECK(free_us(fork, 2) == Approx(7));
    CHECK(free_us(fork, 64) == Approx(7));
    CHECK(fork.critical_path() / us == Approx(7));
}

TEST_CASE("blocks of a loop are shared, and later work waits for the last block", "[unit]") {
    const Recording recording = graph_of({{serial(us), loop(blocks(8, us)), serial(2 * us)}}, {});
    CHECK(free_us(recording, 1) == Approx(11));
    CHECK(free_us(recording, 3) == Approx(6));
    CHECK(free_us(recording, 4) == Approx(5));
    SECTION("more cores than blocks bring nothing more") {
        CHECK(free_us(recording, 8) == Approx(4));
        CHECK(free_us(recording, 100) == Approx(4));
    }
    CHECK(recording.serial() / us == Approx(3));
    CHECK(recording.critical_path() / us == Approx(4));
}

TEST_CASE("one long block holds a loop up, most when it is taken last", "[unit]") {
    const Recording first = graph_of({{loop({9 * us, us, us, us})}}, {});
    const Recording last = graph_of({{loop({us, us, us, 9 * us})}}, {});
    CHECK(free_us(first, 2) == Approx(9));  // the other worker takes all other blocks
    CHECK(free_us(last, 2) == Approx(10));  // the long block is the second of two in its share
    CHECK(free_us(last, 4) == Approx(9));
}

TEST_CASE("who is through with its stage takes blocks of another's loop", "[unit]") {
    const Recording recording = graph_of({{loop(blocks(10, us))}, {serial(2 * us)}}, {});
    CHECK(free_us(recording, 2) == Approx(6));
}

TEST_CASE("a worker costs a join, a barrier or a wake-up, and a counter is free for one at a time", "[unit]") {
    MachineModel machine = MachineModel::free_of_cost();
    const Recording two = graph_of({{loop(blocks(2, 10 * us))}}, {});
    machine.join = 0.5 * us;
    CHECK(predict_seconds(two, 2, machine) / us == Approx(10.5));
    const Recording late = graph_of({{serial(100 * us), loop(blocks(2, 10 * us))}}, {});
    machine.wake_up = 5 * us;
    machine.patience = 50 * us;
    CHECK(predict_seconds(late, 2, machine) / us == Approx(115));
    machine.barrier = 0.3 * us;
    const Recording phases = graph_of({{phase(blocks(2, us)), phase(blocks(1, us)), phase(blocks(4, us))}}, {});
    CHECK(predict_seconds(phases, 2, machine) / us == Approx(1.3 + 1 + 2.3));

    MachineModel counter = MachineModel::free_of_cost();
    counter.line_transfer = us;
    const Recording even = graph_of({{loop(blocks(100, 0.1 * us))}}, {});
    CHECK(predict_seconds(even, 4, counter) / us < 5);  // each worker has its own counter
    // The third worker's share has the long blocks. Another worker takes one, but not before the counter has moved.
    Recording uneven = graph_of({{loop(blocks(8, 0.1 * us))}}, {});
    for (std::size_t b = 4; b < 6; ++b) uneven.seconds[b] = 50 * us;
    const double without = free_us(uneven, 4);
    CHECK(predict_seconds(uneven, 4, counter) / us == Approx(without + 1).margin(0.2));
}

TEST_CASE("phases wait for each other and are shared by who is free", "[unit]") {
    const Recording recording = graph_of({{phase(blocks(4, us)), serial(us), phase(blocks(3, us))}}, {});
    CHECK(free_us(recording, 1) == Approx(8));
    CHECK(free_us(recording, 2) == Approx(2 + 1 + 2));
    CHECK(free_us(recording, 4) == Approx(1 + 1 + 1));
    CHECK(recording.critical_path() / us == Approx(3));
}

TEST_CASE("cores share the bandwidth, and chiplets share written data", "[unit]") {
    MachineModel machine = MachineModel::free_of_cost();
    const Recording recording = graph_of({{loop(blocks(4, us))}}, {});
    machine.bandwidth = 20e9;
    const Traffic large{.bytes_per_second = 10e9, .working_set = 1e12};
    CHECK(predict_seconds(recording, 4, machine, large) / us == Approx(2));
    CHECK(predict_seconds(recording, 2, machine, large) / us == Approx(2));
    CHECK(predict_seconds(recording, 4, machine, {.bytes_per_second = 10e9, .working_set = 1e6}) / us == Approx(1));
    machine.own_from_elsewhere = 1;
    machine.far_rate = 10e9;
    machine.cores_per_chiplet = 2;  // half of the data is on the other chiplet, a quarter on the other core of this one
    CHECK(predict_seconds(recording, 4, machine, {.bytes_per_second = 10e9, .working_set = 1e6}) / us == Approx(1.5));
    machine.near_rate = 5e9;
    CHECK(predict_seconds(recording, 4, machine, {.bytes_per_second = 10e9, .working_set = 1e6}) / us == Approx(2));
    machine.own_from_elsewhere = 0.1;  // each core takes the block of its own share
    CHECK(predict_seconds(recording, 4, machine, {.bytes_per_second = 10e9, .working_set = 1e6}) / us == Approx(1.1));
}

TEST_CASE("costs of stages tell where the time goes", "[unit]") {
    const auto costs = [](const Recording& recording, int cores, const MachineModel& machine) {
        std::vector<StageCost> found = stage_costs(recording, cores, machine);
        for (StageCost& cost : found) {
            cost.work /= us;
            cost.exchange /= us;
            cost.handing_out /= us;
            cost.alone /= us;
            cost.tail /= us;
        }
        return found;
    };
    SECTION("what one does alone, and the last block of a loop, by cores that wait") {
        const Recording recording =
            graph_of({{serial(2 * us), loop({us, us, us, us, us})}, {serial(3 * us)}}, {{0, 1}});
        const std::vector<StageCost> found = costs(recording, 4, MachineModel::free_of_cost());
        REQUIRE(found.size() == 3);
        CHECK(found[0].work == Approx(7.0 / 4));
        CHECK(found[0].alone == Approx(2 * 3.0 / 4));
        CHECK(found[0].tail == Approx(3.0 / 4));  // the fifth block
        CHECK(found[0].sum() == Approx(4));
        CHECK(found[1].work == Approx(3.0 / 4));
        CHECK(found[1].alone == Approx(3 * 3.0 / 4));
        CHECK(found[2].sum() == 0);
    }
    SECTION("a join is none of the waiting") {
        MachineModel machine = MachineModel::free_of_cost();
        machine.join = 0.5 * us;
        const std::vector<StageCost> found = costs(graph_of({{loop(blocks(2, 10 * us))}}, {}), 2, machine);
        CHECK(found[0].handing_out == Approx(0.25));
        CHECK(found[0].tail == Approx(0.25));
        CHECK(found[0].work == Approx(10));
    }
    SECTION("members that a team has no block for wait") {
        MachineModel machine = MachineModel::free_of_cost();
        machine.barrier = us;
        const std::vector<StageCost> found = costs(graph_of({{phase(blocks(2, 4 * us))}}, {}), 4, machine);
        CHECK(found[0].work == Approx(2));
        CHECK(found[0].handing_out == Approx(0.5));
        CHECK(found[0].tail == Approx(2 * 5.0 / 4));
    }
    SECTION("all together they are what is predicted") {
        MachineModel machine;
        machine.near_rate = 1e9;
        const Traffic traffic{.bytes_per_second = 1e9, .working_set = 1e12};
        for (unsigned seed = 0; seed < 40; ++seed) {
            const Recording recording = random_recording(seed, true);
            for (const int cores : {1, 3, 16, 64}) {
                double sum = 0, work = 0;
                for (const StageCost& cost : stage_costs(recording, cores, machine, traffic)) {
                    sum += cost.sum();
                    work += cost.work;
                }
                CHECK(sum == Approx(predict_seconds(recording, cores, machine, traffic)));
                CHECK(work == Approx(recording.work() / cores));
            }
        }
    }
}

TEST_CASE("one core does the work between two graphs", "[unit]") {
    Recording recording = graph_of({{loop(blocks(4, us))}}, {});
    Recording between;
    between.runs = {{no_index, {0, 1}}};
    between.pieces = {{PieceKind::serial, {0, 1}}};
    between.seconds = {3 * us};
    append(between, recording);
    append(graph_of({{loop(blocks(4, us))}}, {}), recording);
    CHECK(free_us(recording, 4) == Approx(1 + 3 + 1));
    CHECK(recording.critical_path() / us == Approx(5));
}

TEST_CASE("a schedule of random stages keeps Graham's bounds", "[unit]") {
    for (unsigned seed = 0; seed < 200; ++seed) {
        const Recording recording = random_recording(seed, false);
        const double work = recording.work() / us, path = recording.critical_path() / us;
        for (int cores : {1, 2, 3, 7, 40}) {
            INFO("seed " << seed << ", " << cores << " cores");
            const double time = free_us(recording, cores);
            CHECK(time >= std::max(work / cores, path) * (1 - 1e-12));
            CHECK(time <= (work / cores + (1 - 1.0 / cores) * path) * (1 + 1e-12));
        }
    }
}

TEST_CASE("with loops no schedule is shorter than work and longest chain allow, nor longer than one core takes",
          "[unit]") {
    for (unsigned seed = 0; seed < 200; ++seed) {
        const Recording recording = random_recording(seed, true);
        const double work = recording.work() / us, path = recording.critical_path() / us;
        CHECK(free_us(recording, 1) == Approx(work));
        for (int cores : {2, 5, 64}) {
            INFO("seed " << seed << ", " << cores << " cores");
            const double time = free_us(recording, cores);
            CHECK(time >= std::max(work / cores, path) * (1 - 1e-12));
            CHECK(time <= work * (1 + 1e-12));
        }
    }
}

}  // namespace skerry::test::profiling_schedule_test
