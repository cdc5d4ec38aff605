// One scene: recorded, predicted and measured in the same steps.
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
    double window = 0.25;      // s, that one thread takes for the steps of a window
    int least_steps = 20;      // of a window, however long they take
    int repeats = 15;          // of each window, recorded and measured
    double wait = 30;          // s, for other programs to leave the cores alone, of all measurements of a window
    int claimed_workers = 64;  // that work is cut for
    std::vector<int> cores{1, 2, 4, 8, 16, 32, 64};
    std::vector<int> costs{16, 64};  // cores for which it is said what each stage costs
    std::vector<int> threads{1, 2};  // measured
    MachineModel machine;
    // bytes that a step reads or writes for each tetrahedron, counted by the columns of a pile of balls with elements
    // by edges and nodes, as by default: elements 450, their nodes 490, nodes 75 a few times
    double bytes_per_tetrahedron = 1100;
};

struct SceneStudy {
    std::string name;
    std::size_t tetrahedra = 0, bodies = 0;
    std::uint64_t steps = 0;           // recorded
    double contacts = 0, regions = 0;  // of a step, mean of the windows' last
    Index largest_region = 0;          // of these steps
    std::vector<std::string> stage_name;
    Recording recording;  // all windows, undisturbed
    Traffic traffic;
    std::map<int, double> predicted;              // s, by cores
    std::map<int, std::vector<StageCost>> costs;  // s, by cores
    std::map<int, double> measured;               // s, by threads, undisturbed (quiet.h)
    double others = 0;                            // cores that other programs took meanwhile all the same, mean
};

/// Runs the world from `begin` to `end`, s, and looks at windows of steps in between. Recordings and measurements go on
/// from clones of the same state; throws std::runtime_error unless all end in the same state.
SceneStudy study_scene(const std::string& name, World& world, double begin, double end, const StudyOptions& options);

}  // namespace skerry::profiling
