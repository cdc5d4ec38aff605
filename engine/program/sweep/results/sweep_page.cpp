#include "engine/program/sweep/results/sweep_page.h"

#include "engine/output/escape_markup.h"
#include "engine/program/sweep/results/sweep_table.h"

namespace skerry {

namespace {

/// Returns JSON text for use inside a script element. The text "</" would end the element and is escaped.
std::string script_text(const Json& json) {
    std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    for (std::size_t at = text.find("</"); at != std::string::npos; at = text.find("</", at))
        text.replace(at, 2, "<\\/");
    return text;
}

Json rows_json(const SweepTable& table) {
    Json rows = Json::array();
    for (std::size_t i = 0; i < table.files.size(); ++i) {
        const CaseFile& file = table.files[i];
        const bool whole = file.state == CaseFileState::whole;
        Json values = Json::object(), figures = Json::object();
        for (std::size_t p = 0; p < table.cases.parameters.size(); ++p)
            if (table.cases.values[i][p]) values[table.cases.parameters[p].name] = *table.cases.values[i][p];
        // A value that is not finite becomes null.
        for (const auto& [name, value] : file.result.figures) figures[name] = value;
        rows.push_back({{"case", i},
                        {"status", whole ? name_of(file.result.status) : "not run"},
                        {"message", file.result.message},
                        {"warnings", file.result.warnings},
                        {"values", values},
                        {"figures", figures}});
    }
    return rows;
}

/// Replaces the first occurrence of `mark` in `text` by `part`.
void put_in(const std::string& mark, const std::string& part, std::string& text) {
    const std::size_t at = text.find(mark);
    if (at != std::string::npos) text.replace(at, mark.size(), part);
}

}  // namespace

std::string table_page(const SweepTable& table) {
    Json parameters = Json::array();
    for (const Parameter& parameter : table.cases.parameters) parameters.push_back(parameter.name);
    const Json data = {{"name", table.sweep.name},
                       {"description", table.sweep.description},
                       {"scene", table.sweep.scene.path.filename().string()},
                       {"parameters", parameters},
                       {"figures", figure_names(table)},
                       {"rows", rows_json(table)}};
    std::string page(sweep_page_html);
    // @DATA@ is replaced first because @TITLE@ comes before it in the page. The search for @TITLE@ then cannot find a
    // text in the data.
    put_in("@DATA@", script_text(data), page);
    put_in("@TITLE@", escape_markup(table.sweep.name), page);
    return page;
}

}  // namespace skerry
