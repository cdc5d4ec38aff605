// Recording: what each piece of some steps took on one thread, and what may run beside what.
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

/// serial: what one thread does alone. loop: the blocks of one run_blocks call. phase: those of one phase of a Team.
enum class PieceKind : std::uint8_t { serial, loop, phase };

struct Piece {
    PieceKind kind;
    Range blocks;  // rows of Recording::seconds; one for a serial piece

    bool operator==(const Piece&) const = default;
};

/// One stage of one step, or what the thread does between two graphs: its pieces, one after the other.
struct StageRun {
    Index stage;   // no_index: between graphs
    Range pieces;  // rows of Recording::pieces

    bool operator==(const StageRun&) const = default;
};

/// Which stage waits for which, as GraphEdges.
struct RecordedGraph {
    std::vector<Index> successor_offset;  // stage_count + 1
    std::vector<Index> successor;
    std::vector<Index> predecessor_count;  // by stage

    std::size_t stage_count() const { return predecessor_count.size(); }
    void copy(const GraphEdges& edges);
    bool operator==(const RecordedGraph&) const = default;
};

struct Recording {
    RecordedGraph graph;          // the same in all steps
    std::vector<StageRun> runs;   // a graph has one of each stage, in their order; what is between graphs has one
    std::vector<Piece> pieces;    // of all runs
    std::vector<double> seconds;  // of each block

    /// Wall time of one thread, s.
    double work() const;
    /// What no other thread can take part in, s. Other stages may run beside it.
    double serial() const;
    /// The longest chain of pieces that wait for each other, s: no number of cores takes less.
    double critical_path() const;
    /// The same pieces in the same order; what they took may differ.
    bool same_work(const Recording& other) const;
    std::span<const double> blocks(const Piece& piece) const;
};

/// Calls part(runs) for each graph, whose runs are one a stage, and for each single run between graphs.
template <class Part>
void for_each_part(const Recording& recording, Part&& part) {
    const std::span<const StageRun> runs(recording.runs);
    for (std::size_t r = 0; r < runs.size();) {
        const std::size_t count = runs[r].stage == no_index ? 1 : recording.graph.stage_count();
        part(runs.subspan(r, count));
        r += count;
    }
}

/// What one stage comes to in all steps, s.
struct StageSum {
    double work = 0;
    double serial = 0;
    std::size_t blocks = 0;  // of loops and phases
};
/// By stage; the last is what lies between graphs.
std::vector<StageSum> sums_by_stage(const Recording& recording);

/// Of each block what a fifth of several recordings of the same steps does not exceed (quiet.h): what was interrupted,
/// or found its caches full of another program's data, is not taken for slow. Throws std::runtime_error unless all did
/// the same work.
Recording undisturbed(std::span<const Recording> recordings);

/// Appends steps of the same graph.
void append(const Recording& more, Recording& all);

/// One line a piece: run, stage, kind, then microseconds of its blocks.
void write_csv(const Recording& recording, std::span<const std::string> stage_name, std::ostream& out);

}  // namespace skerry::profiling
