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

/// Difference of a run from the scene as it is. "The scene as it is" means the scene file with the changes in
/// StudySettings::assignments.
struct StudyVariant {
    // mesh level: 0 is the mesh of the scene; each level up halves the edge length, each level down doubles it
    int refine = 0;
    Real step = 1;       // ratio of the step length to the mean step of the scene as it is; 1: the scene's own steps
    Real tolerance = 1;  // ratio of the solver's tolerance to that of the scene
    std::optional<ElementKind> element{};  // element kind of all bodies; empty: the kinds of the scene
    int draw = 0;  // seed of the random shifts of the start positions, up to 1e-12 m; 0: no shifts

    /// True for the scene as it is.
    bool is_scene() const { return refine == 0 && step == 1 && tolerance == 1 && !element && draw == 0; }
    bool operator==(const StudyVariant&) const = default;
};

/// Outcome of a run of a study.
enum class StudyRunStatus {
    ok,        // the run reached its end
    failed,    // a step could not be committed
    refused,   // the scene cannot be built with these settings, or its columns differ from those of the first run
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
    // Length scale of the column [m]: diagonal, at the start, of the bounding box of the body to which the column
    // belongs. If it belongs to no body, the box contains all bodies.
    Real size = 0;
    // false for a column that gets no error bar of its own, such as the position of one of many bodies
    bool reported = true;
    // true for a column with the mean, least or largest value over all bodies without attachments; such values are
    // meaningful also in a chaotic run
    bool is_statistic = false;
    std::vector<Real> values{};  // one for each time in StudyRun::time; NaN if unknown
    // For a column of a largest stress: number of the node with the largest value in the run, within its body. For
    // other columns: no_index.
    Index node = no_index;
    Vec3 place = Vec3::Zero();  // position of `node` at the start [m]
    // Relative error of the values because flat faces approximate a curved surface. Runs with finer meshes do not show
    // this error, because they keep the flat faces of the scene's mesh.
    Real shape_error = 0;
};

/// Area of the faces on which a traction of a scene acts. A study compares this area between runs, because a traction
/// can select other faces on a finer mesh.
struct StudyLoad {
    std::string name;  // name of the load
    Real area = 0;     // area of its faces at the start [m^2]
    bool operator==(const StudyLoad&) const = default;
};

/// A run of a study. The command `skerry run SCENE`, with one option --set for each of `assignments`, repeats the run,
/// except for the random shifts of StudyVariant::draw.
struct StudyRun {
    StudyVariant variant;  // difference from the scene as it is
    // StudySettings::assignments, then assignments that make the change `variant`; see SceneOverrides::assignments
    std::vector<std::string> assignments;
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
    known,  // the differences between runs decrease as the theory says; the error bar follows from them
    // the differences do not follow the theory, or another check failed; StudyQuantity::sentence tells the reason
    irregular,
    singular,  // the largest stress grows without limit as the mesh is refined; `error` is infinite
    chaotic,   // differences of 1e-12 m at the start change the value; see StudyQuantity::agree_until
    zero,      // the value consists only of errors of the contact solver or of the steps; `error` bounds its magnitude
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
    // PROBE.QUANTITY_FIGURE, for example tip.displacement_z_end. FIGURE tells which number is taken from the time
    // series: end, max, min, mean, or agreed (the last value on which runs with shifted start positions agree).
    std::string name;
    std::string unit;                                     // SI unit; 1 for counts and ratios
    Real value = std::numeric_limits<Real>::quiet_NaN();  // value of the scene as it is
    // best: value extrapolated to edge length, step length and tolerance 0. best_error: half width of its error bar.
    Real best = std::numeric_limits<Real>::quiet_NaN(), best_error = std::numeric_limits<Real>::quiet_NaN();
    Real error = std::numeric_limits<Real>::quiet_NaN();  // half width of the error bar of `value`
    // Part of `error` from the mesh. A part (this one and the next three) is 0 if the study plans no runs that could
    // show it; `mesh`, for example, is 0 if all bodies are rigid.
    Real mesh = std::numeric_limits<Real>::quiet_NaN();
    Real step = std::numeric_limits<Real>::quiet_NaN();     // part of `error` from the step length
    Real contact = std::numeric_limits<Real>::quiet_NaN();  // part of `error` from the tolerance of the contact solver
    // part of `error` from random shifts of the start positions by up to 1e-12 m (StudyVariant::draw)
    Real noise = std::numeric_limits<Real>::quiet_NaN();
    // Scale to which relative errors refer: the largest absolute value over the run; for lengths and energies, the
    // largest change from the start.
    Real scale = std::numeric_limits<Real>::quiet_NaN();
    // Observed order of convergence in the edge length: the part `mesh` is proportional to this power of the length.
    Real mesh_order = std::numeric_limits<Real>::quiet_NaN();
    Real step_order = std::numeric_limits<Real>::quiet_NaN();  // observed order in the step length
    // theoretical order of convergence in the edge length
    Real expected_mesh_order = std::numeric_limits<Real>::quiet_NaN();
    // theoretical order of convergence in the step length
    Real expected_step_order = std::numeric_limits<Real>::quiet_NaN();
    StudyVerdict verdict = StudyVerdict::not_measured;  // reliability
    std::string sentence{};                             // verdict in words, with its reason
    Real agree_until = infinity;  // time until which runs with start positions shifted by up to 1e-12 m agree [s]
    // Value of each run and half width of its error bar, in the order of StudyResult::runs; NaN if unknown.
    std::vector<Real> run_values{}, run_errors{};
};

