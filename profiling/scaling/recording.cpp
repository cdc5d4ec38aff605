#include "profiling/scaling/recording.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <ostream>
#include <stdexcept>

#include "profiling/scaling/quiet.h"

namespace skerry::profiling {

namespace {

double sum_of(std::span<const double> seconds) {
    return std::accumulate(seconds.begin(), seconds.end(), 0.0);
}

std::span<const Piece> pieces_of(const Recording& recording, const StageRun& run) {
    return std::span(recording.pieces)
        .subspan(static_cast<std::size_t>(run.pieces.begin), static_cast<std::size_t>(run.pieces.size()));
}

/// Time of a stage on as many cores as it has blocks [s].
double shortest(const Recording& recording, const StageRun& run) {
    double seconds = 0;
    for (const Piece& piece : pieces_of(recording, run))
        if (piece.blocks.size() > 0) seconds += std::ranges::max(recording.blocks(piece));
    return seconds;
}

double critical_path_of(const Recording& recording, std::span<const StageRun> graph) {
    if (graph.front().stage == no_index) return shortest(recording, graph.front());
    std::vector<double> start(graph.size(), 0.0);
    double end = 0;
    for (std::size_t s = 0; s < graph.size(); ++s) {  // every edge goes to a later stage
        const double done = start[s] + shortest(recording, graph[s]);
        end = std::max(end, done);
        for (Index e = recording.graph.successor_offset[s]; e < recording.graph.successor_offset[s + 1]; ++e) {
            double& next = start[static_cast<std::size_t>(recording.graph.successor[static_cast<std::size_t>(e)])];
            next = std::max(next, done);
        }
    }
    return end;
}

Range moved(Range range, std::size_t by) {
    return {range.begin + static_cast<Index>(by), range.end + static_cast<Index>(by)};
}

}  // namespace

void RecordedGraph::copy(const GraphEdges& edges) {
    successor_offset.assign(edges.successor_offset.begin(), edges.successor_offset.end());
    successor.assign(edges.successor.begin(), edges.successor.end());
    predecessor_count.assign(edges.predecessor_count.begin(), edges.predecessor_count.end());
}

std::span<const double> Recording::blocks(const Piece& piece) const {
    return std::span(seconds).subspan(static_cast<std::size_t>(piece.blocks.begin),
                                      static_cast<std::size_t>(piece.blocks.size()));
}

double Recording::work() const {
    return sum_of(seconds);
}

double Recording::serial() const {
    double sum = 0;
    for (const Piece& piece : pieces)
        if (piece.kind == PieceKind::serial) sum += sum_of(blocks(piece));
    return sum;
}

double Recording::critical_path() const {
    double sum = 0;
    for_each_part(*this, [&](std::span<const StageRun> part) { sum += critical_path_of(*this, part); });
    return sum;
}

bool Recording::same_work(const Recording& other) const {
    return graph == other.graph && runs == other.runs && pieces == other.pieces;
}

std::vector<StageSum> sums_by_stage(const Recording& recording) {
    std::vector<StageSum> sums(recording.graph.stage_count() + 1);
    for (const StageRun& run : recording.runs) {
        StageSum& sum = run.stage == no_index ? sums.back() : sums[static_cast<std::size_t>(run.stage)];
        for (const Piece& piece : pieces_of(recording, run)) {
            const double seconds = sum_of(recording.blocks(piece));
            sum.work += seconds;
            if (piece.kind == PieceKind::serial)
                sum.serial += seconds;
            else
                sum.blocks += static_cast<std::size_t>(piece.blocks.size());
        }
    }
    return sums;
}

Recording undisturbed(std::span<const Recording> recordings) {
    Recording result = recordings.front();
    for (const Recording& other : recordings)
        if (!other.same_work(result)) throw std::runtime_error("two recordings of the same steps differ in their work");
    std::vector<double> times(recordings.size());
    for (std::size_t block = 0; block < result.seconds.size(); ++block) {
        for (std::size_t r = 0; r < times.size(); ++r) times[r] = recordings[r].seconds[block];
        result.seconds[block] = lower_fifth(times);
    }
    return result;
}

void append(const Recording& more, Recording& all) {
    if (all.graph.stage_count() == 0) all.graph = more.graph;
    if (more.graph.stage_count() != 0 && more.graph != all.graph)
        throw std::runtime_error("recordings of different graphs are not joined");
    const std::size_t blocks = all.seconds.size(), pieces = all.pieces.size();
    for (const StageRun& run : more.runs) all.runs.push_back({run.stage, moved(run.pieces, pieces)});
    for (const Piece& piece : more.pieces) all.pieces.push_back({piece.kind, moved(piece.blocks, blocks)});
    all.seconds.insert(all.seconds.end(), more.seconds.begin(), more.seconds.end());
}

void write_csv(const Recording& recording, std::span<const std::string> stage_name, std::ostream& out) {
    constexpr std::array kinds{"serial", "loop", "phase"};
    out << "run,stage,kind,us\n";
    for (std::size_t r = 0; r < recording.runs.size(); ++r) {
        const StageRun& run = recording.runs[r];
        const auto stage = static_cast<std::size_t>(run.stage);
        for (const Piece& piece : pieces_of(recording, run)) {
            out << r << ',' << (run.stage == no_index ? "between graphs" : stage_name[stage].c_str()) << ','
                << kinds[static_cast<std::size_t>(piece.kind)] << ',';
            const char* separator = "";
            for (const double seconds : recording.blocks(piece)) {
                out << separator << 1e6 * seconds;
                separator = " ";
            }
            out << '\n';
        }
    }
}

}  // namespace skerry::profiling
