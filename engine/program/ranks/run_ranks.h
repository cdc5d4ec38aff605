// Processes that share one run: `mpirun -n N skerry run SCENE`.
#pragma once

#include <array>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/program/commands.h"
#include "engine/scene/place.h"
#include "jobs/ranks/ranks.h"
#include "skerry/error.h"
#include "skerry/report.h"
#include "skerry/scene.h"

namespace skerry {

/// Values of WorldReport that each rank counts for its own part of the world, summed over all ranks.
struct RankWork {
    std::vector<StageReport> stages;
    std::uint64_t broad_searches = 0, pair_searches = 0, candidates = 0, inline_steps = 0;
};

/// Comparison of the ranks of a run, for its report.
struct RanksReport {
    int count = 1, hosts = 1;
    std::vector<double> peak_memory;  // greatest resident memory of each rank so far [bytes]
    // means per step; messages and bytes are sums over all ranks, reductions are those of one rank
    double messages = 0, bytes = 0, reductions = 0;
    double waiting = 0;  // share of the wall time of the steps spent in MPI calls; mean of all ranks
    // longest computing time of a rank, divided by the mean of all ranks
    double imbalance = 1;
    RankWork work{};  // empty if there is one rank

    /// Completes `world`, the report of rank 0, which counts only the work of rank 0: replaces its values by those of
    /// `work`, the sums over all ranks. Does nothing if there is one rank.
    void complete(WorldReport& world) const;
};

/// The ranks (MPI processes) that share the simulation of one run. Rank 0 builds the world, which is then divided among
/// them. Only rank 0 reports and writes files, for which it gathers the whole world.
///
/// Functions marked as collective must be called by all ranks. In a run of one process no function communicates.
class RunRanks {
public:
    /// Joins the other processes that mpirun or srun has started with this process, if there are any. Throws SceneError
    /// if the program was built without MPI.
    static RunRanks join();
    /// A run of this process alone.
    RunRanks() = default;

    bool several() const { return ranks_ != nullptr; }
    bool is_first() const { return !several() || ranks_->rank() == 0; }

    /// Throws an error on all ranks unless all of them run the same program with the same options and instruction set,
    /// and read the same files. `scene`: scene file. `assignments`: changes of the scene by --set.
    void compare_starts(const std::filesystem::path& scene, std::span<const std::string> assignments);
    /// Collective. Returns the value of rank 0 on all ranks. Throws an error on all ranks if one of them has failed
    /// before or has received a signal: the signal may have interrupted rank 0 in its search for a static equilibrium.
    Json of_first(const Json& mine) const;
    /// Returns `asked` with two changes: the number of threads is that of the launcher if `asked` has none, and ranks
    /// other than 0 print no messages. Throws SceneError for outputs that several ranks cannot write.
    RunOptions options_for(const RunOptions& asked) const;
    /// Divides the world of the scene of rank 0 among the ranks, and returns the part of this rank. Throws SceneError
    /// if the world holds something that cannot be divided. Afterwards `scene.world` must not be used until
    /// gathered_world() fills it on rank 0. A single process keeps the world in `scene`.
    World& divide(Scene& scene, OwnerMap owners);
    /// Collective. Returns the whole world on rank 0, null on the other ranks. The first call gathers the world; a
    /// later call does so only if before_advance() was called since the previous call.
    World* gathered_world();
    /// Must be called before and after each World::advance of the part of this rank. These two functions measure the
    /// communication of the steps.
    void before_advance();
    void after_advance();

    /// Collective. Returns true on all ranks if the argument is true on one of them.
    bool any(bool mine) const;
    /// Collective. Returns equal reports on all ranks. `wall`: wall time of the steps on this rank [s]. `steps`: number
    /// of these steps.
    RanksReport report(double wall, std::uint64_t steps) const;

    /// Sets the text that rank 0 writes to standard error if the launcher ends the job by a signal, as it does when
    /// another rank has failed.
    void set_last_words(std::string text);
    /// Handles an error that ended the run of this rank, and returns the exit code.
    /// - Before divide(), the ranks compare their errors, and rank 0 reports.
    /// - After divide(), the other ranks do not check for errors, so this function ends all processes.
    /// - If MPI does not connect the processes, the first one reports its error. The others return success: once one of
    ///   them fails, the launcher ends all processes, possibly before the first one has reported.
    int fail(const std::exception& error);
    /// Collective. Returns the largest exit code of all ranks.
    int last_code(int mine) const;

private:
    explicit RunRanks(std::unique_ptr<Ranks> ranks) : ranks_(std::move(ranks)) {}
    /// Collective. Returns the JSON objects `mine` of all ranks. Throws AgreedError if one of them has a key "error" or
    /// a nonzero value of the key "signal", or if their values of the key "alike" differ.
    std::vector<Json> agree(const Json& mine) const;

    std::unique_ptr<Ranks> ranks_;  // null in a run of one process
    bool divided_ = false, is_gathered_ = false;
    Scene* scene_ = nullptr;
    std::optional<World> part_;
    // traffic counted until the last before_advance(), and the traffic of all calls of World::advance
    RankTraffic before_, in_steps_;
    // current text, and the previous text, which stays because a signal handler may still be writing it
    std::array<std::string, 2> last_words_;
};

/// Throws SceneError if mpirun or srun has started several processes of a command that cannot share its work.
void require_one_process(const std::string& command);
/// Returns true in the process that prints for all processes that mpirun or srun has started.
bool is_first_process();
/// Handles an error that a process finds before it calls RunRanks::join(). If MPI connects the processes, they compare
/// their errors and rank 0 reports; otherwise the first process reports its own. Returns the exit code.
int fail_together(const SceneError& error);

}  // namespace skerry
