// What the arguments of a stage pass, and what does not compile.
#include "jobs/access.h"

#include <catch2/catch.hpp>

#include "components/node_table.h"
#include "jobs/task_graph.h"

using namespace skerry;

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
static_assert(!Readable<Column<Real>> && !Readable<Real> && !Valuable<Real>, "nothing that is gone when the stage runs");
static_assert(!Readable<std::span<Real>&> && !Readable<Real*&> && !Readable<RaggedView<Index>&>, "nothing that only shows other data");
static_assert(Writable<Column<Real>&> && !Writable<const Column<Real>&>);
static_assert(Makeable<NodeTable&> && !Makeable<const NodeTable&>);

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

TEST_CASE("two reads never conflict, a write conflicts with both", "[unit]") {
    Column<Real> column, other;
    REQUIRE_FALSE(conflict(read(column), read(column)));
    REQUIRE(conflict(read(column), write(column)));
    REQUIRE(conflict(write(column), write(column)));
    REQUIRE_FALSE(conflict(write(column), write(other)));
}

TEST_CASE("a table as a whole conflicts with each of its columns, and with no column of another", "[unit]") {
    NodeTable nodes, others;
    nodes.for_each_column([&](const char* name, auto& column) {
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

TEST_CASE("reads, writes, bundle and only_if declare what they were told, value declares nothing", "[unit]") {
    Column<Real> a, b;
    Real number = 0;
    REQUIRE(conflict(reads(a, b), write(b)));
    REQUIRE_FALSE(conflict(reads(a, b), read(b)));
    REQUIRE(conflict(writes(a, b), read(b)));
    REQUIRE(conflict(bundle([] { return 0; }, reads(a), writes(b)), read(b)));
    REQUIRE_FALSE(conflict(bundle([] { return 0; }, reads(a), writes(b)), read(a)));
    REQUIRE(conflict(only_if([] { return true; }, reads(number)), make(number)));
    REQUIRE(accesses_of(value(number)).empty());
}
