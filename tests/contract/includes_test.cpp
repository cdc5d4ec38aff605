// Includes point down, and only jobs/ and its backends include threading libraries.
#include <catch2/catch.hpp>
#include <filesystem>
#include <optional>
#include <regex>
#include <set>

#include "tests/contract/project_files.h"

namespace skerry::test::includes_test {

namespace {

using skerry::test::ProjectFile;

/// The folder that a file belongs to, and its layer ("floor").
struct Place {
    std::string folder;
    int floor;
};

std::optional<Place> place_of(const std::string& path) {
    // jobs is beside the components and uses them. tests/support also serves the benchmarks, which tests include. The
    // first matching prefix counts.
    static const std::vector<Place> places{
        {"components/", 10},        {"jobs/", 11},
        {"systems/geometry/", 20},  {"systems/material/", 30},
        {"systems/collision/", 30}, {"systems/forces/", 30},
        {"systems/dynamics/", 40},  {"systems/contact/", 40},
        {"systems/solver/", 50},    {"systems/kernels/", 55},
        {"engine/include/", 56},    {"engine/base/", 60},
        {"engine/hdf5/", 61},       {"engine/mesh/", 61},
        {"engine/fill/", 62},       {"engine/problem/", 62},
        {"engine/world/", 63},      {"engine/estimate/", 64},
        {"engine/materials/", 64},  {"engine/output/", 65},
        {"engine/absent/", 66},     {"engine/live/", 66},
        {"engine/rollout/", 66},    {"engine/scene/", 67},
        {"engine/study/", 68},      {"engine/mpi/", 69},
        {"engine/program/", 69},    {"engine/python/", 69},
        {"tests/support/", 70},     {"examples/", 71},
        {"profiling/", 71},         {"tests/", 72},
    };
    for (const Place& place : places)
        if (path.starts_with(place.folder)) return place;
    return std::nullopt;
}

/// Layer within a folder, from its subfolders. A file directly in the folder is above all of them.
int inner_floor(const std::string& path) {
    static const std::vector<Place> places{
        {"systems/collision/inputs/", 1},    {"systems/collision/tree/", 1},    {"systems/collision/narrow/", 2},
        {"systems/collision/colliders/", 3}, {"systems/collision/overlap/", 4}, {"systems/collision/search/", 4},
        {"systems/collision/cylinders/", 4}, {"systems/dynamics/kinds/", 1},    {"systems/dynamics/elements/", 2},
        {"systems/dynamics/stability/", 3},  {"systems/dynamics/motion/", 4},   {"systems/dynamics/checks/", 5},
        {"systems/dynamics/clusters/", 4},   {"systems/dynamics/rigid/", 3},    {"systems/dynamics/implicit/", 4},
        {"systems/dynamics/recovery/", 3},   {"systems/solver/inputs/", 1},     {"systems/solver/local/", 2},
        {"systems/solver/equations/", 3},    {"systems/solver/operators/", 4},  {"systems/solver/methods/", 5},
        {"systems/solver/lanes/", 6},        {"systems/solver/coloured/", 6},   {"systems/solver/regions/", 7},
    };
    constexpr int top = 100;
    for (const Place& place : places)
        if (path.starts_with(place.folder)) return place.floor;
    return top;
}

bool same_folder(const std::string& a, const std::string& b) {
    return std::filesystem::path(a).parent_path() == std::filesystem::path(b).parent_path();
}

bool is_public(const std::string& path) {
    static const std::set<std::string> components{"components/types.h",
                                                  "components/options.h",
                                                  "components/handle.h",
                                                  "components/joint_kind.h",
                                                  "components/column.h",
                                                  "components/range.h",
                                                  "components/access_check.h",
                                                  "components/tie_kind.h",
                                                  "components/cable_control.h",
                                                  "components/cavity_law.h",
                                                  "components/time_key.h",
                                                  "components/load_kind.h",
                                                  "components/orthotropic_moduli.h",
                                                  "components/spring_side.h"};
    return path.starts_with("engine/include/skerry/") || components.contains(path);
}

/// Path of the included project file, searched beside the including file, from the root and, for public headers, from
/// engine/include.
std::optional<std::string> included_file(const std::string& from, const std::string& name) {
    const std::string beside = (std::filesystem::path(from).parent_path() / name).lexically_normal().generic_string();
    for (const std::string& path : {beside, name, "engine/include/" + name})
        if (skerry::test::project_has(path)) return path;
    return std::nullopt;
}

/// The fault of an include of a project file, or an empty string.
std::string objection(const std::string& from, const std::string& to) {
    const std::optional<Place> own = place_of(from), other = place_of(to);
    if (!other) return "is on no floor";
    if (own->folder != other->folder && other->floor >= own->floor) return "does not point down";
    if (own->folder == other->folder && !same_folder(from, to) && inner_floor(to) >= inner_floor(from) &&
        own->folder.starts_with("systems/"))
        return "does not point down within its folder";
    if (from.starts_with("engine/include/") && !is_public(to)) return "is no public header";
    return "";
}

/// The fault of an include of a threading header, or an empty string. Atomics are allowed everywhere: a scratch pool
/// may count with one. The live view has threads that wait for browsers, and take no part in a step.
std::string threading_objection(const std::string& from, const std::string& header) {
    static const std::regex library("(tbb|oneapi)/.*|omp\\.h|pthread\\.h|future|execution");
    static const std::regex primitive(
        "thread|mutex|shared_mutex|condition_variable|semaphore|latch|barrier|stop_token");
    if (header == "mpi.h" && from != "jobs/ranks/mpi_ranks.cpp") return "is for jobs/ranks/mpi_ranks.cpp alone";
    if (place_of(from)->floor >= 70 || from.starts_with("jobs/backend_")) return "";
    if (std::regex_match(header, library)) return "is for jobs/backend_*.cpp alone";
    if (std::regex_match(header, primitive) && !from.starts_with("jobs/") && !from.starts_with("engine/live/"))
        return "is for jobs and engine/live alone";
    return "";
}

struct Include {
    std::string name;
    bool quoted;
};

std::optional<Include> include_of(const std::string& line) {
    static const std::regex directive("\\s*#\\s*include\\s*([<\"])([^>\"]+)[>\"].*");
    std::smatch match;
    if (!std::regex_match(line, match, directive)) return std::nullopt;
    return Include{match[2], match[1] == "\""};
}

bool is_checked(const ProjectFile& file) {
    const bool is_code = file.path.ends_with(".h") || file.path.ends_with(".cpp");
    return is_code && place_of(file.path) && !file.path.starts_with("tests/consumer/");
}

}  // namespace

TEST_CASE("includes point down", "[contract]") {
    int seen = 0;
    for (const ProjectFile& file : skerry::test::project_files()) {
        if (!is_checked(file)) continue;
        for (const std::string& line : file.lines) {
            const std::optional<Include> include = include_of(line);
            if (!include) continue;
            const std::optional<std::string> target = included_file(file.path, include->name);
            INFO(file.path << ": " << line);
            if (target) {
                ++seen;
                CHECK(objection(file.path, *target) == "");
            } else {
                // A quoted include must be a file of the project.
                CHECK_FALSE(include->quoted);
            }
        }
    }
    CHECK(seen > 100);
}

TEST_CASE("only jobs know a threading library", "[contract]") {
    static const std::regex parallel_pragma("\\s*#\\s*pragma\\s+omp\\s+(?!simd|declare simd).*");
    for (const ProjectFile& file : skerry::test::project_files()) {
        if (!is_checked(file)) continue;
        for (const std::string& line : file.lines) {
            INFO(file.path << ": " << line);
            if (const std::optional<Include> include = include_of(line))
                CHECK(threading_objection(file.path, include->name) == "");
            // Pragmas for vector loops are allowed everywhere.
            if (std::regex_match(line, parallel_pragma)) CHECK(file.path.starts_with("jobs/backend_"));
        }
    }
}

TEST_CASE("the test of includes finds planted faults", "[contract]") {
    CHECK(objection("systems/geometry/a.h", "systems/solver/b.h") != "");
    CHECK(objection("systems/material/a.h", "systems/collision/b.h") != "");
    CHECK(objection("components/a.h", "jobs/b.h") != "");
    CHECK(objection("systems/dynamics/elements/a.h", "systems/dynamics/motion/b.h") != "");
    CHECK(objection("systems/dynamics/motion/a.h", "systems/dynamics/elements/b.h") == "");
    CHECK(objection("systems/collision/tree/a.h", "systems/collision/b.h") != "");
    CHECK(objection("systems/solver/operators/a.h", "systems/solver/methods/b.h") != "");
    CHECK(objection("systems/solver/lanes/a.h", "systems/solver/coloured/b.h") != "");
    CHECK(objection("systems/solver/regions/a.h", "systems/solver/solve_regions.h") != "");
    CHECK(objection("systems/solver/regions/a.h", "systems/solver/lanes/b.h") == "");
    CHECK(objection("systems/collision/a.h", "systems/collision/tree/b.h") == "");
    CHECK(objection("jobs/a.h", "components/b.h") == "");
    CHECK(objection("engine/scene/a.cpp", "engine/world/b.h") == "");
    CHECK(objection("engine/world/a.cpp", "engine/scene/b.h") != "");
    CHECK(objection("engine/mesh/a.cpp", "engine/world/b.h") != "");
    CHECK(objection("engine/include/skerry/a.h", "engine/world/b.h") != "");
    CHECK(objection("engine/include/skerry/a.h", "components/node_table.h") != "");
    CHECK(threading_objection("systems/solver/a.cpp", "tbb/parallel_for.h") != "");
    CHECK(threading_objection("engine/world/a.cpp", "mutex") != "");
    CHECK(threading_objection("engine/live/a.cpp", "mutex") == "");
    CHECK(threading_objection("engine/live/a.cpp", "future") != "");
    CHECK(threading_objection("jobs/backend_tbb.cpp", "tbb/task_arena.h") == "");
    CHECK(threading_objection("engine/world/a.cpp", "mpi.h") != "");
    CHECK(include_of("  #  include <omp.h>  // why")->name == "omp.h");
}

}  // namespace skerry::test::includes_test
