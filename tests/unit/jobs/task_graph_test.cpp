#include "jobs/task_graph.h"

#include <catch2/catch.hpp>
#include <random>
#include <string>
#include <vector>

#include "components/check.h"
#include "components/node_table.h"
#include "tests/unit/jobs/executors.h"

namespace skerry::test::task_graph_test {

namespace {

using Edges = std::vector<std::pair<Index, Index>>;

Edges edges_of(const TaskGraph& graph) {
    Edges edges;
    for (const TaskGraph::Edge& edge : graph.edges()) edges.emplace_back(edge.from, edge.to);
    return edges;
}

const auto nothing = [](auto&&...) {};

void add_one(std::span<const Real> from, std::span<Real> to) {
    for (std::size_t row = 0; row < from.size(); ++row) to[row] = from[row] + 1;
}

}  // namespace

TEST_CASE("a reader waits for the writer before it, a writer for the readers and the writer before it", "[unit]") {
    Column<Real> a;
    TaskGraph graph;
    graph.stage("write", nothing, write(a));
    graph.stage("read", nothing, read(a));
    graph.stage("read too", nothing, read(a));
    graph.stage("write again", nothing, write(a));
    graph.stage("write last", nothing, write(a));
    graph.compile();
    REQUIRE(edges_of(graph) == Edges{{0, 1}, {0, 2}, {1, 3}, {2, 3}, {3, 4}});
}

TEST_CASE("stages that share nothing, or only read the same, do not wait for each other", "[unit]") {
    Column<Real> a, b, c;
    const Real h = 0.5;
    TaskGraph graph;
    graph.stage("one", nothing, read(a), value(h), write(b));
    graph.stage("two", nothing, read(a), value(h), write(c));
    graph.compile();
    REQUIRE(graph.edges().empty());
}

TEST_CASE("edges that follow from others are left out", "[unit]") {
    Column<Real> a, b;
    TaskGraph graph;
    graph.stage("0", nothing, write(a), write(b));
    graph.stage("1", nothing, read(a), write(b));
    graph.stage("2", nothing, read(a), read(b));  // also waits for 0, but 1 already does
    graph.compile();
    REQUIRE(edges_of(graph) == Edges{{0, 1}, {1, 2}});
}

TEST_CASE("the edges order every conflicting pair and no edge can be left out, on random stages", "[unit]") {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        CAPTURE(seed);
        std::mt19937 random(seed);
        std::vector<Column<Real>> columns(6);
        const Index count = 15;
        std::vector<std::string> names;
        for (Index s = 0; s < count; ++s) names.push_back(std::to_string(s));
        std::vector<std::vector<int>> access(count, std::vector<int>(columns.size(), 0));  // 1 reads, 2 writes
        TaskGraph graph;
        for (Index s = 0; s < count; ++s) {
            const std::size_t r = random() % columns.size(), w = random() % columns.size();
            access[s][r] = 1;
            access[s][w] = 2;
            graph.stage(names[s].c_str(), nothing, read(columns[r]), write(columns[w]));
        }
        graph.compile();

        const auto reachable = [&](std::size_t without) {
            std::vector<std::vector<bool>> reach(count, std::vector<bool>(count, false));
            for (Index to = 0; to < count; ++to)
                for (std::size_t e = 0; e < graph.edges().size(); ++e) {
                    if (e == without || graph.edges()[e].to != to) continue;
                    const Index from = graph.edges()[e].from;
                    reach[from][to] = true;
                    for (Index s = 0; s < from; ++s)
                        if (reach[s][from]) reach[s][to] = true;
                }
            return reach;
        };
        const auto reach = reachable(graph.edges().size());
        for (Index from = 0; from < count; ++from)
            for (Index to = from + 1; to < count; ++to)
                for (std::size_t c = 0; c < columns.size(); ++c)
                    if (access[from][c] * access[to][c] >= 2) REQUIRE(reach[from][to]);
        for (std::size_t e = 0; e < graph.edges().size(); ++e)
            REQUIRE_FALSE(reachable(e)[graph.edges()[e].from][graph.edges()[e].to]);
    }
}

TEST_CASE("a stage that makes rows of a table is ordered with stages that touch its columns", "[unit]") {
    NodeTable nodes;
    TaskGraph graph;
    graph.stage("make", nothing, make(nodes));
    graph.stage("position", nothing, write(nodes.position));
    graph.stage("velocity", nothing, write(nodes.velocity));
    graph.stage("whole", nothing, read(nodes));
    graph.compile();
    REQUIRE(edges_of(graph) == Edges{{0, 1}, {0, 2}, {1, 3}, {2, 3}});
}

