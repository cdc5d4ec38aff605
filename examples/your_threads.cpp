// The host owns the threads. A world runs in the task arena that calls it and never outside of it. The number of
// threads does not change a bit of the result.
#include <skerry/world.h>
#include <tbb/task_arena.h>

#include <cstdint>
#include <iostream>
#include <stdexcept>

namespace {

/// Three balls on top of each other fall for a third of a second.
std::uint64_t fall(const skerry::Settings& settings) {
    skerry::World world(settings);
    auto rubber = world.add_material({.young_modulus = 5e4});
    world.add_collider(skerry::Plane{});
    for (int i = 0; i < 3; ++i)
        world.add_body(skerry::mesh::ball(0.1, 6), {.material = rubber, .position = {0.01 * i, 0, 0.12 + 0.21 * i}});
    const skerry::StepReport report = world.advance(1.0 / 3.0);
    if (!report.ok()) throw std::runtime_error(report.message());
    return world.state_hash();
}

}  // namespace

int main() {
    // A world uses the arena of its caller by default: here an arena of the host with two threads.
    tbb::task_arena arena(2);
    const std::uint64_t in_your_arena = arena.execute([] { return fall({}); });

    // Alternatively, a world gets an arena of its own with a given number of threads.
    const std::uint64_t on_one_thread = fall({.threads = 1});
    const std::uint64_t on_four_threads = fall({.threads = 4});

    std::cout << std::hex << in_your_arena << " in the arena of the host\n"
              << on_one_thread << " on one thread\n"
              << on_four_threads << " on four threads\n";
    return in_your_arena == on_one_thread && in_your_arena == on_four_threads ? 0 : 1;
}
