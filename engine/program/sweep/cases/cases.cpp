#include "engine/program/sweep/cases/cases.h"

#include <algorithm>
#include <array>

#include "engine/program/sweep/cases/draw.h"

namespace skerry {

namespace {

using Row = std::vector<std::optional<Json>>;

void add_parameter(Cases& cases, const std::string& name, const std::vector<std::string>& places, const Place& place) {
    if (places.empty()) place.key("set").refuse("an empty list", "at least one place in the scene");
    const std::string own = name.empty() ? places.front() : name;
    constexpr std::array columns{case_column, status_column, message_column, warnings_column, hash_column};
    if (std::ranges::find(columns, own) != columns.end())
        place.key("name").refuse(in_quotes(own) + ", which is reserved for a column of the results",
                                 "another name for the parameter");
    for (const Parameter& other : cases.parameters)
        if (other.name == own)
            place.key("name").refuse(in_quotes(own) + ", which is already the name of a parameter",
                                     "a different name for every parameter");
    cases.parameters.push_back({own, {}, place});
    for (const std::string& at : places) {
        for (const Parameter& other : cases.parameters)
            if (std::ranges::find(other.places, at) != other.places.end())
                place.key("set").refuse(
                    in_quotes(at) + ", which the parameter " + in_quotes(other.name) + " already sets",
                    "a place that no parameter sets yet");
        cases.parameters.back().places.push_back(at);
    }
}

std::vector<Json> values_of(const GridEntry& entry) {
    std::vector<Json> values;
    for (const AnyValue& value : entry.values) values.push_back(value.json);
    if (entry.from)
        for (int i = 0; i < entry.count; ++i)
            values.emplace_back(spaced(*entry.from, *entry.to, entry.count, i, entry.spacing));
    return values;
}

void expand_grid(const SweepFile& sweep, Cases& cases) {
    cases.values.emplace_back();
    for (std::size_t p = 0; p < sweep.grid.size(); ++p) {
        const GridEntry& entry = sweep.grid[p];
        add_parameter(cases, entry.name, entry.set.items, entry.place);
        const std::vector<Json> values = values_of(entry);
        if (values.size() * cases.values.size() > most_cases)
            sweep.place.key("grid").refuse(std::to_string(values.size() * cases.values.size()) +
                                               " combinations of the first " + std::to_string(p + 1) + " parameters",
                                           "at most " + std::to_string(most_cases) + " cases in all",
                                           "use fewer parameters or fewer values");
        std::vector<Row> rows;
        for (const Row& row : cases.values)
            for (const Json& value : values) rows.emplace_back(row).emplace_back(value);
        cases.values = std::move(rows);
    }
}

void expand_list(const SweepFile& sweep, Cases& cases) {
    const Place place = sweep.place.key("list");
    if (sweep.list.size() > most_cases)
        place.refuse("a list of " + std::to_string(sweep.list.size()) + " cases",
                     "at most " + std::to_string(most_cases) + " cases");
    for (std::size_t i = 0; i < sweep.list.size(); ++i) {
        Row& row = cases.values.emplace_back(cases.parameters.size());
        for (const auto& [name, value] : sweep.list[i].items) {
            const auto found = std::ranges::find(cases.parameters, name, &Parameter::name);
            const auto column = static_cast<std::size_t>(found - cases.parameters.begin());
            if (found == cases.parameters.end()) {
                add_parameter(cases, name, {name}, place.item(i));
                row.emplace_back();
            }
            row[column] = value.json;
        }
    }
    for (Row& row : cases.values) row.resize(cases.parameters.size());
}

void expand_random(const RandomEntry& random, Cases& cases) {
    for (const DrawnEntry& entry : random.parameters) add_parameter(cases, entry.name, entry.set.items, entry.place);
    // All parameters of a case are drawn before the next case. A larger count therefore leaves the earlier cases
    // unchanged.
    Draws draws(random.seed);
    for (int i = 0; i < random.count; ++i) {
        Row& row = cases.values.emplace_back();
        for (const DrawnEntry& entry : random.parameters) {
            const double value = draws.draw(entry);
            row.emplace_back(entry.distribution == Distribution::integer ? Json(static_cast<std::int64_t>(value))
                                                                         : Json(value));
        }
    }
}

}  // namespace

Cases cases_of(const SweepFile& sweep) {
    Cases cases;
    if (sweep.random)
        expand_random(*sweep.random, cases);
    else if (!sweep.grid.empty())
        expand_grid(sweep, cases);
    else
        expand_list(sweep, cases);
    return cases;
}

std::vector<std::string> assignments_of(const SweepFile& sweep, const Cases& cases, int index) {
    std::vector<std::string> assignments;
    for (const auto& [place, value] : sweep.set.items) assignments.push_back(place + "=" + value.json.dump());
    const Row& row = cases.values[static_cast<std::size_t>(index)];
    for (std::size_t p = 0; p < row.size(); ++p)
        if (row[p])
            for (const std::string& place : cases.parameters[p].places)
                assignments.push_back(place + "=" + row[p]->dump());
    return assignments;
}

std::string case_text(const Cases& cases, int index) {
    std::string text;
    const Row& row = cases.values[static_cast<std::size_t>(index)];
    for (std::size_t p = 0; p < row.size(); ++p)
        if (row[p]) text += (text.empty() ? "" : ", ") + cases.parameters[p].name + "=" + row[p]->dump();
    return text;
}

}  // namespace skerry
