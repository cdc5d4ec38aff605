#include "engine/study/run_file.h"
#include "skerry/study.h"

namespace skerry {

namespace {

// NaN and infinity become null in the JSON text.
Json quantity_json(const StudyQuantity& q) {
    return object_of({{"name", q.name},
                      {"unit", q.unit},
                      {"value", q.value},
                      {"error", q.error},
                      {"mesh", q.mesh},
                      {"step", q.step},
                      {"contact", q.contact},
                      {"noise", q.noise},
                      {"best", q.best},
                      {"best_error", q.best_error},
                      {"scale", q.scale},
                      {"mesh_order", q.mesh_order},
                      {"expected_mesh_order", q.expected_mesh_order},
                      {"step_order", q.step_order},
                      {"expected_step_order", q.expected_step_order},
                      {"agree_until", q.agree_until},
                      {"run_values", q.run_values},
                      {"run_errors", q.run_errors},
                      {"verdict", name_of(q.verdict)},
                      {"sentence", q.sentence}});
}

/// Half widths of the error bars of the time series of the first run.
Json bands_json(const StudyResult& result) {
    Json bands = Json::array();
    for (std::size_t c = 0; c < result.bands.size(); ++c) {
        if (result.bands[c].empty()) continue;
        const SeriesColumn& what = result.runs.front().columns[c].what;
        bands.push_back(object_of(
            {{"probe", what.probe}, {"quantity", what.quantity}, {"unit", what.unit}, {"errors", result.bands[c]}}));
    }
    return bands;
}

}  // namespace

std::string study_json(const StudyResult& result) {
    Json json = object_of({{"schema", "skerry.study/1"},
                           {"scene", result.scene},
                           {"quantities", Json::array()},
                           {"wanted_error", result.wanted_error},
                           {"cheapest", nullptr},
                           {"agree_until", result.agree_until},
                           {"growth_rate", result.growth_rate},
                           {"sentences", result.sentences},
                           {"runs", Json::array()}});
    for (const StudyQuantity& quantity : result.quantities) json["quantities"].push_back(quantity_json(quantity));
    if (const std::optional<CheapestSettings>& cheapest = result.cheapest)
        json["cheapest"] = object_of({{"set", cheapest->assignments},
                                      {"variant", variant_json(cheapest->variant)},
                                      {"reaches", cheapest->reaches},
                                      {"error", cheapest->error},
                                      {"cpu_seconds", cheapest->cpu_seconds},
                                      {"sentence", cheapest->sentence}});
    for (const StudyRun& run : result.runs) json["runs"].push_back(run_json(run));
    json["bands"] = bands_json(result);
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace skerry
