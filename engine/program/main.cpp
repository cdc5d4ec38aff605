// Main function: reads the command line, runs the requested command, and turns exceptions into messages and exit codes.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <exception>
#include <iostream>
#include <sstream>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "engine/output/number_text.h"
#include "engine/program/commands.h"
#include "engine/program/examples.h"
#include "engine/program/output_formats.h"
#include "engine/program/ranks/run_ranks.h"
#include "engine/program/sweep/cases/sweep_file.h"
#include "engine/scene/place.h"
#include "skerry/instruction_set.h"

namespace {

using namespace skerry;

/// Validator that accepts finite numbers above 0.
const CLI::Validator positive_number(
    [](std::string& text) {
        double value = 0;
        return CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0
                   ? std::string()
                   : "found " + text + ", expected a number above 0";
    },
    "NUMBER > 0");

const CLI::Validator share(
    [](std::string& text) {
        double value = 0;
        return CLI::detail::lexical_cast(text, value) && value >= 0 && value < 1
                   ? std::string()
                   : "found " + text + ", expected a number of at least 0 and below 1";
    },
    "0 <= NUMBER < 1");

/// Validator that accepts numbers of the type Number from `least` to `most`.
template <class Number>
CLI::Validator within(Number least, Number most) {
    constexpr int digits = 10;
    const std::string from = short_text(least, digits), to = short_text(most, digits);
    return {[=](std::string& text) {
                Number value{};
                return CLI::detail::lexical_cast(text, value) && least <= value && value <= most
                           ? std::string()
                           : "found " + text + ", expected a " + (std::is_integral_v<Number> ? "whole " : "") +
                                 "number from " + from + " to " + to;
            },
            from + " to " + to};
}

template <class Enum>
std::vector<std::string> names_of_all() {
    std::vector<std::string> names;
    for (const auto& [value, name] : EnumNames<Enum>::table) names.emplace_back(name);
    return names;
}

/// Adds an option whose values are the names of an enum. For a name that earlier versions accepted, the error message
/// includes the hint of RemovedNames.
template <class Enum, class Target>
void add_choice(CLI::App& app, const std::string& flag, Target& target, const std::string& meaning) {
    app.add_option_function<std::string>(
           flag, [&target](const std::string& name) { target = *from_name<Enum>(name); }, meaning)
        ->check(CLI::Validator(
            [](std::string& name) {
                const std::string_view hint = hint_for_removed<Enum>(name);
                return hint.empty() ? std::string() : "found " + name + ", which was removed: " + std::string(hint);
            },
            ""))
        ->check(CLI::IsMember(names_of_all<Enum>()));
}

/// Adds an option for a number above 0. `target` stays empty unless the user gives the option.
CLI::Option* add_number(CLI::App& app, const std::string& flag, std::optional<Real>& target,
                        const std::string& meaning) {
    return app
        .add_option_function<Real>(
            flag, [&target](const Real& value) { target = value; }, meaning)
        ->check(positive_number);
}

void add_set(CLI::App& command, std::vector<std::string>& assignments) {
    command
        .add_option("--set", assignments,
                    "change a value of the scene, for example bodies[0].position=[0,0,1] or materials.rubber.E=2e5; "
                    "repeat the option to change several values")
        ->type_name("PLACE=VALUE")
        ->allow_extra_args(false);
}

/// Adds an option for a whole number of at least `least`. `target` stays empty unless the user gives the option.
void add_count(CLI::App& app, const std::string& flag, std::optional<int>& target, int least,
               const std::string& meaning) {
    constexpr int most = 2147483647;
    app.add_option_function<int>(
           flag, [&target](const int& value) { target = value; }, meaning)
        ->check(within(least, most));
}

void add_outputs(CLI::App& command, RunOptions& options) {
    for (const OutputFormat& format : output_formats())
        command.add_option(format.option, options.outputs[format.option], format.meaning);
    add_choice<FilmColor>(command, "--film-color", options.film_color,
                          "quantity that the colours of --film and --gltf show: von Mises stress, speed or contact "
                          "pressure; default: none, each body has its own colour");
    add_number(
        command, "--film-max", options.film_max,
        "value at the upper end of these colours, which begin at zero [Pa, m/s]; default: 99 % of the values are "
        "below it");
    add_number(command, "--frames-per-second", options.frames_per_second,
               "number of frames of output per simulated second");
    add_count(command, "--export-every", options.problems_every, 1,
              "export every N-th step; steps without contacts are not exported; default: N for about 20 exported steps "
              "in the run");
    add_choice<ProblemsOf>(
        command, "--export-problems-of", options.problems_of,
        "content of each exported file: all contacts of a step (default), or one contact region of a step");
    CLI::Option* quiet =
        command.add_flag("--quiet", options.quiet, "print no progress and no summary; warnings go to standard error");
    command
        .add_flag("--profile", options.profile,
                  "after the summary print step limits, solver figures, energies, stage times and the state hash")
        ->excludes(quiet);
    command.add_flag("--strict", options.strict, "end with exit code 1 if the run has warnings");
}

/// Adds the options that override settings of the scene.
void add_overrides(CLI::App& command, SceneOverrides& overrides) {
    add_set(command, overrides.assignments);
    add_choice<Backend>(command, "--backend", overrides.backend, "library that manages the threads");
    add_number(command, "--step", overrides.step_size, "largest step size [s]; default: the stable step");
    add_choice<SolverMethod>(command, "--method", overrides.method, "contact solver");
    add_choice<Friction>(command, "--friction", overrides.friction, "friction law");
    add_number(command, "--tolerance", overrides.tolerance,
               "relative error at which the solver of a contact region stops");
    add_count(command, "--max-iterations", overrides.max_iterations, 1,
              "largest number of sweeps over a contact region in a step");
    add_choice<StartOverlaps>(command, "--start-overlaps", overrides.start_overlaps,
                              "treatment of bodies that overlap at the start: move them apart (resolve), stop with an "
                              "error (refuse), or start with the overlaps (ignore)");
    add_choice<ElementKind>(command, "--element", overrides.element,
                            "element type of all bodies; smoothed elements bend correctly on coarse meshes");
    add_choice<ContactRegions>(command, "--contact-regions", overrides.contact_regions,
                               "grouping of contacts into regions, each of which is solved on its own");
}

void add_threads(CLI::App& command, SceneOverrides& overrides) {
    command
        .add_option_function<int>(
            "--threads", [&overrides](const int& count) { overrides.threads = count; },
            "number of worker threads; 0: one per core")
        ->check(within(0, 1024));
}

/// Adds the options for writing checkpoints and for resuming a run. Returns the option --restart.
CLI::Option* add_checkpoints(CLI::App& command, RunOptions& options) {
    CLI::Option* checkpoint = command.add_option("--checkpoint", options.checkpoint,
                                                 "file for the state of the run, from which --restart can continue; "
                                                 "rewritten several times during the run and at the end of the run");
    add_number(command, "--every", options.every,
               "simulated time between checkpoints [s]; default: a tenth of the run. A checkpoint is written at the "
               "end of a frame or of a sample of the probes")
        ->needs(checkpoint);
    CLI::Option* restart = command.add_option(
        "--restart", options.restart,
        "checkpoint from which to continue; the result is bitwise identical to the result of an uninterrupted run");
    for (const char* fixed : {"--set", "--frames-per-second", "--step", "--method", "--friction", "--tolerance",
                              "--max-iterations", "--start-overlaps", "--element", "--contact-regions", "--from-rest"})
        restart->excludes(command.get_option(fixed));
    return restart;
}

void add_run(CLI::App& app, RunOptions& options) {
    CLI::App& command = *app.add_subcommand("run", "Simulate a scene");
    command.footer(run_examples);
    CLI::Option* scene =
        command.add_option("SCENE", options.scene, "scene file (JSON); `skerry schema` prints its format");
    add_number(command, "--seconds", options.seconds,
               "time at which the run ends [s]; default: \"seconds\" of the scene");
    add_threads(command, options.overrides);
    add_outputs(command, options);
    add_overrides(command, options.overrides);
    command.add_flag("--from-rest", options.from_rest,
                     "move the bodies to a static equilibrium under the loads at time 0 before the run");
    CLI::Option* restart = add_checkpoints(command, options);
    add_choice<OwnerMap>(
        command, "--owners", options.owners,
        "with several ranks (docs/cluster.md): rule that divides the bodies among them; default: curve, "
        "neighbours have the same owner");
    command.callback([scene, restart] {
        if (scene->count() == 0 && restart->count() == 0) throw CLI::RequiredError("SCENE");
    });
}

void add_view(CLI::App& app, ViewOptions& options) {
    CLI::App& command = *app.add_subcommand("view", "Simulate a scene and show it live in a browser");
    command.footer(view_examples);
    command.add_option("SCENE", options.scene, "scene file (JSON); `skerry schema` prints its format")->required();
    add_number(command, "--seconds", options.seconds, "simulated time after which the program ends [s]; default: none");
    add_threads(command, options.overrides);
    command
        .add_option("--rate", options.rate,
                    "simulated time per wall time: 1 is real time, 0.1 slow motion, 0 as fast as possible")
        ->check(within(0.0, 1000.0))
        ->capture_default_str();
    command.add_flag("--paused", options.paused, "wait for the user to press play");
    command.add_option("--port", options.port, "port of the server; 0: a free port")
        ->check(within(0, 65535))
        ->capture_default_str();
    command.add_flag("!--no-open", options.open, "only print the address, and do not open the browser");
    add_overrides(command, options.overrides);
}

void add_solve(CLI::App& app, SolveOptions& options) {
    CLI::App& command = *app.add_subcommand("solve", "Solve a frictional contact problem from a file");
    command.footer("Example:\n  skerry solve Box_Stacks.hdf5 --tolerance 1e-8 --json --reactions reactions.txt");
    command
        .add_option("PROBLEM", options.problem,
                    "problem in FCLIB's HDF5 format; a global problem is first condensed to the contacts")
        ->required();
    add_choice<SolverMethod>(command, "--method", options.settings.method, "contact solver");
    add_choice<Friction>(command, "--friction", options.settings.friction, "friction law");
    command
        .add_option("--tolerance", options.settings.tolerance,
                    "largest accepted relative error of the impulses, defined as in FCLIB and Siconos "
                    "(docs/methods/errors.md)")
        ->check(positive_number)
        ->capture_default_str();
    command
        .add_option("--relaxation", options.settings.relaxation,
                    "relaxation factor of the sweeps, below 2; a value above 1 is over-relaxation")
        ->check(positive_number)
        ->capture_default_str();
    command
        .add_option("--max-iterations", options.settings.max_iterations,
                    "largest number of sweeps over a contact region")
        ->check(within(1, 2147483647))
        ->capture_default_str();
    command.add_option("--reactions", options.reactions,
                       "text file for the reactions: one line per contact with the normal and two tangential "
                       "components, 17 digits each");
    command.add_flag("--json", options.json, "print the result as JSON");
}

void add_inspect(CLI::App& app, InspectOptions& options) {
    CLI::App& command = *app.add_subcommand("inspect", "Show the content and likely problems of a mesh or scene");
    command.footer(inspect_examples);
    command
        .add_option(
            "FILE", options.file,
            "mesh file (.msh, .inp, .mesh, .meshb, .vtk, .vtu, .node, .ele), surface (.obj, .ply, .stl) or scene file "
            "(.json)")
        ->required();
    add_set(command, options.assignments);
    command.add_flag("--json", options.json, "print the result as JSON");
    CLI::Option* repair = command.add_option("--repair", options.repair,
                                             "write a new mesh (.msh) of the same body with a longer stable step");
    command
        .add_option("--tolerance", options.tolerance,
                    "largest movement of the surface, as a fraction of the diagonal of the bounding box; 0: the "
                    "surface stays unchanged")
        ->check(share)
        ->capture_default_str()
        ->needs(repair);
    command
        .add_option(
            "--body", options.body,
            "for a scene: name of the body whose mesh is repaired; default: the body with the smallest stable step")
        ->needs(repair);
    command.add_flag("--overwrite", options.overwrite, "allow --repair to replace the input file")->needs(repair);
}

void add_fill(CLI::App& app, FillOptions& options) {
    CLI::App& command = *app.add_subcommand("fill", "Fill a triangle surface with tetrahedra");
    command.footer(fill_examples);
    command
        .add_option_function<std::vector<std::string>>(
            "FILES",
            [&options](const std::vector<std::string>& files) {
                options.surfaces.assign(files.begin(), files.end() - 1);
                options.mesh = files.back();
            },
            "one or more surfaces (.stl, .obj, .ply or a mesh file), then the mesh to write (.msh)")
        ->required()
        ->expected(2, CLI::detail::expected_max_vector_size)
        ->type_name("SURFACE... OUT.msh");
    command
        .add_option("--scale", options.settings.scale,
                    "factor for all coordinates of the surface, 0.001 for one in millimetres; other lengths are those "
                    "after scaling")
        ->check(positive_number)
        ->capture_default_str();
    add_number(command, "--edge", options.settings.edge,
               "edge length of the tetrahedra and of their surface [m]; default: the triangles of a surface without "
               "faults are kept, and other surfaces get a twentieth of the diagonal of the bounding box");
    command
        .add_option("--tolerance", options.settings.tolerance,
                    "largest distance between the surface and the mesh, as a fraction of the diagonal of the bounding "
                    "box; 0: keep all triangles, and refuse surfaces with faults")
        ->check(share)
        ->capture_default_str();
    command.add_flag(
        "--cavities", options.settings.cavities,
        "leave the inside of all inner shells empty; default: only the inside of shells whose triangles are "
        "clockwise as seen from outside, and all other inner shells bound regions with their own labels");
    command.add_option("--material", options.material,
                       "material for which the stable step is computed; `skerry materials` lists the names");
    command.add_option("--scene", options.scene, "also write a scene in which the body falls on a floor");
    command.add_option("--time-limit", options.settings.limits.seconds, "time limit of each run of a mesher [s]")
        ->check(positive_number)
        ->capture_default_str();
    command
        .add_option_function<Real>(
            "--memory-limit", [&options](const Real& limit) { options.settings.limits.bytes = 1e9 * limit; },
            "memory limit of a mesher [GB]; default: 8")
        ->check(positive_number);
    command.add_flag("--json", options.json, "print the result as JSON");
}

void add_sweep(CLI::App& app, SweepOptions& options) {
    CLI::App& command = *app.add_subcommand("sweep", "Simulate a scene with many values, one case per core");
    command.footer(sweep_examples);
    command.add_option("CASES", options.cases, "JSON file with the scene and the cases")->required();
    command.add_option("--out", options.out, "folder for the results; default: out/NAME, if CASES is NAME.json");
    add_count(
        command, "--jobs", options.jobs, 1,
        "number of cases that run at the same time, each with one thread; default: the number of available cores");
    add_count(command, "--rank", options.rank, 0,
              "number of this process, counted from 0, if several processes share the cases; needs --of");
    add_count(command, "--of", options.of, 1, "number of processes that share the cases; needs --rank");
    command.add_flag("--probes", options.probes, "write the time series of the scene's probes, one CSV file per case");
    command.add_flag(
        "--redo", options.redo,
        "run a case again if the result file belongs to another case or to an earlier version of the scene");
    command.add_flag("--dry-run", options.dry_run, "list the cases of this process without running them");
    command.add_flag("--table", options.table,
                     "write the table and the page from the existing results without running cases");
    command.add_flag("--strict", options.strict, "end with exit code 1 if a case failed, was refused or has warnings");
    command.add_flag("--quiet", options.quiet, "print no progress and no table");
}

/// Reads a positive number, or a percentage such as 1%. Returns nothing for any other text.
std::optional<double> read_share(std::string text) {
    const bool percent = !text.empty() && text.back() == '%';
    if (percent) text.pop_back();
    double value = 0;
    if (!CLI::detail::lexical_cast(text, value) || !std::isfinite(value) || !(value > 0)) return {};
    return percent ? value / 100 : value;
}

void add_study(CLI::App& app, StudyOptions& options) {
    CLI::App& command = *app.add_subcommand("study", "Determine the errors of the results of a scene");
    command.footer(study_examples);
    command.add_option("SCENE", options.scene, "scene file (JSON); `skerry schema` prints its format")->required();
    command
        .add_option_function<std::string>(
            "--error", [&options](const std::string& text) { options.settings.error = *read_share(text); },
            "wanted relative error, for which the cheapest settings are searched; default: 1%")
        ->check(CLI::Validator(
            [](std::string& text) {
                return read_share(text) ? std::string() : "found " + text + ", expected a number above 0 such as 1%";
            },
            "SHARE"));
    command
        .add_option("--probe", options.settings.probes,
                    "probe or body whose quantities get error bars, as NAME or NAME.QUANTITY; repeat the option for "
                    "several; default: all probes of the scene, and displacement, contact force and largest stress "
                    "of each body, and the energies")
        ->type_name("NAME")
        ->allow_extra_args(false);
    add_number(command, "--seconds", options.settings.seconds,
               "time at which the runs end [s]; default: \"seconds\" of the scene");
    add_set(command, options.settings.assignments);
    command
        .add_option(
            "--threads,--jobs", options.settings.threads,
            "number of threads of the study; 0: one per core. The runs have one thread each, except very long ones")
        ->check(within(0, 1024));
    add_number(
        command, "--budget", options.settings.budget,
        "largest wall time of the study, divided by that of one run with one thread; finer meshes and other runs "
        "that do not fit are left out; default: 15, or more as long as the study takes less than 5 s");
    command.add_option("--out", options.out, "folder for the results; default: out/NAME_study, if SCENE is NAME.json");
    command.add_flag("--redo", options.settings.redo, "make all runs again, and replace those in the folder");
    command.add_flag("--quiet", options.quiet, "print no progress and no report");
}

/// Throws SceneError if the command is unknown, and suggests the nearest name. CLI11 would only report that a command
/// is required.
void require_known_command(const CLI::App& app, int argc, char** argv) {
    if (argc < 2 || argv[1][0] == '-') return;
    const std::string found = argv[1];
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
    if (std::ranges::find(names, found) != names.end()) return;
    refuse("command line", {}, "the command " + in_quotes(found), "one of the commands " + listed(names),
           nearest_hint(found, names));
}

/// Returns the version, the instruction set that the kernels use, and the instruction sets of this machine.
std::string version_text() {
    std::string sets;
    for (const std::string_view set : instruction_sets()) sets += (sets.empty() ? "" : ", ") + std::string(set);
    return std::string("skerry ") + SKERRY_VERSION + "\ninstruction set: " + std::string(instruction_set()) +
           " (this machine supports: " + sets +
           "; to use another one, set the environment variable SKERRY_INSTRUCTION_SET)";
}

/// Prints the help, or the error in the command line, once for all processes of a run. Returns the exit code.
int end_reading(const CLI::App& app, const CLI::ParseError& error) {
    std::ostringstream help, text;
    if (app.exit(error, help, text) != 0)
        return fail_together(SceneError(text.str().substr(0, text.str().find_last_not_of('\n') + 1)));
    if (is_first_process()) std::cout << help.str();
    return exit_ok;
}

int run_command_line(int argc, char** argv) {
    CLI::App app("Simulates deformable bodies in frictional contact", "skerry");
    app.footer(general_examples);
    app.set_version_flag("--version", version_text);
    app.require_subcommand(1);
    RunOptions run_options;
    ViewOptions view_options;
    SolveOptions solve_options;
    InspectOptions inspect_options;
    FillOptions fill_options;
    SweepOptions sweep_options;
    StudyOptions study_options;
    add_run(app, run_options);
    add_view(app, view_options);
    add_solve(app, solve_options);
    add_inspect(app, inspect_options);
    add_fill(app, fill_options);
    add_sweep(app, sweep_options);
    add_study(app, study_options);
    bool schema_of_sweeps = false;
    app.add_subcommand("schema", "Print the JSON schema of scenes")
        ->add_flag("--sweep", schema_of_sweeps, "print the JSON schema of the input files of `skerry sweep` instead");
    bool materials_as_json = false;
    app.add_subcommand("materials", "List materials from the literature with their sources")
        ->add_flag("--json", materials_as_json, "print the list as JSON");
    try {
        require_known_command(app, argc, argv);
        app.parse(argc, argv);
        require_one_process(app.get_subcommands().front()->get_name());
    } catch (const CLI::ParseError& error) {
        return end_reading(app, error);
    } catch (const SceneError& error) {
        return fail_together(error);
    }
    if (app.got_subcommand("run")) return run(run_options);
    if (app.got_subcommand("sweep")) return sweep(sweep_options);
    if (app.got_subcommand("view")) return view(view_options);
    if (app.got_subcommand("solve")) return solve(solve_options);
    if (app.got_subcommand("inspect")) return inspect(inspect_options);
    if (app.got_subcommand("fill")) return fill(fill_options);
    if (app.got_subcommand("materials")) return materials(materials_as_json);
    if (app.got_subcommand("study")) return study(study_options);
    std::cout << (schema_of_sweeps ? sweep_schema() : scene_schema());
    return exit_ok;
}

/// Makes the allocator keep freed memory instead of returning it to the system. Loading a scene frees and allocates
/// much memory, and the system would have to clear every page before it is used again.
void keep_freed_memory() {
#ifdef __GLIBC__
    // `largest_kept`: blocks below this size come from the heap. `most_kept`: free memory at the end of the heap up to
    // this size stays in the process. The C library raises both limits [bytes] by itself only after large blocks were
    // freed.
    constexpr int largest_kept = 32 << 20, most_kept = 64 << 20;
    mallopt(M_MMAP_THRESHOLD, largest_kept);
    mallopt(M_TRIM_THRESHOLD, most_kept);
#endif
}

}  // namespace

int main(int argc, char** argv) {
    keep_freed_memory();
    try {
        return run_command_line(argc, argv);
    } catch (const std::exception& error) {
        std::cerr << "skerry: " << error.what() << "\n";
        return dynamic_cast<const SceneError*>(&error) != nullptr ? exit_bad_input : exit_failed;
    }
}
