// Main function: reads the command line, runs the requested command, and turns exceptions into messages and exit codes.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <exception>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "engine/program/commands.h"
#include "engine/program/output_formats.h"
#include "engine/program/sweep/cases/sweep_file.h"
#include "engine/scene/place.h"
#include "skerry/instruction_set.h"

namespace {

using namespace skerry;

const char* const general_examples = R"(Examples:
  skerry run scenes/skittles.json                          simulate, and print a summary
  skerry run scenes/skittles.json --page skittles.html     and write a page that plays it in a browser
  skerry run scenes/bucket.json --out frames --stats s.json   frames for ParaView, figures for scripts
  skerry inspect scenes/table.json                         sizes, step length, cost and problems of a scene
  skerry inspect bunny.msh                                 sizes, quality and problems of a mesh
  skerry solve problem.hdf5 --tolerance 1e-6               solve a frictional contact problem of FCLIB
  skerry sweep examples/incline_sweep.json                 a scene with many values, one case per core

Exit codes: 0 ok, 1 the simulation failed, a problem did not converge, or a --strict run has warnings, 2 bad input, 3 an
output of a run could not be written, 128 + n stopped by signal n.
`skerry COMMAND --help` describes the options of a command.)";

const char* const run_examples = R"(Examples:
  skerry run scenes/skittles.json --seconds 2 --threads 2
  skerry run scenes/table.json --page table.html --frames-per-second 30
  skerry run scenes/table.json --profile                                         with the times of all stages
  skerry run scenes/bucket.json --contact-regions global --stats global.json     one contact region instead of many
  skerry run scenes/bucket.json --export-problems problems --export-every 100    then: skerry solve problems/FILE
  skerry run scenes/drop/drop_27.json --threads 1 --quiet --stats drop.json      only the figures
  skerry run scenes/bucket.json --checkpoint bucket.skerry --every 0.5           if it is killed, continue with:
  skerry run --restart bucket.skerry --checkpoint bucket.skerry --every 0.5

At the end the run prints a short summary: what was simulated, how long it took, the most telling figures, warnings (the
reasons not to rely on the result, each with its remedy) and the written files. --profile adds step limits, solver
figures, energies, the times of all stages and the hash of the final state. --stats has all of these as JSON.

--restart takes the scene, its settings, the length and the frames from the checkpoint. Give SCENE only if its file has
moved. --seconds may be larger and --threads may differ. --stats then covers the whole run, except for the times of the
stages. Probes and the frames of --out continue; use the same files and folder. --page and --trace begin at the
checkpoint.)";

const char* const inspect_examples = R"(Examples:
  skerry inspect bunny.msh                                 sizes, quality, faults, and which tetrahedra bound the step
  skerry inspect bunny.msh --repair better.msh             the same body with a longer step, if there is one
  skerry inspect bunny.msh --repair better.msh --tolerance 0      new tetrahedra inside, the surface as it is
  skerry inspect scene.json --repair arm.msh --body arm    the mesh of one body, judged with its own material
  skerry inspect scenes/skittles.json --json
  skerry inspect scenes/skittles.json --set materials.skittle.young_modulus=6e5

--repair fills the surface anew (Netgen), once as it is and once without its needles and caps, and writes what has the
longer step. It ends with 1, and writes nothing, when no step is 5 % longer or the surface moves by more than the
tolerance.)";

const char* const sweep_examples = R"(CASES is JSON: a scene, and the values that it has in turn:

  {"scene": "incline.json",
   "set": {"seconds": 1},
   "grid": [{"name": "mu", "set": ["materials.block.friction", "colliders[0].friction"], "values": [0.2, 0.3, 0.4]},
            {"set": "materials.block.E", "from": 1e4, "to": 1e6, "count": 5, "spacing": "log"}]}

All combinations of a "grid"; or a "list" of cases, each with values by place; or "random" ones:

   "random": {"seed": 1, "count": 100, "parameters": [
       {"set": "materials.block.E", "distribution": "log_uniform", "from": 1e4, "to": 1e6},
       {"set": "bodies[0].position[2]", "distribution": "normal", "mean": 0.05, "deviation": 0.01}]}

