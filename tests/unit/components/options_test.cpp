#include "components/options.h"

#include <catch2/catch.hpp>
#include <set>

namespace skerry::test::options_test {

namespace {

// Each name leads back to its choice, and no two choices share one.
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

TEST_CASE("names are those that scenes are written with", "[unit]") {
    REQUIRE(name_of(MaterialModel::stable_neo_hookean) == "stable_neo_hookean");
    REQUIRE(name_of(ContactRegions::paper_algorithm_1) == "paper_algorithm_1");
    REQUIRE(from_name<Friction>("Cone") == std::nullopt);  // case counts
}

}  // namespace skerry::test::options_test
