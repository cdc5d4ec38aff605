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

/// Scene of a study as it is.
struct StudiedScene {
    std::filesystem::path path;
    SceneFile file;
    std::vector<std::string> assignments;  // changes that all runs share
    SceneLevels levels;
    Settings settings;
    bool has_explicit = false;         // true with deformable bodies that are integrated explicitly
    std::vector<FlatBody> flat{};      // bodies whose refined meshes keep the flat faces of a file
    std::vector<Real> shape_errors{};  // shape_error of each column (StudyColumn)
    double longest_call = 0;           // longest simulated time of a call of advance [s]
};

/// Reads and builds the scene, and checks the names of the probes. Throws SceneError.
StudiedScene read_studied_scene(const std::filesystem::path& path, const StudySettings& settings);

/// Stages of a study. The results of a stage show which runs of the next ones are needed, and how long they take.
/// - start: the scene as it is, and the first run that begins 1e-12 m apart from it.
/// - basic: other elements, steps, tolerances and coarser meshes.
/// - finer: meshes one level finer.
/// - last: the runs that are made only if a part of the error is not yet known well.
enum class StudyStage { start, basic, finer, last };

struct PlannedRun {
    StudyVariant variant;
    double cost = 1;     // predicted CPU time, divided by that of the scene as it is
    std::string reason;  // reason why the run is left out; empty: it is made
    StudyStage stage = StudyStage::basic;
};

/// Runs that a study of the scene may need, stage by stage, in each stage the most important first. The first is the
/// scene as it is.
std::vector<PlannedRun> plan_study(const StudiedScene& scene);

/// Predicts the costs of the finer meshes from the runs with coarser ones, which are indexed as the plan. A level costs
/// at most the ratio of the numbers of tetrahedra and steps, and less on small meshes.
void predict_levels(const StudiedScene& scene, std::span<const StudyRun> runs, std::span<PlannedRun> plan);

/// Predicted wall time of runs with these costs, in units of the cost.
double wall_time(std::vector<double> costs, int threads);
/// True if a run takes so long that it gets all threads, one run after the other.
bool gets_all_threads(double cost, double total, int threads);
/// Leaves out runs that do not fit into the budget: a run is left out if it and the chosen runs before it would take
/// longer than `budget` times the first run. Runs before number `first` are not left out.
void keep_to_budget(double budget, int threads, std::size_t first, std::span<PlannedRun> plan);

/// Assignments with which `skerry run --set` runs a variant. `mean_step`: mean step of the unchanged scene [s].
std::vector<std::string> variant_assignments(const StudiedScene& scene, const StudyVariant& variant, Real mean_step);

}  // namespace skerry
