// Cases that a cases file defines: grids, lists, draws; and the hash that identifies a result.
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <numeric>
#include <set>

#include "engine/program/sweep/cases/cases.h"
#include "engine/program/sweep/cases/draw.h"
#include "engine/scene/case_hash.h"
#include "tests/support/temporary_folder.h"

namespace skerry::test::sweep_cases_test {

namespace {

using skerry::Json;

/// A folder with a scene and a cases file.
class SweepFolder {
public:
    explicit SweepFolder(const std::string& cases) {
        write("scene.json", R"({"materials": {"rubber": {"E": 1e5}}, "bodies": []})");
        write("cases.json", R"({"scene": "scene.json", )" + cases + "}");
    }
    void write(const std::string& name, const std::string& text) const { std::ofstream(folder_.path() / name) << text; }
    skerry::SweepFile file() const { return skerry::read_sweep_file(folder_.path() / "cases.json"); }
    std::filesystem::path scene() const { return folder_.path() / "scene.json"; }

private:
    skerry::TemporaryFolder folder_;
};

std::vector<std::string> texts(const std::string& cases) {
    const skerry::SweepFile file = SweepFolder(cases).file();
    const skerry::Cases all = cases_of(file);
    std::vector<std::string> found;
    for (int i = 0; i < all.count(); ++i) found.push_back(case_text(all, i));
    return found;
}

std::vector<double> drawn(const std::string& distribution, int count) {
    const skerry::SweepFile file = SweepFolder(R"("random": {"seed": 7, "count": )" + std::to_string(count) +
                                               R"(, "parameters": [{"set": "x", )" + distribution + "}]}")
                                       .file();
    std::vector<double> values;
    for (const auto& row : cases_of(file).values) values.push_back(row[0]->get<double>());
    return values;
}

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double deviation(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += std::pow(value - mean(values), 2);
    return std::sqrt(sum / static_cast<double>(values.size()));
}

}  // namespace

TEST_CASE("a grid is all combinations, the last parameter first", "[unit]") {
    CHECK(
        texts(R"("grid": [{"set": "a", "values": [1, "two", [3]]}, {"name": "x", "set": "b", "values": [0.5, 1]}])") ==
        std::vector<std::string>{"a=1, x=0.5", "a=1, x=1", "a=\"two\", x=0.5", "a=\"two\", x=1", "a=[3], x=0.5",
                                 "a=[3], x=1"});
}

TEST_CASE("numbers are spaced by equal differences or ratios, with exact ends and no noise", "[unit]") {
    CHECK(texts(R"("grid": [{"set": "a", "from": 0, "to": 0.3, "count": 4}])") ==
          std::vector<std::string>{"a=0.0", "a=0.1", "a=0.2", "a=0.3"});
    CHECK(texts(R"("grid": [{"set": "a", "from": 1e6, "to": 1e-2, "count": 5, "spacing": "log"}])") ==
          std::vector<std::string>{"a=1000000.0", "a=10000.0", "a=100.0", "a=1.0", "a=0.01"});
    CHECK(texts(R"("grid": [{"set": "a", "from": 3, "to": 5, "count": 1}])") == std::vector<std::string>{"a=3.0"});
}

TEST_CASE("cases of a list have the values they name", "[unit]") {
    const SweepFolder folder(R"("set": {"seconds": 1}, "list": [{"a": 1}, {}, {"b": "x", "a": 2}])");
    const skerry::SweepFile file = folder.file();
    const skerry::Cases cases = cases_of(file);
    REQUIRE(cases.parameters.size() == 2);
    CHECK(assignments_of(file, cases, 0) == std::vector<std::string>{"seconds=1", "a=1"});
    CHECK(assignments_of(file, cases, 1) == std::vector<std::string>{"seconds=1"});
    CHECK(assignments_of(file, cases, 2) == std::vector<std::string>{"seconds=1", "a=2", "b=\"x\""});
}

TEST_CASE("one value can go to several places", "[unit]") {
    const SweepFolder folder(R"("grid": [{"name": "mu", "set": ["a.mu", "b.mu"], "values": [0.3]}])");
    const skerry::SweepFile file = folder.file();
    CHECK(assignments_of(file, cases_of(file), 0) == std::vector<std::string>{"a.mu=0.3", "b.mu=0.3"});
}

TEST_CASE("draws are the same on every machine", "[unit]") {
    // The standard prescribes the numbers of mt19937_64: the 10,000th of the default seed is 9981545732273789042.
    std::mt19937_64 engine;
    engine.discard(9999);
    CHECK(engine() == 9981545732273789042ull);
    // Expected values come from an independent program, written from the definitions of the engine and the draws.
    CHECK(texts(R"("random": {"seed": 7, "count": 2, "parameters": [{"set": "u", "from": -1, "to": 3},
        {"set": "l", "distribution": "log_uniform", "from": 1e4, "to": 1e6},
        {"set": "i", "distribution": "integer", "from": 1, "to": 6},
        {"set": "n", "distribution": "normal", "mean": 1, "deviation": 0.1}]})") ==
          std::vector<std::string>{"u=2.01754121661, l=791776.13187, i=1, n=1.04359415981",
                                   "u=1.8716227386, l=324705.817403, i=4, n=0.913775171521"});
}

