#include "engine/program/series_figures.h"

#include <algorithm>

#include "engine/output/series/series_summary.h"

namespace skerry {

namespace {

/// Returns the part of a figure's name that gives its unit, for example _m_s for m/s.
std::string ending(std::string unit) {
    if (unit == "1") return {};
    std::ranges::replace_if(
        unit, [](char c) { return c == ' ' || c == '/'; }, '_');
    return "_" + unit;
}

}  // namespace

SeriesFigures::SeriesFigures(World& world, const std::vector<RecordedProbe>& probes) : recorder_(world, probes) {
    recorder_.sample(world);
}

void SeriesFigures::sample(const World& world) {
    recorder_.sample(world);
}

std::vector<std::pair<std::string, double>> SeriesFigures::all() const {
    std::vector<std::pair<std::string, double>> figures;
    const auto values_of = [this](std::size_t column) {
        std::vector<Real> values;
        for (std::size_t row = 0; row < recorder_.row_count(); ++row) values.push_back(recorder_.row(row)[column]);
        return values;
    };
    const std::vector<Real> time = values_of(0);
    for (std::size_t c = 1; c < recorder_.columns().size(); ++c) {
        const SeriesSummary summary = summary_of_series(time, values_of(c));
        const SeriesColumn& column = recorder_.columns()[c];
        const auto add = [&](const char* statistic, double value) {
            figures.emplace_back(column.probe + "." + column.quantity + statistic + ending(column.unit), value);
        };
        add("_end", summary.end);
        add("_min", summary.least);
        add("_max", summary.most);
        add("_mean", summary.mean);
    }
    return figures;
}

}  // namespace skerry