Places are those of `skerry run --set`. docs/sweep.md says more, `skerry schema --sweep` all.

Examples:
  skerry sweep cases.json --dry-run                        which cases there are, and which of them are done
  skerry sweep cases.json --out results                    as many at a time as there are cores
  skerry sweep cases.json --out results                    again, after Ctrl-C: goes on with those that are left
  mpirun -n 64 skerry sweep cases.json --out results       process I of N runs cases I, I + N, ...; so do
  srun -n 64 skerry sweep cases.json --out results         tasks and arrays (sbatch --array=0-63) of SLURM, and
  skerry sweep cases.json --out results --rank 0 --of 2    processes that were started by hand
  skerry sweep cases.json --out results --table            the table of what is there

Results: case_000000.json and so on, one for each case, which appear when they are whole; with the last of all cases
sweep.csv, a table for spreadsheets, and sweep.html, a page with the same table and a plot. A case that is refused or
fails is a result, too; one that was killed is none, and is run again.
Exit codes: 0 all cases of this process have a result, 1 one of them has none (--strict: or one failed, was refused or
has warnings), 2 bad input, 3 a file could not be written, 128 + n stopped by signal n.)";

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
                   : "found " + text + ", expected a share from 0 to below 1";
    },
    "0 <= NUMBER < 1");

template <class Enum>
std::vector<std::string> names_of_all() {
    std::vector<std::string> names;
    for (const auto& [value, name] : EnumNames<Enum>::table) names.emplace_back(name);
    return names;
}

/// Adds an option whose values are the names of an enum. If a name was removed from the enum, the error message
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
        .add_option(
            "--set", assignments,
            "change a value of the scene: bodies[0].position=[0,0,1], materials.rubber.E=2e5; may be given again")
        ->type_name("PLACE=VALUE")
        ->allow_extra_args(false);
}

/// Adds an option for a whole number of at least `least`. `target` stays empty unless the user gives the option.
void add_count(CLI::App& app, const std::string& flag, std::optional<int>& target, int least,
               const std::string& meaning) {
    constexpr int most = 2147483647;
    app.add_option_function<int>(
           flag, [&target](const int& value) { target = value; }, meaning)
        ->check(CLI::Range(least, most));
}

void add_outputs(CLI::App& command, RunOptions& options) {
    for (const OutputFormat& format : output_formats())
        command.add_option(format.option, options.outputs[format.option], format.meaning);
    add_number(command, "--frames-per-second", options.frames_per_second, "frames of output per simulated second");
    add_count(command, "--export-every", options.problems_every, 1,
              "export every N-th step, if it has contacts; by default about 20 steps of the run");
    add_choice<ProblemsOf>(command, "--export-problems-of", options.problems_of,
                           "content of each file: a whole step (default), or one contact region of it");
    CLI::Option* quiet =
        command.add_flag("--quiet", options.quiet, "no progress, no summary; warnings go to standard error");
    command
        .add_flag("--profile", options.profile,
                  "after the summary print step limits, solver figures, energies, stage times and the state hash")
        ->excludes(quiet);
    command.add_flag("--strict", options.strict, "end with exit code 1 if the run has warnings");
}

/// Adds the options that override settings of the scene.
void add_overrides(CLI::App& command, SceneOverrides& overrides) {
    add_set(command, overrides.assignments);
    add_choice<Backend>(command, "--backend", overrides.backend, "library that runs the threads");
    add_number(command, "--step", overrides.step_size, "step size [s]; by default the stable step");
    add_choice<SolverMethod>(command, "--method", overrides.method, "contact solver");
    add_choice<Friction>(command, "--friction", overrides.friction, "friction law");
    add_number(command, "--tolerance", overrides.tolerance, "relative error allowed in each contact region");
    add_count(command, "--max-iterations", overrides.max_iterations, 1, "most sweeps over a contact region in a step");
    add_choice<StartOverlaps>(command, "--start-overlaps", overrides.start_overlaps,
                              "treatment of bodies that overlap at the start");
    add_choice<ElementKind>(command, "--element", overrides.element,
                            "elements of all bodies; smoothed ones bend correctly on coarse meshes");
    add_choice<ContactRegions>(command, "--contact-regions", overrides.contact_regions,
                               "grouping of contacts into regions, each of which is solved on its own");
}

