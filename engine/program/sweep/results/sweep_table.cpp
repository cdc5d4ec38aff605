#include "engine/program/sweep/results/sweep_table.h"

#include <algorithm>
#include <cmath>

#include "engine/output/number_text.h"
#include "engine/program/csv_text.h"

namespace skerry {

namespace {

constexpr int most_lines = 60;  // largest number of cases in the table on the terminal
constexpr int most_messages = 10;
// The table on the terminal shows figures of probes if the name of the figure has one of these endings.
constexpr const char* shown_of_probes[] = {".slip_m", ".largest_force_max_N", ".largest_von_mises_max_Pa",
                                           ".smallest_volume_ratio_min"};

using Cells = std::vector<std::string>;

std::string number_cell(double value) {
    return std::isfinite(value) ? short_text(value, 5) : "-";
}

double figure_of(const CaseResult& result, std::string_view name) {
    const auto found = std::ranges::find(result.figures, name, [](const auto& figure) { return figure.first; });
    return found == result.figures.end() ? std::nan("") : found->second;
}

/// Returns the names of the numbers that the table on the terminal shows.
std::vector<std::string> shown_figures(const SweepTable& table) {
    std::vector<std::string> names{"seconds_simulated", "steps",         "seconds_cpu",
                                   "contacts_mean",     "penetration_m", "energy_error_share"};
    for (const std::string& name : figure_names(table))
        if (std::ranges::any_of(shown_of_probes, [&](const char* end) { return name.ends_with(end); }))
            names.push_back(name);
    names.emplace_back("warnings");
    return names;
}

std::string value_cell(const std::optional<Json>& value) {
    if (!value) return "-";
    if (value->is_number_float()) return short_text(value->get<double>(), 6);
    return value->is_string() ? value->get<std::string>() : value->dump();
}

Cells case_cells(const SweepTable& table, int index, const std::vector<std::string>& shown) {
    const auto row = static_cast<std::size_t>(index);
    const CaseFile& file = table.files[row];
    const bool has_result = file.state == CaseFileState::whole;
    Cells cells{std::to_string(index)};
    for (const std::optional<Json>& value : table.cases.values[row]) cells.push_back(value_cell(value));
    cells.emplace_back(has_result ? name_of(file.result.status) : "not run");
    for (const std::string& name : shown) cells.push_back(number_cell(figure_of(file.result, name)));
    return cells;
}

std::string aligned(const std::vector<Cells>& lines) {
    std::vector<std::size_t> width;
    for (const Cells& cells : lines) {
        width.resize(std::max(width.size(), cells.size()));
        for (std::size_t i = 0; i < cells.size(); ++i) width[i] = std::max(width[i], cells[i].size());
    }
    std::string text;
    for (const Cells& cells : lines) {
        for (std::size_t i = 0; i < cells.size(); ++i)
            text += (i == 0 ? "" : "  ") + std::string(width[i] - cells[i].size(), ' ') + cells[i];
        text += "\n";
    }
    return text;
}

std::string messages_text(const SweepTable& table) {
    std::string text;
    int listed = 0, omitted = 0;
    for (const CaseFile& file : table.files) {
        const CaseResult& result = file.result;
        if (file.state != CaseFileState::whole || (result.message.empty() && result.warnings.empty())) continue;
        if (listed++ >= most_messages) {
            ++omitted;
            continue;
        }
        const std::string case_name = "case " + std::to_string(result.index) + " ";
        if (!result.message.empty())
            text += case_name + std::string(name_of(result.status)) + ": " + result.message + "\n";
        for (const std::string& warning : result.warnings) text += case_name + "WARNING: " + warning + "\n";
    }
    if (omitted > 0)
        text += "... " + std::to_string(omitted) + " more cases have messages or warnings; sweep.csv lists them all\n";
    return text;
}

std::string totals_text(const SweepTable& table) {
    int counts[3] = {0, 0, 0}, warned = 0, missing = 0;
    double cpu = 0;
    for (const CaseFile& file : table.files) {
        if (file.state != CaseFileState::whole) {
            ++missing;
            continue;
        }
        ++counts[static_cast<int>(file.result.status)];
        if (!file.result.warnings.empty()) ++warned;
        cpu += figure_of(file.result, "seconds_cpu");
    }
    std::string text = std::to_string(table.cases.count()) + " cases: " + std::to_string(counts[0]) + " ok";
    const auto add = [&text](int count, const char* description) {
        if (count > 0) text += ", " + std::to_string(count) + " " + description;
    };
    add(counts[1], "failed");
    add(counts[2], "refused");
    add(missing, "not run");
    add(warned, "with warnings");
    return text + "; " + duration_text(cpu) + " of CPU time in total\n";
}

/// Returns a note if at least two cases were simulated and all simulated cases ended in bitwise equal states: the
/// parameters then had no effect. Otherwise returns an empty text.
std::string sameness_text(const SweepTable& table) {
    std::string hash;
    int simulated = 0;
    for (const CaseFile& file : table.files) {
        if (file.state != CaseFileState::whole || file.result.state_hash.empty()) continue;
        if (!hash.empty() && file.result.state_hash != hash) return {};
        hash = file.result.state_hash;
        ++simulated;
    }
    return simulated > 1 ? "All " + std::to_string(simulated) +
                               " cases that ran ended in the same state: the parameters had no effect\n"
                         : "";
}

std::string joined(const std::vector<std::string>& sentences) {
    std::string text;
    for (const std::string& sentence : sentences) text += (text.empty() ? "" : "; ") + sentence;
    return text;
}

}  // namespace

std::vector<std::string> figure_names(const SweepTable& table) {
    std::vector<std::string> names;
    for (const CaseFile& file : table.files)
        for (const auto& [name, value] : file.result.figures)
            if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    return names;
}

std::string table_text(const SweepTable& table) {
    const std::vector<std::string> shown = shown_figures(table);
    Cells head{std::string(case_column)};
    for (const Parameter& parameter : table.cases.parameters) head.push_back(parameter.name);
    head.emplace_back(status_column);
    head.insert(head.end(), shown.begin(), shown.end());
    std::vector<Cells> lines{head};
    const int count = std::min(table.cases.count(), most_lines);
    for (int i = 0; i < count; ++i) lines.push_back(case_cells(table, i, shown));
    std::string text = aligned(lines);
    if (count < table.cases.count())
        text += "... " + std::to_string(table.cases.count() - count) + " more cases in sweep.csv\n";
    return text + messages_text(table) + sameness_text(table) + totals_text(table);
}

std::string table_csv(const SweepTable& table) {
    const std::vector<std::string> figures = figure_names(table);
    Cells head{std::string(case_column)};
    for (const Parameter& parameter : table.cases.parameters) head.push_back(parameter.name);
    head.emplace_back(status_column);
    head.insert(head.end(), figures.begin(), figures.end());
    for (const std::string_view name : {hash_column, message_column, warnings_column}) head.emplace_back(name);
    std::string csv;
    add_csv_line(head, csv);
    for (std::size_t i = 0; i < table.files.size(); ++i) {
        const CaseFile& file = table.files[i];
        Cells cells{std::to_string(i)};
        for (const std::optional<Json>& value : table.cases.values[i])
            cells.push_back(!value               ? std::string()
                            : value->is_string() ? value->get<std::string>()
                            : value->is_number() ? csv_number(value->get<double>())
                                                 : value->dump());
        cells.emplace_back(file.state == CaseFileState::whole ? name_of(file.result.status) : "not run");
        for (const std::string& name : figures) cells.push_back(csv_number(figure_of(file.result, name)));
        cells.insert(cells.end(), {file.result.state_hash, file.result.message, joined(file.result.warnings)});
        add_csv_line(cells, csv);
    }
    return csv;
}

}  // namespace skerry
