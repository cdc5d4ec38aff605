// Study of one scene: the same steps are recorded, predicted and measured.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "profiling/scaling/recording.h"
#include "profiling/scaling/schedule.h"
#include "skerry/world.h"

namespace skerry::profiling {

struct StudyOptions {
    int windows = 4;           // times at which steps are recorded, spread over the run
    double window = 0.25;      // time of one thread for the steps of a window [s]
    int least_steps = 20;      // smallest number of steps of a window
    int repeats = 15;          // recordings and measurements of each window
    double wait = 30;          // longest wait for idle cores, for all measurements of a window [s]
    int claimed_workers = 64;  // number of workers that work is divided for
    std::vector<int> cores{1, 2, 4, 8, 16, 32, 64};
    std::vector<int> costs{16, 64};  // core counts for which the costs of each stage are computed
    std::vector<int> threads{1, 2};  // numbers of threads that are measured
    MachineModel machine;
    // Data that a step reads or writes per tetrahedron [bytes]. It is counted from the columns of a pile of balls with
    // the default elements (smoothed by edges and nodes): elements 450, their nodes 490, nodes 75 a few times.
    double bytes_per_tetrahedron = 1100;
};

struct SceneStudy {
    std::string name;
    std::size_t tetrahedra = 0, bodies = 0;
    std::uint64_t steps = 0;           // number of recorded steps
    double contacts = 0, regions = 0;  // per step, mean over the last steps of the windows
    Index largest_region = 0;          // contacts of the largest region in these steps
    std::vector<std::string> stage_name;
    Recording recording;  // all windows, without disturbances (quiet.h)
    Traffic traffic;
    std::map<int, double> predicted;              // by number of cores [s]
    std::map<int, std::vector<StageCost>> costs;  // by number of cores [s]
    std::map<int, double> measured;               // by number of threads, without disturbances (quiet.h) [s]
    double others = 0;  // mean number of cores that other programs used in the runs that count
};

/// Runs the world from `begin` to `end` [s] and studies windows of steps in between. Recordings and measurements run on
/// clones of the same state. Throws std::runtime_error unless all of them end in the same state.
SceneStudy study_scene(const std::string& name, World& world, double begin, double end, const StudyOptions& options);

}  // namespace skerry::profiling
