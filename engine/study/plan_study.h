// Plan of a study: its runs, how each of them changes the scene, and which of them fit into the budget.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "engine/scene/mesh_levels.h"
#include "engine/scene/scene_file.h"
#include "engine/study/flat_faces.h"
#include "skerry/scene.h"
#include "skerry/study.h"

namespace skerry {

/// The scene of a study "as it is", without the changes of a variant.
struct StudiedScene {
    std::filesystem::path path;
    SceneFile file;
    std::vector<std::string> assignments;  // changes of the scene file that all runs share
    SceneLevels levels;
    Settings settings;
    bool has_explicit = false;         // true if a deformable body is integrated explicitly
    std::vector<FlatBody> flat{};      // bodies whose refined meshes keep the flat faces of a file
    std::vector<Real> shape_errors{};  // StudyColumn::shape_error of each column
    double longest_call = 0;           // longest simulated time of a call of advance [s]
};

/// Reads and builds the scene, and checks the names of the probes. Throws SceneError.
StudiedScene read_studied_scene(const std::filesystem::path& path, const StudySettings& settings);

/// Stages of a study. The results of a stage show which runs of the next stages are needed, and how long they take.
/// - start: the scene as it is, and the first run with a start that is perturbed by 1e-12 m.
/// - basic: other elements, steps, tolerances and coarser meshes.
/// - finer: meshes one level finer.
/// - last: the runs that are made only if a part of the error is not yet known well.
enum class StudyStage { start, basic, finer, last };

struct PlannedRun {
    StudyVariant variant;
    double cost = 1;     // predicted CPU time, divided by that of the scene as it is
    std::string reason;  // reason why the run is not made; empty if it is made
    StudyStage stage = StudyStage::basic;
};

/// Returns the runs that a study of the scene may need, ordered by stage and then by importance. The first one is that
/// of the scene as it is.
std::vector<PlannedRun> plan_study(const StudiedScene& scene);

/// Predicts the costs of runs with finer meshes from the runs with coarser ones. runs[i] is the run of plan[i]. The
/// upper limit of the growth of the cost per level is that of the number of tetrahedra times the number of steps. On
/// small meshes the cost grows less.
void predict_levels(const StudiedScene& scene, std::span<const StudyRun> runs, std::span<PlannedRun> plan);

/// Predicted wall time of runs with these costs, in units of the cost.
double wall_time(std::vector<double> costs, int threads);
/// True if a run is made alone with all threads: it would take longer on one thread than all remaining runs, divided
/// equally among the threads. `total`: sum of the costs of all runs that are not made yet, with this one.
bool gets_all_threads(double cost, double total, int threads);
/// Leaves out runs that do not fit into the budget, which is `budget` times the duration of the first run. The runs are
/// taken in order: a run is left out if it and the chosen runs would take longer. Runs with an index below `first` are
/// already made and stay.
void keep_to_budget(double budget, int threads, std::size_t first, std::span<PlannedRun> plan);

/// Assignments with which `skerry run --set` runs a variant. `mean_step`: mean step of the unchanged scene [s].
std::vector<std::string> variant_assignments(const StudiedScene& scene, const StudyVariant& variant, Real mean_step);

}  // namespace skerry
