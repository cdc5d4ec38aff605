// Recording of steps on one thread: the time of each piece of work, and which pieces may run in parallel.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <span>
#include <string>
#include <vector>

#include "components/range.h"
#include "components/types.h"
#include "jobs/executor.h"

namespace skerry::profiling {

/// serial: work that one thread does alone. loop: the blocks of one run_blocks call. phase: the blocks of one Team
/// phase.
enum class PieceKind : std::uint8_t { serial, loop, phase };

struct Piece {
    PieceKind kind;
    Range blocks;  // rows of Recording::seconds; one for a serial piece

    bool operator==(const Piece&) const = default;
};

/// The pieces of one stage of one step, or of the work of the thread between two graphs, one after the other.
struct StageRun {
    Index stage;   // no_index: between graphs
    Range pieces;  // rows of Recording::pieces

    bool operator==(const StageRun&) const = default;
};

/// Dependencies between stages, in the layout of GraphEdges.
struct RecordedGraph {
    std::vector<Index> successor_offset;  // of length stage_count + 1
    std::vector<Index> successor;
    std::vector<Index> predecessor_count;  // by stage

    std::size_t stage_count() const { return predecessor_count.size(); }
    void copy(const GraphEdges& edges);
    bool operator==(const RecordedGraph&) const = default;
};

struct Recording {
    RecordedGraph graph;          // identical in all steps
    std::vector<StageRun> runs;   // one per stage of a graph, in stage order; one for the work between two graphs
    std::vector<Piece> pieces;    // of all runs
    std::vector<double> seconds;  // time of each block [s]

    /// Wall time of one thread [s].
    double work() const;
    /// Time of the serial pieces, which no other thread can share [s]. Other stages may run beside them.
    double serial() const;
    /// Time of the longest chain of pieces that wait for each other: a lower bound for any number of cores [s].
    double critical_path() const;
    /// True if both have the same pieces in the same order. Their times may differ.
    bool same_work(const Recording& other) const;
    std::span<const double> blocks(const Piece& piece) const;
};

/// Calls part(runs) for each graph, with one run per stage, and for each single run between graphs.
template <class Part>
void for_each_part(const Recording& recording, Part&& part) {
    const std::span<const StageRun> runs(recording.runs);
    for (std::size_t r = 0; r < runs.size();) {
        const std::size_t count = runs[r].stage == no_index ? 1 : recording.graph.stage_count();
        part(runs.subspan(r, count));
        r += count;
    }
}

/// Sums of one stage over all steps.
struct StageSum {
    double work = 0;
    double serial = 0;
    std::size_t blocks = 0;  // number of blocks of loops and phases
};
/// Sums by stage. The last entry is the work between graphs.
std::vector<StageSum> sums_by_stage(const Recording& recording);

/// Takes for each block the lower fifth of its times in several recordings of the same steps (quiet.h). A block that
/// was interrupted, or found its caches full of another program's data, is then not taken for slow. Throws
/// std::runtime_error unless all recordings did the same work.
Recording undisturbed(std::span<const Recording> recordings);

/// Appends the steps of `more`. Throws std::runtime_error if they belong to a different graph.
void append(const Recording& more, Recording& all);

/// Writes one line per piece: run, stage, kind, then the times of its blocks [us].
void write_csv(const Recording& recording, std::span<const std::string> stage_name, std::ostream& out);

}  // namespace skerry::profiling
