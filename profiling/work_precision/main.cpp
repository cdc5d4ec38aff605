// profile_work_precision: CPU time against error of Skerry, beside Bullet's deformable bodies and MuJoCo's flex where
// these are installed. It varies the time step and integrator, the solver and its tolerance, and the mesh. It also
// compares a pile by its statistics, and how well friction holds. Writes CSV files; profiling/plot_work_precision.py
// draws them.
//
// Every engine gets the same meshes, masses, material and gravity (scenes.cpp), runs on one thread, and is timed by the
// CPU time of its steps alone. The error is the mass-weighted distance of all nodes, averaged over time. One error is
// relative to a run of Skerry with a step far shorter than any compared; the error of that run is written, too. The
// other is relative to the peer's own run with its shortest step.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <functional>
#include <map>

#include "profiling/work_precision/study.h"

using namespace skerry::profiling;

int main(int argc, char** argv) {
    CLI::App app{"CPU time against error, ours beside Bullet and MuJoCo where they are installed. Writes CSV files."};
    Study study;
    StudyOptions& options = study.options;
    std::vector<std::string> axes{"time", "solver", "mesh", "pile", "creep"};
    const std::map<std::string, std::function<void(Study&)>> parts{{"time", study_time},
                                                                   {"solver", study_solver},
                                                                   {"mesh", study_mesh},
                                                                   {"pile", study_pile},
                                                                   {"creep", study_creep}};
    app.add_option("--axes", axes, "Parts of the study")
        ->delimiter(',')
        ->check(CLI::IsMember(axes))
        ->capture_default_str();
    app.add_option("--scenes", options.scenes,
                   "Only these (twist, bounce, slide, stack, skittles, finger, pile, creep)")
        ->delimiter(',');
    app.add_option("--out", options.out, "Folder for the tables")->capture_default_str();
    app.add_option("--python", options.python, "Python that may have MuJoCo")->capture_default_str();
    app.add_option("--cap", options.cap, "CPU seconds of the longest run of a peer that is compared")
        ->capture_default_str();
    app.add_option("--repeat", options.repeat, "Runs of which the median time counts, where they are short")
        ->capture_default_str();
    app.add_flag("--quick", options.quick, "Fewer steps, tolerances, meshes and runs");
    app.add_flag("--no-peers", options.no_peers, "Ours alone");
    CLI11_PARSE(app, argc, argv);
    if (options.quick && app.count("--cap") == 0) options.cap = 0.5;
    try {
        std::filesystem::create_directories(options.out / "runs");
        if (!options.no_peers) study.peers = find_peers(std::filesystem::path(argv[0]).parent_path(), options.python);
        const std::filesystem::path file = options.out / "work_precision.csv";
        study.table.open(file);
        study.table << "axis,scene,engine,variant,level,tetrahedra,simulated,step,tolerance,seconds,steps,error,error_"
                       "own,reference_error,"
                       "own_reference_error,finished\n";
        for (const std::string& axis : axes) parts.at(axis)(study);
        std::fprintf(stderr, "\r\033[K");
        std::printf("%s\n", file.c_str());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "\n%s\n", error.what());
        return 1;
    }
    return 0;
}
