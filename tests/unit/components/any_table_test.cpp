// Tables and columns of types unknown to the caller behave like the typed ones.
#include "components/any_table.h"

#include <catch2/catch.hpp>
#include <cstddef>
#include <cstring>
#include <set>
#include <string>
#include <vector>

#include "components/body_table.h"
#include "components/collider_table.h"
#include "components/node_table.h"
#include "components/pair_table.h"
#include "components/rigid_body_table.h"

namespace skerry::test::any_table_test {

namespace {

template <class Table>
std::vector<std::string> names_by_visit(Table& table) {
    std::vector<std::string> names;
    table.for_each_column([&](const char* name, auto&, ColumnRole) { names.emplace_back(name); });
    return names;
}

std::vector<std::string> names_by_list(const AnyTable& table) {
    std::vector<std::string> names;
    for (const ColumnInfo& info : table.columns()) names.emplace_back(info.name);
    return names;
}

}  // namespace

TEST_CASE("a table lists the columns that it visits, in the same order and at their places", "[unit]") {
    BodyTable bodies;
    const AnyTable table(bodies, "bodies");
    CHECK(std::string(table.name()) == "bodies");
    CHECK(names_by_list(table) == names_by_visit(bodies));
    std::size_t at = 0;
    bodies.for_each_column([&](const char* name, auto& column, ColumnRole role) {
        CAPTURE(name);
        const ColumnInfo& info = table.columns()[at++];
        CHECK(table.column(info).is(&column));
        CHECK(info.role == role);
        CHECK(info.type->bytes == sizeof *column.data());
    });
    for (const ColumnInfo& info : table.columns()) CHECK(info.has_row_each);
}

TEST_CASE("a table resizes and erases the columns that have one row each, and no others", "[unit]") {
    ColliderTable colliders;
    colliders.keyframe.resize(7);
    const AnyTable table(colliders);
    table.resize(5);
    CHECK(colliders.slot.size() == 5);
    CHECK(colliders.travel.size() == 5);
    CHECK(colliders.keyframe.size() == 7);
    for (std::uint32_t row = 0; row < 5; ++row) colliders.slot[row] = row;
    const std::vector<Range> gone{{0, 1}, {3, 4}};
    table.erase(gone);
    CHECK(std::vector(colliders.slot.begin(), colliders.slot.end()) == std::vector<std::uint32_t>{1, 2, 4});
    CHECK(colliders.geometry.size() == 3);
    CHECK(colliders.keyframe.size() == 7);

    PairTable pairs;
    AnyTable(pairs).resize(2);
    CHECK(pairs.key.size() == 2);
    CHECK(pairs.rebuilt.size() == 2);
    CHECK(pairs.work.size() == 0);
}

TEST_CASE("rows that a table gets are value-initialised, and vectors and matrices in them are zero", "[unit]") {
    BodyTable bodies;
    AnyTable(bodies).resize(1);
    CHECK(bodies.filter[0] == CollisionFilter{});
    CHECK(bodies.surface[0] == SurfaceProperties{});
    CHECK(bodies.frame[0].offset.isZero(0));
    RigidBodyTable rigid;
    AnyTable(rigid).resize(100);
    for (std::size_t row = 0; row < 100; ++row) {
        CHECK(rigid.momentum[row].isZero(0));
        CHECK(rigid.rotation[row].isZero(0));
    }
}

TEST_CASE("the bytes of a column of unknown type are its rows", "[unit]") {
    Column<Vec3> column;
    const AnyColumn any(column);
    any.resize(2);
    REQUIRE(column.size() == 2);
    CHECK(column[1].isZero(0));
    column[1] = Vec3(1, 2, 3);
    Vec3 read;
    std::memcpy(read.data(), any.read() + any.type().bytes, sizeof read);
    CHECK(read == Vec3(1, 2, 3));
    CHECK(any.type().number == NumberType::real);
    CHECK(any.type().width == 3);
    CHECK(any.type().members == nullptr);
}

TEST_CASE("a row type knows how many values an enum has, and the members of a struct", "[unit]") {
    CHECK(row_type<BodyKind>.values == 2);
    CHECK(row_type<MaterialModel>.values == EnumNames<MaterialModel>::table.size());
    CHECK(row_type<Real>.values == 0);
    CHECK_FALSE(row_type<BvhNode>.is_known());

    const RowType& type = row_type<ColliderGeometry>;
    REQUIRE(type.members != nullptr);
    REQUIRE(type.members().size() == 2);
    CHECK(std::string(type.members()[0].name) == "shape");
    CHECK(type.members()[0].type->values == 7);
    CHECK(type.members()[1].offset == offsetof(ColliderGeometry, size));
    CHECK(type.members()[1].type->width == 3);
}

TEST_CASE("integers of every type are read as they are", "[unit]") {
    const auto read = [](auto value, NumberType type) {
        return number_at(reinterpret_cast<const std::byte*>(&value), type);
    };
    CHECK(read(std::int32_t{-5}, NumberType::int32) == -5);
    CHECK(read(std::uint8_t{200}, NumberType::uint8) == 200);
    CHECK(read(std::uint16_t{60000}, NumberType::uint16) == 60000);
    CHECK(read(std::uint32_t{4000000000}, NumberType::uint32) == 4000000000);
    CHECK(read(std::uint64_t{1} << 40, NumberType::uint64) == std::int64_t{1} << 40);
    CHECK_THROWS(read(Real{1}, NumberType::real));
}

}  // namespace skerry::test::any_table_test
