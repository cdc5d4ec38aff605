#include "engine/program/sweep/share.h"

#include <charconv>
#include <cstring>

#include "engine/base/complaint.h"

namespace skerry {

namespace {

const char* const by_hand = "set the share by hand with --rank I --of N, where I is from 0 to N - 1";

class Variables {
public:
    explicit Variables(const Environment& environment) : environment_(environment) {}

    bool has(const char* name) const { return text(name) != nullptr; }

    /// Returns the value of the environment variable as a number, or nothing if the variable is not set.
    std::optional<int> number(const char* name) const {
        const char* const found = text(name);
        if (found == nullptr) return {};
        int value = 0;
        const char* const end = found + std::strlen(found);
        const auto [read, error] = std::from_chars(found, end, value);
        if (error != std::errc() || read != end || value < 0)
            refuse(name, {}, "\"" + std::string(found) + "\"", "a whole number from 0", by_hand);
        return value;
    }

private:
    /// Returns the value of an environment variable, or null. An empty variable counts as not set, because scripts
    /// unset variables this way.
    const char* text(const char* name) const {
        const char* const value = environment_(name);
        return value != nullptr && *value != '\0' ? value : nullptr;
    }

    const Environment& environment_;
};

void require_within(const Share& share, const std::string& who) {
    if (share.of < 1) refuse(who, {}, "0 processes", "at least one process", by_hand);
    if (share.rank >= share.of)
        refuse(who, {}, "rank " + std::to_string(share.rank) + " of " + std::to_string(share.of),
               "a rank from 0 to " + std::to_string(share.of - 1), by_hand);
}

/// Returns the share of this process if it is a job of a SLURM array, otherwise a share with all cases. The job numbers
/// of an array may start with any number and have a constant stride.
Share array_share(const Variables& variables) {
    const std::optional<int> id = variables.number("SLURM_ARRAY_TASK_ID");
    if (!id) return {};
    const std::optional<int> count = variables.number("SLURM_ARRAY_TASK_COUNT");
    if (!count)
        refuse("SLURM_ARRAY_TASK_ID", {}, "no environment variable SLURM_ARRAY_TASK_COUNT",
               "a variable SLURM_ARRAY_TASK_COUNT with the number of jobs of the array", by_hand);
    const int least = variables.number("SLURM_ARRAY_TASK_MIN").value_or(0);
    const int step = variables.number("SLURM_ARRAY_TASK_STEP").value_or(1);
    if (*id < least || step < 1 || (*id - least) % step != 0 || (*id - least) / step >= *count)
        refuse("SLURM_ARRAY_TASK_ID", {},
               "job " + std::to_string(*id) + " in an array of " + std::to_string(*count) +
                   " jobs, of which the first is job " + std::to_string(least) + " and the numbers increase by " +
                   std::to_string(step),
               "a job number of an array without gaps, such as --array=0-63", by_hand);
    return {(*id - least) / step, *count, "SLURM_ARRAY_TASK_ID, SLURM_ARRAY_TASK_COUNT", {}};
}

}  // namespace

Share task_share(const Environment& environment) {
    const Variables variables(environment);
    // Variables that launchers set for their processes. The first launcher whose variables are set is that of this
    // process. The order matters: a process that mpirun starts in a Slurm job has the variables of both, and its
    // launcher is mpirun.
    struct Launcher {
        const char *rank, *of;
    };
    constexpr Launcher launchers[] = {
        {"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"}, {"PMI_RANK", "PMI_SIZE"}, {"SLURM_PROCID", "SLURM_NTASKS"}};
    std::optional<int> cores = variables.number("SLURM_CPUS_PER_TASK");
    if (cores == 0) cores.reset();
    for (const Launcher& launcher : launchers) {
        const bool slurm = std::strcmp(launcher.rank, "SLURM_PROCID") == 0;
        // A batch script started by sbatch is not a task: it has rank 0, and SLURM_NTASKS is only the number of
        // possible tasks.
        if (slurm && variables.has("SLURM_JOB_ID") && !variables.has("SLURM_STEP_ID")) continue;
        const char* const count = slurm && variables.has("SLURM_STEP_NUM_TASKS") ? "SLURM_STEP_NUM_TASKS" : launcher.of;
        const std::optional<int> rank = variables.number(launcher.rank), of = variables.number(count);
        if (!rank || !of) continue;
        const Share share{*rank, *of, std::string(launcher.rank) + ", " + count, cores.value_or(1)};
        require_within(share, share.said_by);
        return share;
    }
    return {0, 1, {}, cores};
}

Share share_of(std::optional<int> rank, std::optional<int> of, const Environment& environment) {
    const Variables variables(environment);
    Share share;
    if (rank || of) {
        if (!rank || !of)
            refuse("command line", {}, rank ? "--rank without --of" : "--of without --rank",
                   "both options, --rank I --of N", {});
        share = {*rank, *of, "--rank, --of", {}};
        require_within(share, "command line");
        return share;
    }
    const Share array = array_share(variables), task = task_share(environment);
    share.rank = array.rank * task.of + task.rank;
    share.of = array.of * task.of;
    share.said_by = array.said_by + (array.said_by.empty() || task.said_by.empty() ? "" : "; ") + task.said_by;
    share.cores = task.cores;
    return share;
}

}  // namespace skerry
