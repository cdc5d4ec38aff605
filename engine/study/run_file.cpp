#include "engine/study/run_file.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <ostream>
#include <stdexcept>
#include <system_error>

#include "engine/base/complaint.h"
#include "engine/base/write_file.h"
#include "engine/output/number_text.h"

namespace skerry {

namespace {

constexpr const char* run_schema = "skerry.study_run/1";

std::filesystem::path run_file(const std::filesystem::path& folder, const StudyVariant& variant) {
    return folder / ("run_" + variant_name(variant) + ".json");
}

Json columns_json(const StudyRun& run) {
    Json columns = Json::array();
    for (const StudyColumn& column : run.columns)
        columns.push_back(object_of({{"probe", column.what.probe},
                                     {"quantity", column.what.quantity},
                                     {"unit", column.what.unit},
                                     {"size", column.size},
                                     {"reported", column.reported},
                                     {"statistic", column.is_statistic},
                                     {"node", column.node},
                                     {"place", {column.place.x(), column.place.y(), column.place.z()}},
                                     {"values", column.values}}));  // a value that is not finite becomes null
    return columns;
}

StudyColumn column_from(const Json& json) {
    StudyColumn column;
    json.at("probe").get_to(column.what.probe);
    json.at("quantity").get_to(column.what.quantity);
    json.at("unit").get_to(column.what.unit);
    json.at("size").get_to(column.size);
    json.at("reported").get_to(column.reported);
    json.at("statistic").get_to(column.is_statistic);
    json.at("node").get_to(column.node);
    for (int axis = 0; axis < 3; ++axis) json.at("place").at(static_cast<std::size_t>(axis)).get_to(column.place[axis]);
    for (const Json& value : json.at("values"))
        column.values.push_back(value.is_null() ? std::nan("") : value.get<Real>());
    return column;
}

/// True if every column has one value for each row. A run with the status `ok` must also have at least one row and
/// column.
bool is_whole(const StudyRun& run) {
    if (run.status == StudyRunStatus::ok && (run.time.empty() || run.columns.empty())) return false;
    return std::ranges::all_of(run.columns,
                               [&](const StudyColumn& column) { return column.values.size() == run.time.size(); });
}

/// Reads a run from the document of write_run(). Throws an exception for any other document.
StudyRun run_from(const Json& json, const StudyVariant& variant) {
    StudyRun run;
    run.variant = variant;
    json.at("set").get_to(run.assignments);
    run.status = from_name<StudyRunStatus>(json.at("status").get<std::string>()).value();
    json.at("message").get_to(run.message);
    json.at("warnings").get_to(run.warnings);
    json.at("cpu_seconds").get_to(run.cpu_seconds);
    json.at("steps").get_to(run.steps);
    run.integrator = from_name<Integrator>(json.at("integrator").get<std::string>()).value();
    run.state_hash = std::stoull(json.at("state_hash").get<std::string>(), nullptr, 16);
    json.at("tetrahedra").get_to(run.tetrahedra);
    json.at("max_contacts").get_to(run.max_contacts);
    for (const auto& [name, area] : json.at("loaded_areas").items()) run.loads.push_back({name, area.get<Real>()});
    json.at("time").get_to(run.time);
    for (const Json& column : json.at("columns")) run.columns.push_back(column_from(column));
    if (!is_whole(run)) throw std::invalid_argument("columns of different lengths");
    return run;
}

}  // namespace

std::string variant_name(const StudyVariant& variant) {
    std::string name;
    const auto add = [&](const char* setting, const std::string& value) {
        name += (name.empty() ? "" : "_") + (setting + ("_" + value));
    };
    if (variant.refine != 0) add("refine", std::to_string(variant.refine));
    if (variant.step != 1) add("step", short_text(variant.step));
    if (variant.tolerance != 1) add("tolerance", short_text(variant.tolerance));
    if (variant.element) add("element", std::string(name_of(*variant.element)));
    if (variant.draw != 0) add("draw", std::to_string(variant.draw));
    return name.empty() ? "scene" : name;
}

Json variant_json(const StudyVariant& variant) {
    Json json = object_of({{"refine", variant.refine}, {"step", variant.step}, {"tolerance", variant.tolerance}});
    if (variant.element) json["element"] = name_of(*variant.element);
    json["draw"] = variant.draw;
    return json;
}

Json run_json(const StudyRun& run) {
    Json areas = Json::object();
    for (const StudyLoad& load : run.loads) areas[load.name] = load.area;
    return object_of({{"name", variant_name(run.variant)},
                      {"variant", variant_json(run.variant)},
                      {"set", run.assignments},
                      {"status", name_of(run.status)},
                      {"message", run.message},
                      {"warnings", run.warnings},
                      {"cpu_seconds", run.cpu_seconds},
                      {"steps", run.steps},
                      {"integrator", name_of(run.integrator)},
                      {"state_hash", hash_text(run.state_hash)},
                      {"tetrahedra", run.tetrahedra},
                      {"max_contacts", run.max_contacts},
                      {"loaded_areas", areas}});
}

OutputLock reserve_folder(const std::filesystem::path& folder, const std::filesystem::path& scene) {
    // A folder that cannot be written needs no lock, because the study stores nothing in it.
    const bool read_only = std::filesystem::exists(folder) && access(folder.c_str(), W_OK) != 0;
    return {folder.empty() || read_only ? std::filesystem::path() : folder / "study.lock",
            {folder.string(), "study", "folder", {}, {}, {}},
            "study of " + std::filesystem::absolute(scene).string()};
}

void write_run(const std::filesystem::path& folder, const std::string& inputs, const StudyRun& run) {
    Json json = object_of({{"schema", run_schema}, {"inputs", inputs}});
    json.update(run_json(run));
    json["time"] = run.time;
    json["columns"] = columns_json(run);
    write_file(run_file(folder, run.variant),
               [&](std::ostream& out) { out << json.dump(-1, ' ', false, Json::error_handler_t::replace) << "\n"; });
}

StoredRun read_run(const std::filesystem::path& folder, const std::string& inputs, const StudyVariant& variant) {
    const std::filesystem::path file = run_file(folder, variant);
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return {};
    const std::string name = file.filename().string();
    try {
        const Json json = Json::parse(std::string(std::istreambuf_iterator<char>(stream), {}));
        if (json.at("schema") != run_schema) return {{}, name + " is no run of a study"};
        if (json.at("inputs") != inputs) return {{}, name + " is a run of another scene or with other settings"};
        return {run_from(json, variant), {}};
    } catch (const std::exception&) {  // no valid JSON, or a key is missing or has another type
        return {{}, name + " is no run of a study"};
    }
}

void remove_run(const std::filesystem::path& folder, const StudyVariant& variant) {
    const std::filesystem::path file = run_file(folder, variant);
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return;
    const Json json = Json::parse(stream, nullptr, false);
    const auto schema = json.is_object() ? json.find("schema") : json.end();
    if (schema == json.end() || !schema->is_string() ||
        !schema->get_ref<const std::string&>().starts_with("skerry.study_run/"))
        refuse_in(file.string(), "study", "folder", "a file that is no run of a study",
                  "runs of a study, which are replaced", "choose another folder");
    std::error_code ignored;  // an error is ignored here, because read_run() refuses a file that remains
    std::filesystem::remove(file, ignored);
}

}  // namespace skerry
