#include "engine/program/sweep/sweep_plan.h"

#include <algorithm>
#include <utility>

#include "engine/scene/assign.h"
#include "engine/scene/case_hash.h"
#include "engine/scene/scene_file.h"

namespace skerry {

namespace {

/// Sets the value at `key_path` in `json`, the document of a scene. Errors name `location`, the location in the file of
/// cases.
void try_assignment(const Place& location, const std::string& key_path, const Json& value,
                    const std::filesystem::path& scene, Json& json) {
    if (key_path.find('=') != std::string::npos)
        location.refuse("the place " + in_quotes(key_path), "a place without \"=\" and a value");
    called_at(location, [&] { assign(key_path + "=" + value.dump(), scene, json); });
}

/// Throws SceneError if none of the first hundred cases gives a readable scene. If they all fail, the fault is probably
/// in the sweep, not in single cases.
void require_a_readable_case(const SweepPlan& plan) {
    const SweepFile& file = plan.file;
    constexpr int most_tried = 100;
    std::string first;
    for (int i = 0; i < std::min(plan.cases.count(), most_tried); ++i) {
        try {
            read_scene_file(file.scene.path, assignments_of(file, plan.cases, i));
            return;
        } catch (const SceneError& error) {
            if (first.empty())
                first = "case " + std::to_string(i) + " (" + case_text(plan.cases, i) + "): " + error.what();
        }
    }
    file.place.key(file.random         ? "random"
                   : file.grid.empty() ? "list"
                                       : "grid")
        .refuse_inner(SceneError("no case gives a valid scene; the first error is in " + first));
}

/// Throws SceneError if an assignment of the sweep names a place that does not exist in the scene. In a list of cases,
/// each case may set other places, so all cases are tested. In other sweeps all cases set the same places, so the first
/// case is enough.
void require_assignable(const SweepPlan& plan, const Json& scene) {
    const SweepFile& file = plan.file;
    Json fixed = scene;
    for (const auto& [key_path, value] : file.set.items)
        try_assignment(file.place.key("set"), key_path, value.json, file.scene.path, fixed);
    for (std::size_t i = 0; i < plan.cases.values.size(); ++i) {
        Json json = fixed;
        for (std::size_t p = 0; p < plan.cases.parameters.size(); ++p) {
            const Parameter& parameter = plan.cases.parameters[p];
            const std::optional<Json>& value = plan.cases.values[i][p];
            if (!value) continue;
            const Place location = file.list.empty() ? parameter.place.key("set") : file.place.key("list").item(i);
            for (const std::string& key_path : parameter.places)
                try_assignment(location, key_path, *value, file.scene.path, json);
        }
        if (file.list.empty()) return;
    }
}

/// Default folder of the results. It has the name of the sweep, so this name must be valid for a folder.
std::filesystem::path folder_of(const SweepFile& file) {
    if (file.name.find('/') != std::string::npos || file.name == "." || file.name == "..")
        file.place.key("name").refuse(in_quotes(file.name), "a name without \"/\", other than \".\" and \"..\"",
                                      "choose the folder of the results with --out");
    return std::filesystem::path("out") / file.name;
}

}  // namespace

CaseJob SweepPlan::job(int index, bool probes) const {
    Json values = Json::object();
    const std::vector<std::optional<Json>>& row = cases.values[static_cast<std::size_t>(index)];
    for (std::size_t p = 0; p < row.size(); ++p)
        if (row[p]) values[cases.parameters[p].name] = *row[p];
    return {index,
            file.scene.path,
            {file.name, file.scene.path.string(), hashes[static_cast<std::size_t>(index)], std::move(values),
             assignments_of(file, cases, index)},
            folder,
            probes};
}

CaseFile SweepPlan::read(int index) const {
    return read_case(case_file(folder, index), index, hashes[static_cast<std::size_t>(index)]);
}

SweepPlan plan_sweep(const std::filesystem::path& file, const std::filesystem::path& folder) {
    SweepPlan plan{.file = read_sweep_file(file), .cases = {}, .folder = folder, .hashes = {}};
    plan.cases = cases_of(plan.file);
    if (plan.folder.empty()) plan.folder = folder_of(plan.file);
    CaseHasher hasher(plan.file.scene.path);
    require_assignable(plan, hasher.scene());
    require_a_readable_case(plan);
    for (int i = 0; i < plan.cases.count(); ++i)
        plan.hashes.push_back(hasher.hash(assignments_of(plan.file, plan.cases, i)));
    return plan;
}

}  // namespace skerry
