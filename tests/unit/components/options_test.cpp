#include "components/options.h"

#include <catch2/catch.hpp>
#include <set>

namespace skerry::test::options_test {

namespace {

// Checks that each name leads back to its value, and that no two values share a name.
template <class Enum>
void require_names_to_be_unique() {
    std::set<std::string_view> names;
    for (const auto& [value, name] : EnumNames<Enum>::table) {
        CAPTURE(name);
        REQUIRE(names.insert(name).second);
        REQUIRE(name_of(value) == name);
        REQUIRE(from_name<Enum>(name) == value);
    }
    REQUIRE_FALSE(from_name<Enum>("").has_value());
    REQUIRE_FALSE(from_name<Enum>("no such choice").has_value());
}

}  // namespace

TEMPLATE_TEST_CASE("every choice has a name of its own that leads back to it", "[unit]", MaterialModel, Friction,
                   ContactRegions, SolverMethod, Backend, WarmStart) {
    require_names_to_be_unique<TestType>();
}

TEST_CASE("a name that was removed is no choice, and has a hint that names one", "[unit]") {
    for (const auto& [name, hint] : RemovedNames<SolverMethod>::table) {
        CHECK_FALSE(from_name<SolverMethod>(name).has_value());
        CHECK(hint_for_removed<SolverMethod>(name) == hint);
        CHECK(hint.find(name_of(SolverMethod::automatic)) != std::string_view::npos);
    }
    CHECK(hint_for_removed<Friction>("cone_convex").find("\"cone\"") != std::string_view::npos);
    CHECK(hint_for_removed<ContactRegions>("paper_algorithm_1").find("\"separate\"") != std::string_view::npos);
    CHECK(hint_for_removed<SolverMethod>("pgs").empty());
    CHECK(hint_for_removed<Backend>("nncg").empty());
}

TEST_CASE("names are those that scenes are written with", "[unit]") {
    REQUIRE(name_of(MaterialModel::stable_neo_hookean) == "stable_neo_hookean");
    REQUIRE(name_of(SolverMethod::pcg_pgs) == "pcg_pgs");
    REQUIRE(from_name<Friction>("Cone") == std::nullopt);  // case matters
}

}  // namespace skerry::test::options_test
