// Arguments of a stage: passed values, declared access, code that must not compile, and forbidden access.
#include "jobs/access.h"

#include <catch2/catch.hpp>

#include "components/check.h"
#include "components/node_table.h"
#include "jobs/parallel_for.h"
#include "jobs/task_graph.h"
#include "jobs/team.h"
#include "tests/unit/jobs/executors.h"

namespace skerry::test::jobs_access_test {

namespace {

using ReadReals = decltype(read(std::declval<const Column<Real>&>()));
using WriteReals = decltype(write(std::declval<Column<Real>&>()));
using ReadRows = decltype(read(std::declval<const Ragged<Index>&>()));
using ReadNodes = decltype(read(std::declval<const NodeTable&>()));
using MakeNodes = decltype(make(std::declval<NodeTable&>()));

using Reader = void (*)(std::span<const Real>);
using Writer = void (*)(std::span<Real>);

static_assert(StageFits<Reader, ReadReals>);
static_assert(StageFits<Writer, WriteReals>);
static_assert(!StageFits<Writer, ReadReals>, "read() must not be given to a span that can be written to");
static_assert(!StageFits<void (*)(Executor&, std::span<Real>), ReadReals>);
static_assert(!StageFits<Reader, ReadReals, ReadReals>, "an argument too many");
static_assert(!StageFits<Reader>, "an argument too few");
static_assert(!StageFits<void (*)(std::span<const Vec3>), ReadReals>, "another type of rows");
static_assert(StageFits<void (*)(RaggedView<Index>), ReadRows>);
static_assert(StageFits<void (*)(const NodeTable&), ReadNodes>);
static_assert(!StageFits<void (*)(NodeTable&), ReadNodes>, "a table to read must not be given to one who makes rows");
static_assert(StageFits<void (*)(NodeTable&), MakeNodes>);
static_assert(StageFits<void (*)(Executor&, std::span<const Real>), ReadReals>);

template <class T>
concept Readable = requires(T object) {
    read(std::forward<T>(object));
};
template <class T>
concept Writable = requires(T object) {
    write(std::forward<T>(object));
};
template <class T>
concept Makeable = requires(T object) {
    make(std::forward<T>(object));
};
template <class T>
concept Valuable = requires(T object) {
    value(std::forward<T>(object));
};

static_assert(Readable<Column<Real>&> && Readable<const Column<Real>&> && Readable<NodeTable&> && Readable<Real&>);
static_assert(!Readable<Column<Real>> && !Readable<Real> && !Valuable<Real>,
              "nothing that is gone when the stage runs");
static_assert(!Readable<std::span<Real>&> && !Readable<Real*&> && !Readable<RaggedView<Index>&>,
              "nothing that only shows other data");
static_assert(Writable<Column<Real>&> && !Writable<const Column<Real>&>);
static_assert(Makeable<NodeTable&> && !Makeable<const NodeTable&>);

struct Follow {
    std::span<const Vec3> position;
    std::span<const Vec3> load;
    Real h;

    static Follow bind(const Binder& binder, const NodeTable& nodes, const bool& loaded, const Real& h) {
        return {binder.read(nodes.position), binder.read_if(binder.read(loaded), nodes.load), binder.value(h)};
    }
};
struct Move {
    std::span<Vec3> velocity, push_out;

