// TaskGraph: the stages of a step in one list. Dependencies between stages follow from the declared reads and writes.
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "jobs/executor.h"
#include "jobs/stage_arguments.h"
#include "jobs/trace.h"

namespace skerry {

namespace access_detail {

// Calls a stage function with the values that the stage arguments pass. The executor is the first argument if the
// function takes one.
template <class F, class Passed>
struct StageCall;

template <class F, class... P>
struct StageCall<F, std::tuple<P...>> {
    static constexpr bool takes_executor = std::is_invocable_v<F&, Executor&, P...>;
    static constexpr bool possible = takes_executor || std::is_invocable_v<F&, P...>;

    static decltype(auto) call(F& function, Executor& executor, std::tuple<P...>&& passed) {
        return std::apply(
            [&](auto&&... p) -> decltype(auto) {
                if constexpr (takes_executor) {
                    return std::invoke(function, executor, std::forward<decltype(p)>(p)...);
                } else {
                    return std::invoke(function, std::forward<decltype(p)>(p)...);
                }
            },
            std::move(passed));
    }
};

template <class... Args>
using Passed = decltype(std::tuple_cat(std::declval<const Args&>().pass()...));
template <class F, class... Args>
using CallOf = StageCall<F, Passed<Args...>>;
template <class F, class... Args>
using ResultOf =
    decltype(CallOf<F, Args...>::call(std::declval<F&>(), std::declval<Executor&>(), std::declval<Passed<Args...>>()));

}  // namespace access_detail

/// True if the arguments of a stage fit the parameters of its function. For example, read() does not fit a mutable
/// span.
template <class F, class... Args>
concept StageFits = access_detail::CallOf<F, Args...>::possible;

/// Statistics of a stage since the graph was made or since reset_stats() was called.
struct StageStats {
    const char* name;
    double seconds = 0;  // time from start to end on the thread of the stage, summed over all runs [s]
    std::uint64_t runs = 0;
    std::uint64_t skipped = 0;  // how often the guard (only_if) of the stage was false or the stage returned false
};

/// Name, accesses and phase of a stage.
struct StageDeclaration {
    const char* name;
    AccessList accesses;
    bool guarded;            // true: the stage has an only_if argument and may be skipped
    const char* phase = "";  // set by TaskGraph
};

/// Stages and the order between them. Two stages that access the same object run in the order of the list if one of
/// them writes the object. Building a graph may allocate memory. Running a graph allocates none after its first run on
/// an executor. Example of a stage:
///
///     g.stage("dynamics/drive_nodes", drive_nodes, inputs<NodeMotionInputs>(attachments), value(s.h),
///             read(n.position), write(n.velocity));
///
/// The functions of stage_arguments.h make the arguments, in the order of the parameters of the stage function. The
/// graph itself passes a first parameter Executor&. Spans are made when the stage starts, because earlier stages may
/// resize the columns.
class TaskGraph {
public:
    struct Edge {
        Index from;
        Index to;
        auto operator<=>(const Edge&) const = default;
    };

    TaskGraph();

    /// Begins a phase: stages that are added from now on belong to this phase. Phases group the stages in the drawing
    /// of the graph (to_dot) and have no effect on the order of stages. `name` must be a string literal.
    void begin_phase(const char* name) { phase_ = name; }
    /// Adds a stage. `name` must be a string literal, or exist as long as the graph and any trace of it. A stage
    /// function may return bool; false means that the stage had nothing to do.
    template <class F, class... Args>
    requires StageFits<F, Args...>
    void stage(const char* name, F function, Args... args) {
        using Call = access_detail::CallOf<F, Args...>;
        using Result = access_detail::ResultOf<F, Args...>;
        static_assert(std::is_void_v<Result> || std::is_same_v<Result, bool>,
                      "a stage function must return void or bool; for another result use stage_with_result");
        auto run = [function, args...](Executor& executor) mutable {
            if (!(args.allows() && ...)) return Outcome::guarded;
            if constexpr (std::is_void_v<Result>) {
                Call::call(function, executor, std::tuple_cat(args.pass()...));
                return Outcome::ran;
            } else {
                return Call::call(function, executor, std::tuple_cat(args.pass()...)) ? Outcome::ran : Outcome::idle;
            }
        };
        add({name, access_detail::joined(args...), (Args::guards || ...)}, std::move(run));
    }

    /// Adds a stage whose return value is assigned to `result`. This write is declared as an access of the stage.
    template <class Result, class F, class... Args>
    requires StageFits<F, Args...>
    void stage_with_result(const char* name, Result& result, F function, Args... args) {
        using Call = access_detail::CallOf<F, Args...>;
        auto run = [function, &result, args...](Executor& executor) mutable {
            if (!(args.allows() && ...)) return Outcome::guarded;
            result = Call::call(function, executor, std::tuple_cat(args.pass()...));
            return Outcome::ran;
        };
        add({name, access_detail::joined(args..., make(result)), (Args::guards || ...)}, std::move(run));
    }

    /// Computes the edges of the graph. Call it once, after the last stage was added. Throws CheckFailed if a stage
    /// declares an object as a value and some stage writes this object.
    void compile();

    /// Sets the memory range in which accesses are checked: with SKERRY_CHECK_ACCESS, a stage throws CheckFailed if it
    /// accesses a column in this range without having declared the access. `name_of` returns the name of the object at
    /// an address, for the message.
    using NameOf = std::string (*)(void* memory, const void* place);
    void track(void* memory, std::size_t bytes, NameOf name_of) { tracked_ = {memory, bytes, name_of}; }

    /// Runs every stage once. If a stage throws, stages that have not started yet are skipped, and the exception is
    /// rethrown.
    void run(Executor& executor, Trace* trace = nullptr);
    /// Runs every stage once on the calling thread, in list order. Use it for scenes that are too small for threads to
    /// pay off.
    void run_inline(Trace* trace = nullptr);

    std::span<const StageDeclaration> stages() const { return stages_; }
    std::span<const StageStats> stats() const { return stats_; }
    void reset_stats();

    /// The smallest set of edges from which all dependencies follow, sorted by Edge::from, then by Edge::to. Stages are
    /// numbered in list order.
    std::span<const Edge> edges() const { return edges_; }
    /// The graph as text in the dot language of Graphviz, with a box around the stages of each phase.
    std::string to_dot() const;

private:
    enum class Outcome { ran, idle, guarded };
    using Run = std::function<Outcome(Executor&)>;
    struct Tracked {
        void* memory = nullptr;
        std::size_t bytes = 0;
        NameOf name_of = nullptr;
    };
    class StageWatch;

    void add(StageDeclaration stage, Run run);
    /// Runs a stage. Returns the end time of the stage, or `begin` if the guard (only_if) of the stage was false.
    Trace::Time run_stage(Index number, Trace::Time begin, Executor& executor, Trace* trace);
    void run_all(Executor& executor, Trace* trace);

    const char* phase_ = "";
    std::vector<StageDeclaration> stages_;
    std::vector<Run> run_;           // by stage
    std::vector<StageStats> stats_;  // by stage
    std::vector<Edge> edges_;
    // The edges in the form of GraphEdges, which an executor needs.
    std::vector<Index> successor_offset_, successor_, predecessor_count_;
    std::unique_ptr<Executor> inline_executor_;
    Tracked tracked_;
    bool compiled_ = false;
};

}  // namespace skerry
