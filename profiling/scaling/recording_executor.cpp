#include "profiling/scaling/recording_executor.h"

#include <algorithm>

#include "components/check.h"
#include "jobs/arithmetic_scope.h"
#include "jobs/backends.h"
#include "profiling/measure.h"

namespace skerry::profiling {

namespace {

Index size_of(const auto& rows) {
    return static_cast<Index>(rows.size());
}

void reserve_as(const Recording& expected, Recording& recording) {
    constexpr std::size_t at_least = 1 << 16;
    recording.runs.reserve(std::max(at_least, expected.runs.size()));
    recording.pieces.reserve(std::max(at_least, expected.pieces.size()));
    recording.seconds.resize(std::max(16 * at_least, expected.seconds.size()));  // makes the system provide its pages
    recording.seconds.clear();
}

}  // namespace

RecordingExecutor::RecordingExecutor(int claimed_workers) : claimed_workers_(claimed_workers) {
    SKERRY_CHECK(claimed_workers >= 2);
    constexpr Index tries = 10001;
    begin();
    run_blocks(tries, [](Index) {});
    std::vector<double> empty = end().seconds;
    note_cost_ = median(std::move(empty));
}

void RecordingExecutor::begin(const Recording& expected) {
    recording_ = {};
    reserve_as(expected, recording_);
    on_ = true;
    open_run(no_index);
    last_ = Clock::now();
}

Recording RecordingExecutor::end() {
    note_serial();
    close_run();
    on_ = false;
    return std::move(recording_);
}

void RecordingExecutor::note_block() {
    const Clock::time_point now = Clock::now();
    recording_.seconds.push_back(std::max(0.0, std::chrono::duration<double>(now - last_).count() - note_cost_));
    last_ = now;
}

void RecordingExecutor::note_serial() {
    note_block();
    const Index end = size_of(recording_.seconds);
    recording_.pieces.push_back({PieceKind::serial, {end - 1, end}});
}

void RecordingExecutor::open_run(Index stage) {
    const Index first = size_of(recording_.pieces);
    recording_.runs.push_back({stage, {first, first}});
}

void RecordingExecutor::close_run() {
    recording_.runs.back().pieces.end = size_of(recording_.pieces);
}

void RecordingExecutor::run_noted(PieceKind kind, Index begin, Index end, FunctionRef<void(Index)> body) {
    const bool within = in_block_, noted = on_ && !within;
    FirstError error;
    in_block_ = true;
    for (Index block = begin; block < end; ++block) {
        try {
            body(block);
        } catch (...) {
            error.keep(block);
        }
        if (noted) note_block();
    }
    in_block_ = within;
    if (noted)
        recording_.pieces.push_back({kind, {size_of(recording_.seconds) - (end - begin), size_of(recording_.seconds)}});
    error.rethrow();
}

void RecordingExecutor::run_blocks(Index count, FunctionRef<void(Index)> body) {
    const ArithmeticScope arithmetic;
    if (on_ && !in_block_) note_serial();
    run_noted(PieceKind::loop, 0, count, body);
}

void RecordingExecutor::run_phases(std::span<const Index> phase_offset, FunctionRef<void(Index)> body) {
    const ArithmeticScope arithmetic;
    if (on_ && !in_block_) note_serial();
    FirstError error;
    for (std::size_t phase = 0; phase + 1 < phase_offset.size(); ++phase) {
        if (phase_offset[phase] == phase_offset[phase + 1]) continue;
        try {
            run_noted(PieceKind::phase, phase_offset[phase], phase_offset[phase + 1], body);
        } catch (...) {
            error.keep(static_cast<Index>(phase));
        }
    }
    error.rethrow();
}

void RecordingExecutor::run_graph(const GraphEdges& edges, FunctionRef<void(Index)> run_stage) {
    const ArithmeticScope arithmetic;
    if (on_) {
        note_serial();
        close_run();
        if (recording_.graph.stage_count() == 0) recording_.graph.copy(edges);
        SKERRY_CHECK(recording_.graph.stage_count() == edges.predecessor_count.size());
    }
    FirstError error;
    for (Index stage = 0; stage < size_of(edges.predecessor_count); ++stage) {
        if (on_) open_run(stage);
        try {
            if (!error.any()) run_stage(stage);
        } catch (...) {
            error.keep(stage);
        }
        if (!on_) continue;
        note_serial();
        close_run();
    }
    if (on_) open_run(no_index);
    error.rethrow();
}

}  // namespace skerry::profiling
