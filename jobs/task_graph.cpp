#include "jobs/task_graph.h"

#include <algorithm>
#include <chrono>
#include <string_view>

#include "components/check.h"

namespace skerry {

namespace {

bool conflict(const AccessList& a, const AccessList& b) {
    return std::any_of(a.begin(), a.end(), [&](const Access& access) {
        return std::any_of(b.begin(), b.end(), [&](const Access& other) { return access.conflicts_with(other); });
    });
}

/// True if a stage writes an object that another stage declares as Use::value, and therefore no stage may write.
/// `written`: accesses of the first stage. `taken`: accesses of the second stage.
bool breaks_value(const AccessList& written, const AccessList& taken) {
    return std::ranges::any_of(written, [&](const Access& access) {
        return access.writes() && std::ranges::any_of(taken, [&](const Access& other) {
                   return other.use == Use::value && access.overlaps(other);
               });
    });
}

}  // namespace

TaskGraph::TaskGraph() : inline_executor_(make_executor(Backend::serial, 1)) {}

/// AccessWatch that throws CheckFailed if the running stage accesses a column without having declared the access.
class TaskGraph::StageWatch final : public AccessWatch {
public:
    StageWatch(const StageDeclaration& stage, const Tracked& tracked) : stage_(stage), tracked_(tracked) {}

    void touched(const void* column, std::size_t bytes, bool writes) const override {
        const auto begin = reinterpret_cast<std::uintptr_t>(column);
        const auto memory = reinterpret_cast<std::uintptr_t>(tracked_.memory);
        if (begin < memory || begin >= memory + tracked_.bytes) return;
        const auto declared = [&](const Access& access) {
            return (access.writes() || !writes) && access.begin <= begin && begin + bytes <= access.end;
        };
        if (std::ranges::any_of(stage_.accesses, declared)) return;
        throw CheckFailed(std::string("the stage ") + stage_.name + (writes ? " writes " : " reads ") +
                          tracked_.name_of(tracked_.memory, column) + " without having declared this access");
    }

private:
    const StageDeclaration& stage_;
    const Tracked& tracked_;
};

void TaskGraph::add(StageDeclaration stage, Run run) {
    if (std::ranges::all_of(stage.accesses, [](const Access& access) { return access.use == Use::value; }))
        throw CheckFailed(std::string("the stage ") + stage.name +
                          " declares no access, so no other stage would wait for it");
    for (const StageDeclaration& other : stages_)
        if (std::string_view(other.name) == stage.name)
            throw CheckFailed(std::string("two stages are named ") + stage.name);
    stage.phase = phase_;
    stats_.push_back({stage.name});
    run_.push_back(std::move(run));
    stages_.push_back(std::move(stage));
    compiled_ = false;
}

void TaskGraph::compile() {
    const std::size_t count = stages_.size();
    for (const StageDeclaration& writer : stages_)
        for (const StageDeclaration& reader : stages_)
            if (breaks_value(writer.accesses, reader.accesses))
                throw CheckFailed(std::string("the stage ") + reader.name +
                                  " reads as a constant value the data that the stage " + writer.name + " writes");
    edges_.clear();
    // before[s][p]: stage s waits for stage p, directly or through other stages. The predecessors of a stage are
    // visited from the last to the first, and p gets no edge to s if another predecessor of s already waits for p. So
    // the set of edges is minimal.
    std::vector<std::vector<bool>> before(count, std::vector<bool>(count, false));
    for (std::size_t s = 0; s < count; ++s) {
        for (std::size_t p = s; p-- > 0;) {
            if (before[s][p] || !conflict(stages_[p].accesses, stages_[s].accesses)) continue;
            edges_.push_back({static_cast<Index>(p), static_cast<Index>(s)});
            before[s][p] = true;
            for (std::size_t earlier = 0; earlier < p; ++earlier)
                if (before[p][earlier]) before[s][earlier] = true;
        }
    }
    std::sort(edges_.begin(), edges_.end());

    successor_offset_.assign(count + 1, 0);
    successor_.clear();
    predecessor_count_.assign(count, 0);
    for (const Edge& edge : edges_) {
        ++successor_offset_[edge.from + 1];
        successor_.push_back(edge.to);
        ++predecessor_count_[edge.to];
    }
    for (std::size_t s = 0; s < count; ++s) successor_offset_[s + 1] += successor_offset_[s];
    compiled_ = true;
}

void TaskGraph::run(Executor& executor, Trace* trace) {
    run_all(executor, trace);
}

void TaskGraph::run_inline(Trace* trace) {
    run_all(*inline_executor_, trace);
}

void TaskGraph::run_all(Executor& executor, Trace* trace) {
    if (!compiled_) throw CheckFailed("a task graph runs only after compile()");
    const GraphEdges edges{successor_offset_, successor_, predecessor_count_};
    if (executor.worker_count() > 1) {
        executor.run_graph(edges, [&](Index number) { run_stage(number, Trace::now(), executor, trace); });
        return;
    }
    // The clock is read only once per stage: stages run one after the other, so the end time of one is the start time
    // of the next. The reading time matters in a step of a few microseconds.
    Trace::Time time = Trace::now();
    executor.run_graph(edges, [&](Index number) { time = run_stage(number, time, executor, trace); });
}

Trace::Time TaskGraph::run_stage(Index number, Trace::Time begin, Executor& executor, Trace* trace) {
    StageStats& stats = stats_[number];
    const StageWatch watch(stages_[number], tracked_);
    const AccessScope access(access_is_checked ? &watch : nullptr);
    const Outcome outcome = run_[number](executor);
    if (outcome == Outcome::guarded) {
        ++stats.skipped;
        return begin;
    }
    const Trace::Time end = Trace::now();
    stats.seconds += std::chrono::duration<double>(end - begin).count();
    if (outcome == Outcome::ran) {
        ++stats.runs;
    } else {
        ++stats.skipped;
    }
    if (trace) trace->add(stats.name, begin, end);
    return end;
}

void TaskGraph::reset_stats() {
    for (StageStats& stats : stats_) stats = {stats.name};
}

std::string TaskGraph::to_dot() const {
    std::string text =
        "digraph step {\n    rankdir=TB;\n    node [shape=box, fontname=Helvetica];\n    labeljust=l;\n"
        "    fontname=Helvetica;\n";
    const auto quoted = [this](Index stage) { return '"' + std::string(stats_[stage].name) + '"'; };
    std::string_view phase;
    for (Index stage = 0; stage < static_cast<Index>(stages_.size()); ++stage) {
        const std::string_view of_stage = stages_[static_cast<std::size_t>(stage)].phase;
        if (of_stage != phase) {
            if (!phase.empty()) text += "    }\n";
            phase = of_stage;
            if (!phase.empty())
                text +=
                    "    subgraph cluster_" + std::to_string(stage) + " {\n    label=\"" + std::string(phase) + "\";\n";
        }
        text += "    " + quoted(stage) + ";\n";
    }
    if (!phase.empty()) text += "    }\n";
    for (const Edge& edge : edges_) text += "    " + quoted(edge.from) + " -> " + quoted(edge.to) + ";\n";
    return text + "}\n";
}

}  // namespace skerry