    static Move bind(const Binder& binder, NodeTable& nodes, const bool& pushed) {
        return {binder.write(nodes.velocity), binder.write_if(binder.value(pushed), nodes.push_out)};
    }
};

template <class T>
concept Input = requires(T object) {
    inputs<Follow>(std::forward<T>(object));
};
static_assert(Input<NodeTable&> && !Input<NodeTable> && !Input<std::span<Real>&>, "an object that stays");

const auto stateless = [](bool go) { return go; };
const auto with_memory = [go = true](bool) { return go; };
bool free_function(bool go) {
    return go;
}
static_assert(access_detail::is_stateless<std::remove_cv_t<decltype(stateless)>> &&
              access_detail::is_stateless<decltype(&free_function)>);
static_assert(!access_detail::is_stateless<std::remove_cv_t<decltype(with_memory)>>,
              "a guard that captures could look at anything");

static_assert(sizeof(Column<Real>) == sizeof(std::vector<Real>), "the check takes no room");

AccessList accesses_of(const auto& argument) {
    AccessList list;
    argument.declare(list);
    return list;
}

bool conflict(const auto& a, const auto& b) {
    for (const Access& first : accesses_of(a))
        for (const Access& second : accesses_of(b))
            if (first.conflicts_with(second)) return true;
    return false;
}

}  // namespace

TEST_CASE("a table read without a column conflicts with who writes another, not with who writes that one", "[unit]") {
    struct WithoutMass {
        static WithoutMass bind(const Binder& binder, const NodeTable& nodes) {
            binder.read_but(nodes, nodes.mass);
            return {};
        }
    };
    NodeTable nodes;
    const auto table = inputs<WithoutMass>(nodes);
    REQUIRE_FALSE(conflict(table, write(nodes.mass)));
    REQUIRE(conflict(table, write(nodes.position)));
    REQUIRE(conflict(table, write(nodes.velocity)));
    REQUIRE(conflict(table, write(nodes.inverse_mass)));
    REQUIRE(conflict(table, make(nodes)));
    REQUIRE_FALSE(conflict(table, read(nodes)));
}

TEST_CASE("two reads never conflict, a write conflicts with both", "[unit]") {
    Column<Real> column, other;
    REQUIRE_FALSE(conflict(read(column), read(column)));
    REQUIRE(conflict(read(column), write(column)));
    REQUIRE(conflict(write(column), write(column)));
    REQUIRE_FALSE(conflict(write(column), write(other)));
}

TEST_CASE("a table as a whole conflicts with each of its columns, and with no column of another", "[unit]") {
    NodeTable nodes, others;
    nodes.for_each_column([&](const char* name, auto& column, ColumnRole) {
        CAPTURE(name);
        REQUIRE(conflict(make(nodes), read(column)));
        REQUIRE(conflict(read(nodes), write(column)));
        REQUIRE_FALSE(conflict(read(nodes), read(column)));
        REQUIRE_FALSE(conflict(make(others), write(column)));
    });
    REQUIRE_FALSE(conflict(write(nodes.position), write(nodes.velocity)));
    REQUIRE_FALSE(conflict(write(nodes.position), read(nodes.body)));
}

TEST_CASE("a ragged conflicts with its offsets and its items", "[unit]") {
    Ragged<Index> ragged;
    REQUIRE(conflict(read(ragged), write(ragged.offset)));
    REQUIRE(conflict(read(ragged), write(ragged.item)));
    REQUIRE(conflict(make(ragged), read(ragged.item)));
}

TEST_CASE("inputs and outputs declare the arguments of bind, whether it is wanted or not, and pass it", "[unit]") {
    NodeTable nodes;
    nodes.for_each_column([](const char*, auto& column, ColumnRole) { column.resize(3); });
    bool flag = false;
    Real h = 0.5;
    const auto list_of = [](auto&& ask) {
        AccessList list;
        ask(Binder(list));
        return list;
    };
    const AccessList read_list = list_of([&](const Binder& binder) {
        binder.read(nodes.position);
        binder.read(flag);
        binder.read(nodes.load);
        binder.value(h);
    });
    const AccessList write_list = list_of([&](const Binder& binder) {
        binder.write(nodes.velocity);
        binder.value(flag);
        binder.write(nodes.push_out);
    });
    for (const bool wanted : {false, true}) {
        flag = wanted;
        const auto in = inputs<Follow>(nodes, flag, h);
        const auto out = outputs<Move>(nodes, flag);
        CHECK(accesses_of(in) == read_list);
        CHECK(accesses_of(out) == write_list);
        const Follow follow = std::get<0>(in.pass());
        CHECK(follow.position.data() == nodes.position.data());
        CHECK(follow.load.size() == (wanted ? 3 : 0));
        CHECK(follow.h == 0.5);
        const Move move = std::get<0>(out.pass());
        CHECK(move.velocity.data() == nodes.velocity.data());
        CHECK(move.push_out.size() == (wanted ? 3 : 0));
    }
}

TEST_CASE("a value conflicts with nothing, and a guard declares its arguments", "[unit]") {
    Real number = 0;
    REQUIRE_FALSE(conflict(value(number), make(number)));
    REQUIRE(conflict(only_if([](Real x) { return x > 0; }, read(number)), make(number)));
    REQUIRE_FALSE(conflict(only_if([](Real x) { return x > 0; }, value(number)), make(number)));
    REQUIRE(only_if([](Real x) { return x == 0; }, value(number)).allows());
    number = 1;
    REQUIRE_FALSE(only_if([](Real x) { return x == 0; }, value(number)).allows());
}

#ifdef SKERRY_CHECK_ACCESS

namespace {

/// Columns that the graph of a test tracks.
struct Rows {
    Column<Real> a, b;
    Ragged<Index> ragged;

