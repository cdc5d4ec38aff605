#include "engine/program/sweep/results/case_result.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <ostream>

#include "engine/base/write_file.h"
#include "engine/output/number_text.h"

namespace skerry {

namespace {

constexpr const char* case_schema = "skerry.case/2";

Json json_of_figures(const CaseResult& result) {
    Json figures = Json::object();
    for (const auto& [name, value] : result.figures) figures[name] = std::isfinite(value) ? Json(value) : Json();
    return figures;
}

/// Reads a result from the document of a result file. Throws an exception if the document lacks a key that write_case()
/// writes, or if a value has another type.
CaseResult result_from(const Json& json) {
    CaseResult result;
    json.at("case").get_to(result.index);
    result.status = from_name<CaseStatus>(json.at("status").get<std::string>()).value();
    json.at("message").get_to(result.message);
    json.at("warnings").get_to(result.warnings);
    json.at("state_hash").get_to(result.state_hash);
    for (const auto& [name, value] : json.at("figures").items())
        result.figures.emplace_back(name, value.is_null() ? std::nan("") : value.get<double>());
    return result;
}

}  // namespace

CaseResult result_of(const RunResult& run, double seconds_cpu) {
    const WorldReport& r = run.report;
    CaseResult result;
    if (run.status != "ok") {
        result.status = CaseStatus::failed;
        result.message = run.status;
    }
    result.warnings = warnings_of(run);
    result.state_hash = hash_text(run.state_hash);
    result.figures = {
        {"seconds_simulated", run.seconds_simulated},
        {"steps", static_cast<double>(r.steps)},
        {"seconds_wall", run.seconds_wall},
        {"seconds_cpu", seconds_cpu},
        {"kinetic_J", r.energy.kinetic},
        {"elastic_J", r.energy.elastic},
        {"potential_J", r.energy.potential},
        {"dissipated_J", r.energy.dissipated},
        {"energy_error_share", r.energy_error_share},
        {"contacts_mean", r.mean_contacts},
        {"contacts_max", static_cast<double>(r.max_contacts)},
        {"penetration_m", r.max_penetration},
        {"solver_error", r.worst_error},
        {"warnings", static_cast<double>(result.warnings.size())},
    };
    for (const ProbeRecord& probe : run.probes) {
        const auto add = [&](const char* figure, double value) {
            result.figures.emplace_back(probe.name + "." + figure, value);
        };
        add("slip_m", probe.slip_distance);
        add("max_slip_m_s", probe.max_slip);
        add("stick_s", probe.stick_time);
        add("slide_s", probe.slide_time);
        add("open_s", probe.open_time);
        add("changes", probe.changes);
        add("max_von_mises_Pa", probe.max_von_mises);
    }
    result.figures.insert(result.figures.end(), run.series.begin(), run.series.end());
    return result;
}

std::filesystem::path case_file(const std::filesystem::path& folder, int index) {
    char name[32];
    std::snprintf(name, sizeof name, "case_%06d.json", index);
    return folder / name;
}

void write_case(const std::filesystem::path& file, const CaseHead& head, const CaseResult& result, const Json& report) {
    const Json json = object_of({
        {"schema", case_schema},
        {"sweep", head.sweep},
        {"scene_file", head.scene},
        {"case", result.index},
        {"parameters", head.parameters},
        {"set", head.assignments},
        {"case_hash", head.case_hash},
        {"version", SKERRY_VERSION},
        {"status", name_of(result.status)},
        {"message", result.message},
        {"warnings", result.warnings},
        {"figures", json_of_figures(result)},
        {"state_hash", result.state_hash},
        {"report", report},
    });
    write_file(file,
               [&](std::ostream& out) { out << json.dump(1, ' ', false, Json::error_handler_t::replace) << "\n"; });
}

CaseFile read_case(const std::filesystem::path& file, int index, const std::string& case_hash) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return {};
    CaseFile read{CaseFileState::other, {}, "a file that is not the result of a case"};
    const std::string text(std::istreambuf_iterator<char>(stream), {});
    try {
        const Json json = Json::parse(text);
        if (json.at("schema") != case_schema) return read;
        const std::string own_hash = json.at("case_hash").get<std::string>();
        if (own_hash != case_hash || json.at("case") != index) {
            read.found = "the result of another case, or of an earlier version of the scene, with the parameters " +
                         json.at("parameters").dump(-1, ' ', false, Json::error_handler_t::replace);
            return read;
        }
        return {CaseFileState::whole, result_from(json), {}};
    } catch (const std::exception&) {  // the document is not valid JSON, lacks a key, or has an invalid status
        return read;
    }
}

}  // namespace skerry
