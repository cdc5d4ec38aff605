// profile_messages: measures messages between MPI ranks through the interface Ranks. mpirun starts it on two or more
// ranks. study_ranks.py uses the output.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <limits>
#include <vector>

#include "jobs/ranks/mpi_ranks.h"

using namespace skerry;

namespace {

/// Time of a call [s]: the least mean of several batches, because other programs only make calls slower.
double seconds_of(const std::function<void()>& call) {
    constexpr int batches = 20, calls = 50;
    double least = std::numeric_limits<double>::infinity();
    for (int batch = 0; batch < batches; ++batch) {
        const auto start = std::chrono::steady_clock::now();
        for (int i = 0; i < calls; ++i) call();
        least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return least / calls;
}

}  // namespace

int main() {
    const std::unique_ptr<Ranks> ranks = start_mpi();
    const auto report = [&](const char* call, std::size_t peers, std::size_t bytes, double seconds) {
        if (ranks->rank() == 0) std::printf("%s,%d,%zu,%zu,%.3g\n", call, ranks->size(), peers, bytes, seconds);
    };
    if (ranks->rank() == 0) std::printf("call,ranks,peers,bytes,seconds\n");
    std::vector<int> others;
    for (int rank = 0; rank < ranks->size(); ++rank)
        if (rank != ranks->rank()) others.push_back(rank);
    for (const std::size_t bytes : std::initializer_list<std::size_t>{0, 1000, 10000, 100000, 1000000}) {
        const std::vector<RankMessage> out(others.size(), RankMessage(bytes));
        std::vector<RankMessage> in(others.size());
        report("exchange", others.size(), bytes, seconds_of([&] { ranks->exchange(others, out, in); }));
    }
    constexpr std::size_t record_bytes = 256;
    std::vector<std::byte> record(record_bytes);
    const auto keep = [](std::byte*, const std::byte*) {};
    report("reduce", others.size(), record_bytes, seconds_of([&] { ranks->reduce(record, keep); }));
    return 0;
}
