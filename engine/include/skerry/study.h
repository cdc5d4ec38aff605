// Studies: a scene is run with finer and coarser meshes, steps and tolerances, and each result gets an error bar
// (docs/study.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "components/options.h"
#include "skerry/recorder.h"
#include "skerry/settings.h"

#pragma GCC visibility push(default)
namespace skerry {

/// Difference of a run from the scene as it is.
struct StudyVariant {
    int refine = 0;      // level of the meshes: each level halves the edges, negative levels double them
    Real step = 1;       // ratio of the step length to the mean step of the unchanged scene; 1: the scene's own steps
    Real tolerance = 1;  // ratio of the solver's tolerance to that of the scene
    std::optional<ElementKind> element{};  // element kind of all bodies; empty: the kinds of the scene
    int draw = 0;                          // number of the perturbation of the start, from 1; 0: none

    /// True for the scene as it is.
    bool is_scene() const { return refine == 0 && step == 1 && tolerance == 1 && !element && draw == 0; }
    bool operator==(const StudyVariant&) const = default;
};

/// Outcome of a run of a study.
enum class StudyRunStatus {
    ok,       // the run reached its end
    failed,   // a step was refused
    refused,  // the scene cannot be built with these settings, or the run records other columns than the scene as it is
    left_out,  // the run was not made: it did not fit into the budget, or the scene does not allow this change
};
template <>
struct EnumNames<StudyRunStatus> {
    static constexpr std::array<std::pair<StudyRunStatus, std::string_view>, 4> table{{
        {StudyRunStatus::ok, "ok"},
        {StudyRunStatus::failed, "failed"},
        {StudyRunStatus::refused, "refused"},
        {StudyRunStatus::left_out, "left_out"},
    }};
};

/// A time series of a run.
struct StudyColumn {
    SeriesColumn what;  // probe, quantity and unit
    // diagonal of the bounding box at the start: of the body of the column, or of all bodies if the column has no body
    // [m]
    Real size = 0;
    // False for a column that gets no error bar of its own, such as the position of one of many bodies.
    bool reported = true;
    // true for a mean, least or largest value of all bodies, which is meaningful also in a chaotic run
    bool is_statistic = false;
    std::vector<Real> values{};  // one per time; NaN if unknown
    // For a column of a largest stress: number within the body of the node that had the largest value of the run. Else
    // no_index.
    Index node = no_index;
    Vec3 place = Vec3::Zero();  // position of `node` at the start [m]
    // Relative error of the values because flat faces approximate a curved surface.
    Real shape_error = 0;
};

/// The faces on which a traction of a scene acts.
struct StudyLoad {
    std::string name;  // name of the load
    Real area = 0;     // area of its faces at the start [m^2]
    bool operator==(const StudyLoad&) const = default;
};

/// A run of a study. `skerry run SCENE` with the assignments as --set repeats the run, except for its perturbation.
struct StudyRun {
    StudyVariant variant;                        // difference from the scene as it is
    std::vector<std::string> assignments;        // the same difference, as SceneOverrides::assignments
    StudyRunStatus status = StudyRunStatus::ok;  // outcome
    std::string message{};                       // reason, unless the status is ok
    std::vector<std::string> warnings{};         // reasons not to rely on the run
    double cpu_seconds = 0;                      // CPU time of the steps; predicted if the run was left out [s]
    std::uint64_t steps = 0;                     // number of steps
    Integrator integrator = Integrator::symplectic_euler;  // Settings::integrator
    std::uint64_t state_hash = 0;                          // hash of the state at the end
    std::size_t tetrahedra = 0;                            // number of tetrahedra of all bodies
    std::size_t max_contacts = 0;                          // largest number of contacts in any step
    std::vector<StudyLoad> loads{};                        // the tractions of the scene
    std::vector<Real> time{};                              // simulated time of each row [s]
    std::vector<StudyColumn> columns{};                    // the recorded time series
};

/// Reliability of a quantity.
enum class StudyVerdict {
    known,         // the error bar follows from runs whose differences behave as the theory says
    irregular,     // the differences do not follow the theory; the error bar is a multiple of the largest difference
    singular,      // the largest stress grows without limit as the mesh is refined; `error` is infinite
    chaotic,       // differences of 1e-12 m at the start change the value; see StudyQuantity::agree_until
    zero,          // the value is an error of the contact solver or of the steps; `error` bounds its absolute value
    not_measured,  // the runs that could show the error are missing
};
template <>
struct EnumNames<StudyVerdict> {
    static constexpr std::array<std::pair<StudyVerdict, std::string_view>, 6> table{{
        {StudyVerdict::known, "known"},
        {StudyVerdict::irregular, "irregular"},
        {StudyVerdict::singular, "singular"},
        {StudyVerdict::chaotic, "chaotic"},
        {StudyVerdict::zero, "zero"},
        {StudyVerdict::not_measured, "not_measured"},
    }};
};

/// A number with its error bar. Values that were not measured are NaN.
struct StudyQuantity {
    std::string name;  // name as in the table of a sweep without its unit, for example tip.displacement_z_end
    std::string unit;  // SI unit; 1 for counts and ratios
    Real value = std::numeric_limits<Real>::quiet_NaN();  // value of the scene as it is
    // Value extrapolated to vanishing edges, steps and tolerance, and its error.
    Real best = std::numeric_limits<Real>::quiet_NaN(), best_error = std::numeric_limits<Real>::quiet_NaN();
    Real error = std::numeric_limits<Real>::quiet_NaN();  // half width of the error bar of `value`
    // Part of `error` from the mesh. Each part is 0 if the study has no runs for it.
    Real mesh = std::numeric_limits<Real>::quiet_NaN();
    Real step = std::numeric_limits<Real>::quiet_NaN();     // part of `error` from the step length
    Real contact = std::numeric_limits<Real>::quiet_NaN();  // part of `error` from the tolerance of the contact solver
    Real noise = std::numeric_limits<Real>::quiet_NaN();    // part of `error` from differences of 1e-12 m at the start
    // Scale to which relative errors refer, for example the largest absolute value over the run.
    Real scale = std::numeric_limits<Real>::quiet_NaN();
    // Observed order of convergence: the part `mesh` is proportional to this power of the edge length.
    Real mesh_order = std::numeric_limits<Real>::quiet_NaN();
    Real step_order = std::numeric_limits<Real>::quiet_NaN();  // observed order in the step length
    // theoretical order of convergence in the edge length
    Real expected_mesh_order = std::numeric_limits<Real>::quiet_NaN();
    // theoretical order of convergence in the step length
    Real expected_step_order = std::numeric_limits<Real>::quiet_NaN();
    StudyVerdict verdict = StudyVerdict::not_measured;  // reliability
    std::string sentence{};                             // verdict in words
    Real agree_until = infinity;  // time until which perturbed runs agree on the column of the quantity [s]
    // Value of each run and half width of its error bar, in the order of StudyResult::runs; NaN if unknown.
    std::vector<Real> run_values{}, run_errors{};
};

/// The cheapest settings whose predicted errors are at most the wanted error.
struct CheapestSettings {
    StudyVariant variant;    // difference from the scene as it is
    bool reaches = false;    // false: no settings reach the wanted error, and these come nearest
    double error = 0;        // predicted largest relative error of all quantities with a known error
    double cpu_seconds = 0;  // predicted CPU time [s]
    std::string sentence{};  // the quantity with the largest error, or why no settings reach the wanted error
    std::vector<std::string> assignments{};  // for `skerry run --set`; filled in by study()
};

/// Error bars of the quantities of a scene, and the runs that they come from.
struct StudyResult {
    std::string scene;                      // name of the scene
    std::vector<StudyRun> runs;             // the first is the scene as it is
    std::vector<StudyQuantity> quantities;  // values and error bars of all reported columns
    double wanted_error = 0;                // StudySettings::error
    // Half width of the error bar of each value of each column of the first run; empty for columns that are not
    // reported.
    std::vector<std::vector<Real>> bands;
    std::optional<CheapestSettings> cheapest;  // empty if no quantity has a known error
    Real agree_until = infinity;               // time until which perturbed runs agree on all columns [s]
    Real growth_rate = 0;                // rate at which small differences of the start grow; 0 if they do not [1/s]
    std::vector<std::string> sentences;  // remarks on the study as a whole
    bool stopped = false;                // true if go_on ended the study; quantities are then empty
};

/// Progress of a study, for StudySettings::go_on.
struct StudyProgress {
    int runs_done = 0;     // number of completed runs
    int runs_running = 0;  // number of runs that are being made
    int runs = 0;          // number of planned runs
    double share = 0;      // share of the predicted CPU time that is done, from 0 to 1
};

/// Extent of a study, and its stopping.
struct StudySettings {
    double error = 0.01;                // wanted relative error, for the choice of the cheapest settings, > 0
    std::vector<std::string> probes{};  // names NAME or NAME.QUANTITY of the probes; empty: all and the default ones
    std::optional<Real> seconds{};      // duration of the runs; empty: that of the scene [s]
    std::vector<std::string> assignments{};  // changes of the scene, as SceneOverrides::assignments
    int threads = 0;                         // number of threads of the study; 0: the number of cores
    // Largest wall time of the study, divided by that of one run of the scene with one thread, > 0. Less important runs
    // that do not fit are left out. Empty: 15, or more as long as the study takes less than 5 s.
    std::optional<double> budget{};
    // Folder that keeps the results of the runs. A later study of the same scene continues with them. Empty: none.
    std::filesystem::path folder{};
    bool redo = false;          // true: the runs in the folder are removed and made again
    std::string fill_python{};  // see SceneOverrides::fill_python
    // If given, called about every 20 ms on the thread that called study(). If it returns false or throws, all runs
    // stop before their next step. An exception is rethrown.
    std::function<bool(const StudyProgress&)> go_on{};
};

/// Runs a scene with several meshes, steps, tolerances and element kinds, and determines the error of each probe. The
/// runs and their order of importance are listed in docs/study.md. The numbers do not depend on the number of threads,
/// except through the budget, which decides which runs fit. A run that fails is a result, and the study continues.
///
/// Throws SceneError if the scene cannot be run as it is, a setting or the name of a probe is invalid, or the folder
/// holds runs of another scene.
StudyResult study(const std::filesystem::path& scene, const StudySettings& settings = {});

/// Returns one line per quantity with its error bar, the verdicts, the runs that are missing, and the cheapest
/// settings. Long lists are cut; the page has them all.
std::string study_text(const StudyResult& result);

/// Returns a web page with a plot of error against CPU time, the time series with their error bars, and tables of all
/// quantities and runs. The page is one file that needs no other files.
std::string study_page(const StudyResult& result);

/// Returns a JSON document with all numbers except the time series of the runs. The key `bands` has the error bars of
/// the rows of the first run. A number that is not finite becomes null.
std::string study_json(const StudyResult& result);

/// Writes the scene with the cheapest settings. Paths in the new file lead to the files of the scene. Throws
/// SceneError, also if no settings reach the wanted error.
void write_cheapest_scene(const std::filesystem::path& scene, const StudyResult& result,
                          const std::filesystem::path& file);

}  // namespace skerry
#pragma GCC visibility pop