TEST_CASE("data flow through the stages in the order of the list, on every backend", "[unit]") {
    Column<Real> a, b, c, d, sum;
    for (Column<Real>* column : {&a, &b, &c, &d, &sum}) column->resize(100);
    TaskGraph graph;
    graph.stage("b", add_one, read(a), write(b));
    graph.stage("c", add_one, read(b), write(c));
    graph.stage("d", add_one, read(b), write(d));
    graph.stage(
        "sum",
        [](std::span<const Real> x, std::span<const Real> y, std::span<Real> z) {
            for (std::size_t i = 0; i < z.size(); ++i) z[i] += x[i] + y[i];
        },
        read(c), read(d), write(sum));
    graph.stage("a", add_one, read(sum), write(a));
    graph.compile();
    for (const ExecutorChoice& choice : executor_choices()) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        a.assign(100, 0);
        sum.assign(100, 0);
        for (int run = 0; run < 3; ++run) graph.run(*executor);
        // a, sum over the runs: 0, 0 -> 5, 4 -> 19, 18 -> 61, 60
        REQUIRE(std::all_of(a.begin(), a.end(), [](Real x) { return x == 61; }));
    }
    a.assign(100, 0);
    sum.assign(100, 0);
    for (int run = 0; run < 3; ++run) graph.run_inline();
    REQUIRE(std::all_of(a.begin(), a.end(), [](Real x) { return x == 61; }));
}

TEST_CASE("spans are taken when the stage starts, after earlier stages made rows", "[unit]") {
    Column<Real> column;
    std::size_t seen = 0;
    Real number = 1;
    TaskGraph graph;
    graph.stage(
        "grow", [](Column<Real>& rows) { rows.resize(1000, 3.0); }, make(column));
    graph.stage(
        "look", [&seen](std::span<const Real> rows, Real h) { seen = rows.size() * static_cast<std::size_t>(h); },
        read(column), value(number));
    graph.compile();
    number = 2;  // value() passes the value at run time
    graph.run_inline();
    REQUIRE(seen == 2000);
}

TEST_CASE("inputs are bound when the stage starts", "[unit]") {
    struct Inputs {
        std::span<const Real> rows;
        Real factor;

        static Inputs bind(const Binder& binder, const Column<Real>& column, const Real& factor) {
            return {binder.read(column), binder.value(factor)};
        }
    };
    struct Outputs {
        std::span<Real> rows;

        static Outputs bind(const Binder& binder, Column<Real>& column) { return {binder.write(column)}; }
    };
    Column<Real> column, result;
    Real factor = 0;
    TaskGraph graph;
    graph.stage(
        "grow",
        [](Column<Real>& rows, Column<Real>& results) {
            rows.resize(7);
            results.resize(1);
        },
        make(column), make(result));
    graph.stage(
        "use",
        [](const Inputs& in, const Outputs& out) { out.rows[0] = in.factor * static_cast<Real>(in.rows.size()); },
        inputs<Inputs>(column, factor), outputs<Outputs>(result));
    graph.compile();
    REQUIRE(edges_of(graph) == Edges{{0, 1}});
    factor = 2;
    graph.run_inline();
    REQUIRE(result[0] == 14);
}

TEST_CASE("a value argument of a stage cannot be written by other stages", "[unit]") {
    Column<Real> a;
    Real h = 1;
    TaskGraph graph;
    graph.stage("use", nothing, value(h), write(a));
    graph.compile();
    graph.stage("change", nothing, read(a), make(h));
    REQUIRE_THROWS_WITH(graph.compile(),
                        Catch::Contains("use reads as a constant value the data that the stage change writes"));
}

TEST_CASE("the graph lists the data declared by its stages, and the stages with a guard", "[unit]") {
    Column<Real> a, b;
    const bool go = true;
    TaskGraph graph;
    graph.stage("folder/plain", nothing, read(a), write(b));
    graph.stage("folder/guarded", nothing, write(a), only_if([](bool may) { return may; }, value(go)));
    REQUIRE(graph.stages().size() == 2);
    REQUIRE(graph.stages()[0].name == std::string("folder/plain"));
    REQUIRE_FALSE(graph.stages()[0].guarded);
    REQUIRE(graph.stages()[1].guarded);
    AccessList expected;
    const Binder binder(expected);
    binder.read(a);
    binder.write(b);
    REQUIRE(graph.stages()[0].accesses == expected);
}

TEST_CASE("a leading executor is passed by the graph", "[unit]") {
    Column<Real> column;
    const Executor* seen = nullptr;
    TaskGraph graph;
    graph.stage(
        "look", [&seen](Executor& executor, std::span<const Real>) { seen = &executor; }, read(column));
    graph.compile();
    const auto executor = make_executor(available_backends().front(), 2);
    graph.run(*executor);
    REQUIRE(seen == executor.get());
    graph.run_inline();
    REQUIRE(seen->backend() == Backend::serial);
}

