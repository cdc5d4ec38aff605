#include "engine/program/series_figures.h"

#include <algorithm>

#include "engine/output/series/series_figures.h"

namespace skerry {

namespace {

/// Ending of the name of a figure with this unit, for example _m_s for m/s.
std::string ending(std::string unit) {
    if (unit == "1") return {};
    std::ranges::replace_if(
        unit, [](char c) { return c == ' ' || c == '/'; }, '_');
    return "_" + unit;
}

std::vector<Real> values_of(const Recorder& recorder, std::size_t column) {
    std::vector<Real> values;
    for (std::size_t row = 0; row < recorder.row_count(); ++row) values.push_back(recorder.row(row)[column]);
    return values;
}

}  // namespace

std::vector<std::pair<std::string, double>> named_figures(const Recorder& recorder) {
    std::vector<std::pair<std::string, double>> named;
    const std::vector<Real> time = values_of(recorder, 0);
    for (std::size_t c = 1; c < recorder.columns().size(); ++c) {
        const SeriesColumn& column = recorder.columns()[c];
        const SeriesFigures figures = series_figures(time, values_of(recorder, c));
        const auto add = [&](const char* which, double value) {
            named.emplace_back(column.probe + "." + column.quantity + which + ending(column.unit), value);
        };
        add("_end", figures.end);
        add("_min", figures.least);
        add("_max", figures.most);
        add("_mean", figures.mean);
    }
    return named;
}

}  // namespace skerry
