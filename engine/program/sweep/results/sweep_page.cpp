#include "engine/output/table/table_page.h"
#include "engine/program/sweep/results/sweep_table.h"

namespace skerry {

namespace {

Json rows_json(const SweepTable& table) {
    Json rows = Json::array();
    for (std::size_t i = 0; i < table.files.size(); ++i) {
        const CaseFile& file = table.files[i];
        const bool has_result = file.state == CaseFileState::whole;
        Json values = Json::object(), figures = Json::object();
        for (std::size_t p = 0; p < table.cases.parameters.size(); ++p)
            if (table.cases.values[i][p]) values[table.cases.parameters[p].name] = *table.cases.values[i][p];
        // Json writes a value that is not finite as null.
        for (const auto& [name, value] : file.result.figures) figures[name] = value;
        rows.push_back(object_of({{"case", i},
                                  {"status", has_result ? name_of(file.result.status) : "not run"},
                                  {"message", file.result.message},
                                  {"warnings", file.result.warnings},
                                  {"values", values},
                                  {"figures", figures}}));
    }
    return rows;
}

}  // namespace

std::string table_page(const SweepTable& table) {
    Json parameters = Json::array();
    for (const Parameter& parameter : table.cases.parameters) parameters.push_back(parameter.name);
    const Json data = object_of({{"name", table.sweep.name},
                                 {"description", table.sweep.description},
                                 {"scene", table.sweep.scene.path.filename().string()},
                                 {"parameters", parameters},
                                 {"figures", figure_names(table)},
                                 {"rows", rows_json(table)}});
    return table_page(table.sweep.name, data.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace skerry
