// Runs random scenes for a given time, each in its own process. A crash or hang is recorded and the next scene runs.
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <map>

#include "run_random_scene.h"
#include "tests/support/temporary_folder.h"

using namespace skerry;
using namespace skerry::test;

namespace {

struct Options {
    double seconds = 60;                   // wall time for all scenes [s]
    std::uint64_t seed = 1;                // seed of the first scene
    std::uint64_t scenes = 0;              // 0: as many as the time allows
    double scene_seconds = 20;             // CPU time after which a scene is cut short before its next step [s]
    double hang_seconds = 200;             // CPU time after which an unfinished scene counts as hung [s]
    int compare_every = 8;                 // one scene in so many is run again on other threads
    bool list = false;                     // print one line per scene
    std::filesystem::path out;             // folder for failed scenes
    std::vector<std::string> assignments;  // settings for all scenes, as in SceneOverrides
};

class Clock {
public:
    double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

struct Verdict {
    std::string kind;  // ok, refused, cut_short, failed, crashed, hung
    std::string text;
};

/// Runs a scene in the current process and returns the verdict that the child process reports.
Verdict run_here(const RandomScene& scene, bool compare, const Options& options) {
    const TemporaryFolder folder;
    char text[512];
    try {
        const SceneRun run =
            run_random_scene(scene, folder.path(), {.assignments = options.assignments}, options.scene_seconds);
        // A run that the clock did not cut short ends at the same step as its rerun.
        if (compare && run.end != SceneEnd::cut_short) {
            const SceneOverrides other{.threads = 4, .backend = Backend::threads, .assignments = options.assignments};
            const SceneRun again = run_random_scene(scene, folder.path(), other);
            if (again.hash != run.hash || again.steps != run.steps) return {"failed", "other bits on other threads"};
        }
        std::snprintf(text, sizeof text, "steps %" PRIu64 " contacts %d growth %.3g energy off by %.3g %% %s",
                      run.steps, static_cast<int>(run.max_contacts), run.energy_growth, 100 * run.energy_error_share,
                      run.message.c_str());
        const char* const kinds[] = {"ok", "refused", "cut_short"};
        return {kinds[static_cast<int>(run.end)], text};
    } catch (const std::exception& error) {
        return {"failed", error.what()};
    }
}

/// Runs a scene in a child process and waits for it.
Verdict run_apart(const RandomScene& scene, bool compare, const Options& options) {
    int channel[2];
    if (pipe(channel) != 0) return {"failed", "no pipe"};
    const pid_t child = fork();
    if (child == 0) {
        close(channel[0]);
        // The limit is CPU time, because wall time means nothing on a busy machine.
        const rlimit limit{static_cast<rlim_t>(options.hang_seconds), RLIM_INFINITY};
        setrlimit(RLIMIT_CPU, &limit);
        const Verdict verdict = run_here(scene, compare, options);
        const std::string said = verdict.kind + " " + verdict.text;
        const bool written = write(channel[1], said.data(), said.size()) == static_cast<ssize_t>(said.size());
        _exit(written ? 0 : 1);
    }
    close(channel[1]);
    std::string said;
    char buffer[4096];
    for (ssize_t got; (got = read(channel[0], buffer, sizeof buffer)) > 0;)
        said.append(buffer, static_cast<std::size_t>(got));
    close(channel[0]);
    int status = 0;
    waitpid(child, &status, 0);
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) return {"hung", ""};
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        return {"crashed", WIFSIGNALED(status) ? strsignal(WTERMSIG(status)) : "left without a word"};
    const std::size_t space = said.find(' ');
    return {said.substr(0, space), space == std::string::npos ? "" : said.substr(space + 1)};
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app("Runs random scenes and checks every step of them.");
    app.add_option("--seconds", options.seconds, "wall time for all of them");
    app.add_option("--seed", options.seed, "of the first scene; the next ones count up");
    app.add_option("--scenes", options.scenes, "stop after so many");
    app.add_option("--scene-seconds", options.scene_seconds, "CPU time after which a scene is cut short");
    app.add_option("--hang-seconds", options.hang_seconds, "CPU time after which a scene counts as hung");
    app.add_option("--compare-every", options.compare_every,
                   "every so many scenes is run again on four threads; 0: none");
    app.add_option("--set", options.assignments, "PLACE=VALUE in every scene, such as settings.clusters=false");
    app.add_option("--out", options.out, "folder for the scenes that failed, as JSON");
    app.add_flag("--list", options.list, "one line a scene");
    CLI11_PARSE(app, argc, argv);

    const Clock clock;
    std::map<std::string, int> counts;
    std::uint64_t done = 0;
    double shown = 0;
    for (std::uint64_t seed = options.seed;
         clock.seconds() < options.seconds && (options.scenes == 0 || done < options.scenes); ++seed, ++done) {
        const RandomScene scene = make_random_scene(seed);
        const bool compare = options.compare_every > 0 && seed % static_cast<std::uint64_t>(options.compare_every) == 0;
        const Clock of_scene;
        const Verdict verdict = run_apart(scene, compare, options);
        ++counts[verdict.kind];
        const bool bad = verdict.kind == "failed" || verdict.kind == "crashed" || verdict.kind == "hung";
        if (bad || options.list)
            std::printf("%" PRIu64 " %s %.1f s %s%s\n", seed, verdict.kind.c_str(), of_scene.seconds(),
                        scene.passive ? "passive " : "", verdict.text.c_str());
        if (bad && !options.out.empty()) {
            std::filesystem::create_directories(options.out);
            write_random_scene(scene, options.out, "scene_" + std::to_string(seed) + ".json");
        }
        if (clock.seconds() - shown > 30 && !options.list) {
            shown = clock.seconds();
            std::printf("%.0f s, %" PRIu64 " scenes\n", shown, done + 1);
        }
        std::fflush(stdout);
    }
    std::printf("%" PRIu64 " scenes from seed %" PRIu64 " in %.0f s:", done, options.seed, clock.seconds());
    for (const auto& [kind, count] : counts) std::printf(" %s %d", kind.c_str(), count);
    std::printf("\n");
    return counts.count("failed") + counts.count("crashed") + counts.count("hung") > 0 ? 1 : 0;
}
