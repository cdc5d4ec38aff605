#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <string>

#include "engine/program/commands.h"
#include "engine/program/number_text.h"
#include "engine/program/plan_warnings.h"
#include "engine/program/progress.h"
#include "engine/program/signal_guard.h"
#include "engine/scene/scene_plan.h"
#include "skerry/live.h"

namespace skerry {

namespace {

/// Opens an address in the browser of the user. Does nothing if there is no desktop or no program to open it.
void open_browser(const std::string& address) {
#ifdef __APPLE__
    const char* const program = "open";
#else
    const char* const program = "xdg-open";
    if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY")) return;
#endif
    posix_spawn_file_actions_t silence;
    posix_spawnattr_t own_group;  // so that Ctrl-C does not end the browser
    posix_spawn_file_actions_init(&silence);
    posix_spawnattr_init(&own_group);
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        posix_spawn_file_actions_addopen(&silence, stream, "/dev/null", O_RDWR, 0);
    posix_spawnattr_setflags(&own_group, POSIX_SPAWN_SETPGROUP);
    std::string name = program, argument = address;
    char* const arguments[] = {name.data(), argument.data(), nullptr};
    pid_t process = 0;
    static_cast<void>(posix_spawnp(&process, program, &silence, &own_group, arguments, environ));
    posix_spawn_file_actions_destroy(&silence);
    posix_spawnattr_destroy(&own_group);
}

}  // namespace

int view(const ViewOptions& options) {
    const ScenePlan plan = plan_with_progress(options.scene, options.overrides, true);
    print_lines("WARNING", plan_warnings(plan));
    print_lines("NOTE", plan_notes(plan));
    SetupProgress setup(true, plan);
    Scene scene = build_scene(plan, [&](std::size_t bodies) { setup.added(bodies); });
    LiveView live(scene.world, {.title = scene.name,
                                .port = options.port,
                                .rate = options.rate,
                                .paused = options.paused,
                                .sliders = scene.sliders,
                                .probes = scene.recorded});
    std::cout << scene.name << ": open " << live.address() << " in a browser; Ctrl-C ends" << std::endl;
    if (options.open) open_browser(live.address());
    const SignalGuard guard;
    const Stopwatch watch;
    Real simulated = 0, before = scene.world.time();
    const auto go_on = [&] {
        // Sums of the advances, because a reset sets the time of the world back.
        simulated += std::max<Real>(0, scene.world.time() - before);
        before = scene.world.time();
        return caught_signal == 0 && !(options.seconds && simulated >= *options.seconds);
    };
    live.run(scene.world, go_on, [](const std::string& problem) { std::cerr << "skerry: " << problem << std::endl; });
    const double wall = watch.seconds();
    std::cout << scene.name << ": " << short_number(simulated, 4) << " s simulated in " << with_unit(wall, "s") << ", "
              << short_number(simulated / wall) << " times real time; frames: " << live.frames_sent() << " sent, "
              << live.frames_dropped() << " dropped" << std::endl;
    return exit_ok;
}

}  // namespace skerry
