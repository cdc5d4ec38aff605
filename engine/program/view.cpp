#include <fcntl.h>
#include <spawn.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>

#include "engine/output/number_text.h"
#include "engine/program/commands.h"
#include "engine/program/plan_warnings.h"
#include "engine/program/progress.h"
#include "engine/program/signal_guard.h"
#include "engine/scene/scene_plan.h"
#include "skerry/live.h"

namespace skerry {

namespace {

/// A page that redirects a browser to an address. Other users of the machine can read the arguments of programs, but
/// not this file, so that the token in the address stays secret. The destructor removes the file.
class LeadingPage {
public:
    explicit LeadingPage(const std::string& address) {
        std::error_code error;
        const std::filesystem::path temporary = std::filesystem::temp_directory_path(error);
        std::string folder = (temporary / "skerry-view-XXXXXX").string();
        if (error || !mkdtemp(folder.data())) return;
        folder_ = folder;
        const std::string page =
            "<!doctype html><meta charset=\"utf-8\"><meta http-equiv=\"refresh\" content=\"0; url=" + address + "\">\n";
        const int file = ::open(path().c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0600);
        if (file < 0) return;
        const ssize_t written = ::write(file, page.data(), page.size());
        is_complete_ = ::close(file) == 0 && written == static_cast<ssize_t>(page.size());
    }
    ~LeadingPage() {
        if (folder_.empty()) return;
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }
    LeadingPage(const LeadingPage&) = delete;
    LeadingPage& operator=(const LeadingPage&) = delete;

    bool is_complete() const { return is_complete_; }
    std::string path() const { return (folder_ / "view.html").string(); }

private:
    std::filesystem::path folder_;
    bool is_complete_ = false;
};

bool has_desktop() {
    return std::getenv("DISPLAY") || std::getenv("WAYLAND_DISPLAY");
}

/// Opens a file in the browser of the user. Does nothing if there is no program to open it.
void open_in_browser(const std::string& path) {
    posix_spawn_file_actions_t silence;
    posix_spawnattr_t own_group;  // a process group of its own, so that Ctrl-C does not end the browser
    posix_spawn_file_actions_init(&silence);
    posix_spawnattr_init(&own_group);
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        posix_spawn_file_actions_addopen(&silence, stream, "/dev/null", O_RDWR, 0);
    posix_spawnattr_setflags(&own_group, POSIX_SPAWN_SETPGROUP);
    std::string name = "xdg-open", argument = path;
    char* const arguments[] = {name.data(), argument.data(), nullptr};
    pid_t process = 0;
    static_cast<void>(posix_spawnp(&process, name.c_str(), &silence, &own_group, arguments, environ));
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
    const SignalGuard guard;
    std::cout << scene.name << ": open " << live.address() << " in a browser; Ctrl-C ends" << std::endl;
    std::optional<LeadingPage> page;
    if (options.open && has_desktop() && page.emplace(live.address()).is_complete()) open_in_browser(page->path());
    const Stopwatch watch;
    Real simulated = 0, before = scene.world.time();
    const auto go_on = [&] {
        // Only increases of the time are added, because a reset of the view sets the time of the world back.
        simulated += std::max<Real>(0, scene.world.time() - before);
        before = scene.world.time();
        return caught_signal == 0 && !(options.seconds && simulated >= *options.seconds);
    };
    live.run(scene.world, go_on, [](const std::string& problem) { std::cerr << "skerry: " << problem << std::endl; });
    const double wall = watch.seconds();
    std::cout << scene.name << ": " << short_text(simulated, 4) << " s simulated in " << with_unit(wall, "s") << ", "
              << short_text(simulated / wall) << " times real time; frames: " << live.frames_sent() << " sent, "
              << live.frames_dropped() << " dropped" << std::endl;
    return exit_ok;
}

}  // namespace skerry