TEST_CASE("a higher count adds cases and changes none", "[unit]") {
    const std::vector<double> few = drawn(R"("distribution": "normal", "mean": 0, "deviation": 1)", 5);
    const std::vector<double> many = drawn(R"("distribution": "normal", "mean": 0, "deviation": 1)", 50);
    CHECK(few == std::vector<double>(many.begin(), many.begin() + 5));
}

TEST_CASE("draws have the mean and the spread of their distribution", "[unit][long]") {
    // Means of 40,000 draws are within four standard errors of the expected means: 0.02 standard deviations.
    constexpr int count = 40000;
    const std::vector<double> uniform = drawn(R"("from": 2, "to": 5)", count);
    CHECK(std::abs(mean(uniform) - 3.5) < 0.02);
    CHECK(std::abs(deviation(uniform) - 3 / std::sqrt(12.0)) < 0.02);
    CHECK(std::ranges::all_of(uniform, [](double v) { return v >= 2 && v <= 5; }));
    std::vector<double> logs = drawn(R"("distribution": "log_uniform", "from": 0.1, "to": 1000)", count);
    for (double& value : logs) value = std::log10(value);
    CHECK(std::abs(mean(logs) - 1) < 0.025);
    CHECK(std::abs(deviation(logs) - 4 / std::sqrt(12.0)) < 0.025);
    const std::vector<double> normal = drawn(R"("distribution": "normal", "mean": -3, "deviation": 2)", count);
    CHECK(std::abs(mean(normal) + 3) < 0.04);
    CHECK(std::abs(deviation(normal) - 2) < 0.04);
    const std::vector<double> dice = drawn(R"("distribution": "integer", "from": 1, "to": 6)", count);
    CHECK(std::set<double>(dice.begin(), dice.end()) == std::set<double>{1, 2, 3, 4, 5, 6});
    CHECK(std::abs(mean(dice) - 3.5) < 0.04);
}

TEST_CASE("logarithm and exponential are right to rounding", "[unit]") {
    for (double x = 1e-300; x < 1e300; x *= 1.37) {
        const double expected = std::log(x);
        CHECK(std::abs(skerry::natural_log(x) - expected) <= 1e-15 * std::max(1.0, std::abs(expected)));
    }
    for (double x = -700; x < 700; x += 0.37)
        CHECK(std::abs(skerry::exponential(x) / std::exp(x) - 1) <= 1e-15 * std::max(1.0, std::abs(x)));
    CHECK(skerry::natural_log(1) == 0);
    CHECK(skerry::exponential(0) == 1);
}

TEST_CASE("the hash of a case covers its values, its scene and the files that this names", "[unit]") {
    const SweepFolder folder(R"("list": [{}])");
    folder.write("part.json", "{}");
    folder.write("mesh.node", "1");
    folder.write("mesh.ele", "1");
    folder.write("scene.json", R"({"include": "part.json", "bodies": [{"mesh": {"file": "mesh.node"}}]})");
    const auto hash = [&](std::vector<std::string> assignments) {
        return skerry::CaseHasher(folder.scene()).hash(assignments);
    };
    std::set<std::string> seen{hash({})};
    const auto is_new = [&](const std::string& found) { return seen.insert(found).second; };
    CHECK_FALSE(is_new(hash({})));
    CHECK(is_new(hash({"seconds=1"})));
    CHECK(is_new(hash({"seconds=2"})));
    CHECK(is_new(hash({"bodies[7].x=1"})));  // cannot be applied to the scene
    CHECK(is_new(hash({"bodies[8].x=1"})));
    CHECK_FALSE(is_new(hash({"seconds=2"})));
    folder.write("part.json", R"({"seconds": 3})");
    CHECK(is_new(hash({})));
    folder.write("mesh.ele", "2");  // file beside the named one
    CHECK(is_new(hash({})));
    folder.write("part.json", R"({"include": "scene.json"})");  // a circular include is refused later
    CHECK(is_new(hash({})));
    folder.write("scene.json", R"({"bodies": [ {"mesh": {"file": "mesh.node"}}], "seconds": 1})");
    CHECK(is_new(hash({})));
}

}  // namespace skerry::test::sweep_cases_test
