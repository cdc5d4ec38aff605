// The command `skerry sweep`: runs the cases that have no result yet, and writes the table when all cases have a
// result.
#include <fcntl.h>
#include <sched.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <ostream>

#include "engine/base/complaint.h"
#include "engine/base/write_file.h"
#include "engine/output/number_text.h"
#include "engine/program/commands.h"
#include "engine/program/require_writable.h"
#include "engine/program/sweep/case_progress.h"
#include "engine/program/sweep/process_pool.h"
#include "engine/program/sweep/results/sweep_table.h"
#include "engine/program/sweep/share.h"
#include "engine/program/sweep/sweep_plan.h"

namespace skerry {

namespace {

/// Returns the number of cores that this process may use. A CPU affinity or the cpuset of a cgroup can make it smaller
/// than the number of cores of the machine.
int cores_here() {
    cpu_set_t set;
    CPU_ZERO(&set);
    if (sched_getaffinity(0, sizeof set, &set) == 0) return CPU_COUNT(&set);
    // sched_getaffinity fails if the machine has more cores than a cpu_set_t can represent.
    return std::max(1, static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN)));
}

std::vector<int> cases_of_share(const SweepPlan& plan, const Share& share) {
    std::vector<int> own_cases;
    for (int i = 0; i < plan.cases.count(); ++i)
        if (share.has(i)) own_cases.push_back(i);
    return own_cases;
}

/// Returns the cases of `own_cases` that have no result yet. If the file of a case holds anything but the result of
/// this case, throws SceneError unless `redo` is set.
std::vector<int> unfinished_cases(const SweepPlan& plan, const std::vector<int>& own_cases, bool redo) {
    std::vector<int> unfinished;
    int of_other_cases = 0;
    std::string first;  // description of the first file in the state `other`
    for (const int index : own_cases) {
        const CaseFile file = plan.read(index);
        if (file.state == CaseFileState::other && of_other_cases++ == 0)
            first = case_file({}, index).string() + " is " + file.found;
        if (file.state != CaseFileState::whole) unfinished.push_back(index);
    }
    if (of_other_cases == 0) return unfinished;
    if (!redo)
        refuse_in(plan.folder.string(), "output", {},
                  std::to_string(of_other_cases) + (of_other_cases == 1 ? " file that does" : " files that do") +
                      " not belong to these cases; " + first,
                  "results of the cases of " + plan.file.place.file().string() + " in its present version",
                  "add --redo to compute these cases again, or choose another folder with --out");
    std::cerr << "skerry: " << of_other_cases << " cases are computed again, because their files hold other results"
              << std::endl;
    return unfinished;
}

void print_cases(const SweepPlan& plan, const std::vector<int>& own_cases) {
    int done = 0;
    for (const int index : own_cases) {
        const CaseFileState state = plan.read(index).state;
        done += state == CaseFileState::whole ? 1 : 0;
        std::cout << "case " << index << ": " << case_text(plan.cases, index)
                  << (state == CaseFileState::whole   ? "  (done)"
                      : state == CaseFileState::other ? "  (the file holds the result of another case)"
                                                      : "")
                  << "\n";
    }
    std::cout << own_cases.size() << " of " << plan.cases.count() << " cases are for this process, " << done
              << " of these have a result; folder of the results: " << plan.folder.string() << std::endl;
}

/// Holds a lock on the folder of results while the object exists, so that only one process at a time writes the tables.
/// Has no effect if the file system does not support locks.
class FolderLock {
public:
    explicit FolderLock(const std::filesystem::path& folder) : descriptor_(open(folder.c_str(), O_RDONLY | O_CLOEXEC)) {
        if (descriptor_ >= 0) static_cast<void>(flock(descriptor_, LOCK_EX));
    }
    ~FolderLock() {
        if (descriptor_ >= 0) close(descriptor_);
    }
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

private:
    int descriptor_;
};

SweepTable collect(const SweepPlan& plan) {
    SweepTable table{plan.file, plan.cases, {}};
    for (int i = 0; i < plan.cases.count(); ++i) table.files.push_back(plan.read(i));
    return table;
}

int count_missing(const SweepTable& table) {
    int missing = 0;
    for (const CaseFile& file : table.files) missing += file.state == CaseFileState::whole ? 0 : 1;
    return missing;
}

void write_tables(const SweepPlan& plan, const SweepTable& table, bool quiet) {
    const FolderLock lock(plan.folder);
    const std::filesystem::path csv = plan.folder / "sweep.csv", page = plan.folder / "sweep.html";
    write_file(csv, [&](std::ostream& out) { out << table_csv(table); });
    write_file(page, [&](std::ostream& out) { out << table_page(table); });
    if (!quiet) std::cout << table_text(table) << "wrote " << csv.string() << "\nwrote " << page.string() << std::endl;
}

/// Removes the incomplete files of a case that did not end normally.
void remove_unfinished(const SweepPlan& plan, int index) {
    std::error_code ignored;
    std::filesystem::remove(case_file(plan.folder, index) += ".part", ignored);
    std::filesystem::remove(unfinished_series_file(plan.folder, index), ignored);
}

struct SweepRun {
    PoolEnd end;
    bool output_failed = false;
};