    Rows() {
        a.resize(64);
        b.resize(64);
    }
    static std::string name_of(void* rows, const void* place) {
        return place == &static_cast<Rows*>(rows)->b ? "rows.b" : "another column";
    }
};

using Touch = void (*)(Rows&);
const std::vector<std::pair<const char*, Touch>> reads_of_b{
    {"[]", [](Rows& rows) { (void)std::as_const(rows).b[0]; }},
    {"size", [](Rows& rows) { (void)rows.b.size(); }},
    {"span", [](Rows& rows) { (void)std::as_const(rows).b.span(); }},
    {"begin", [](Rows& rows) { (void)std::as_const(rows).b.begin(); }},
    {"copy", [](Rows& rows) { const Column<Real> copy = rows.b; }},
};
const std::vector<std::pair<const char*, Touch>> writes_of_b{
    {"[]", [](Rows& rows) { rows.b[0] = 1; }},
    {"resize", [](Rows& rows) { rows.b.resize(64); }},
    {"push_back", [](Rows& rows) { rows.b.push_back(1); }},
    {"span", [](Rows& rows) { (void)rows.b.span(); }},
    {"data", [](Rows& rows) { (void)rows.b.data(); }},
    {"assignment",
     [](Rows& rows) {
         const Column<Real> other;
         rows.b = other;
     }},
};

/// Lists the ways to touch rows: on the stage's thread, in the last block of a loop, in the last block of a team.
void list_everywhere(std::vector<std::function<void(Executor&)>>& ways, Rows& rows, Touch touch) {
    ways.push_back([&rows, touch](Executor&) { touch(rows); });
    ways.push_back([&rows, touch](Executor& executor) {
        parallel_for(executor, 64, 1, [&](std::size_t begin, std::size_t) {
            if (begin == 63) touch(rows);
        });
    });
    ways.push_back([&rows, touch](Executor& executor) {
        Team team;
        team.gather(executor, [&] {
            team.run_blocks(64, [&](Index block) {
                if (block == 63) touch(rows);
            });
        });
    });
}

/// Runs a stage that does `work` and declares `arguments`.
void run_stage(Rows& rows, Executor& executor, const std::function<void(Executor&)>& work, const auto&... arguments) {
    TaskGraph graph;
    graph.track(&rows, sizeof rows, Rows::name_of);
    graph.stage(
        "folder/stage", [&work](Executor& workers, const auto&...) { work(workers); }, arguments...);
    graph.compile();
    graph.run(executor);
}

}  // namespace

TEST_CASE("a stage that touches a column it has not declared fails, and says which", "[unit]") {
    for (const ExecutorChoice& choice : executor_choices({1, 2, 4})) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        const auto fails = [&](const auto& touches, const std::string& message, auto&&... arguments) {
            for (const auto& [name, touch] : touches) {
                CAPTURE(name);
                Rows rows;
                std::vector<std::function<void(Executor&)>> ways;
                list_everywhere(ways, rows, touch);
                for (const auto& way : ways)
                    CHECK_THROWS_WITH(run_stage(rows, *executor, way, arguments(rows)...), Catch::Contains(message));
                CHECK_NOTHROW(touch(rows));  // the threads are free again
            }
        };
        const auto writes_a = [](Rows& rows) { return write(rows.a); };
        const auto reads_b = [](Rows& rows) { return read(rows.b); };
        fails(reads_of_b, "the stage folder/stage reads rows.b", writes_a);
        fails(writes_of_b, "the stage folder/stage writes rows.b", writes_a);
        fails(writes_of_b, "the stage folder/stage writes rows.b", writes_a, reads_b);
    }
}