/// Adds the options for writing checkpoints and for resuming a run. Returns the option --restart.
CLI::Option* add_checkpoints(CLI::App& command, RunOptions& options) {
    CLI::Option* checkpoint = command.add_option(
        "--checkpoint", options.checkpoint,
        "file for the state of the run, for --restart; replaced several times during the run and at its end");
    add_number(command, "--every", options.every,
               "simulated time between checkpoints [s], by default a tenth of the run; written at the end of a frame "
               "or of a sample of the probes")
        ->needs(checkpoint);
    CLI::Option* restart =
        command.add_option("--restart", options.restart,
                           "checkpoint to continue from; the result has the bits of a run that was not stopped");
    for (const char* fixed : {"--set", "--frames-per-second", "--step", "--method", "--friction", "--tolerance",
                              "--element", "--contact-regions"})
        restart->excludes(command.get_option(fixed));
    return restart;
}

void add_run(CLI::App& app, RunOptions& options) {
    CLI::App& command = *app.add_subcommand("run", "Simulate a scene");
    command.footer(run_examples);
    CLI::Option* scene =
        command.add_option("SCENE", options.scene, "scene file (JSON); `skerry schema` prints its format");
    add_number(command, "--seconds", options.seconds, "simulated time [s]; by default \"seconds\" of the scene");
    command
        .add_option_function<int>(
            "--threads", [&options](const int& count) { options.overrides.threads = count; },
            "worker threads; 0: one per core")
        ->check(CLI::Range(0, 1024));
    add_outputs(command, options);
    add_overrides(command, options.overrides);
    CLI::Option* restart = add_checkpoints(command, options);
    command.callback([scene, restart] {
        if (scene->count() == 0 && restart->count() == 0) throw CLI::RequiredError("SCENE");
    });
}

void add_solve(CLI::App& app, SolveOptions& options) {
    CLI::App& command = *app.add_subcommand("solve", "Solve a frictional contact problem on its own");
    command.footer("Example:\n  skerry solve Box_Stacks.hdf5 --tolerance 1e-8 --json --reactions reactions.txt");
    command.add_option("PROBLEM", options.problem, "a problem in FCLIB's HDF5 form; a global one is condensed first")
        ->required();
    add_choice<SolverMethod>(command, "--method", options.settings.method, "contact solver");
    add_choice<Friction>(command, "--friction", options.settings.friction, "friction law");
    command
        .add_option("--tolerance", options.settings.tolerance, "on the relative error, as FCLIB and Siconos measure it")
        ->check(positive_number)
        ->capture_default_str();
    command
        .add_option("--relaxation", options.settings.relaxation, "of the sweeps, below 2; above 1 is over-relaxation")
        ->check(positive_number)
        ->capture_default_str();
    command.add_option("--max-iterations", options.settings.max_iterations, "sweeps of a region")
        ->check(CLI::Range(1, 2147483647))
        ->capture_default_str();
    command.add_option("--reactions", options.reactions,
                       "file for the reactions: one contact a line, normal and two tangents, 17 digits");
    command.add_flag("--json", options.json, "print JSON");
}

void add_inspect(CLI::App& app, InspectOptions& options) {
    CLI::App& command = *app.add_subcommand("inspect", "Say what is in a mesh or a scene, and what looks wrong");
    command.footer(inspect_examples);
    command.add_option("FILE", options.file, "a mesh (.msh, .vtk, .node, .ele) or a scene (.json)")->required();
    add_set(command, options.assignments);
    command.add_flag("--json", options.json, "print JSON");
    CLI::Option* repair =
        command.add_option("--repair", options.repair, "write a mesh (.msh) of the same body whose step is longer");
    command
        .add_option("--tolerance", options.tolerance,
                    "how far the surface may move, as a share of the bounding box's diagonal; 0: not at all")
        ->check(share)
        ->capture_default_str()
        ->needs(repair);
    command
        .add_option("--body", options.body,
                    "of a scene, the body whose mesh is mended; by default the one that bounds the step")
        ->needs(repair);
    command.add_flag("--overwrite", options.overwrite, "--repair may replace the file that is read")->needs(repair);
}

