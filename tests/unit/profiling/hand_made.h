// Recordings made by hand, with known schedules.
#pragma once

#include <initializer_list>
#include <utility>
#include <vector>

#include "profiling/scaling/recording.h"

namespace skerry::profiling {

struct HandMadePiece {
    PieceKind kind;
    std::vector<double> seconds;  // duration of each block [s]
};

inline HandMadePiece serial(double seconds) {
    return {PieceKind::serial, {seconds}};
}
inline HandMadePiece loop(std::vector<double> seconds) {
    return {PieceKind::loop, std::move(seconds)};
}
inline HandMadePiece phase(std::vector<double> seconds) {
    return {PieceKind::phase, std::move(seconds)};
}

/// One graph with these pieces per stage. Edges are ordered pairs of stages and lead to later stages.
inline Recording graph_of(const std::vector<std::vector<HandMadePiece>>& stages,
                          const std::vector<std::pair<Index, Index>>& edges) {
    Recording recording;
    recording.graph.successor_offset.assign(stages.size() + 1, 0);
    recording.graph.predecessor_count.assign(stages.size(), 0);
    for (const auto& [from, to] : edges) {
        recording.graph.successor.push_back(to);
        ++recording.graph.predecessor_count[static_cast<std::size_t>(to)];
        for (std::size_t s = static_cast<std::size_t>(from) + 1; s <= stages.size(); ++s)
            ++recording.graph.successor_offset[s];
    }
    const auto size = [](const auto& rows) { return static_cast<Index>(rows.size()); };
    for (std::size_t s = 0; s < stages.size(); ++s) {
        const Index first_piece = size(recording.pieces);
        for (const HandMadePiece& piece : stages[s]) {
            const Index first = size(recording.seconds);
            recording.seconds.insert(recording.seconds.end(), piece.seconds.begin(), piece.seconds.end());
            recording.pieces.push_back({piece.kind, {first, size(recording.seconds)}});
        }
        recording.runs.push_back({static_cast<Index>(s), {first_piece, size(recording.pieces)}});
    }
    return recording;
}

}  // namespace skerry::profiling
