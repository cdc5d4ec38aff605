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

/// Sums over the ranks of the values of WorldReport that each rank counts for itself.
struct RankWork {
    std::vector<StageReport> stages;
    std::uint64_t broad_searches = 0, pair_searches = 0, candidates = 0, inline_steps = 0;
};

/// Comparison of the ranks of a run, for its report.
struct RanksReport {
    int count = 1, hosts = 1;
    std::vector<double> peak_memory;                 // greatest resident memory of each rank so far [bytes]
    double messages = 0, bytes = 0, reductions = 0;  // means per step; messages and bytes are sums over all ranks
    double waiting = 0;                              // share of the wall time of the steps, mean over the ranks
    // longest computing time of a rank, divided by the mean of all ranks
    double imbalance = 1;
    RankWork work{};  // empty if there is one rank

    /// Replaces the work of rank 0 in the report of the whole world by the work of all ranks.
    void complete(WorldReport& world) const;
};

/// The ranks that make a run together. Rank 0 builds the world, which is then divided among them. Rank 0 alone reports
/// and writes files, for which it gathers the whole world. Without other ranks all functions are trivial.
class RunRanks {
public:
    /// Joins the other processes that mpirun or srun has started with this process, if there are any. Throws SceneError
    /// if the program was built without MPI.
    static RunRanks join();
    /// A run of this process alone.
    RunRanks() = default;

    bool several() const { return ranks_ != nullptr; }
    bool is_first() const { return !several() || ranks_->rank() == 0; }

    /// Throws an error on all ranks unless all of them run the same program with the same options, and have read the
    /// same files. `scene` and `assignments`: scene file with the changes by options.
    void compare_starts(const std::filesystem::path& scene, std::span<const std::string> assignments);
    /// Collective. Returns the value of rank 0 on all ranks. Throws an error on all ranks if rank 0 has failed before,
    /// or if a signal has reached one of them, because the world may then not be at rest.
    Json of_first(const Json& mine) const;
    /// Returns the options for this rank. Throws SceneError for outputs that several ranks cannot write.
    RunOptions options_for(const RunOptions& asked) const;
    /// Divides the world of the scene of rank 0 among the ranks, and returns the part of this rank. Throws SceneError
    /// if the world holds something that cannot be divided. Afterwards the world of the scene is valid on rank 0 alone,
    /// after a call of whole().
    World& divide(Scene& scene, OwnerMap owners);
    /// Collective. Returns the whole world on rank 0, null on the other ranks. It is gathered if there was a call of
    /// advance() since the last call of this function.
    World* whole();
    /// Must be called before and after the part is advanced.
    void before_advance();
    void after_advance();

    /// Collective. Returns true on all ranks if the argument is true on one of them.
    bool any(bool mine) const;
    /// Collective. `wall`: wall time of the steps [s]. `steps`: number of steps. All ranks return the same.
    RanksReport report(double wall, std::uint64_t steps) const;

    /// Sets the text that rank 0 writes to standard error if the job is ended, because another rank has failed.
    void set_last_words(std::string text);
    /// Handles an error that ended the run of this rank, and returns the exit code. If the others cannot know the
    /// error, this function ends them all. If MPI does not connect the processes, the first one reports its error, and
    /// the others succeed: a launcher would end the first one when another fails.
    int fail(const std::exception& error);
    /// Collective. Returns the largest exit code of all ranks.
    int last_code(int mine) const;

private:
    explicit RunRanks(std::unique_ptr<Ranks> ranks) : ranks_(std::move(ranks)) {}
    /// Collective. Returns the values of all ranks. Throws AgreedError if one of the ranks has an error.
    std::vector<Json> agree(const Json& mine) const;

    std::unique_ptr<Ranks> ranks_;  // null: this process is alone
    bool divided_ = false, is_gathered_ = false;
    Scene* scene_ = nullptr;
    std::optional<World> part_;
    // traffic at the last call of before_advance, and its sums over all calls of advance
    RankTraffic before_, in_steps_;
    std::array<std::string, 2> last_words_;  // current text, and the previous one
};

/// Throws SceneError if mpirun or srun has started several processes of a command that cannot share its work.
void require_one_process(const std::string& command);
/// Returns true in the process that prints for all processes that mpirun or srun has started.
bool is_first_process();
/// Handles an error that processes have before they join for a run. They compare it by MPI if they can, and report it
/// once. Returns the exit code.
int fail_together(const SceneError& error);

}  // namespace skerry