SweepRun run_cases(const SweepPlan& plan, const std::vector<int>& unfinished, int jobs, const SweepOptions& options) {
    SweepRun run;
    const auto count = static_cast<int>(unfinished.size());
    CaseProgress progress(!options.quiet && count > 0, "cases");
    const auto index_of = [&](int job) { return unfinished[static_cast<std::size_t>(job)]; };
    const auto run_job = [&](int job) { return run_case(plan.job(index_of(job), options.probes)); };
    const auto goes_on = [&](int, int code) {
        // After an output error (such as a full disk) no more cases start, because their results could not be written
        // either.
        run.output_failed |= code == exit_output;
        return !run.output_failed;
    };
    const auto show = [&](int done, int running) {
        progress.show(done, running, count, static_cast<double>(done) / count);
    };
    run.end = run_in_processes(count, jobs, {run_job, goes_on, show});
    for (const auto& [job, cause] : run.end.lost) remove_unfinished(plan, index_of(job));
    for (const int job : run.end.stopped) remove_unfinished(plan, index_of(job));
    clear_bar();
    for (const auto& [job, cause] : run.end.lost)
        std::cerr << "skerry: case " << index_of(job) << " (" << case_text(plan.cases, index_of(job)) << ") " << cause
                  << ": the case has no result; run the sweep again" << std::endl;
    return run;
}

/// Considers the cases of `own_cases` that have a result. True if none of them failed, was refused or has warnings.
bool all_good(const SweepPlan& plan, const std::vector<int>& own_cases) {
    return std::ranges::all_of(own_cases, [&](int index) {
        const CaseFile file = plan.read(index);
        return file.state != CaseFileState::whole ||
               (file.result.status == CaseStatus::ok && file.result.warnings.empty());
    });
}

bool has_file(const SweepPlan& plan, int index) {
    std::error_code error;
    return std::filesystem::exists(case_file(plan.folder, index), error);
}

/// True if every case has a file. The files are not read, so that this check is fast for each of many processes.
bool all_have_files(const SweepPlan& plan) {
    for (int i = 0; i < plan.cases.count(); ++i)
        if (!has_file(plan, i)) return false;
    return true;
}

/// Writes the table if all cases have a result or --table is given. Otherwise prints how to continue the sweep.
void conclude(const SweepPlan& plan, const std::vector<int>& own_cases, const SweepOptions& options) {
    if (options.table || all_have_files(plan)) {
        const SweepTable table = collect(plan);
        if (options.table || count_missing(table) == 0) return write_tables(plan, table, options.quiet);
    }
    if (options.quiet) return;
    // Counts files instead of successful jobs, because a job may have written its result before a signal stopped it.
    const auto finished = std::ranges::count_if(own_cases, [&](int index) { return has_file(plan, index); });
    const bool all_finished = finished == static_cast<std::ptrdiff_t>(own_cases.size());
    std::cout << finished << " of " << own_cases.size() << " cases of this process have a result in "
              << plan.folder.string() << ". "
              << (all_finished ? "" : "Run the same command again for the other cases. ")
              << "The table is written when all " << plan.cases.count() << " cases have a result, or with --table."
              << std::endl;
}

int exit_code_of(const SweepPlan& plan, const std::vector<int>& own_cases, const SweepRun& run,
                 const SweepOptions& options) {
    if (run.end.signal != 0) return exit_signal + run.end.signal;
    if (run.output_failed) return exit_output;
    if (!run.end.lost.empty()) return exit_failed;
    return options.strict && !all_good(plan, own_cases) ? exit_failed : exit_ok;
}

/// Throws SceneError if the folder of results cannot be written, or if results would replace the input files.
void check_folder(const SweepPlan& plan, const SweepOptions& options) {
    require_writable_folder(plan.folder);
    for (const char* name : {"sweep.csv", "sweep.html"}) require_writable_file(plan.folder / name);
    for (const std::filesystem::path& read : {options.cases, plan.file.scene.path}) {
        std::error_code error;
        const std::string name = read.filename().string();
        const bool is_result_name = name.starts_with("case_") || name == "sweep.csv" || name == "sweep.html";
        if (is_result_name &&
            std::filesystem::equivalent(std::filesystem::absolute(read).parent_path(), plan.folder, error))
            refuse_in(read.string(), "--out", {},
                      "an input file that would be overwritten by a result of the same name",
                      "another folder for the results", "choose another --out, or rename the input file");
    }
}

}  // namespace

int sweep(const SweepOptions& options) {
    const Share share = share_of(options.rank, options.of, [](const char* name) { return std::getenv(name); });
    const SweepPlan plan = plan_sweep(options.cases, options.out);
    const std::vector<int> own_cases = cases_of_share(plan, share);
    if (options.dry_run) {
        print_cases(plan, own_cases);
        return exit_ok;
    }
    check_folder(plan, options);
    SweepRun run;
    if (!options.table) {
        const std::vector<int> unfinished = unfinished_cases(plan, own_cases, options.redo);
        const int jobs = options.jobs.value_or(share.cores.value_or(cores_here()));
        if (!options.quiet) {
            if (!share.said_by.empty())
                std::cerr << "skerry: process " << share.rank << " of " << share.of << " (" << share.said_by << ")\n";
            std::cerr << "skerry: " << unfinished.size() << " of " << own_cases.size() << " cases to run, " << jobs
                      << " at a time\n";
        }
        make_folder(plan.folder);
        run = run_cases(plan, unfinished, jobs, options);
    }
    try {
        conclude(plan, own_cases, options);
    } catch (const SceneError& error) {  // the results exist; only the table could not be written
        std::cerr << "skerry: " << error.what() << std::endl;
        return exit_output;
    }
    return exit_code_of(plan, own_cases, run, options);
}

}  // namespace skerry
