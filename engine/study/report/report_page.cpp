#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/output/json_object.h"
#include "engine/output/number_text.h"
#include "engine/output/table/table_page.h"
#include "engine/study/report/wording.h"
#include "skerry/study.h"

namespace skerry {

namespace {

constexpr const char* cpu_time = "CPU time [s]";
constexpr std::size_t most_rows = 400;  // largest number of rows of a time series in the page

std::string heading(const StudyQuantity& q) {
    return q.name + " [" + q.unit + "]";
}
std::string error_heading(const StudyQuantity& q) {
    return "error of " + heading(q);
}

/// True for a quantity that is zero except for rounding, such as the horizontal component of a vertical force.
bool is_zero(const StudyQuantity& q) {
    constexpr Real rounding = 1e-9;
    return q.verdict == StudyVerdict::known && std::abs(q.value) + q.error <= rounding * q.scale;
}

Json run_rows(const StudyResult& result) {
    Json rows = Json::array();
    for (std::size_t i = 0; i < result.runs.size(); ++i) {
        const StudyRun& run = result.runs[i];
        Json figures = {{cpu_time, run.cpu_seconds}, {"steps", run.steps}, {"tetrahedra", run.tetrahedra}};
        for (const StudyQuantity& q : result.quantities) {
            if (i >= q.run_values.size()) continue;
            figures[heading(q)] = q.run_values[i];
            figures[error_heading(q)] = q.run_errors[i];
        }
        std::string changes;
        for (const std::string& assignment : run.assignments) changes += (changes.empty() ? "" : " ") + assignment;
        rows.push_back(object_of({{"case", i},
                                  {"status", run.status == StudyRunStatus::left_out ? "left out" : name_of(run.status)},
                                  {"message", run.message},
                                  {"warnings", run.warnings},
                                  {"values", object_of({{"settings", variant_text(run.variant)},
                                                        {"mesh level", run.variant.refine},
                                                        {"step", run.variant.step},
                                                        {"tolerance", run.variant.tolerance},
                                                        {"assignments", changes}})},
                                  {"figures", figures}}));
    }
    return rows;
}

/// Returns the table without the columns whose cells are empty in all rows below the heading.
Json without_empty_columns(const Json& rows) {
    Json kept = Json::array();
    for (const Json& row : rows) {
        Json& cells = kept.emplace_back(Json::array());
        for (std::size_t c = 0; c < row.size(); ++c)
            if (std::any_of(rows.begin() + 1, rows.end(), [c](const Json& any) { return any[c] != ""; }))
                cells.push_back(row[c]);
    }
    return kept;
}

Json summary_table(const StudyResult& result) {
    Json rows = {{"quantity", "value", "relative", "verdict", "parts", "best value", "orders", "remark"}};
    for (const StudyQuantity& q : result.quantities) {
        if (is_zero(q)) continue;
        const QuantityText text = quantity_text(q);
        const auto with_bar = [](const std::string& value, const std::string& error) {
            return error.empty() ? value : value + " \u00b1 " + error;
        };
        // The sentences of all quantities with a verdict other than `known` are left out here, because the notes above
        // the table contain them.
        rows.push_back({q.name, with_bar(text.value, text.error) + " " + text.unit, text.share, name_of(q.verdict),
                        text.parts, with_bar(text.best, text.best_error), text.orders,
                        q.verdict == StudyVerdict::known ? q.sentence : std::string()});
    }
    return without_empty_columns(rows);
}

Json time_series(const StudyResult& result) {
    const StudyRun& scene = result.runs.front();
    const std::size_t stride = (scene.time.size() + most_rows - 1) / most_rows;
    const auto thinned = [stride](const std::vector<Real>& values) {
        Json list = Json::array();
        for (std::size_t row = 0; row < values.size(); row += std::max<std::size_t>(stride, 1)) {
            constexpr int digits = 7;
            list.push_back(std::isfinite(values[row]) ? Json(std::stod(short_text(values[row], digits))) : Json());
        }
        return list;
    };
    Json columns = Json::array();
    for (std::size_t column = 0; column < result.bands.size(); ++column) {
        if (result.bands[column].empty()) continue;
        Json runs = Json::array();
        for (const StudyRun& run : result.runs)
            runs.push_back(run.time == scene.time && column < run.columns.size() ? thinned(run.columns[column].values)
                                                                                 : Json());
        columns.push_back(object_of(
            {{"name", scene.columns[column].what.heading()}, {"runs", runs}, {"band", thinned(result.bands[column])}}));
    }
    return object_of({{"time", thinned(scene.time)}, {"columns", columns}});
}

}  // namespace

std::string study_page(const StudyResult& result) {
    Json figures = {cpu_time, "steps", "tetrahedra"};
    std::string first_error;
    for (const StudyQuantity& q : result.quantities) {
        figures.push_back(heading(q));
        figures.push_back(error_heading(q));
        // The plot opens with the first quantity that is not a small component of a vector.
        constexpr Real main_share = 0.1;
        if (first_error.empty() && q.error > 0 && std::isfinite(q.error) && std::abs(q.value) > main_share * q.scale)
            first_error = error_heading(q);
    }
    std::vector<std::string> notes = result.sentences;
    for (const std::vector<std::string>& lines : {verdict_lines(result), missing_lines(result)})
        notes.insert(notes.end(), lines.begin(), lines.end());
    if (result.cheapest) {
        const CheapestSettings& cheapest = *result.cheapest;
        notes.push_back((cheapest.reaches ? "Cheapest settings for an error of " : "Nearest to an error of ") +
                        percent(result.wanted_error) + ": " + variant_text(cheapest.variant) + "; predicted error " +
                        percent(cheapest.error) + ", CPU time " + duration_text(cheapest.cpu_seconds) + "; " +
                        cheapest.sentence + ".");
    }
    const Json data = object_of(
        {{"name", "Study of " + result.scene},
         {"description", "Error bars of each quantity, from runs with other meshes, steps, tolerances and elements."},
         {"noun", "run"},
         {"scene", result.scene},
         {"parameters", {"settings", "mesh level", "step", "tolerance", "assignments"}},
         {"figures", figures},
         {"tabled", {cpu_time, "steps", "tetrahedra"}},
         {"rows", run_rows(result)},
         {"start", object_of({{"x", cpu_time},
                              {"y", first_error.empty() ? "steps" : first_error},
                              {"color", "settings"},
                              {"logX", true},
                              {"logY", true},
                              {"lines", false}})},
         {"notes", notes},
         {"summary", summary_table(result)},
         {"series", time_series(result)}});
    return table_page("Study of " + result.scene, data.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace skerry