void add_sweep(CLI::App& app, SweepOptions& options) {
    CLI::App& command = *app.add_subcommand("sweep", "Simulate a scene with many values, a case a core");
    command.footer(sweep_examples);
    command.add_option("CASES", options.cases, "a scene and its cases, in JSON")->required();
    command.add_option("--out", options.out, "folder for the results; by default out/NAME for NAME.json");
    add_count(command, "--jobs", options.jobs, 1,
              "cases at a time, each with one thread; by default the cores there are");
    add_count(command, "--rank", options.rank, 0,
              "of several processes that share the cases: which one this is, from 0");
    add_count(command, "--of", options.of, 1, "how many they are");
    command.add_flag("--probes", options.probes, "write the series of the scene's probes, a CSV file for each case");
    command.add_flag("--redo", options.redo, "replace results of other cases, or of the scene as it was before");
    command.add_flag("--dry-run", options.dry_run, "list the cases of this process, and run none");
    command.add_flag("--table", options.table, "make the table and the page of what is there, and run none");
    command.add_flag("--strict", options.strict, "end with exit code 1 if a case failed, was refused or has warnings");
    command.add_flag("--quiet", options.quiet, "no progress, no table");
}

/// Throws SceneError that names an unknown command. CLI11 only says that a command is required.
void require_known_command(const CLI::App& app, int argc, char** argv) {
    if (argc < 2 || argv[1][0] == '-') return;
    const std::string found = argv[1];
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
    if (std::ranges::find(names, found) != names.end()) return;
    Complaint{.file = {},
              .object = "command line",
              .field = {},
              .found = in_quotes(found),
              .expected = "one of " + listed(names),
              .hint = nearest_hint(found, names)}
        .raise();
}

/// Returns the version, the instruction set that the kernels use, and the instruction sets of this machine.
std::string version_text() {
    std::string sets;
    for (const std::string_view set : instruction_sets()) sets += (sets.empty() ? "" : ", ") + std::string(set);
    return std::string("skerry ") + SKERRY_VERSION + "\ninstruction set: " + std::string(instruction_set()) +
           " (here: " + sets + "; SKERRY_INSTRUCTION_SET chooses)";
}

int run_command_line(int argc, char** argv) {
    CLI::App app("Deformable bodies that touch each other with friction", "skerry");
    app.footer(general_examples);
    app.set_version_flag("--version", version_text);
    app.require_subcommand(1);
    RunOptions run_options;
    SolveOptions solve_options;
    InspectOptions inspect_options;
    SweepOptions sweep_options;
    add_run(app, run_options);
    add_solve(app, solve_options);
    add_inspect(app, inspect_options);
    add_sweep(app, sweep_options);
    bool schema_of_sweeps = false;
    app.add_subcommand("schema", "Print the JSON schema of scenes")
        ->add_flag("--sweep", schema_of_sweeps, "that of cases for `skerry sweep` instead");
    require_known_command(app, argc, argv);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? exit_ok : exit_bad_input;
    }
    if (app.got_subcommand("run")) return run(run_options);
    if (app.got_subcommand("solve")) return solve(solve_options);
    if (app.got_subcommand("inspect")) return inspect(inspect_options);
    if (app.got_subcommand("sweep")) return sweep(sweep_options);
    std::cout << (schema_of_sweeps ? sweep_schema() : scene_schema());
    return exit_ok;
}

/// Makes the allocator keep freed memory instead of returning it to the system. Loading a scene frees and allocates
/// much memory, and the system would have to clear every page that it hands out again.
void keep_freed_memory() {
#ifdef __GLIBC__
    // Sizes in bytes. The C library would adapt these two limits by itself, but later.
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
    } catch (const SceneError& error) {
        std::cerr << "skerry: " << error.what() << "\n";
        return exit_bad_input;
    } catch (const std::exception& error) {
        std::cerr << "skerry: " << error.what() << "\n";
        return exit_failed;
    }
}
