// The commands of the program. Each command returns the exit code of the program.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "skerry/fill.h"
#include "skerry/output.h"
#include "skerry/problem.h"
#include "skerry/ranks.h"
#include "skerry/scene.h"
#include "skerry/study.h"

namespace skerry {

enum ExitCode : int {
    exit_ok = 0,
    exit_failed = 1,     // the simulation or solver failed, or a strict run has warnings
    exit_bad_input = 2,  // error in an input file or on the command line
    exit_output = 3,     // the computation succeeded, but an output could not be written
    // the run reached its end, but its results cannot be trusted (WorldReport::distrust)
    exit_untrusted = 4,
};
// If a signal stops a run, the exit code is this number plus the number of the signal.
inline constexpr int exit_signal = 128;

/// Content of one file of exported contact problems: either a whole step, or one contact region of a step.
enum class ProblemsOf { step, region };
template <>
struct EnumNames<ProblemsOf> {
    static constexpr std::array<std::pair<ProblemsOf, std::string_view>, 2> table{{
        {ProblemsOf::step, "step"},
        {ProblemsOf::region, "region"},
    }};
};

struct RunOptions {
    std::filesystem::path scene;  // may be empty if `restart` is given: the checkpoint names the scene
    std::optional<Real> seconds;
    std::optional<Real> frames_per_second;
    SceneOverrides overrides;
    // File or folder of each output, indexed by the command-line option of the output (OutputFormat::option). Outputs
    // with an empty path are not written.
    std::map<std::string, std::filesystem::path> outputs;
    ProblemsOf problems_of = ProblemsOf::step;
    FilmColor film_color = FilmColor::none;
    std::optional<Real> film_max;       // value at the upper end of the colours of films and glTF files [Pa or m/s]
    std::optional<int> problems_every;  // every N-th step is exported
    bool quiet = false;
    bool profile = false;               // also print step limits, solver statistics, energies and stage times
    bool strict = false;                // warnings count as failure: the run ends with exit_failed
    bool series_figures = false;        // compute RunResult::series, for the table of a sweep
    std::filesystem::path checkpoint;   // file for checkpoints; empty: no checkpoints
    std::optional<Real> every;          // simulated time between two checkpoints [s]
    bool from_rest = false;             // true: the run starts from a static equilibrium
    std::filesystem::path restart;      // checkpoint from which the run resumes; empty: a new run
    OwnerMap owners = OwnerMap::curve;  // division of the bodies among several ranks
};
int run(const RunOptions& options);

struct ViewOptions {
    std::filesystem::path scene;
    SceneOverrides overrides;
    std::optional<Real> seconds;  // simulated time after which the program ends
    Real rate = 1;                // simulated time per wall time; 0: as fast as possible
    int port = 0;                 // 0: a free port
    bool paused = false;          // wait for the user to press play
    bool open = true;             // open the browser
};
int view(const ViewOptions& options);

struct InspectOptions {
    std::filesystem::path file;
    std::vector<std::string> assignments;  // assignments PLACE=VALUE that change a scene
    bool json = false;
    std::filesystem::path repair;  // file for the repaired mesh; empty: only inspect
    // Largest allowed distance between the old and the new surface, divided by the diagonal of the bounding box.
    Real tolerance = 2e-3;
    // Name of the body whose mesh is repaired. If the name is empty, the body with the smallest stable step is chosen.
    std::string body;
    bool overwrite = false;  // the repaired mesh may replace the input file
};
int inspect(const InspectOptions& options);

struct FillOptions {
    std::vector<std::filesystem::path> surfaces;
    std::filesystem::path mesh;   // file for the mesh (.msh)
    std::filesystem::path scene;  // file for a scene in which the body falls on a floor; empty: none
    std::string material;         // named material for the scene and for the reported stable step; empty: the default
    mesh::FillSettings settings;
    bool json = false;
};
int fill(const FillOptions& options);

/// Prints the named materials, as JSON or as a table.
int materials(bool as_json);

struct SolveOptions {
    std::filesystem::path problem, reactions;
    ProblemSettings settings;
    bool json = false;
};
int solve(const SolveOptions& options);

struct SweepOptions {
    std::filesystem::path cases;
    // Folder of the results. If empty, it is out/NAME for the sweep with the name NAME.
    std::filesystem::path out;
    std::optional<int> jobs;      // number of cases that run at the same time
    std::optional<int> rank, of;  // rank of this process, and number of processes that share the cases
    bool probes = false;          // also write the time series of the probes of each case
    bool redo = false;            // also run cases whose result files are outdated, and replace these files
    bool dry_run = false;         // list the cases without running them
    bool table = false;           // write the table of the existing results without running cases
    // True: the sweep ends with exit_failed if a case fails, is refused or has warnings.
    bool strict = false;
    bool quiet = false;
};
int sweep(const SweepOptions& options);

struct StudyOptions {
    std::filesystem::path scene;
    StudySettings settings;  // settings without the folder, which is `out`
    // Folder of the results. If empty, it is out/NAME_study for the scene file NAME.json.
    std::filesystem::path out;
    bool quiet = false;
};
int study(const StudyOptions& options);

}  // namespace skerry