TEST_CASE("a stage that returns false counts as skipped, any other as run", "[unit]") {
    Column<Real> a;
    bool useful = true;
    TaskGraph graph;
    graph.stage(
        "maybe", [&useful](std::span<Real>) { return useful; }, write(a));
    graph.stage(
        "always", [](std::span<Real>) {}, write(a));
    graph.compile();
    graph.run_inline();
    graph.run_inline();
    useful = false;
    graph.run_inline();
    REQUIRE(graph.stats()[0].name == std::string("maybe"));
    REQUIRE(graph.stats()[0].runs == 2);
    REQUIRE(graph.stats()[0].skipped == 1);
    REQUIRE(graph.stats()[1].runs == 3);
    REQUIRE(graph.stats()[1].skipped == 0);
    REQUIRE(graph.stats()[1].seconds > 0);
    graph.reset_stats();
    REQUIRE(graph.stats()[0].runs == 0);
    REQUIRE(graph.stats()[0].seconds == 0);
    REQUIRE(graph.stats()[0].name == std::string("maybe"));
}

TEST_CASE("a guard waits for its arguments and skips its stage when false", "[unit]") {
    int fault = 0;
    Column<Real> input, output;
    input.resize(1);
    output.resize(1);
    TaskGraph graph;
    graph.stage_with_result(
        "check", fault, [](std::span<const Real> rows) { return rows[0] < 0 ? 1 : 0; }, read(input));
    graph.stage(
        "commit", [](std::span<Real> rows) { rows[0] += 1; }, write(output),
        only_if([](int found) { return found == 0; }, read(fault)));
    graph.compile();
    REQUIRE(edges_of(graph) == Edges{{0, 1}});
    for (const ExecutorChoice& choice : executor_choices()) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        graph.reset_stats();
        output[0] = 0;
        input[0] = 1;
        graph.run(*executor);
        REQUIRE(output[0] == 1);
        input[0] = -1;
        graph.run(*executor);
        REQUIRE(output[0] == 1);
        REQUIRE(graph.stats()[1].runs == 1);
        REQUIRE(graph.stats()[1].skipped == 1);
    }
}

TEST_CASE("an exception of a stage comes out and the stages after it are left out", "[unit]") {
    Column<Real> a;
    bool reached = false;
    TaskGraph graph;
    graph.stage(
        "fail", [](std::span<Real>) { throw std::runtime_error("broken"); }, write(a));
    graph.stage(
        "after", [&reached](std::span<const Real>) { reached = true; }, read(a));
    graph.compile();
    for (const ExecutorChoice& choice : executor_choices()) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        REQUIRE_THROWS_WITH(graph.run(*executor), "broken");
        REQUIRE_FALSE(reached);
    }
    REQUIRE_THROWS_WITH(graph.run_inline(), "broken");
}

TEST_CASE("a stage that declares nothing, a name used twice and a run before compile are errors", "[unit]") {
    Column<Real> a;
    const Real h = 1;
    TaskGraph graph;
    REQUIRE_THROWS_AS(graph.stage("lost", nothing, value(h)), CheckFailed);
    REQUIRE_THROWS_WITH(graph.stage("lost", nothing), Catch::Contains("lost"));
    graph.stage("once", nothing, write(a));
    REQUIRE_THROWS_WITH(graph.stage("once", nothing, write(a)), Catch::Contains("once"));
    REQUIRE_THROWS_AS(graph.run_inline(), CheckFailed);
    graph.compile();
    REQUIRE_NOTHROW(graph.run_inline());
    graph.stage("late", nothing, write(a));
    REQUIRE_THROWS_AS(graph.run_inline(), CheckFailed);
}

TEST_CASE("a graph without stages compiles and runs", "[unit]") {
    TaskGraph graph;
    graph.compile();
    graph.run_inline();
    graph.run(*make_executor(available_backends().front(), 2));
    REQUIRE(graph.stats().empty());
    REQUIRE(graph.to_dot() ==
            "digraph step {\n    rankdir=TB;\n    node [shape=box, fontname=Helvetica];\n    labeljust=l;\n"
            "    fontname=Helvetica;\n}\n");
}

TEST_CASE("the drawing names every stage and every edge", "[unit]") {
    Column<Real> a;
    TaskGraph graph;
    graph.stage("dynamics/first", nothing, write(a));
    graph.stage("dynamics/second", nothing, read(a));
    graph.compile();
    REQUIRE_THAT(graph.to_dot(), Catch::Contains("    \"dynamics/first\";\n    \"dynamics/second\";\n"));
    REQUIRE_THAT(graph.to_dot(), Catch::Contains("    \"dynamics/first\" -> \"dynamics/second\";\n"));
}

}  // namespace skerry::test::task_graph_test