TEST_CASE("a stage may use declared data, and unwatched data", "[unit]") {
    Column<Real> outside;
    outside.resize(1);
    for (const ExecutorChoice& choice : executor_choices({1, 2, 4})) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        const auto passes = [&](const auto& touches, auto&& argument) {
            for (const auto& [name, touch] : touches) {
                CAPTURE(name);
                Rows rows;
                std::vector<std::function<void(Executor&)>> ways;
                list_everywhere(ways, rows, touch);
                for (const auto& way : ways) CHECK_NOTHROW(run_stage(rows, *executor, way, argument(rows)));
            }
        };
        passes(reads_of_b, [](Rows& rows) { return read(rows.b); });
        passes(reads_of_b, [](Rows& rows) { return write(rows.b); });
        passes(reads_of_b, [](Rows& rows) { return read(rows); });
        passes(writes_of_b, [](Rows& rows) { return write(rows.b); });
        passes(writes_of_b, [](Rows& rows) { return make(rows); });
        Rows rows;
        const auto work = [&](Executor&) {
            Column<Real> local;
            local.resize(3);
            outside[0] = local[1];
        };
        CHECK_NOTHROW(run_stage(rows, *executor, work, read(rows.a)));
    }
}

TEST_CASE("a guard and inputs that use undeclared data fail as well", "[unit]") {
    struct Secret {
        std::span<const Real> rows;
        static Secret bind(const Binder& binder, const Rows& rows) {
            binder.read(rows.a);
            return {rows.b.span()};
        }
    };
    Rows rows;
    TaskGraph graph;
    graph.track(&rows, sizeof rows, Rows::name_of);
    graph.stage(
        "secret", [](const Secret&) {}, inputs<Secret>(rows));
    graph.compile();
    REQUIRE_THROWS_WITH(graph.run_inline(), Catch::Contains("the stage secret reads rows.b"));

    static const Rows* const looked_at = &rows;
    TaskGraph guarded;
    guarded.track(&rows, sizeof rows, Rows::name_of);
    guarded.stage(
        "guarded", [](std::span<const Real>) {}, read(rows.a),
        only_if([](const Column<Real>&) { return looked_at->b.empty(); }, value(rows.a)));
    guarded.compile();
    REQUIRE_THROWS_WITH(guarded.run_inline(), Catch::Contains("the stage guarded reads rows.b"));
}

TEST_CASE("workers that help several stages may use the data of each stage", "[unit]") {
    Rows rows;
    const auto fill = [](Executor& executor, Column<Real>& column) {
        parallel_for(executor, 64, 1, [&](std::size_t begin, std::size_t) { column[begin] += 1; });
    };
    TaskGraph graph;
    graph.track(&rows, sizeof rows, Rows::name_of);
    graph.stage("a", fill, make(rows.a));
    graph.stage("b", fill, make(rows.b));
    graph.compile();
    REQUIRE(graph.edges().empty());
    for (const ExecutorChoice& choice : executor_choices({2, 4})) {
        CAPTURE(choice.text());
        const auto executor = choice.make();
        for (int run = 0; run < 50; ++run) REQUIRE_NOTHROW(graph.run(*executor));
    }
}

#else

// The check of access and its tests exist only in builds without NDEBUG, such as that of the thread sanitizer.

#endif

}  // namespace skerry::test::jobs_access_test