/// The cheapest settings whose predicted errors are at most the wanted error.
struct CheapestSettings {
    StudyVariant variant;  // difference from the scene as it is
    // False if no settings reach the wanted error. These settings are then the cheapest of those whose predicted error
    // is at most 10 % larger than the smallest predicted error of all settings.
    bool reaches = false;
    double error = 0;        // largest predicted relative error of a quantity with the verdict `known` or `irregular`
    double cpu_seconds = 0;  // predicted CPU time [s]
    std::string sentence{};  // the quantity with the largest error, or why no settings reach the wanted error
    std::vector<std::string> assignments{};  // assignments for `skerry run --set` that make these settings
};

/// Error bars of the quantities of a scene, and the runs that they come from.
struct StudyResult {
    std::string scene;                      // name of the scene
    std::vector<StudyRun> runs;             // runs[0] is the run of the scene as it is
    std::vector<StudyQuantity> quantities;  // values and error bars of all reported columns
    double wanted_error = 0;                // StudySettings::error
    // Half widths of the error bars of the values in runs[0].columns: bands[c][r] belongs to row r of column c.
    // - The list of a column that is not reported is empty.
    // - A half width is NaN after the time StudyQuantity::agree_until of the quantities that come from its column,
    //   except in columns with is_statistic.
    std::vector<std::vector<Real>> bands;
    std::optional<CheapestSettings> cheapest;  // empty if no quantity has the verdict `known` or `irregular`
    Real agree_until = infinity;               // time until which runs with shifted starts agree on all positions [s]
    Real growth_rate = 0;                // exponential growth rate of small differences at the start; 0: none [1/s]
    std::vector<std::string> sentences;  // remarks on the study as a whole
    bool stopped = false;                // true if go_on ended the study; runs and quantities are then empty
};

/// Progress of a study, for StudySettings::go_on.
struct StudyProgress {
    int runs_done = 0;     // number of completed runs
    int runs_running = 0;  // number of runs that are being made
    int runs = 0;          // number of planned runs
    double share = 0;      // share of the predicted CPU time that is done, from 0 to 1
};

/// Settings of a study.
struct StudySettings {
    double error = 0.01;  // wanted relative error for the cheapest settings, > 0 and < 1
    // reported probes, as NAME or NAME.QUANTITY; empty: those of the scene and default ones
    std::vector<std::string> probes{};
    std::optional<Real> seconds{};           // duration of the runs; empty: that of the scene [s]
    std::vector<std::string> assignments{};  // changes of the scene, as SceneOverrides::assignments
    int threads = 0;                         // number of threads of the study; 0: the number of cores
    // Upper limit of the wall time of the study, > 0, as a multiple of the wall time of one run of the scene with one
    // thread. Runs with which the study would take longer are left out, the least important first. Empty: the multiple
    // is 15, or more if the study then still takes less than 5 s.
    std::optional<double> budget{};
    // Folder in which each run is stored when it ends. A later study of the unchanged scene reads these runs instead of
    // making them again. Empty: no folder.
    std::filesystem::path folder{};
    bool redo = false;          // true: the runs in the folder are removed and made again
    std::string fill_python{};  // see SceneOverrides::fill_python
    // If given, called about every 20 ms on the thread that called study(). If it returns false or throws, all runs
    // stop before their next step. An exception is rethrown.
    std::function<bool(const StudyProgress&)> go_on{};
};

/// Runs a scene with several meshes, steps, tolerances and element kinds, and determines the error of each probe. The
/// runs and their order of importance are listed in docs/study.md.
///
/// - Threads: the results of runs do not depend on their number; only the choice of the runs that fit into the budget
///   does.
/// - Failed runs: if a variant fails, the study continues. If the scene as it is fails in a step, the study ends
///   without quantities, and StudyResult::sentences contains the reason.
/// Throws SceneError if the scene cannot be read or built, a setting or the name of a probe is invalid, the folder
/// holds runs of another scene or of other settings, or a file of the scene changes during the study.
StudyResult study(const std::filesystem::path& scene, const StudySettings& settings = {});

/// Returns one line per quantity with its error bar, the verdicts, the runs that are missing, and the cheapest
/// settings. Long lists are cut; study_page() has all entries.
std::string study_text(const StudyResult& result);

/// Returns a web page with a plot of error against CPU time, the time series with their error bars, and tables of all
/// quantities and runs. The page is one file that needs no other files.
std::string study_page(const StudyResult& result);

/// Returns a JSON document with all numbers except the time series of the runs. The key `bands` has StudyResult::bands.
/// A number that is not finite becomes null.
std::string study_json(const StudyResult& result);

/// Writes the scene with the cheapest settings to `file`. Paths in it lead to the files of the original scene. Throws
/// SceneError if no settings reach the wanted error, or if the file cannot be written.
void write_cheapest_scene(const std::filesystem::path& scene, const StudyResult& result,
                          const std::filesystem::path& file);

}  // namespace skerry
#pragma GCC visibility pop
