// profile_separation: repeats the measurements of the paper on region separation and on its solver.
// profiling/plot_separation.py reads the tables.
#include "profiling/separation.h"

#include <CLI/CLI.hpp>
#include <cstdio>

using namespace skerry;
using namespace skerry::profiling;

int main(int argc, char** argv) {
    CLI::App app{"Measures what region separation brings, as the paper does. Writes tables (CSV)."};
    SeparationOptions options;
    std::string only;
    app.add_option("--out", options.out, "Folder for the tables")->capture_default_str();
    app.add_option("--only", only, "One part: scenes, growth or methods")
        ->check(CLI::IsMember({"scenes", "growth", "methods"}));
    app.add_flag("--quick", options.quick, "Fewer and smaller cases: under a minute");
    CLI11_PARSE(app, argc, argv);
    try {
        std::filesystem::create_directories(options.out);
        const auto wanted = [&](const char* part) { return only.empty() || only == part; };
        std::vector<StepProblem> steps;
        if (wanted("scenes") || wanted("methods")) steps = profile_scenes(options);
        if (wanted("scenes")) profile_dense(options, steps);
        if (wanted("growth")) profile_growth(options);
        if (wanted("methods")) {
            profile_cone(options, steps);
            profile_poor_cases(options, steps);
            profile_algorithm_1(options, steps);
        }
        std::fprintf(stderr, "\r\033[K");
        std::printf("%s\n", options.out.c_str());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
